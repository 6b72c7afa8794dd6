/**
 * Drawing a part with the mouse or the keys: lines and arcs on a grid, lengths and radii typed, edges that would cross refused.
 */
import { ApiError, send } from "./api.js";
import { byId, choice, draw, show } from "./dom.js";
import { outlinePath, segmentOf, segmentPath } from "./geometry.js";
import { bulgeOfRadius, bulgeThrough, Refusal, Sketch } from "./sketch.js";
import { length, readLength, scale } from "./units.js";

/** How near in pixels the start of the chain must be to be taken instead of the grid. */
const CATCH = 12;
/** The part drawn by hand has this name. */
const NAME = "drawing";

/** The tool; it exists while a part is drawn. */
export class DrawingTool {
  /**
   * @param {import("./part-drawing.js").PartDrawing} drawing
   * @param {(part: any) => void} finished called with the part as the server tells it
   */
  constructor(drawing, finished) {
    this.drawing = drawing;
    this.finished = finished;
    this.sketch = new Sketch();
    this.kind = "line";
    /** The end of an arc that still needs a point to pass through. */
    this.arcEnd = null;
    this.cursor = [0, 0];
    this.refused = null;
    drawing.stray = "";
    drawing.trouble = null;
    drawing.others = null;
    drawing.view.tool = this;
    drawing.svg.classList.add("tooled");
    drawing.lettering = () => this.letter();
    drawing.build();
    drawing.view.fit([-10, -10, 130, 90], [20, 20, 20, 20]);
    this.listen();
    this.tell("Click the first corner, or move with the arrow keys and press Enter.");
    this.paint();
  }

