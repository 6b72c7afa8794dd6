/**
 * The drawing of one fixture: the server's picture, of which groups are moved, and what the page adds to it.
 *
 * How the groups of the picture are marked is written in presenting/zoomed_picture.py and presenting/moving_picture.py.
 */
import { draw, quiet, show } from "./dom.js";
import { drawOver } from "./fixture-overlay.js";
import { forceOf, intoVise, poseMatrix, writtenTurn } from "./pose.js";
import { nearestMove, programPaths } from "./program-drawing.js";
import { clampFromAbove, supportPads } from "./supports-drawing.js";
import { lyingMatrix } from "./trial.js";
import { length } from "./units.js";
import { Viewport } from "./viewport.js";

/** Units of a picture for each pixel. */
export const UNITS = 1.15;
/** A picture is asked for anew in a frame that is so many times as wide or high as its own. */
const OTHER = 1.12;
/** How far what slides opens before it closes before the user's eyes, as a share of the drawing's width. */
const OPEN = 0.16;

/** The numbers of a text. @param {string} text */
const numbers = (text) => text.match(/-?[\d.]+(e[-+]?\d+)?/g)?.map(Number) ?? [];

/**
 * The groups of a picture, and the picture's root.
 * @param {string} text
 */
export function pictureOf(text) {
  const root = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  return { root, groups: [...root.children].filter(({ tagName }) => !["title", "rect"].includes(tagName)).map((child) => document.importNode(child, true)) };
}

/** A drawing of fixtures in an SVG element. */
export class FixtureDrawing {
  /**
   * @param {SVGSVGElement} svg
   * @param {(index: number|null, at: DOMRect|null) => void} pointed called with the peg that is pointed at or focused
   * @param {(row: any, size: number[]) => Promise<string|null>} redrawn asks for the picture of a fixture in a frame of another size in pixels
   */
  constructor(svg, pointed, redrawn) {
    this.svg = svg;
    this.view = new Viewport(svg);
    this.view.onview = () => this.letter();
    this.pointed = pointed;
    this.row = null;
    this.load = null;
    this.open = 0;
    this.frame = 0;
    /** How the part lies where it was put by hand; null where the fixture has it. @type {import("./trial.js").Lying|null} */
    this.lying = null;
    /** What else keeps its size on top. @type {() => Node[]} */
    this.extras = () => [];
    /** How far the cutter is to keep off the pegs, in mm; null for no such circles. @type {number|null} */
    this.clearance = null;
    /** Supports under the part and the clamp over them. @type {any} */
    this.supports = null;
    /** What was understood of the machine's program, and the move of it that comes nearest. @type {any} */
    this.program = null;
    /** @type {any} */
    this.passing = null;
    /** Pegs in the picture. @type {SVGElement[]} */
    this.pegs = [];
    this.suit = quiet(async () => {
      const { row, size } = this;
      const frame = this.view.size;
      const others = frame.map((pixels, k) => (pixels * UNITS) / size?.[k]);
      if (!row?.rank || this.view.printing || !others.every((share) => share > 0) || others.every((share) => share < OTHER && share > 1 / OTHER)) return;
      const picture = await redrawn(row, frame);
      if (!picture || this.row !== row || this.open || this.lying) return;
      row.picture = picture;
      this.build();
      if (this.view.fitted) this.fit();
      else this.view.apply();
    }, 120);
  }

  /**
   * Draw a fixture.
   * @param {any} toolkit
   * @param {import("./pose.js").Row} row
   */
  show(toolkit, row) {
    cancelAnimationFrame(this.frame);
    this.open = 0;
    this.lying = null;
    this.supports = null;
    this.toolkit = toolkit;
    this.row = row;
    this.toVise = intoVise(row);
    this.build();
    this.fit();
    this.svg.setAttribute("aria-label", this.words());
  }

  /** See the whole picture. */
  fit() {
    const [from, to] = [[0, this.size[1]], [this.size[0], 0]].map(([x, y]) => this.map.inverse().transformPoint({ x, y }));
    this.view.fit([from.x, from.y, to.x, to.y], [0, 0, 0, 0]);
  }

  /** Show how far the cutter is to keep off the pegs. */
  keepOff(clearance) {
    if (clearance === this.clearance) return;
    this.clearance = clearance;
    if (this.row) this.add();
  }

  /** Show supports and the clamp on top, or none. @param {any} supports a set of the server, with the radii */
  showSupports(supports) {
    if (supports === this.supports) return;
    this.supports = supports;
    if (this.row) this.add();
  }

  /** Show the paths of a program, or none. @param {any} read */
  showProgram(read) {
    this.program = read;
    if (this.row) this.add();
  }

  /** Light up the move that comes nearest, or none. @param {any} passing as the server tells it */
  showPassing(passing) {
    if (passing === this.passing) return;
    this.passing = passing;
    if (this.row) this.add();
  }

