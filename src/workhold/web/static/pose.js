/**
 * Where a fixture puts things: the part's pose, contacts and holes, in mm in the vise frame.
 *
 * A pose maps a point q of the part to R(theta) q + (x, y).
 */
import { segmentsOf } from "./geometry.js";

/** @typedef {{rank: number|null, theta_deg: number, x: number, y: number, holes: string[], faces: number[], touched: string[], flush: number[], pegs: number[][], contacts: number[][], normals: number[][], forces: number[], jaw_separation: number, carriers: Carrier[], title: string, settings: {sign: string, name: string, length: number}[], mover: string, order: string, origin: string, picture: string}} Row */

/**
 * A carrier of holes, a wall or a clamp: the numbers of its pegs, their radius, the direction in which it clamps or null.
 * @typedef {{pegs: number[], peg_radius: number, clamping: number[]|null}} Carrier
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
 * The pose as a matrix.
 * @param {Row} row
 */
export function poseMatrix(row) {
  const [c, s] = turn(row);
  return new DOMMatrix([c, s, -s, c, row.x, row.y]);
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
 * What the forces of a fixture are told for each newton of.
 * @param {{mover: string, order: string}} row
 */
export function forceOf({ mover, order }) {
  return order ? `${mover} force of both` : `${mover} force`;
}
