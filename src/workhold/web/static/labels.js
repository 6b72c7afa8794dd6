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

/** Degrees to either side of the wanted way, and how many times as far, a label may stand; those wanted most first. */
const TURNS = [0, 25, -25, 50, -50, 80, -80, 115, -115, 150, -150, 180];
const FARTHER = [1, 1.4, 1.9];

/** Places around a middle: on an ellipse towards a unit vector (y downward), and then ever more aside and farther. */
export function around([x, y], [ux, uy], [far, high]) {
  return FARTHER.flatMap((times) => TURNS.map((turn) => {
    const [c, s] = [Math.cos((turn * Math.PI) / 180), Math.sin((turn * Math.PI) / 180)];
    return { x: x + times * far * (c * ux - s * uy), y: y + times * high * (s * ux + c * uy) };
  }));
}
