/**
 * Pan and zoom of a drawing: wheel, drag, pinch, buttons and keys.
 *
 * What is in mm lies in the group `world`, whose transform maps mm (y up) to CSS pixels; lettering and arrow heads, whose
 * size does not depend on the zoom, are drawn anew in `overlay` by whoever listens to `onview`.
 */
import { draw } from "./dom.js";

const CLOSEST = 400;
const WHEEL = 0.0016;
/** Pixels of a drawing on paper. */
const SHEET = [720, 560];

/** A drawing that can be panned and zoomed. */
export class Viewport {
  /** @param {SVGSVGElement} svg fills its frame */
  constructor(svg) {
    this.svg = svg;
    this.world = draw("g.world");
    this.overlay = draw("g.overlay");
    svg.append(this.world, this.overlay);
    this.k = 1;
    this.x = 0;
    this.y = 0;
    this.bounds = [0, 0, 100, 100];
    this.margins = [30, 30, 30, 30];
    this.fitted = true;
    /** @type {() => void} */
    this.onview = () => {};
    /** @type {null|{down: Function, move?: Function, up?: Function, hover?: Function}} what takes the pointer first */
    this.tool = null;
    this.printing = false;
    this.pointers = new Map();
    this.taken = null;
    this.listen();
    new ResizeObserver(() => (this.fitted ? this.fit() : this.apply())).observe(svg);
    addEventListener("beforeprint", () => this.print(true));
    addEventListener("afterprint", () => this.print(false));
  }

  /** Width and height in pixels; on paper those of a sheet, to which the browser scales them. */
  get size() {
    return this.printing ? SHEET : [this.svg.clientWidth, this.svg.clientHeight];
  }

  /** Fit the drawing to a sheet of paper, or to the screen again. */
  print(printing) {
    this.printing = printing;
    if (printing) this.svg.setAttribute("viewBox", `0 0 ${SHEET[0]} ${SHEET[1]}`);
    else this.svg.removeAttribute("viewBox");
    this.fit();
  }

  /**
   * Show a box in mm as large as it goes.
   * @param {number[]} [bounds]
   * @param {number[]} [margins] room in pixels: top, right, bottom, left
   */
  fit(bounds = this.bounds, margins = this.margins) {
    this.bounds = bounds;
    this.margins = margins;
    const [width, height] = this.size;
    if (!width || !height) return;
    const [top, right, bottom, left] = margins;
    const across = Math.max(bounds[2] - bounds[0], 1e-6);
    const up = Math.max(bounds[3] - bounds[1], 1e-6);
    this.least = Math.min(Math.max(width - left - right, 40) / across, Math.max(height - top - bottom, 40) / up);
    this.k = this.least;
    this.x = left + (width - left - right - this.k * across) / 2 - this.k * bounds[0];
    this.y = height - bottom - (height - top - bottom - this.k * up) / 2 + this.k * bounds[1];
    this.fitted = true;
    this.apply();
  }

  /** Write the transform and let the lettering follow. */
  apply() {
    this.world.setAttribute("transform", `matrix(${this.k} 0 0 ${-this.k} ${this.x} ${this.y})`);
    this.onview();
  }

  /** The pixel of a point in mm. */
  page([x, y]) {
    return [this.x + this.k * x, this.y - this.k * y];
  }

  /** The point in mm of a pixel of the drawing. */
  model([px, py]) {
    return [(px - this.x) / this.k, (this.y - py) / this.k];
  }

  /** The point in mm under a pointer. */
  under(event) {
    const box = this.svg.getBoundingClientRect();
    return this.model([event.clientX - box.left, event.clientY - box.top]);
  }

  /**
   * Zoom about a pixel, by default the middle.
   * @param {number} factor
   * @param {number[]} [at]
   */
  zoom(factor, at = [this.svg.clientWidth / 2, this.svg.clientHeight / 2]) {
    const next = Math.min(Math.max(this.k * factor, (this.least ?? 1) / 4), (this.least ?? 1) * CLOSEST);
    const ratio = next / this.k;
    this.x = at[0] - ratio * (at[0] - this.x);
    this.y = at[1] - ratio * (at[1] - this.y);
    this.k = next;
    this.fitted = false;
    this.apply();
  }

  /** Move the drawing by pixels. */
  pan(dx, dy) {
    this.x += dx;
    this.y += dy;
    this.fitted = false;
    this.apply();
  }

  /** Listen to wheel, pointers and keys. */
  listen() {
    this.svg.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.svg.addEventListener("pointerdown", (event) => this.down(event));
    this.svg.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) this.svg.addEventListener(end, (event) => this.up(event));
    this.svg.addEventListener("keydown", (event) => this.key(event));
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const box = this.svg.getBoundingClientRect();
    const step = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
    this.zoom(Math.exp(-step * WHEEL), [event.clientX - box.left, event.clientY - box.top]);
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (event.button !== 0) return;
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.pointers.size === 1 && this.tool?.down(this.under(event), event)) {
      this.taken = event.pointerId;
      this.svg.setPointerCapture(event.pointerId);
    }
  }

  /** @param {PointerEvent} event */
  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      this.tool?.hover?.(this.under(event), event);
      return;
    }
    if (this.taken === event.pointerId && this.pointers.size === 1) {
      this.tool?.move?.(this.under(event), event);
      return;
    }
    const now = [event.clientX, event.clientY];
    if (this.pointers.size === 1) {
      if (Math.hypot(now[0] - before[0], now[1] - before[1]) < 3 && !this.panning) return;
      if (!this.panning) this.svg.setPointerCapture(event.pointerId);
      this.panning = true;
      this.pan(now[0] - before[0], now[1] - before[1]);
    } else {
      this.pinch(event.pointerId, before, now);
    }
    this.pointers.set(event.pointerId, now);
  }

  /** Two fingers: the point between them stays under them. */
  pinch(id, before, now) {
    const other = [...this.pointers].find(([key]) => key !== id)?.[1];
    if (!other) return;
    const ratio = Math.hypot(now[0] - other[0], now[1] - other[1]) /
      Math.max(1, Math.hypot(before[0] - other[0], before[1] - other[1]));
    const box = this.svg.getBoundingClientRect();
    this.zoom(ratio, [(now[0] + other[0]) / 2 - box.left, (now[1] + other[1]) / 2 - box.top]);
    this.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
  }

  /** @param {PointerEvent} event */
  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.taken === event.pointerId) {
      this.taken = null;
      this.tool?.up?.(this.under(event), event);
    }
    if (this.pointers.size === 0 && this.panning) {
      this.panning = false;
      // A drag is not a click on what lies under it.
      const stop = (click) => click.stopPropagation();
      this.svg.addEventListener("click", stop, { capture: true, once: true });
      setTimeout(() => this.svg.removeEventListener("click", stop, { capture: true }), 0);
    }
  }

  /** Plus, minus and 0 zoom; arrows with Shift pan. @param {KeyboardEvent} event */
  key(event) {
    const pans = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
    if (event.key === "+" || event.key === "=") this.zoom(1.3);
    else if (event.key === "-") this.zoom(1 / 1.3);
    else if (event.key === "0") this.fit();
    else if (event.shiftKey && pans[event.key]) this.pan(...pans[event.key]);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
