/**
 * The drawing of one fixture: plates with their holes, the part in its pose, pegs, and what lies in mm.
 *
 * Lettering and arrows are in fixture-lettering.js; they keep their size when the drawing is zoomed.
 */
import { draw, show } from "./dom.js";
import { boundsOf, outlinePath, segmentPath } from "./geometry.js";
import { drawLettering } from "./fixture-lettering.js";
import { contactsOf, forceOf, intoVise, partSegments, place, poseMatrix, touchableSegments, writtenTurn } from "./pose.js";
import { nearestMove, programPaths } from "./program-drawing.js";
import { clampFromAbove, supportPads } from "./supports-drawing.js";
import { lyingMatrix } from "./trial.js";
import { Viewport } from "./viewport.js";

/** Room around the drawing for lettering, in pixels: top, right, bottom, left. */
const MARGINS = [62, 52, 48, 52];
const MOST_HOLES = 2500;

/** A drawing of fixtures in an SVG element. */
export class FixtureDrawing {
  /**
   * @param {SVGSVGElement} svg
   * @param {(index: number|null, at: DOMRect|null) => void} pointed called with the peg that is pointed at or focused
   */
  constructor(svg, pointed = () => {}) {
    this.svg = svg;
    this.view = new Viewport(svg);
    this.view.onview = () => this.letter();
    this.pointed = pointed;
    this.row = null;
    this.load = null;
    this.open = 0;
    this.frame = 0;
    this.underPegs = draw("g");
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
  }

  /**
   * Draw a fixture.
   * @param {any} part
   * @param {any} toolkit
   * @param {import("./pose.js").Row} row
   * @param {{keepView?: boolean}} [options]
   */
  show(part, toolkit, row, { keepView = false } = {}) {
    cancelAnimationFrame(this.frame);
    this.open = 0;
    this.lying = null;
    this.supports = null;
    const toVise = intoVise(row);
    const box = boundsOf(partSegments(part).map(({ segment }) => segment), toVise);
    this.part = part;
    this.toolkit = toolkit;
    this.row = row;
    this.toVise = toVise;
    this.contacts = contactsOf(part, row).map(({ contact, normal }) => {
      const [x, y] = toVise(normal);
      return { at: toVise(contact), normal: [x - row.x, y - row.y] };
    });
    this.build();
    const whole = [...box];
    for (const { plate } of row.carriers) {
      whole[0] = Math.min(whole[0], plate[0]);
      whole[1] = Math.min(whole[1], plate[1]);
      whole[2] = Math.max(whole[2], plate[2]);
      whole[3] = Math.max(whole[3], plate[3]);
    }
    this.whole = whole;
    const margins = this.svg.clientWidth < 520 ? [58, 34, 40, 34] : MARGINS;
    if (keepView && !this.view.fitted) this.view.apply();
    else this.view.fit(whole, margins);
    this.svg.setAttribute("aria-label", this.words());
  }

  /** Show how far the cutter is to keep off the pegs. */
  keepOff(clearance) {
    if (clearance === this.clearance) return;
    this.clearance = clearance;
    if (this.row) this.build();
  }

  /** Show supports and the clamp on top, or none. @param {any} supports a set of the server, with the radii */
  showSupports(supports) {
    if (supports === this.supports) return;
    this.supports = supports;
    if (this.row) this.build();
  }

  /** Show the paths of a program, or none. @param {any} read */
  showProgram(read) {
    this.program = read;
    if (this.row) this.build();
  }