  /** Listen to the buttons of the tool. */
  listen() {
    this.stopping = new AbortController();
    const { signal } = this.stopping;
    const press = (id, call) => byId(id).addEventListener("click", call, { signal });
    press("draw-line", () => this.choose("line"));
    press("draw-arc", () => this.choose("arc"));
    press("draw-undo", () => this.undo());
    press("draw-close", () => this.close());
    press("draw-done", () => this.finish());
    byId("draw-size").addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.typed();
    }, { signal });
    byId("draw-grid").addEventListener("change", () => this.paint(), { signal });
    this.drawing.svg.addEventListener("keydown", (event) => this.key(event), { signal });
    this.choose("line");
  }

  /** Give the drawing back. */
  stop() {
    this.stopping.abort();
    const { drawing } = this;
    drawing.view.tool = null;
    drawing.svg.classList.remove("tooled");
    drawing.lettering = () => [];
    drawing.sketch.replaceChildren();
    drawing.stray = null;
  }

  /** The distance of the grid in mm; 0 for none. */
  get grid() {
    return Number(choice("draw-grid").value) * scale();
  }

  /** @param {"line"|"arc"} kind */
  choose(kind) {
    this.kind = kind;
    this.arcEnd = null;
    for (const each of ["line", "arc"]) byId(`draw-${each}`).setAttribute("aria-pressed", String(each === kind));
    byId("draw-size-name").textContent = kind === "line" ? "Length" : "Radius";
    this.paint();
  }

  /** Say something about the drawing. */
  tell(words, bad = false) {
    const line = byId("draw-words");
    line.textContent = words;
    line.classList.toggle("bad", bad);
  }

  /** A point on the grid, or the start of the chain when that is near. */
  snapped(point) {
    const { view } = this.drawing;
    const first = this.sketch.chain[0];
    if (first && this.sketch.chain.length > 1) {
      const [a, b] = [view.page(first), view.page(point)];
      if (Math.hypot(a[0] - b[0], a[1] - b[1]) < CATCH) return [first[0], first[1]];
    }
    const { grid } = this;
    return grid ? point.map((value) => Math.round(value / grid) * grid) : point;
  }

  /** A press of the pointer places a point. */
  down(point) {
    const free = this.kind === "arc" && this.arcEnd;
    this.place(free ? point : this.snapped(point));
    return true;
  }

  /** A drag draws nothing. */
  move(point) {
    this.hover(point);
  }

  /** The pointer moves. */
  hover(point) {
    this.cursor = this.kind === "arc" && this.arcEnd ? point : this.snapped(point);
    this.paint();
  }

  /** The cursor by keys: arrows step by the grid, Enter places. */
  key(event) {
    const step = this.grid || scale();
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (moves[event.key] && !event.shiftKey) {
      this.cursor = [0, 1].map((axis) => this.cursor[axis] + moves[event.key][axis] * step);
      this.paint();
    } else if (event.key === "Enter" || event.key === " ") this.place(this.cursor);
    else if (event.key === "Backspace") this.undo();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Place a point: a corner, the end of an arc, or what the arc passes through. */
  place(point) {
    try {
      if (this.kind === "arc" && this.sketch.last && !this.arcEnd) {
        if (Math.hypot(point[0] - this.sketch.last[0], point[1] - this.sketch.last[1]) < 1e-6) {
          throw new Refusal("The arc needs an end away from its start.", point);
        }
        this.arcEnd = point;
        this.tell("Now a point that the arc passes through, or type its radius.");
      } else if (this.arcEnd) {
        this.add(this.arcEnd, bulgeThrough(this.sketch.last, this.arcEnd, point));
      } else {
        this.add(point, 0);
      }
    } catch (error) {
      this.refuse(error);
    }
    this.paint();
  }

  /** Add an edge. */
  add(point, bulge) {
    const closed = this.sketch.add(point, bulge);
    this.arcEnd = null;
    this.refused = null;
    this.cursor = point;
    if (closed) this.tell("Closed. Press Use this part, or draw a hole inside.");
    else this.tell(`At ${point.map((value) => length(value, 2)).join(", ")}. Click on, type a length, or close.`);
  }

  /** Show why an edge is refused. */
  refuse(error) {
    if (!(error instanceof Refusal)) throw error;
    this.refused = error.at;
    this.tell(error.message, true);
  }

  /** A typed length runs from the last point towards the cursor; a typed radius bends the arc towards it. */
  typed() {
    const field = /** @type {HTMLInputElement} */ (byId("draw-size"));
    const size = readLength(field.value);
    const { last } = this.sketch;
    if (!last || !(size > 0)) {
      this.tell(last ? "Type a length above 0." : "Place the first point before typing a length.", true);
      return;
    }
    try {
      if (this.kind === "line") {
        const [dx, dy] = [this.cursor[0] - last[0], this.cursor[1] - last[1]];
        const far = Math.hypot(dx, dy);
        const [ux, uy] = far > 1e-9 ? [dx / far, dy / far] : [1, 0];
        this.add([last[0] + size * ux, last[1] + size * uy], 0);
      } else {
        if (!this.arcEnd) this.arcEnd = this.cursor;
        const end = this.arcEnd;
        const side = (this.cursor[1] - last[1]) * (end[0] - last[0]) - (this.cursor[0] - last[0]) * (end[1] - last[1]);
        const bulge = bulgeOfRadius(last, end, size, -side);
        if (Number.isNaN(bulge)) throw new Refusal("That radius is too small to reach from one end to the other.", end);
        this.add(end, bulge);
      }
      field.value = "";
    } catch (error) {
      this.refuse(error);
    }
    this.paint();
  }

  /** Take the last step back. */
  undo() {
    if (this.arcEnd) this.arcEnd = null;
    else if (!this.sketch.undo()) this.tell("There is nothing to undo.");
    this.refused = null;
    this.paint();
  }

  /** Close the chain with a line. */
  close() {
    const first = this.sketch.chain[0];
    if (!first || this.sketch.chain.length < 2) {
      this.tell("Draw two edges at least before you close.", true);
      return;
    }
    this.arcEnd = null;
    try {
      this.add([first[0], first[1]], 0);
    } catch (error) {
      this.refuse(error);
    }
    this.paint();
  }

  /** Have the part checked by the server, and use it. */
  async finish() {
    if (this.sketch.chain.length > 1) this.close();
    if (this.sketch.chain.length > 1 || !this.sketch.loops.length) {
      if (!this.sketch.loops.length && !this.refused) this.tell("Draw a closed outline first.", true);
      return;
    }
    const tidy = this.sketch.loops.map((loop) => loop.map((vertex) => vertex.map((v) => Number(v.toPrecision(15)))));
    try {
      this.finished(await send("parts/check", { name: NAME, loops: tidy }));
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      this.refused = error.place && [error.place.x, error.place.y];
      this.tell(error.message, true);
      this.paint();
    }
  }

  /** Draw grid, edges and the edge that would come next. */
  paint() {
    const { chain, loops, edges } = this.sketch;
    const shapes = [draw("path.part-fill", { d: outlinePath(loops) }), draw("path.outline", { d: outlinePath(loops) })];
    shapes.push(draw("path.outline", { d: edges.map((edge) => segmentPath(edge)).join("") }));
    this.wrong = false;
    if (chain.length) {
      const next = this.next();
      if (next) shapes.push(draw(`path.next-edge${this.wrong ? ".bad" : ""}`, { d: segmentPath(next) }));
    }
    this.drawing.sketch.replaceChildren(...shapes);
    this.drawing.letter();
  }

  /** The edge to the cursor; `wrong` tells whether it would be refused. */
  next() {
    const { last } = this.sketch;
    const end = this.arcEnd ?? this.cursor;
    if (Math.hypot(end[0] - last[0], end[1] - last[1]) < 1e-6) return null;
    const bulge = this.arcEnd ? bulgeThrough(last, end, this.cursor) : 0;
    try {
      return this.sketch.edge(end, bulge);
    } catch {
      this.wrong = true;
      return segmentOf(last, end, bulge);
    }
  }

  /** Grid dots, corners, the cursor and the place of a refusal, in pixels. */
  letter() {
    const { view } = this.drawing;
    const shapes = [draw("path.grid", { d: this.gridPath() })];
    for (const [x, y] of this.sketch.chain.map((vertex) => view.page(vertex))) {
      shapes.push(draw("circle.corner", { cx: x, cy: y, r: 3.5 }));
    }
    if (this.sketch.chain.length > 1) {
      const [x, y] = view.page(this.sketch.chain[0]);
      shapes.push(draw("circle.close-here", { cx: x, cy: y, r: 7 }));
    }
    const [cx, cy] = view.page(this.cursor);
    shapes.push(draw("path.cursor", { d: `M${cx - 8} ${cy}h16M${cx} ${cy - 8}v16` }));
    if (this.sketch.last) {
      const [dx, dy] = [0, 1].map((axis) => (this.arcEnd ?? this.cursor)[axis] - this.sketch.last[axis]);
      const text = `${length(Math.hypot(dx, dy), 2)}  ${((Math.atan2(dy, dx) * 180) / Math.PI).toFixed(1)}°`;
      shapes.push(draw("text.dimension-text", { x: cx + 12, y: cy - 10 }, text));
    }
    if (this.refused) {
      const [x, y] = view.page(this.refused);
      shapes.push(draw("circle.trouble", { cx: x, cy: y, r: 13 }));
    }
    show(byId("draw-done"), this.sketch.loops.length > 0 || this.sketch.chain.length > 2);
    return shapes;
  }

  /** The grid as little crosses, coarser when it would be too fine to see. */
  gridPath() {
    const { view, svg } = this.drawing;
    let step = this.grid || 10 * scale();
    while (step * view.k < 9) step *= step * view.k < 4 ? 5 : 2;
    const [left, top] = view.model([0, 0]);
    const [right, bottom] = view.model([svg.clientWidth, svg.clientHeight]);
    let d = "";
    for (let x = Math.ceil(left / step); x * step < right; x += 1) {
      for (let y = Math.ceil(bottom / step); y * step < top; y += 1) {
        const [px, py] = view.page([x * step, y * step]);
        const arm = x % 5 === 0 && y % 5 === 0 ? 2.5 : 1;
        d += `M${px - arm} ${py}h${2 * arm}M${px} ${py - arm}v${2 * arm}`;
      }
    }
    return d;
  }
}
