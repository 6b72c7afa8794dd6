/**
 * The edges of a body: where two of its faces meet at an angle.
 *
 * Faces have vertices of their own, so an edge is a side that triangles of one face use once; its other face has the same side
 * the other way round. Sides within a face, also of triangles of no width, are none.
 */

/** Faces that meet at more than this cosine run on smoothly. */
const SMOOTH = Math.cos((40 * Math.PI) / 180);
/** Places are the same to so many parts of a metre. */
const PARTS = 1e7;

/**
 * @param {import("./glb-reading.js").Body} body
 * @returns {Float32Array} six numbers for each edge: its ends
 */
export function edgesOf({ positions, normals, triangles }) {
  const sides = new Map();
  for (let k = 0; k < triangles.length; k += 3) {
    for (let side = 0; side < 3; side += 1) {
      const [a, b] = [triangles[k + side], triangles[k + ((side + 1) % 3)]];
      const key = a < b ? `${a} ${b}` : `${b} ${a}`;
      sides.set(key, sides.has(key) ? null : [a, b]);
    }
  }
  const place = (vertex) => [0, 1, 2].map((axis) => Math.round(positions[3 * vertex + axis] * PARTS)).join(" ");
  const meeting = new Map();
  for (const side of sides.values()) {
    if (!side) continue;
    const key = side.map(place).sort().join("|");
    meeting.set(key, [...(meeting.get(key) ?? []), side]);
  }
  const ends = [];
  for (const [[a, b], other] of meeting.values()) {
    const there = other ? nearest(positions, a, other) : a;
    const same = [0, 1, 2].reduce((sum, axis) => sum + normals[3 * a + axis] * normals[3 * there + axis], 0);
    if (other && same > SMOOTH) continue;
    for (const vertex of [a, b]) ends.push(...positions.subarray(3 * vertex, 3 * vertex + 3));
  }
  return new Float32Array(ends);
}

/** Which of two vertices stands where another does. */
function nearest(positions, vertex, others) {
  const far = (other) => [0, 1, 2].reduce((sum, axis) => sum + Math.abs(positions[3 * other + axis] - positions[3 * vertex + axis]), 0);
  return far(others[0]) <= far(others[1]) ? others[0] : others[1];
}
