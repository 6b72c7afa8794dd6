/**
 * Whether two edges of a sketch meet anywhere but at a joint they share.
 *
 * Circles and lines are met in closed form; a parameter within the ends decides. The server checks again, exactly.
 */
import { pointAt } from "./geometry.js";

const NEAR = 1e-7;

/**
 * Points that two segments have in common.
 * @param {import("./geometry.js").Segment} a
 * @param {import("./geometry.js").Segment} b
 * @returns {number[][]}
 */
export function meetings(a, b) {
  const found = a.center ? (b.center ? arcArc(a, b) : lineArc(b, a)) : b.center ? lineArc(a, b) : lineLine(a, b);
  const ends = [a.start, a.end].filter((point) => on(b, point)).concat([b.start, b.end].filter((point) => on(a, point)));
  return [...found.filter((point) => on(a, point) && on(b, point)), ...ends];
}

/**
 * Where a new edge meets a chain of edges, its own start and, if it closes the chain, its end left out; null for nowhere.
 * @param {import("./geometry.js").Segment} edge
 * @param {import("./geometry.js").Segment[]} others
 * @param {number[][]} joints points where touching is allowed
 */
export function crossing(edge, others, joints) {
  for (const other of others) {
    for (const point of meetings(edge, other)) {
      if (!joints.some((joint) => apart(joint, point) < 1e-5)) return point;
    }
    const backwards = overlap(edge, other);
    if (backwards) return backwards;
  }
  return null;
}

/** A point in the middle of what two edges on one line or circle share; null when they share nothing more than ends. */
function overlap(a, b) {
  for (const share of [0.5, 0.02, 0.98]) {
    const [p, q] = [pointAt(a, share), pointAt(b, share)];
    if (on(b, p, 1e-6)) return p;
    if (on(a, q, 1e-6)) return q;
  }
  return null;
}

/** @param {number[]} a @param {number[]} b */
function apart(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/** Whether a point lies on a segment. */
function on(segment, point, near = NEAR * 10) {
  if (segment.center) {
    if (Math.abs(apart(segment.center, point) - segment.radius) > near) return false;
    const angle = Math.atan2(point[1] - segment.center[1], point[0] - segment.center[0]);
    const middle = segment.from + segment.sweep / 2;
    const turn = Math.abs(Math.atan2(Math.sin(angle - middle), Math.cos(angle - middle)));
    return turn <= Math.abs(segment.sweep) / 2 + near / segment.radius;
  }
  const [dx, dy] = [segment.end[0] - segment.start[0], segment.end[1] - segment.start[1]];
  const size = Math.hypot(dx, dy);
  const along = ((point[0] - segment.start[0]) * dx + (point[1] - segment.start[1]) * dy) / size;
  const aside = ((point[0] - segment.start[0]) * dy - (point[1] - segment.start[1]) * dx) / size;
  return Math.abs(aside) <= near && along >= -near && along <= size + near;
}

/** Where two lines cross. */
function lineLine(a, b) {
  const [ax, ay] = [a.end[0] - a.start[0], a.end[1] - a.start[1]];
  const [bx, by] = [b.end[0] - b.start[0], b.end[1] - b.start[1]];
  const turn = ax * by - ay * bx;
  if (Math.abs(turn) < 1e-12 * Math.hypot(ax, ay) * Math.hypot(bx, by)) return [];
  const share = ((b.start[0] - a.start[0]) * by - (b.start[1] - a.start[1]) * bx) / turn;
  return [pointAt(a, share)];
}

/** Where a line crosses the circle of an arc. */
function lineArc(line, arc) {
  const [dx, dy] = [line.end[0] - line.start[0], line.end[1] - line.start[1]];
  const size = Math.hypot(dx, dy);
  const along = ((arc.center[0] - line.start[0]) * dx + (arc.center[1] - line.start[1]) * dy) / size;
  const foot = [line.start[0] + (along * dx) / size, line.start[1] + (along * dy) / size];
  const rest = arc.radius ** 2 - apart(foot, arc.center) ** 2;
  if (rest < 0) return [];
  const half = Math.sqrt(rest) / size;
  return [-1, 1].map((way) => [foot[0] + way * half * dx, foot[1] + way * half * dy]);
}

/** Where the circles of two arcs cross. */
function arcArc(a, b) {
  const distance = apart(a.center, b.center);
  if (distance < NEAR) return [];
  const along = (distance ** 2 + a.radius ** 2 - b.radius ** 2) / (2 * distance);
  const rest = a.radius ** 2 - along ** 2;
  if (rest < 0) return [];
  const [ux, uy] = [(b.center[0] - a.center[0]) / distance, (b.center[1] - a.center[1]) / distance];
  const aside = Math.sqrt(rest);
  return [-1, 1].map((way) => [
    a.center[0] + along * ux - way * aside * uy,
    a.center[1] + along * uy + way * aside * ux,
  ]);
}
