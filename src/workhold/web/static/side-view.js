/**
 * A set-up from the side, to scale: part, pegs with the heights at which they press, supports, and the clamp on top.
 */
import { draw } from "./dom.js";
import { bareLength, forceAlone } from "./units.js";

/** @typedef {{name: string, kind: string, x: number[], y: number[], z: number[]}} BodyBox extents in mm in the toolkit's frame */

/** Room for lettering in pixels: top, right, bottom, left. */
const MARGINS = [30, 52, 20, 14];
const HIGHEST = 230;
const AIR = 8;
/** What is drawn first lies behind. */
const ORDER = ["plate", "wall", "support", "part", "peg", "clamp"];
const LEAST_APART = 13;

/**
 * Draw one view.
 * @param {SVGSVGElement} svg as wide as there is room
 * @param {{boxes: BodyBox[], thickness: number, peg_height: number, bands: number[][]}} seen
 * @param {string[]} holes of the pegs, in the order of the bands
 * @param {{at: number[], force: number|null, height?: number}} clamp where it presses, with what force in N, and at which height
 * @param {"x"|"y"} across the axis that runs to the right
 */
export function drawSide(svg, seen, holes, clamp, across) {
  const { boxes, thickness, peg_height: top } = seen;
  const run = (box) => (across === "x" ? box.x : [-box.y[1], -box.y[0]]);
  const clampAt = across === "x" ? clamp.at[0] : -clamp.at[1];
  const shown = boxes.filter(({ kind }) => kind !== "plate");
  if (!shown.length) {
    svg.replaceChildren();
    return;
  }
  const [left, right] = [Math.min(...shown.map((box) => run(box)[0])) - AIR, Math.max(...shown.map((box) => run(box)[1])) + AIR];
  const [low, high] = [Math.min(...boxes.map((box) => box.z[0])), Math.max(...shown.map((box) => box.z[1]), thickness)];
  const wide = Math.max(svg.clientWidth || 320, 200);
  const [above, beside, under, before] = MARGINS;
  const k = Math.min((wide - before - beside) / (right - left), (HIGHEST - above - under) / (high - low));
  const tall = above + under + k * (high - low);
  const x = (at) => before + (wide - before - beside - k * (right - left)) / 2 + k * (at - left);
  const z = (at) => above + k * (high - at);
  const sorted = [...boxes].sort((a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind));
  const bodies = sorted.map((box) => {
    const [from, to] = box.kind === "plate" ? [Math.max(run(box)[0], left), Math.min(run(box)[1], right)] : run(box);
    return draw(`rect.side-${box.kind}`, { x: x(from), y: z(box.z[1]), width: Math.max(k * (to - from), 0), height: k * (box.z[1] - box.z[0]) }, draw("title", {}, box.name));
  });
  const bands = holes.flatMap((hole, number) => {
    const box = boxes.find(({ kind, name }) => kind === "peg" && name.endsWith(` ${hole}`));
    const band = seen.bands[number];
    if (!box || !band) return [];
    const middle = (run(box)[0] + run(box)[1]) / 2;
    return [draw("line.side-band", { x1: x(middle), x2: x(middle), y1: z(band[0]), y2: z(band[1]) })];
  });
  const tip = z(clamp.height ?? thickness);
  const press = clamp.force === null ? "clamp" : forceAlone(Math.ceil(clamp.force));
  const arrow = [
    draw("path.side-push", { d: `M${x(clampAt)} ${tip}l-5 -11h3.4v-10h3.2v10h3.4Z` }),
    draw("text.side-word", { x: Math.min(Math.max(x(clampAt), 26), wide - 26), y: Math.max(tip - 25, 11), "text-anchor": "middle" }, press),
  ];
  svg.setAttribute("viewBox", `0 0 ${wide} ${tall}`);
  svg.setAttribute("height", String(tall));
  svg.replaceChildren(...bodies, ...bands, ...arrow, ...ticks([0, top, thickness], wide - beside + 6, z));
}

/** Heights beside the view, none on another. */
function ticks(heights, at, z) {
  const places = [...new Set(heights)].sort((a, b) => a - b).map((height) => ({ height, y: z(height) }));
  places.forEach((place, k) => {
    if (k) place.y = Math.min(place.y, places[k - 1].y - LEAST_APART);
  });
  return places.flatMap(({ height, y }) => [
    draw("path.dimension", { d: `M${at - 4} ${z(height)}h6L${at + 6} ${y}` }),
    draw("text.side-word", { x: at + 9, y, dy: "0.36em" }, bareLength(height, 1)),
  ]);
}
