/**
 * Where a fixture puts things: the part's pose, contacts and holes, in mm in the vise frame.
 *
 * A pose maps a point q of the part to R(theta) q + (x, y).
 */
import { nearest, normalAt, pointAt, segmentsOf } from "./geometry.js";

/** @typedef {{theta_deg: number, x: number, y: number, holes: string[], faces: number[], pegs: number[][], forces: number[], jaw_separation: number}} Row */

/**
 * A function that carries points of the part into the vise.
 * @param {Row} row
 * @returns {(point: number[]) => number[]}
 */
export function intoVise(row) {
  const [c, s] = turn(row);
  return ([x, y]) => [c * x - s * y + row.x, s * x + c * y + row.y];
}

/**
 * A function that carries points of the vise back into the part's coordinates.
 * @param {Row} row
 * @returns {(point: number[]) => number[]}
 */
export function intoPart(row) {
  const [c, s] = turn(row);
  return ([x, y]) => [c * (x - row.x) + s * (y - row.y), -s * (x - row.x) + c * (y - row.y)];
}

/**
 * Cosine and sine of the pose's angle.
 * @param {Row} row
 */
export function turn(row) {
  const angle = (row.theta_deg * Math.PI) / 180;
  return [Math.cos(angle), Math.sin(angle)];
}

/**
 * The pose as an SVG matrix.
 * @param {Row} row
 */
export function poseMatrix(row) {
  const [c, s] = turn(row);
  return `matrix(${c} ${s} ${-s} ${c} ${row.x} ${row.y})`;
}

/** @type {WeakMap<any, {segment: any, face: number}[]>} */
const known = new WeakMap();

/**
 * All segments of a part with the faces they belong to, in the order of their numbers.
 * @param {any} part
 * @returns {{segment: import("./geometry.js").Segment, face: number}[]}
 */
export function partSegments(part) {
  let segments = known.get(part);
  if (!segments) {
    segments = part.loops.flatMap(segmentsOf).map((segment, k) => ({ segment, face: part.segments[k].face }));
    known.set(part, segments);
  }
  return segments;
}

/**
 * Where the pegs of a fixture touch the part, in part coordinates: contact, outward unit normal, whether on the right jaw.
 * @param {any} part
 * @param {Row} row
 * @returns {{peg: number[], contact: number[], normal: number[], right: boolean}[]}
 */
export function contactsOf(part, row) {
  const back = intoPart(row);
  return row.pegs.map((center, k) => {
    const peg = back(center);
    let best = null;
    for (const { segment, face } of partSegments(part)) {
      if (face !== row.faces[k]) continue;
      const found = nearest(segment, peg);
      if (!best || found.distance < best.distance) best = { ...found, segment };
    }
    if (!best) throw new Error(`face ${row.faces[k]} is not one of the part`);
    return {
      peg,
      contact: pointAt(best.segment, best.share),
      normal: normalAt(best.segment, best.share),
      right: row.holes[k].startsWith("R"),
    };
  });
}

/**
 * Column and row of a hole's name, both from 0.
 * @param {string} name such as "L-B3"
 */
export function holeOf(name) {
  const match = /^([LR])-([A-Z]+)(\d+)$/.exec(name);
  if (!match) throw new Error(`${name} names no hole`);
  let column = 0;
  for (const letter of match[2]) column = 26 * column + letter.charCodeAt(0) - 64;
  return { right: match[1] === "R", column: column - 1, row: Number(match[3]) - 1 };
}

/**
 * Letters of a column counted from 0: A to Z, then AA and so on.
 * @param {number} column
 */
export function columnLetters(column) {
  let letters = "";
  for (let rest = column + 1; rest > 0; rest = Math.floor((rest - 1) / 26)) {
    letters = String.fromCharCode(65 + ((rest - 1) % 26)) + letters;
  }
  return letters;
}

/**
 * The jaws as far as they show: plate, columns and rows in reach of part and pegs.
 * @param {any} vise fields
 * @param {Row} row
 * @param {number[]} reach box of the part in the vise frame
 */
export function jawViews(vise, row, reach) {
  const [pitchX, pitchY] = vise.pitch;
  const box = [...reach];
  for (const [x, y] of row.pegs) {
    box[0] = Math.min(box[0], x);
    box[1] = Math.min(box[1], y);
    box[2] = Math.max(box[2], x);
    box[3] = Math.max(box[3], y);
  }
  const more = Math.max(box[2] - box[0], box[3] - box[1]) / 14;
  const [moreX, moreY] = [Math.max(more, pitchX), Math.max(more, pitchY)];
  return [false, true].map((right) => {
    const x0 = right ? (vise.columns - 1) * pitchX + row.jaw_separation : 0;
    const y0 = right ? vise.row_offset ?? 0 : 0;
    let columns = inReach(box[0] - moreX - x0, box[2] + moreX - x0, pitchX, vise.columns);
    // The columns next to the opening always show: the jaw separation is measured from there.
    columns = right ? [0, columns[1]] : [columns[0], vise.columns - 1];
    const rows = inReach(box[1] - moreY - y0, box[3] + moreY - y0, pitchY, vise.rows ?? null);
    const inner = Math.min(pitchX / 2, Math.max(1.25 * vise.peg_radius, 0.48 * row.jaw_separation));
    const [left, after] = right ? [inner, pitchX / 2] : [pitchX / 2, inner];
    return {
      right, x0, y0, columns, rows,
      plate: [
        x0 + columns[0] * pitchX - left, y0 + (rows[0] - 0.5) * pitchY,
        x0 + columns[1] * pitchX + after, y0 + (rows[1] + 0.5) * pitchY,
      ],
    };
  });
}

/** First and last of the columns or rows between two distances from the first one; at least one. */
function inReach(low, high, pitch, count) {
  let last = Math.floor(high / pitch + 1e-6);
  let first = Math.ceil(low / pitch - 1e-6);
  if (count !== null) [last, first] = [Math.min(last, count - 1), Math.min(first, count - 1)];
  return [Math.max(first, 0), Math.max(last, first, 0)];
}
