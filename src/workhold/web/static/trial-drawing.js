/**
 * The part in the hand: dragged and turned in the drawing of the fixture, and the closing that is played from where it is
 * let go.
 */
import { draw } from "./dom.js";
import { inside } from "./geometry.js";
import { state } from "./state.js";
import { armOf, intoLying, middleOf, turned } from "./trial.js";
import { scale } from "./units.js";

/** Pixels within which the handle is taken hold of; its distance from the middle by the part's size, and at least. */
const HOLD = 22;
const FAR = 0.7;
const LEAST = 46;
/** A closing is played in so many milliseconds at least and at most, and in so many for each pixel that something moves. */
const SHORTEST = 500;
const LONGEST = 2600;
const SPEED = 5;

/** What is done with the part in the drawing. */
export class TrialDrawing {
  /**
   * @param {import("./fixture-drawing.js").FixtureDrawing} drawing
   * @param {{put: (lying: import("./trial.js").Lying) => void, letGo: () => void, taken: () => void}} calls with where the
   *   part is put, when it is let go, and when it is taken hold of
   */
  constructor(drawing, calls) {
    this.drawing = drawing;
    this.calls = calls;
    /** @type {import("./trial.js").Lying|null} */
    this.lying = null;
    this.part = null;
    this.held = "";
    this.frame = 0;
    /** What had the pointer before. */
    this.before = drawing.view.tool;
    this.tool = { down: (point) => this.grab(point), move: (point) => this.drag(point), up: () => this.up() };
    this.key = arrowKeys(() => this.lying, (lying) => calls.put(lying), calls.letGo);
  }

  /**
   * Show the part as it lies, or leave it to the fixture.
   * @param {any} part
   * @param {import("./trial.js").Lying|null} lying
   * @param {number} open how far the jaws are open, in mm
   * @param {boolean} movable whether it can be taken hold of
   * @param {{at: number[], radius: number}[]} caught pegs as they stand where the part is no longer caught
   */
  show(part, lying, open, movable, caught = []) {
    this.stop();
    this.part = part;
    this.lying = movable ? lying : null;
    const { drawing } = this;
    drawing.view.tool = lying && movable ? this.tool : this.before;
    drawing.extras = () => (this.lying && !this.playing ? this.handle() : []);
    drawing.lie(lying);
    drawing.slide(open);
    for (const old of drawing.view.world.querySelectorAll(".caught")) old.remove();
    drawing.view.world.append(...caught.map(({ at, radius }) => draw("circle.caught", { cx: at[0], cy: at[1], r: radius })));
    if (!this.lying) return;
    drawing.shape.setAttribute("tabindex", "0");
    drawing.shape.setAttribute("role", "application");
    drawing.shape.setAttribute("aria-label", "The part: arrows move it, comma and point turn it, Enter closes");
    drawing.shape.onkeydown = this.key;
  }

  /** Whether a closing is being played. */
  get playing() {
    return this.frame !== 0;
  }

