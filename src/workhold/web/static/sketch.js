/**
 * A part being drawn: closed loops, and an open chain of lines and arcs that grows; every step can be undone.
 */
import { crossing } from "./crossings.js";
import { segmentOf, segmentsOf } from "./geometry.js";

/** Edges that would cross are refused with this error, which tells where. */
export class Refusal extends Error {
  /** @param {string} message @param {number[]|null} at */
  constructor(message, at) {
    super(message);
    this.at = at;
  }
}

/** What has been drawn. */
export class Sketch {
  constructor() {
    /** @type {number[][][]} closed loops of [x, y, bulge] */
    this.loops = [];
    /** @type {number[][]} vertices [x, y, bulge]; the bulge belongs to the edge that begins there */
    this.chain = [];
    /** @type {{loops: number[][][], chain: number[][]}[]} */
    this.past = [];
  }

  /** Remember how things are. */
  remember() {
    this.past.push({ loops: [...this.loops], chain: this.chain.map((vertex) => [...vertex]) });
  }

  /** Take the last step back. */
  undo() {
    const before = this.past.pop();
    if (before) Object.assign(this, before);
    return before !== undefined;
  }

  /** The last vertex of the open chain. */
  get last() {
    return this.chain[this.chain.length - 1] ?? null;
  }

  /** The edges of the open chain. */
  get edges() {
    return this.chain.slice(0, -1).map((vertex, k) => segmentOf(vertex, this.chain[k + 1], vertex[2]));
  }

  /**
   * The edge from the last vertex to a point, if it may be drawn.
   * @param {number[]} point
   * @param {number} bulge
   * @throws {Refusal}
   */
  edge(point, bulge) {
    const { last } = this;
    if (Math.hypot(point[0] - last[0], point[1] - last[1]) < 1e-6) throw new Refusal("That edge has no length.", point);
    const edge = segmentOf(last, point, bulge);
    const closing = this.closes(point);
    const joints = closing ? [last, this.chain[0]] : [last];
    if (closing && this.chain.length === 2 && bulge === 0 && this.chain[0][2] === 0) {
      throw new Refusal("That edge runs back along the one before.", point);
    }
    const others = [...this.edges, ...this.loops.flatMap(segmentsOf)];
    const at = crossing(edge, others, joints);
    if (at) throw new Refusal("That edge would cross or touch another one.", at);
    return edge;
  }

  /** Whether a point is the start of the chain, so that an edge to it closes the loop. */
  closes(point) {
    const first = this.chain[0];
    return this.chain.length > 1 && Math.hypot(point[0] - first[0], point[1] - first[1]) < 1e-6;
  }

  /**
   * Add a point: the first of a chain, or the end of the next edge. At the start of the chain it closes the loop.
   * @param {number[]} point
   * @param {number} [bulge]
   * @returns {boolean} whether a loop was closed
   * @throws {Refusal}
   */
  add(point, bulge = 0) {
    if (!this.chain.length) {
      this.remember();
      this.chain = [[point[0], point[1], 0]];
      return false;
    }
    this.edge(point, bulge);
    this.remember();
    const closed = this.closes(point);
    this.last[2] = bulge;
    if (closed) {
      this.loops = [...this.loops, this.chain];
      this.chain = [];
    } else {
      this.chain.push([point[0], point[1], 0]);
    }
    return closed;
  }
}

/**
 * The bulge of the arc from one point to another through a third.
 * @param {number[]} start
 * @param {number[]} end
 * @param {number[]} through
 */
export function bulgeThrough(start, end, through) {
  const [ax, ay] = [start[0] - through[0], start[1] - through[1]];
  const [bx, by] = [end[0] - through[0], end[1] - through[1]];
  // The angle seen from a point of the arc is half a turn less half the sweep.
  const angle = Math.atan2(ax * by - ay * bx, ax * bx + ay * by);
  const half = angle < 0 ? Math.PI + angle : angle - Math.PI;
  const bulge = Math.tan(half / 2);
  return Math.abs(bulge) < 1e-9 || !Number.isFinite(bulge) ? 0 : bulge;
}

/**
 * The bulge of the shorter arc of a radius between two points, bent to a side.
 * @param {number[]} start
 * @param {number[]} end
 * @param {number} radius
 * @param {number} side positive for counter-clockwise
 * @returns {number} NaN when the radius is too small
 */
export function bulgeOfRadius(start, end, radius, side) {
  const half = Math.hypot(end[0] - start[0], end[1] - start[1]) / 2;
  if (!(radius >= half * (1 - 1e-9))) return NaN;
  return Math.sign(side || 1) * Math.tan(Math.asin(Math.min(1, half / radius)) / 2);
}
