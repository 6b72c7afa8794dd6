/**
 * Drawing keep-out zones: a circle is dragged from its centre, a polygon clicked corner by corner.
 */
import { draw } from "./dom.js";
import { outlinePath } from "./geometry.js";
import { change, state } from "./state.js";
import { length } from "./units.js";

/** How near in pixels a click must be to the first corner to close a polygon. */
const CLOSE = 12;

/**
 * The loop of a circle.
 * @param {number[]} center
 * @param {number} radius
 */
export function circleLoop([x, y], radius) {
  return [[x - radius, y, 1], [x + radius, y, 1]];
}

/** A tool for one zone; it ends itself when the zone is drawn. */
export class ZoneTool {
  /**
   * @param {import("./part-drawing.js").PartDrawing} drawing
   * @param {"circle"|"polygon"} kind
   * @param {(made: boolean) => void} ended
   * @param {(loop: number[][]) => void} take what becomes of the zone; by default no peg may stand there
   */
  constructor(drawing, kind, ended, take = (loop) => change({ zones: [...state.zones, loop] })) {
    this.take = take;
    this.drawing = drawing;
    this.kind = kind;
    this.ended = ended;
    this.points = [];
    this.at = null;
    drawing.view.tool = this;
    drawing.svg.classList.add("tooled");
    drawing.lettering = () => this.letter();
  }

  /** A press: the centre of a circle, or a corner. */
  down(point) {
    if (this.kind === "circle") {
      this.points = [point];
      return true;
    }
    const { view } = this.drawing;
    const first = this.points[0];
    if (this.points.length > 2) {
      const [a, b] = [view.page(first), view.page(point)];
      if (Math.hypot(a[0] - b[0], a[1] - b[1]) < CLOSE) {
        this.finish(this.points.map(([x, y]) => [x, y, 0]));
        return true;
      }
    }
    this.points.push(point);
    this.preview(point);
    return true;
  }

  /** A drag. */
  move(point) {
    this.preview(point);
  }

  /** The pointer without a press. */
  hover(point) {
    this.preview(point);
  }

  /** The end of a press: a circle is whole. */
  up(point) {
    if (this.kind !== "circle" || !this.points.length) return;
    const radius = Math.hypot(point[0] - this.points[0][0], point[1] - this.points[0][1]);
    if (radius * this.drawing.view.k < 3) {
      this.points = [];
      return;
    }
    this.finish(circleLoop(this.points[0].map(rounded), rounded(radius)));
  }

  /** Show what would be drawn. */
  preview(point) {
    this.at = point;
    const { sketch } = this.drawing;
    if (!this.points.length) {
      sketch.replaceChildren();
    } else if (this.kind === "circle") {
      const radius = Math.hypot(point[0] - this.points[0][0], point[1] - this.points[0][1]);
      sketch.replaceChildren(draw("path.zone", { d: outlinePath([circleLoop(this.points[0], radius)]) }));
    } else {
      const loop = [...this.points, point].map(([x, y]) => [x, y, 0]);
      sketch.replaceChildren(draw("path.zone", { d: outlinePath([loop]) }));
    }
    this.drawing.letter();
  }

  /** The radius while a circle is dragged, and the corner that closes a polygon. */
  letter() {
    const { view } = this.drawing;
    if (!this.points.length || !this.at) return [];
    const [x, y] = view.page(this.points[0]);
    if (this.kind === "polygon") return [draw("circle.close-here", { cx: x, cy: y, r: 7 })];
    const radius = Math.hypot(this.at[0] - this.points[0][0], this.at[1] - this.points[0][1]);
    return [draw("text.dimension-text", { x, y: y - 6, "text-anchor": "middle" }, `r ${length(radius, 1)}`)];
  }

  /** Hand the zone on. */
  finish(loop) {
    this.take(loop);
    this.stop(true);
  }

  /** Put everything back. */
  stop(made = false) {
    this.drawing.view.tool = null;
    this.drawing.svg.classList.remove("tooled");
    this.drawing.lettering = () => [];
    this.drawing.sketch.replaceChildren();
    this.drawing.letter();
    this.ended(made);
  }
}

/** A length to a hundredth of a millimetre: nobody draws finer by hand. */
function rounded(value) {
  return Math.round(value * 100) / 100;
}