  /** Light up the move that comes nearest, or none. @param {any} passing as the server tells it */
  showPassing(passing) {
    if (passing === this.passing) return;
    this.passing = passing;
    if (this.row) this.build();
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

  /** Make everything that lies in mm. */
  build() {
    const { part, row } = this;
    const outline = outlinePath(part.loops);
    const touched = new Set(row.faces.filter((_, k) => !row.corners.includes(k)));
    const shape = draw("g.part", { transform: poseMatrix(row) }, draw("path.part-fill", { d: outline }));
    this.shape = shape;
    this.ghost = draw("path.ghost", { d: outline, transform: poseMatrix(row), hidden: true });
    for (const { segment, face } of touchableSegments(part)) {
      if (touched.has(face)) shape.append(draw("path.touched", { d: segmentPath(segment), "data-face": face }));
    }
    shape.append(...programPaths(this.program), ...nearestMove(this.passing));
    shape.append(draw("path.outline", { d: outline }));
    this.underPegs = draw("g.under-pegs");
    const groups = (contents) => row.carriers.map((each) => draw(each.clamping ? "g.sliding" : "g.still", {}, ...contents(each)));
    this.plates = groups((each) => (each.clamp ? this.clamp(each) : this.plate(each)));
    // Arrows lie over the part, for clamps that stand in a hole of it.
    this.pegs = groups((each) => [
      ...(each.clamp ? [this.push(each)] : []),
      ...each.pegs.map((k, at) => this.peg(row.pegs[k], k, each, each.flats?.[at] ?? null)),
    ]);
    this.pads = row.carriers.map((_, k) => draw("g", {}, ...supportPads(this.supports, k)));
    this.over = draw("g.clamped-down", {}, ...clampFromAbove(this.supports));
    this.view.world.replaceChildren(...this.plates, this.ghost, shape, ...this.pads, this.over, ...this.pegs);
    this.slide(this.open);
  }

  /**
   * Show the part where it was put by hand, with an outline of its place, or where the fixture has it.
   * @param {import("./trial.js").Lying|null} lying
   */
  lie(lying) {
    cancelAnimationFrame(this.frame);
    this.lying = lying;
    this.shape.setAttribute("transform", lying ? lyingMatrix(lying) : poseMatrix(this.row));
    this.shape.classList.toggle("put", lying !== null);
    this.shape.classList.toggle("over", lying?.over === true);
    show(this.ghost, lying !== null);
  }

  /** The plate of a carrier and its holes. */
  plate(carrier) {
    const { columns, rows, hole_radius: size, clamping } = carrier;
    const [x0, y0, x1, y1] = carrier.plate;
    const kind = carrier.pegs.some((k) => this.row.flush.includes(k)) ? "wall" : clamping ? "slides" : "stands";
    const plate = draw(`rect.plate.${kind}`, { x: x0, y: y0, width: x1 - x0, height: y1 - y0 });
    let holes = "";
    if ((columns[1] - columns[0] + 1) * (rows[1] - rows[0] + 1) <= MOST_HOLES) {
      for (let column = columns[0]; column <= columns[1]; column += 1) {
        for (let row = rows[0]; row <= rows[1]; row += 1) {
          const [x, y] = place(carrier, column, row);
          holes += `M${x - size} ${y}a${size} ${size} 0 1 0 ${2 * size} 0a${size} ${size} 0 1 0 ${-2 * size} 0Z`;
        }
      }
    }
    return [plate, draw("path.holes", { d: holes })];
  }

  /** A clamp: its body and bolt, or the line of holes that its tip is on. */
  clamp({ clamp, clamping: [dx], pitch, peg_radius: size }) {
    const { hole, tip, bolt_radius: bolt } = clamp;
    const [x0, y0, x1, y1] = clamp.line;
    const radius = Math.max(size, (dx ? pitch[0] : pitch[1]) / 12);
    if (!hole) return [draw("path.clamp-line", { d: dx ? `M${x0} ${tip[1]}H${x1}` : `M${tip[0]} ${y0}V${y1}` })];
    const ends = { x1: hole[0], y1: hole[1], x2: tip[0], y2: tip[1] };
    return [
      draw("line.clamp-edge.clamp-body", { ...ends, "stroke-width": 2 * radius }),
      draw("line.clamp-fill.clamp-body", { ...ends, "stroke-width": 1.8 * radius }),
      draw("circle.bolt", { cx: hole[0], cy: hole[1], r: Math.min(bolt, 0.8 * radius) }),
    ];
  }

  /** The arrow behind a clamp in the way it pushes. */
  push({ clamp, clamping: [dx, dy], pitch, peg_radius: size }) {
    const pitchAlong = dx ? pitch[0] : pitch[1];
    const radius = Math.max(size, pitchAlong / 12);
    const [x, y] = clamp.hole ?? clamp.tip;
    const at = (away, aside) => `${x - away * dx - aside * dy} ${y - away * dy + aside * dx}`;
    const [near, far, neck, wing, shaft] = [radius * 1.1, pitchAlong * 0.95, radius * 1.1 + pitchAlong * 0.24, pitchAlong * 0.13, pitchAlong * 0.055];
    const corners = [[near, 0], [neck, wing], [neck, shaft], [far, shaft], [far, -shaft], [neck, -shaft], [neck, -wing]];
    return draw("path.clamp-push", { d: `M${corners.map(([away, aside]) => at(away, aside)).join("L")}Z` });
  }

  /** A peg that can be pointed at and focused. */
  peg([x, y], k, { peg_radius: size, flat }, looks) {
    const radius = Math.max(size, Math.min(...this.toolkit.pitch) / 12);
    const { row, clearance } = this;
    const where = row.flush.includes(k) ? "Contact with" : "Peg in";
    const words = `${where} ${row.holes[k]}, on face ${row.touched[k]}, presses with ${row.forces[k].toFixed(3)} N for each N of ${forceOf(row)}`;
    const group = draw("g.peg", { tabindex: 0, role: "img", "aria-label": words, "data-peg": k });
    if (clearance !== null) group.append(draw("circle.keep-out", { cx: x, cy: y, r: (this.toolkit.body_radius ?? size) + clearance }));
    if (looks === null || flat >= size) group.append(draw("circle.peg-body", { cx: x, cy: y, r: radius }));
    else group.append(draw("path.peg-body", { d: flattedPath([x, y], radius, (looks * Math.PI) / 180, Math.acos(flat / size)) }));
    const cross = radius / 2;
    group.append(draw("path.peg-cross", { d: `M${x - cross} ${y}H${x + cross}M${x} ${y - cross}V${y + cross}` }));
    const point = () => {
      this.mark(k);
      this.pointed(k, group.getBoundingClientRect());
    };
    const away = () => {
      this.mark(-1);
      this.pointed(null, null);
    };
    group.addEventListener("pointerenter", point);
    group.addEventListener("pointerleave", away);
    group.addEventListener("focus", point);
    group.addEventListener("blur", away);
    return group;
  }

  /** Mark a peg, in the drawing only. */
  mark(index) {
    for (const peg of this.svg.querySelectorAll(".peg")) peg.classList.toggle("marked", Number(peg.dataset.peg) === index);
  }

  /** Draw the lettering for the view as it is. */
  letter() {
    if (this.row) drawLettering(this);
  }

  /**
   * Show the forces of a load, or none.
   * @param {null|{at: number[], vector: number[], forces: number[]}} load `at` and `vector` in mm in the vise frame
   */
  showLoad(load) {
    this.load = load;
    this.letter();
  }

  /** How far from its place in the drawing a carrier is shown, in mm; a clamp is drawn back no farther than it goes. */
  shift({ clamping, clamp }) {
    const open = Math.min(this.open, clamp?.draws_back ?? Infinity);
    return clamping && open ? [-clamping[0] * open, -clamping[1] * open] : [0, 0];
  }

  /** Put what slides `open` mm from where it clamps. */
  slide(open) {
    this.open = open;
    this.row.carriers.forEach((carrier, k) => {
      const [x, y] = this.shift(carrier);
      const { clamp } = carrier;
      if (clamp) {
        // The bolt stays where it is, and the body is as long as the tip is out.
        for (const body of this.plates[k].querySelectorAll(".clamp-body")) {
          body.setAttribute("x2", clamp.tip[0] + x);
          body.setAttribute("y2", clamp.tip[1] + y);
        }
      }
      for (const group of clamp?.hole ? [this.pegs[k]] : [this.plates[k], this.pegs[k], this.pads[k]]) {
        if (x || y) group.setAttribute("transform", `translate(${x} ${y})`);
        else group.removeAttribute("transform");
      }
    });
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
    const far = Math.max(1.5 * this.row.carriers[0].pitch[0], (this.whole[2] - this.whole[0]) * 0.16);
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
 * The outline of a peg that a flat cuts off.
 *
 * @param {number[]} center
 * @param {number} radius
 * @param {number} looks which way the flat looks, in radians
 * @param {number} half half of the angle that the flat takes of the circle
 */
function flattedPath([x, y], radius, looks, half) {
  const at = (angle) => `${x + radius * Math.cos(angle)} ${y + radius * Math.sin(angle)}`;
  return `M${at(looks + half)}A${radius} ${radius} 0 ${half < Math.PI / 2 ? 1 : 0} 1 ${at(looks - half)}Z`;
}
