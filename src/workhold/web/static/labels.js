/**
 * Places for labels, so that none lies on another or on what must be seen.
 */

/** @typedef {{x: number, y: number, w: number, h: number}} Box a middle, a width and a height in pixels */

const ROUNDS = 40;
const AIR = 3;
/** More labels than this are left where they are: nobody could read them anyway. */
const MOST = 200;

/** How far two boxes lie on each other in x and in y, with some air between them; positive both where they do. */
function overlap(a, b) {
  return [(a.w + b.w) / 2 + AIR - Math.abs(a.x - b.x), (a.h + b.h) / 2 + AIR - Math.abs(a.y - b.y)];
}

/**
 * Whether a label lies on nothing.
 * @param {Box} label
 * @param {Box[]} taken
 */
export function isFree(label, taken) {
  return taken.every((other) => overlap(label, other).some((depth) => depth <= 1e-6));
}

/**
 * Push labels apart until none lies on another or on an obstacle; they stay near where they were.
 * @param {Box[]} labels
 * @param {Box[]} [obstacles] which do not move
 */
export function apart(labels, obstacles = []) {
  if (labels.length > MOST) return;
  const fixed = new Set(obstacles);
  for (let round = 0; round < ROUNDS; round += 1) {
    let moved = false;
    for (const a of labels) {
      for (const b of [...labels, ...obstacles]) {
        if (a === b) continue;
        const [ox, oy] = overlap(a, b);
        if (ox <= 1e-6 || oy <= 1e-6) continue;
        moved = true;
        const share = fixed.has(b) ? 1 : 0.5;
        if (oy <= ox) a.y += share * oy * (a.y >= b.y ? 1 : -1);
        else a.x += share * ox * (a.x >= b.x ? 1 : -1);
      }
    }
    if (!moved) return;
  }
}

/**
 * Small boxes along a line, as obstacles.
 * @param {number[]} from
 * @param {number[]} to
 * @param {number} width
 * @returns {Box[]}
 */
export function along(from, to, width) {
  const steps = Math.max(1, Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / width));
  return Array.from({ length: steps + 1 }, (_, k) => ({
    x: from[0] + (k / steps) * (to[0] - from[0]), y: from[1] + (k / steps) * (to[1] - from[1]), w: width, h: width,
  }));
}
