/**
 * Where a fixture puts things: the part's pose, contacts and holes, in mm in the vise frame.
 *
 * A pose maps a point q of the part to R(theta) q + (x, y).
 */
import { nearest, normalAt, pointAt, segmentsOf } from "./geometry.js";

/** @typedef {{theta_deg: number, x: number, y: number, holes: string[], faces: number[], touched: string[], corners: number[], flush: number[], pegs: number[][], forces: number[], jaw_separation: number, carriers: Carrier[], title: string, setting: {sign: string, name: string, length: number}|null, mover: string, order: string, origin: string}} Row */

/**
 * What shows of a carrier of holes, as the server tells it: the hole in column 0 and row 0, first and last column and row,
 * corners of its plate, numbers of its pegs, columns and rows that are used, the direction in which it slides to clamp or null.
 * A wall has no columns and rows either, and its plate is the bar that shows of it.
 * A clamp that is bolted to a plate comes last, without columns and rows; its plate is the room it takes.
 * @typedef {{letter: string, origin: number[], pitch: number[], columns: number[], rows: number[], plate: number[], hole_radius: number, names_at: string, pegs: number[], peg_radius: number, used_columns: number[], used_rows: number[], clamping: number[]|null, measured: number[][]|null, clamp: null|{draws_back: number|null, hole: number[]|null, tip: number[], bolt_radius: number, line: number[]}}} Carrier
 */

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
 * The turn in degrees as people write it: up to an eighth of a turn clockwise is a negative angle.
 * @param {Row} row
 */
export const writtenTurn = (row) => (row.theta_deg > 315 ? row.theta_deg - 360 : row.theta_deg);

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
 * All segments that something may touch: those of the part, then those that only carriers with heights of their own meet.
 * @param {any} part
 * @returns {{segment: import("./geometry.js").Segment, face: number}[]}
 */
export function touchableSegments(part) {
  const own = Object.entries(part.outlines ?? {}).flatMap(([role, { loops }]) =>
    loops.flatMap(segmentsOf).map((segment, k) => ({ segment, face: part.own_faces[role][k] })));
  return own.length ? [...partSegments(part), ...own] : partSegments(part);
}

/**
 * Where the pegs of a fixture touch the part, in part coordinates: contact and outward unit normal.
 * @param {any} part
 * @param {Row} row
 * @returns {{peg: number[], contact: number[], normal: number[]}[]}
 */
export function contactsOf(part, row) {
  const back = intoPart(row);
  const [c, s] = turn(row);
  return row.pegs.map((center, k) => {
    const peg = back(center);
    // What lies flush on a wall is pushed straight up.
    if (row.flush.includes(k)) return { peg, contact: peg, normal: [-s, -c] };
    let best = null;
    for (const { segment, face } of touchableSegments(part)) {
      if (face !== row.faces[k]) continue;
      const found = nearest(segment, peg);
      if (!best || found.distance < best.distance) best = { ...found, segment };
    }
    if (!best) throw new Error(`face ${row.faces[k]} is not one of the part`);
    return { peg, contact: pointAt(best.segment, best.share), normal: normalAt(best.segment, best.share) };
  });
}

/**
 * Where a hole is.
 * @param {Carrier} carrier
 * @param {number} column
 * @param {number} row
 */
export function place({ origin, pitch }, column, row) {
  return [origin[0] + column * pitch[0], origin[1] + row * pitch[1]];
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
 * What the forces of a fixture are told for each newton of.
 * @param {{mover: string, order: string}} row
 */
export function forceOf({ mover, order }) {
  return order ? `${mover} force of both` : `${mover} force`;
}