  /** Stop what is being played. */
  stop() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
  }

  /** Middle of the part and end of the handle in pixels. */
  ends() {
    const { view } = this.drawing;
    const middle = view.page(middleOf(this.part, this.lying));
    const far = Math.max(FAR * armOf(this.part) * view.k, LEAST);
    const angle = (this.lying.theta_deg * Math.PI) / 180;
    return { middle, end: [middle[0] - far * Math.sin(angle), middle[1] - far * Math.cos(angle)] };
  }

  /** The handle by which the part is turned. */
  handle() {
    const { middle, end } = this.ends();
    return [
      draw("line.turn-line", { x1: middle[0], y1: middle[1], x2: end[0], y2: end[1] }),
      draw("circle.turn-middle", { cx: middle[0], cy: middle[1], r: 3.5 }),
      draw("circle.turn-handle", { cx: end[0], cy: end[1], r: 10 }),
      draw("path.turn-sign", { d: `M${end[0] - 5} ${end[1] + 2}a5.2 5.2 0 1 1 8 2m0 -4v4h-4` }),
    ];
  }

  /** Take hold of the handle or of the part. */
  grab(point) {
    if (!this.lying) return false;
    const { view } = this.drawing;
    const at = view.page(point);
    const { end } = this.ends();
    const turns = Math.hypot(at[0] - end[0], at[1] - end[1]) < HOLD;
    if (!turns && !inside(this.part.loops, intoLying(this.lying)(point))) return false;
    this.held = turns ? "handle" : "part";
    this.calls.taken();
    const [x, y] = middleOf(this.part, this.lying);
    this.from = { lying: this.lying, offset: [point[0] - x, point[1] - y], angle: Math.atan2(point[1] - y, point[0] - x) };
    return true;
  }

  /** The part follows the pointer. */
  drag(point) {
    const { lying, offset, angle } = this.from;
    const [x, y] = middleOf(this.part, lying);
    if (this.held === "part") {
      this.calls.put({ ...lying, x: lying.x + point[0] - offset[0] - x, y: lying.y + point[1] - offset[1] - y });
    } else if (this.held) {
      this.calls.put(turned(this.part, lying, ((Math.atan2(point[1] - y, point[0] - x) - angle) * 180) / Math.PI));
    }
  }

  /** A part that is let go is closed upon; one that was turned may still be moved. */
  up() {
    const { held } = this;
    this.held = "";
    if (held === "part") this.calls.letGo();
  }

  /**
   * Play a closing before the user's eyes; at once for those who want no motion.
   * @param {number[][]} way turn in degrees, x, y and how far the jaws are open in mm
   * @param {boolean} over
   * @param {() => void} ended
   */
  play(way, over, ended) {
    this.stop();
    const { drawing } = this;
    const size = armOf(this.part);
    const show = ([theta_deg, x, y, open]) => {
      this.lying = { theta_deg, x, y, over };
      drawing.lie(this.lying);
      drawing.slide(open);
    };
    const done = () => {
      this.frame = 0;
      show(way[way.length - 1]);
      ended();
    };
    const moves = way.slice(1).map((next, k) => Math.abs(way[k][3] - next[3]) + Math.hypot(way[k][1] - next[1], way[k][2] - next[2]) + size * Math.abs(turnBetween(way[k], next)) * (Math.PI / 180));
    const whole = moves.reduce((sum, move) => sum + move, 0);
    if (whole === 0 || matchMedia("(prefers-reduced-motion: reduce)").matches) return done();
    const time = Math.min(Math.max(whole * drawing.view.k * SPEED, SHORTEST), LONGEST);
    const begun = performance.now();
    const step = (now) => {
      let rest = (Math.min(Math.max(now - begun, 0) / time, 1)) * whole;
      if (rest >= whole) return done();
      let k = 0;
      while (k < moves.length - 1 && rest > moves[k]) rest -= moves[k++];
      show(between(way[k], way[k + 1], moves[k] ? Math.min(rest / moves[k], 1) : 1));
      this.frame = requestAnimationFrame(step);
      return undefined;
    };
    this.frame = requestAnimationFrame(step);
    show(way[0]);
    return undefined;
  }
}

/** By how many degrees a configuration is turned to the next one, the shorter way round. */
function turnBetween([from], [to]) {
  return to - from - 360 * Math.round((to - from) / 360);
}

/** A configuration between two. */
function between(from, to, share) {
  return from.map((value, k) => value + share * (k ? to[k] - value : turnBetween(from, to)));
}

/** A step in mm, or in inches, and in degrees. */
const STEP = { mm: 1, inch: 0.05 };
const TURN = 1;
const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const TURNS = { ",": TURN, ".": -TURN };

/**
 * A listener to keys: arrows move the part in the hand, comma and point turn it, Enter lets it go.
 * @param {() => import("./trial.js").Lying|null} lying
 * @param {(lying: import("./trial.js").Lying) => void} put
 * @param {() => void} letGo
 */
function arrowKeys(lying, put, letGo) {
  return (event) => {
    const now = lying();
    if (!now || event.shiftKey || event.ctrlKey || event.altKey || event.metaKey) return;
    const step = STEP[state.unit] * scale();
    if (MOVES[event.key]) put({ ...now, x: now.x + step * MOVES[event.key][0], y: now.y + step * MOVES[event.key][1] });
    else if (TURNS[event.key]) put(turned(state.part, now, TURNS[event.key]));
    else if (event.key === "Enter") letGo();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
}
