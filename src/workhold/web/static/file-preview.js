/**
 * As much of a refused file as can be drawn without the server, so that its fault can be shown in its place.
 *
 * Lines, circles, arcs and polylines of a DXF, in its own coordinates, and the loops of a JSON file. Nothing here decides
 * anything; what cannot be read is left out of the picture.
 */

const LARGEST = 4_000_000;
const MOST = 20_000;

/**
 * Chains of [x, y, bulge] in mm as the file draws them.
 * @param {File} file
 * @returns {Promise<number[][][]>}
 */
export async function previewOf(file) {
  if (file.size > LARGEST) return [];
  const text = await file.text();
  if (/\.json$/i.test(file.name)) return jsonChains(text);
  if (/\.dxf$/i.test(file.name)) return dxfChains(text);
  return [];
}

/** The loops of a part in JSON. */
function jsonChains(text) {
  const content = JSON.parse(text);
  const factor = content.units === "inch" ? 25.4 : 1;
  const loops = Array.isArray(content.loops) ? content.loops : [];
  return loops
    .filter((loop) => Array.isArray(loop) && loop.length > 1)
    .map((loop) => [...loop, loop[0]].map(([x, y, bulge]) => [x * factor, y * factor, bulge ?? 0]));
}

/** Millimetres of the unit that a DXF names in its header, $INSUNITS. */
const UNITS = { 1: 25.4, 2: 304.8, 4: 1, 5: 10, 6: 1000 };

/**
 * Entities of a DXF in text form: pairs of a code and a value, a line each.
 * @param {string} text
 */
export function dxfChains(text) {
  const lines = text.split(/\r\n|\n|\r/);
  const pairs = [];
  for (let k = 0; k + 1 < lines.length; k += 2) pairs.push([Number(lines[k]), lines[k + 1].trim()]);
  const named = pairs.findIndex(([code, value]) => code === 9 && value === "$INSUNITS");
  const factor = named < 0 ? 1 : UNITS[pairs[named + 1]?.[1]] ?? 1;
  let at = pairs.findIndex(([code, value], k) => code === 2 && value === "ENTITIES" && pairs[k - 1]?.[1] === "SECTION");
  if (at < 0) return [];
  const chains = [];
  while (at < pairs.length && chains.length < MOST) {
    if (pairs[at][0] !== 0) {
      at += 1;
      continue;
    }
    const kind = pairs[at][1];
    if (kind === "ENDSEC") break;
    const own = [];
    for (at += 1; at < pairs.length && pairs[at][0] !== 0; at += 1) own.push(pairs[at]);
    const chain = chainOf(kind, own);
    if (chain) chains.push(chain.map(([x, y, bulge]) => [x * factor, y * factor, bulge]));
  }
  return chains.filter((chain) => chain.every((vertex) => vertex.every(Number.isFinite)));
}

/** One entity as a chain; null for a kind that is not drawn. */
function chainOf(kind, pairs) {
  const value = (code) => Number(pairs.find(([each]) => each === code)?.[1] ?? NaN);
  if (kind === "LINE") return [[value(10), value(20), 0], [value(11), value(21), 0]];
  if (kind === "CIRCLE") {
    const [x, y, r] = [value(10), value(20), value(40)];
    return [[x - r, y, 1], [x + r, y, 1], [x - r, y, 0]];
  }
  if (kind === "ARC") {
    const [x, y, r] = [value(10), value(20), value(40)];
    const from = (value(50) * Math.PI) / 180;
    const sweep = ((((value(51) - value(50)) % 360) + 360) % 360 || 360) * (Math.PI / 180);
    return [0, 0.5, 1].map((share) => [
      x + r * Math.cos(from + share * sweep), y + r * Math.sin(from + share * sweep), Math.tan(sweep / 8),
    ]);
  }
  if (kind === "LWPOLYLINE") {
    const chain = [];
    for (const [code, text] of pairs) {
      if (code === 10) chain.push([Number(text), 0, 0]);
      else if (code === 20 && chain.length) chain[chain.length - 1][1] = Number(text);
      else if (code === 42 && chain.length) chain[chain.length - 1][2] = Number(text);
    }
    if (value(70) & 1 && chain.length) chain.push([...chain[0]]);
    return chain.length > 1 ? chain : null;
  }
  return null;
}