  /** Nothing is shown. */
  clear() {
    cancelAnimationFrame(this.frame);
    this.row = null;
    this.view.world.replaceChildren();
    this.view.overlay.replaceChildren();
  }

  /** What the drawing shows, for those who do not see it. */
  words() {
    const { row } = this;
    const set = row.settings.map((one) => `${one.name} ${one.length.toFixed(3)} mm, `).join("");
    return `Fixture ${row.rank || ""}, ${row.title}: pegs in ${row.holes.join(", ")}, ${set}part turned by ${writtenTurn(row).toFixed(3)} degrees. The table of pegs tells the rest.`;
  }

  /** Put the picture in its place. */
  build() {
    const { root, groups } = pictureOf(this.row.picture);
    const { dataset } = /** @type {SVGElement} */ (/** @type {any} */ (root));
    const [left, top, right, bottom] = numbers(dataset.rim ?? "").map((units) => units / UNITS);
    this.map = new DOMMatrix(numbers(dataset.modelToPage ?? ""));
    this.size = numbers(root.getAttribute("viewBox") ?? "").slice(2);
    this.whole = numbers(dataset.extent ?? "");
    this.rim = [top, right, bottom, left];
    const picture = draw("g.picture", { transform: String(this.map.inverse()) }, ...groups);
    const all = (kind) => /** @type {SVGElement[]} */ ([...picture.querySelectorAll(kind)]);
    this.shape = all(".part")[0];
    this.ghost = draw("path.ghost", { d: this.shape.lastElementChild?.getAttribute("d"), hidden: true });
    this.shape.before(this.ghost);
    this.kept = all(".kept").map((group) => ({ group, at: numbers(group.dataset.at ?? ""), axes: group.dataset.axes ?? "", number: Number(group.dataset.number), step: Number(group.dataset.step ?? 0) }));
    this.movers = all(".moves").map(moverOf);
    this.most = Math.min(...all("[data-most]").map(({ dataset }) => Number(dataset.most)));
    this.travels = all(".travel").filter((group) => group.querySelector(".moves")).map(travelOf);
    const focused = this.pegs.findIndex((peg) => peg === document.activeElement);
    this.pegs = all("[data-peg]");
    for (const peg of this.pegs) this.listen(peg, Number(peg.dataset.peg));
    this.added = [];
    this.arrows = draw("g");
    all(".forces")[0].after(this.arrows);
    this.view.world.replaceChildren(picture);
    this.add();
    this.pegs[focused]?.focus();
  }

  /** What the page adds to the picture: program, supports, circles about the pegs. */
  add() {
    const { row, map, toolkit, clearance } = this;
    for (const old of this.added) old.remove();
    const program = draw("g", { transform: String(map.multiply(poseMatrix(row))) }, ...programPaths(this.program), ...nearestMove(this.passing));
    this.shape.lastElementChild?.before(program);
    const pads = row.carriers.map(({ clamping }, k) => ({ group: draw("g", {}, ...supportPads(this.supports, k)), way: clamping ?? [0, 0], bars: [] }));
    this.over = draw("g.clamped-down", {}, ...clampFromAbove(this.supports));
    const supports = draw("g", { transform: String(map) }, ...pads.map(({ group }) => group), this.over);
    this.view.world.querySelector(".over-part")?.append(supports);
    this.added = [program, supports];
    if (clearance !== null) {
      for (const peg of this.pegs) {
        const k = Number(peg.dataset.peg);
        const [cx, cy] = row.pegs[k];
        const radius = toolkit.body_radius ?? row.carriers.find(({ pegs }) => pegs.includes(k))?.peg_radius ?? 0;
        const circle = draw("g", { transform: String(map) }, draw("circle.keep-out", { cx, cy, r: radius + clearance }));
        peg.prepend(circle);
        this.added.push(circle);
      }
    }
    this.pads = pads;
    this.slide(this.open);
  }

  /** Make a peg something to point at and to focus. */
  listen(peg, k) {
    const { row } = this;
    const where = row.flush.includes(k) ? "Contact with" : "Peg in";
    const words = `${where} ${row.holes[k]}, on face ${row.touched[k]}${row.hold ? "" : `, presses with ${row.forces[k].toFixed(3)} N for each N of ${forceOf(row)}`}`;
    for (const [name, value] of Object.entries({ tabindex: "0", role: "img", "aria-label": words })) peg.setAttribute(name, value);
    for (const name of ["pointerenter", "focus"]) {
      peg.addEventListener(name, () => {
        this.mark(k);
        this.pointed(k, peg.getBoundingClientRect());
      });
    }
    for (const name of ["pointerleave", "blur"]) {
      peg.addEventListener(name, () => {
        this.mark(-1);
        this.pointed(null, null);
      });
    }
  }

