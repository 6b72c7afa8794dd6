/**
 * Lines and arcs of outlines: what a bulge means, paths for SVG and canvas, nearest points and outward normals.
 *
 * A vertex is [x, y, bulge] in mm, y up; bulge = tan(sweep / 4), 0 for a line, positive for a counter-clockwise arc.
 * Material lies on the left.
 */

/**
 * @typedef {Object} Segment
 * @property {number[]} start
 * @property {number[]} end
 * @property {number} bulge
 * @property {number[]|null} center of an arc
 * @property {number} radius of an arc; 0 for a line
 * @property {number} from angle of the start as seen from the centre, in radians
 * @property {number} sweep signed, in radians; 0 for a line
 */

/**
 * A segment from its ends and its bulge.
 * @param {number[]} start
 * @param {number[]} end
 * @param {number} bulge
 * @returns {Segment}
 */
export function segmentOf(start, end, bulge) {
  if (Math.abs(bulge) < 1e-12) return { start, end, bulge: 0, center: null, radius: 0, from: 0, sweep: 0 };
  const [dx, dy] = [end[0] - start[0], end[1] - start[1]];
  // The centre lies (1 - b^2) / 4b chords to the left of the chord's middle.
  const aside = (1 - bulge * bulge) / (4 * bulge);
  const center = [(start[0] + end[0]) / 2 - dy * aside, (start[1] + end[1]) / 2 + dx * aside];
  const radius = (Math.hypot(dx, dy) * (1 + bulge * bulge)) / (4 * Math.abs(bulge));
  const from = Math.atan2(start[1] - center[1], start[0] - center[0]);
  return { start, end, bulge, center, radius, from, sweep: 4 * Math.atan(bulge) };
}

/**
 * The segments of a closed loop.
 * @param {number[][]} loop
 */
export function segmentsOf(loop) {
  return loop.map((vertex, k) => segmentOf(vertex, loop[(k + 1) % loop.length], vertex[2] ?? 0));
}

/**
 * The point of a segment at a share of its length.
 * @param {Segment} segment
 * @param {number} share from 0 to 1
 */
export function pointAt(segment, share) {
  if (!segment.center) {
    return [0, 1].map((axis) => segment.start[axis] + share * (segment.end[axis] - segment.start[axis]));
  }
  const angle = segment.from + share * segment.sweep;
  return [segment.center[0] + segment.radius * Math.cos(angle), segment.center[1] + segment.radius * Math.sin(angle)];
}

/**
 * The outward unit normal of a segment at a share of its length.
 * @param {Segment} segment
 * @param {number} share
 */
export function normalAt(segment, share) {
  if (!segment.center) {
    const [dx, dy] = [segment.end[0] - segment.start[0], segment.end[1] - segment.start[1]];
    const size = Math.hypot(dx, dy);
    return [dy / size, -dx / size];
  }
  const angle = segment.from + share * segment.sweep;
  const sign = Math.sign(segment.sweep);
  return [sign * Math.cos(angle), sign * Math.sin(angle)];
}

/**
 * The nearest point of a segment: its share of the length, and its distance.
 * @param {Segment} segment
 * @param {number[]} point
 * @returns {{share: number, distance: number}}
 */
export function nearest(segment, point) {
  let share;
  if (segment.center) {
    const angle = Math.atan2(point[1] - segment.center[1], point[0] - segment.center[0]);
    const middle = segment.from + segment.sweep / 2;
    const turn = Math.atan2(Math.sin(angle - middle), Math.cos(angle - middle));
    share = 0.5 + turn / segment.sweep;
  } else {
    const [dx, dy] = [segment.end[0] - segment.start[0], segment.end[1] - segment.start[1]];
    share = ((point[0] - segment.start[0]) * dx + (point[1] - segment.start[1]) * dy) / (dx * dx + dy * dy);
  }
  share = Math.min(1, Math.max(0, share));
  const [x, y] = pointAt(segment, share);
  return { share, distance: Math.hypot(point[0] - x, point[1] - y) };
}

/**
 * SVG path data of one segment, in its own coordinates (y up); arcs in two halves, so that none is ambiguous.
 * @param {Segment} segment
 * @param {boolean} [moved] whether to begin with a move to the start
 */
export function segmentPath(segment, moved = true) {
  const start = moved ? `M${segment.start[0]} ${segment.start[1]}` : "";
  if (!segment.center) return `${start}L${segment.end[0]} ${segment.end[1]}`;
  const half = pointAt(segment, 0.5);
  const arc = `A${segment.radius} ${segment.radius} 0 0 ${segment.sweep > 0 ? 1 : 0}`;
  return `${start}${arc} ${half[0]} ${half[1]}${arc} ${segment.end[0]} ${segment.end[1]}`;
}

/**
 * SVG path data of closed loops; fill it by the even-odd rule.
 * @param {number[][][]} loops
 */
export function outlinePath(loops) {
  return loops.map((loop) => segmentsOf(loop).map((s, k) => segmentPath(s, k === 0)).join("") + "Z").join("");
}

/**
 * The smallest box [x0, y0, x1, y1] around segments, arcs with their bulges.
 * @param {Segment[]} segments
 * @param {(point: number[]) => number[]} [map] a turn and a shift done first
 */
export function boundsOf(segments, map = (point) => point) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const segment of segments) {
    const steps = segment.center ? Math.max(2, Math.ceil(Math.abs(segment.sweep) * 12)) : 1;
    for (let k = 0; k <= steps; k += 1) extend(box, map(pointAt(segment, k / steps)));
  }
  return box;
}

/**
 * Make a box large enough for a point.
 * @param {number[]} box
 * @param {number[]} point
 */
export function extend(box, point) {
  box[0] = Math.min(box[0], point[0]);
  box[1] = Math.min(box[1], point[1]);
  box[2] = Math.max(box[2], point[0]);
  box[3] = Math.max(box[3], point[1]);
}

/**
 * Whether a point lies inside closed loops by the even-odd rule; arcs as short chords.
 * @param {number[][][]} loops
 * @param {number[]} point
 */
export function inside(loops, point) {
  let odd = false;
  for (const loop of loops) {
    for (const segment of segmentsOf(loop)) {
      const steps = segment.center ? 32 : 1;
      for (let k = 0; k < steps; k += 1) {
        const [a, b] = [pointAt(segment, k / steps), pointAt(segment, (k + 1) / steps)];
        const crosses = a[1] > point[1] !== b[1] > point[1];
        if (crosses && point[0] < a[0] + ((point[1] - a[1]) / (b[1] - a[1])) * (b[0] - a[0])) odd = !odd;
      }
    }
  }
  return odd;
}
