/**
 * How bodies in space are looked at: turned, moved and zoomed by mouse, touch and keys. What draws them is made of this.
 *
 * Seen from the direction (sin a cos b, sin b, cos a cos b) with a the angle around and b that above, y being up.
 */

/** Degrees of the field of view, from top to bottom. */
export const FIELD = 30;
/** Radians for each pixel and for each press of a key; how much nearer a press goes. */
const TURN = 0.008;
const STEP = Math.PI / 24;
const NEARER = 1.15;
/** The first look: from the front right, above. */
const FIRST = { around: -0.6, above: 0.75 };
/** What is seen whole is this much smaller than the canvas. */
const ROOM = 1.06;
/** How often the middle of what is seen whole is sought. */
const ROUNDS = 8;
const HIGHEST = Math.PI / 2 - 0.001;

/** Half the height that is seen at a distance of 1. */
export const HALF_FIELD = Math.tan((FIELD * Math.PI) / 360);

/** A view that can be turned; a frame is drawn only when something changed. */
export class Orbit {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.around = FIRST.around;
    this.above = FIRST.above;
    /** Extent and middle of all bodies, in metres. */
    this.size = 1;
    this.middle = [0, 0, 0];
    /** Corners of the box about all bodies, in metres. @type {number[][]} */
    this.corners = [];
    this.target = [0, 0, 0];
    this.far = 1;
    this.waiting = false;
    /** @type {Map<number, number[]>} */
    this.pointers = new Map();
    /** Told the number of the body that is pointed at, null for none. @type {((number: number|null) => void)|null} */
    this.onPoint = null;
    this.listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Draw now; by what is made of this. */
  render() {}

  /**
   * The number of the body at a place of the canvas, null for none; by what is made of this.
   * @param {number} _x in pixels of the page
   * @param {number} _y
   * @returns {number|null}
   */
  bodyAt(_x, _y) {
    return null;
  }

  /** Unit vectors to the right, upward, and from what is seen to the eye. */
  axes() {
    const [s, c] = [Math.sin(this.around), Math.cos(this.around)];
    const [up, level] = [Math.sin(this.above), Math.cos(this.above)];
    return [[c, 0, -s], [-up * s, level, -up * c], [level * s, up, level * c]];
  }

  /**
   * See all of some bodies.
   * @param {import("./glb-reading.js").Body[]} bodies
   * @param {boolean} still whether they are looked at as those before
   */
  frame(bodies, still) {
    const [low, high] = boxAbout(bodies);
    this.corners = Array.from({ length: 8 }, (_, k) => low.map((value, axis) => ((k >> axis) & 1 ? high[axis] : value)));
    this.middle = low.map((value, k) => (value + high[k]) / 2);
    this.size = Math.hypot(...low.map((value, k) => high[k] - value)) || 1;
    if (still) this.draw();
    else this.fit();
  }

  /** See everything, from where it is seen first or from angles in radians, as large as the canvas has room for. */
  fit(around = FIRST.around, above = FIRST.above) {
    this.look(around, above);
    this.target = [...this.middle];
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const aspect = width && height ? width / height : 1;
    for (let round = 0; round < ROUNDS; round += 1) {
      const seen = this.corners.map((corner) => this.axes().map((axis) => axis.reduce((sum, value, k) => sum + value * (corner[k] - this.target[k]), 0)));
      this.far = Math.max(0.05 * this.size, ...seen.map(([right, up, out]) => out + (ROOM / HALF_FIELD) * Math.max(Math.abs(up), Math.abs(right) / aspect)));
      // What is nearer looks larger, so the middle of what is seen is not that of the bodies.
      const middle = [0, 1].map((k) => {
        const places = seen.map((at) => at[k] / (this.far - at[2]));
        return (this.far * (Math.min(...places) + Math.max(...places))) / 2;
      });
      const [right, up] = this.axes();
      this.target = this.target.map((value, k) => value + middle[0] * right[k] + middle[1] * up[k]);
    }
    this.draw();
  }

  /** Turn the view to angles in radians. */
  look(around, above) {
    this.around = around;
    this.above = Math.max(-HIGHEST, Math.min(HIGHEST, above));
    this.draw();
  }

  /** Go nearer, or farther where the factor is below 1. */
  zoom(factor) {
    this.far = Math.max(0.05 * this.size, Math.min(20 * this.size, this.far / factor));
    this.draw();
  }

  /** Move what is seen by pixels. */
  shift(right, down) {
    const scale = (2 * this.far * HALF_FIELD) / Math.max(1, this.canvas.clientHeight);
    const [x, y] = this.axes();
    this.target = this.target.map((value, k) => value - right * scale * x[k] + down * scale * y[k]);
    this.draw();
  }

  /** Draw with the next frame. */
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.render();
    });
  }

  /** Listen to mouse, touch and keys. */
  listen() {
    const { canvas, pointers } = this;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    canvas.addEventListener("pointermove", (event) => this.moved(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(name, (event) => pointers.delete(/** @type {PointerEvent} */ (event).pointerId));
    }
    canvas.addEventListener("pointerleave", () => this.onPoint?.(null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-Math.sign(event.deltaY) * 0.12));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => this.pressed(event));
  }

  /** One finger or the mouse turns; two fingers, the right button or Shift move, and two fingers zoom. */
  moved(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      this.onPoint?.(this.bodyAt(event.offsetX, event.offsetY));
      return;
    }
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    const spread = () => {
      const [[ax, ay], [bx, by]] = [...this.pointers.values()];
      return Math.hypot(ax - bx, ay - by);
    };
    const two = this.pointers.size === 2;
    const apart = two ? spread() : 1;
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (two) {
      if (apart > 0) this.zoom(spread() / apart);
      this.shift(dx / 2, dy / 2);
    } else if (event.buttons === 2 || event.shiftKey) this.shift(dx, dy);
    else this.look(this.around - dx * TURN, this.above + dy * TURN);
  }

  /** Arrows turn, with Shift they move; plus and minus zoom, 0 shows all. */
  pressed(event) {
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (arrow && event.shiftKey) this.shift(arrow[0] * 40, arrow[1] * 40);
    else if (arrow) this.look(this.around + arrow[0] * STEP, this.above - arrow[1] * STEP);
    else if (event.key === "+" || event.key === "=") this.zoom(NEARER);
    else if (event.key === "-") this.zoom(1 / NEARER);
    else if (event.key === "0") this.fit();
    else return;
    event.preventDefault();
  }
}

/**
 * Both corners of a box about bodies.
 * @param {import("./glb-reading.js").Body[]} bodies
 */
export function boxAbout(bodies) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { positions } of bodies) {
    for (let k = 0; k < positions.length; k += 1) {
      low[k % 3] = Math.min(low[k % 3], positions[k]);
      high[k % 3] = Math.max(high[k % 3], positions[k]);
    }
  }
  return bodies.length ? [low, high] : [[0, 0, 0], [0, 0, 0]];
}