  /**
   * Show the part where it was put by hand, with an outline of its place, or where the fixture has it.
   * @param {import("./trial.js").Lying|null} lying
   */
  lie(lying) {
    cancelAnimationFrame(this.frame);
    this.lying = lying;
    const { map } = this;
    if (lying) this.shape.setAttribute("transform", String(map.multiply(lyingMatrix(lying)).multiply(poseMatrix(this.row).inverse()).multiply(map.inverse())));
    else this.shape.removeAttribute("transform");
    this.shape.classList.toggle("put", lying !== null);
    this.shape.classList.toggle("over", lying?.over === true);
    show(this.ghost, lying !== null);
  }

  /** Mark a peg, in the drawing only. */
  mark(index) {
    for (const peg of this.pegs) peg.classList.toggle("marked", Number(peg.dataset.peg) === index);
  }

  /** Let what keeps its size keep it, for the view as it is, and draw what lies over the picture. */
  letter() {
    if (!this.row) return;
    const share = this.map.a / UNITS / this.view.k;
    for (const { group, at: [x, y], axes, number, step } of this.kept) {
      const [across, down] = [axes.includes("x") ? share : 1, axes.includes("y") ? share : 1];
      group.setAttribute("transform", `matrix(${across} 0 0 ${down} ${x * (1 - across)} ${y * (1 - down)})`);
      if (step) show(group, number % Math.max(1, Math.ceil(step * share)) === 0);
    }
    // Arrows are drawn in pixels, below the names of holes.
    const { k, x: left, y: foot } = this.view;
    this.arrows.setAttribute("transform", String(this.map.multiply(new DOMMatrix([k, 0, 0, -k, left, foot]).inverse())));
    drawOver(this);
    this.suit();
  }

  /**
   * Show the forces of a load, or none.
   * @param {null|{at: number[], vector: number[], forces: number[], size: number}} load `at` and `vector` in mm in the vise frame
   */
  showLoad(load) {
    this.load = load;
    this.svg.classList.toggle("loaded", load !== null);
    this.letter();
  }

  /** Put what slides `open` mm from where it clamps; a clamp is drawn back no farther than it goes. */
  slide(open) {
    this.open = open;
    this.svg.classList.toggle("opened", open !== 0 || this.lying !== null);
    for (const { group, way, bars } of [...this.movers, ...this.pads]) {
      const [x, y] = way.map((each) => -each * Math.min(open, this.most));
      for (const { bar, at } of bars) bar.setAttribute("d", `M${at[0]} ${at[1]}L${at[2] + x} ${at[3] + y}`);
      if ((x || y) && !bars.length) group.setAttribute("transform", `translate(${x} ${y})`);
      else group.removeAttribute("transform");
    }
    for (const { sign, length: closed, grows, text } of this.travels) text.textContent = `${sign} = ${length(open ? Math.abs(Math.abs(closed) + grows * Math.min(open, this.most)) : closed)}`;
    show(this.over, !open);
    this.letter();
  }

  /** Close the vise before the user's eyes; at once for those who want no motion. */
  close() {
    cancelAnimationFrame(this.frame);
    if (!this.row) return;
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) {
      this.slide(0);
      return;
    }
    const far = (this.whole[2] - this.whole[0]) * OPEN;
    const begun = performance.now();
    const step = (now) => {
      const share = Math.min(1, (now - begun) / 650);
      this.slide(far * (1 - share) ** 3);
      if (share < 1) this.frame = requestAnimationFrame(step);
    };
    this.slide(far);
    this.frame = requestAnimationFrame(step);
  }
}

/**
 * A length to set: the words of its dimension, and by how much it grows for each mm that what slides is open.
 * @param {SVGElement} group
 */
function travelOf(group) {
  const text = /** @type {SVGElement} */ (group.querySelector(".dimension-text"));
  const { way, bars: [{ at: [x0, y0, x1, y1] }] } = moverOf(/** @type {SVGElement} */ (group.querySelector(".moves")));
  return { text, sign: text.dataset.sign, length: Number(text.dataset.length), grows: -Math.sign(way[0] * (x1 - x0) + way[1] * (y1 - y0)) };
}

/**
 * What moves: its group and its way; of a bolted clamp and a dimension only the second end of its bars does.
 * @param {SVGElement} group
 */
function moverOf(group) {
  const bolted = group.querySelector(".clamp .bolt") ? group.querySelectorAll('.clamp > path[stroke-linecap="round"]') : [];
  const bars = [...bolted, ...group.querySelectorAll(":scope > .stretches")];
  return {
    group,
    way: numbers(group.dataset.way ?? ""),
    bars: bars.map((bar) => ({ bar, at: numbers(bar.getAttribute("d") ?? "") })),
  };
}
