/**
 * A part put between the pegs by hand: where it lies, turned over or not, and the pegs that stand in it.
 *
 * A trial is told by how far the part is off its place: `x` and `y` in mm of the middle of its box, `turn` in degrees, from
 * where the fixture has it; turned over it is first turned about an upright line through that middle.
 */
import { boundsOf, inside, nearest } from "./geometry.js";
import { partSegments } from "./pose.js";

/** @typedef {{x: number, y: number, turn: number, over: boolean, opening: number}} Trial */
/** @typedef {{theta_deg: number, x: number, y: number, over: boolean}} Lying a pose of the part, of the part turned over (x to -x in its own frame) where it is `over` */

/** A peg stands in the part by more than this of its radius, or by more than so many mm where it is a point. */
const ROUNDING = 0.02;
const LEAST = 0.01;
/** How much of an opening is tried one after the other. */
const SHARES = [1, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01];

/** The middle of the part's box in its own coordinates. */
function middle(part, over) {
  const [x0, y0, x1, y1] = part.bounds;
  return [((over ? -1 : 1) * (x0 + x1)) / 2, (y0 + y1) / 2];
}

/** Where a pose puts a point. */
function carried({ theta_deg, x, y }, [px, py]) {
  const angle = (theta_deg * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [c * px - s * py + x, s * px + c * py + y];
}

/** The middle of the part's box as it lies, in mm in the vise frame. */
export function middleOf(part, lying) {
  return carried(lying, middle(part, lying.over));
}

/** The farthest that a corner of the part's box is from its middle, in mm. */
export function armOf(part) {
  const [x0, y0, x1, y1] = part.bounds;
  return Math.hypot(x1 - x0, y1 - y0) / 2;
}

/**
 * How the part of a trial lies.
 * @param {any} part
 * @param {import("./pose.js").Row} row
 * @param {Trial} trial
 * @returns {Lying}
 */
export function lyingOf(part, row, trial) {
  const [x, y] = carried(row, middle(part, false));
  const theta_deg = (trial.over ? -row.theta_deg : row.theta_deg) + trial.turn;
  const [u, v] = carried({ theta_deg, x: 0, y: 0 }, middle(part, trial.over));
  return { theta_deg, x: x + trial.x - u, y: y + trial.y - v, over: trial.over };
}

/**
 * How far off its place a part lies: the part of a trial that {@link lyingOf} tells.
 * @param {any} part
 * @param {import("./pose.js").Row} row
 * @param {Lying} lying
 */
export function offsetsOf(part, row, lying) {
  const [x, y] = carried(row, middle(part, false));
  const [u, v] = middleOf(part, lying);
  const turn = lying.theta_deg - (lying.over ? -row.theta_deg : row.theta_deg);
  return { x: u - x, y: v - y, turn: turn - 360 * Math.round(turn / 360), over: lying.over };
}

/** Points of the vise in the part's own coordinates, as it was drawn. */
export function intoLying({ theta_deg, x, y, over }) {
  const angle = (theta_deg * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return ([px, py]) => [(over ? -1 : 1) * (c * (px - x) + s * (py - y)), -s * (px - x) + c * (py - y)];
}

/** A pose as a matrix. */
export function lyingMatrix({ theta_deg, x, y, over }) {
  const angle = (theta_deg * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const sign = over ? -1 : 1;
  return new DOMMatrix([sign * c, sign * s, -s, c, x, y]);
}

/**
 * Where the pegs are with the jaws open, in mm.
 * @param {import("./pose.js").Row} row
 * @param {number} opening how much farther than in the fixture
 */
export function pegsOpen(row, opening) {
  const out = row.pegs.map((peg) => [...peg]);
  for (const { clamping, pegs } of row.carriers) {
    if (clamping) for (const k of pegs) out[k] = [out[k][0] - clamping[0] * opening, out[k][1] - clamping[1] * opening];
  }
  return out;
}

/**
 * The pegs that move, as they stand where the part is no longer caught; none where that is not known, or never.
 * @param {import("./pose.js").Row} row
 * @param {any} told as the server tells it
 * @returns {{at: number[], radius: number}[]}
 */
export function pegsCaught(row, told) {
  if (!told?.pass || told.capture_opening > (told.widest ?? Infinity)) return [];
  const pegs = pegsOpen(row, told.capture_opening);
  const moving = row.carriers.filter(({ clamping }) => clamping);
  return moving.flatMap((each) => each.pegs.map((k) => ({ at: pegs[k], radius: each.peg_radius })));
}

/**
 * The pegs that stand deeper in the part than rounding.
 * @param {any} part
 * @param {import("./pose.js").Row} row
 * @param {Lying} lying
 * @param {number} opening
 * @returns {number[]}
 */
export function entered(part, row, lying, opening) {
  const back = intoLying(lying);
  const radii = row.carriers.flatMap((each) => each.pegs.map((k) => [k, each.peg_radius])).filter(([k]) => !row.flush.includes(k));
  const pegs = pegsOpen(row, opening);
  return radii.flatMap(([k, radius]) => {
    const point = back(pegs[k]);
    const away = Math.min(...partSegments(part).map(({ segment }) => nearest(segment, point).distance));
    const free = inside(part.loops, point) ? -away : away;
    return free < radius - Math.max(ROUNDING * radius, LEAST) ? [k] : [];
  });
}

/**
 * The opening to begin with: that wished for, or as much of it as leaves every peg beside the part in its place; pegs in a
 * hole of it open into its wall.
 * @param {any} part
 * @param {import("./pose.js").Row} row
 * @param {number} wished in mm
 */
export function openingBeside(part, row, wished) {
  const lying = lyingOf(part, row, { x: 0, y: 0, turn: 0, over: false, opening: 0 });
  const share = SHARES.find((one) => !entered(part, row, lying, one * wished).length);
  return (share ?? 0) * wished;
}

/** Whether a part stands in the fence, which runs along x at y = 0. */
export function inFence(part, row, lying) {
  if (!row.flush.length) return false;
  const map = (point) => carried(lying, [lying.over ? -point[0] : point[0], point[1]]);
  return boundsOf(partSegments(part).map(({ segment }) => segment), map)[1] < -0.02;
}

/** A part turned by some degrees about its middle. */
export function turned(part, lying, degrees) {
  const [x, y] = middleOf(part, lying);
  const next = { ...lying, theta_deg: lying.theta_deg + degrees };
  const [u, v] = middleOf(part, next);
  return { ...next, x: next.x + x - u, y: next.y + y - v };
}
