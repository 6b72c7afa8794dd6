/**
 * The drawing of the part as it was given: faces to forbid by a click, keep-out zones, and the places of errors.
 */
import { draw } from "./dom.js";
import { boundsOf, extend, outlinePath, pointAt, normalAt, segmentPath, segmentsOf } from "./geometry.js";
import { apart } from "./labels.js";
import { partSegments } from "./pose.js";
import { programPaths } from "./program-drawing.js";
import { change, state } from "./state.js";
import { bareLength, length, unitWord } from "./units.js";
import { Viewport } from "./viewport.js";

const MARGINS = [40, 40, 46, 46];
/** A number farther than this from its face, in pixels, has a line to it. */
const LEAD = 11;
/** Holes of less than this many pixels have their numbers so many pixels beside them. */
const SMALL = 34;
const BESIDE = 17;

/** The drawing of the part. */
export class PartDrawing {
  /** @param {SVGSVGElement} svg */
  constructor(svg) {
    this.svg = svg;
    this.view = new Viewport(svg);
    this.view.onview = () => this.letter();
    /** What a tool draws: in mm, and on top in pixels. */
    this.sketch = draw("g.sketch");
    /** @type {() => (Node|string)[]} */
    this.lettering = () => [];
    this.trouble = null;
    this.stray = null;
    this.pointed = null;
    this.faces = new Map();
    /** Other parts of the same file, which can be taken by a click. @type {null|{parts: any[], take: (number: number) => void, strokes?: number[][][], isChosen?: boolean}} */
    this.others = null;
  }

  /** Draw the part of the state, seen whole. */
  show() {
    this.trouble = null;
    this.stray = null;
    this.build();
    if (state.part) this.view.fit(this.extentOfAll(), MARGINS);
    else this.view.fit([0, 0, 120, 80], MARGINS);
  }

  /** The part's bounds, with those of all else in its file as long as nothing was chosen. */
  extentOfAll() {
    const box = [...state.part.bounds];
    if (!this.others || this.others.isChosen) return box;
    const { parts, strokes = [] } = this.others;
    const drawn = strokes.length ? [boundsOf(strokes.flatMap((chain) => segmentsOf(chain).slice(0, -1)))] : [];
    for (const [x0, y0, x1, y1] of [...parts.map(({ bounds }) => bounds), ...drawn]) {
      extend(box, [x0, y0]);
      extend(box, [x1, y1]);
    }
    return box;
  }

  /**
   * Show where a file is wrong, with as much of it as could be drawn.
   * @param {number[][][]} strokes lines and arcs of the file, each a chain of [x, y, bulge]
   * @param {{x: number, y: number}|null} place
   * @param {string} words
   */
  showTrouble(strokes, place, words) {
    this.trouble = place && { place, words };
    this.stray = strokes.length ? strokes.map((chain) => chainPath(chain)).join("") : "";
    this.build();
    const box = boundsOf(strokes.flatMap((chain) => segmentsOf(chain).slice(0, -1)));
    if (place) for (const [k, value] of [place.x, place.y, place.x, place.y].entries()) {
      box[k] = k < 2 ? Math.min(box[k], value) : Math.max(box[k], value);
    }
    const more = Math.max(box[2] - box[0], box[3] - box[1], 10) * 0.06;
    if (Number.isFinite(box[0])) this.view.fit([box[0] - more, box[1] - more, box[2] + more, box[3] + more], MARGINS);
    this.letter();
  }

  /** Make everything that lies in mm. */
  build() {
    const { part } = state;
    this.faces.clear();
    const shapes = (this.others?.parts ?? []).map((other) => this.other(other));
    const { strokes = [] } = this.others ?? {};
    if (strokes.length) shapes.push(draw("path.stray", { d: strokes.map((chain) => chainPath(chain)).join("") }));
    if (this.stray !== null) {
      shapes.push(draw("path.stray", { d: this.stray }));
    } else if (part) {
      const outline = outlinePath(part.loops);
      shapes.push(draw("path.part-fill", { d: outline }), ...programPaths(state.programRead));
      shapes.push(draw("g.zones", {}, ...state.zones.map((zone) => draw("path.zone", { d: outlinePath([zone]) }))));
      const byFace = new Map();
      for (const { segment, face } of partSegments(part)) {
        byFace.set(face, `${byFace.get(face) ?? ""}${segmentPath(segment)}`);
      }
      for (const [face, d] of byFace) shapes.push(this.face(face, d));
      shapes.push(draw("path.outline", { d: outline }));
      for (const [face, d] of byFace) if (isNever(part, face)) shapes.push(draw("path.never", { d }));
      for (const { hit } of this.faces.values()) shapes.push(hit);
    }
    this.view.world.replaceChildren(...shapes, this.sketch);
    this.paint();
    this.letter();
  }

  /** Another part of the file, to be taken by a click. */
  other({ number, loops }) {
    // Its holes can be clicked as well.
    const whole = draw("path.other-hit", { d: outlinePath(loops.slice(0, 1)) });
    const shape = draw("g.other-part", { "data-part": number }, draw("title", {}, `Part ${number}`), draw("path", { d: outlinePath(loops) }), whole);
    shape.addEventListener("click", () => {
      if (!this.view.tool) this.others?.take(number);
    });
    return shape;
  }

  /** A face that can be clicked. */
  face(number, d) {
    const seen = draw("path.face", { d });
    const hit = draw("path.face-hit", { d, "data-face": number });
    hit.append(draw("title", {}, `Face ${number}${bandWords(state.part, number)}`));
    hit.addEventListener("click", () => this.click(number));
    hit.addEventListener("pointerenter", () => this.point(number));
    hit.addEventListener("pointerleave", () => this.point(null));
    this.faces.set(number, { seen, hit });
    return seen;
  }

  /** Mark a face that is pointed at, here or in the list of faces. */
  point(number) {
    this.pointed = number;
    this.paint();
    this.letter();
  }

  /** Show which faces are forbidden and which is pointed at. */
  paint() {
    for (const [number, { seen }] of this.faces) {
      seen.classList.toggle("forbidden", state.avoid.includes(number));
      seen.classList.toggle("pointed", number === this.pointed);
    }
  }

  /** Draw what keeps its size: numbers of faces, the extent, errors, and what a tool wants. */
  letter() {
    const words = [];
    const { part } = state;
    if (part && this.stray === null && state.view !== "draw") words.push(...this.extent(part), ...this.numbers(part));
    if (state.view !== "draw") {
      for (const { number, bounds: [x0, y0, x1, y1] } of this.others?.parts ?? []) {
        const [x, y] = this.view.page([(x0 + x1) / 2, (y0 + y1) / 2]);
        words.push(draw("text.other-name", { x, y, dy: "0.36em", "text-anchor": "middle" }, String(number)));
      }
    }
    if (this.trouble) {
      const [x, y] = this.view.page([this.trouble.place.x, this.trouble.place.y]);
      words.push(draw("circle.trouble", { cx: x, cy: y, r: 13 }), draw("circle.trouble-dot", { cx: x, cy: y, r: 3 }));
    }
    this.view.overlay.replaceChildren(...words, ...this.lettering());
  }

  /** The number of each face, where there is room for it or it is asked for; that of a round hole always. */
  numbers(part) {
    const seen = new Map();
    for (const { segment, face } of partSegments(part)) {
      const long = Math.hypot(segment.end[0] - segment.start[0], segment.end[1] - segment.start[1]) * this.view.k;
      if (!seen.has(face) || seen.get(face).long < long) seen.set(face, { segment, long });
    }
    const loops = new Map();
    for (const { loop, face } of part.segments) loops.set(loop, (loops.get(loop) ?? new Set()).add(face));
    const alone = new Set([...loops.values()].filter((faces) => faces.size === 1).flatMap((faces) => [...faces]));
    const labels = [...seen].flatMap(([face, { segment, long }]) => {
      const asked = state.avoid.includes(face) || face === this.pointed;
      if (long < 24 && !asked && !alone.has(face)) return [];
      const on = this.view.page(pointAt(segment, 0.5));
      // Beside a small hole, which a number on it would cover.
      const [nx, ny] = alone.has(face) && long < SMALL ? normalAt(segment, 0.5) : [0, 0];
      return [{ face, x: on[0] - BESIDE * nx, y: on[1] + BESIDE * ny, w: 19, h: 19, on }];
    });
    apart(labels);
    return labels.flatMap((label) => this.number(label));
  }

  /** The number of a face, which stands on it and can be clicked as it can; one that was pushed away has a lead. */
  number({ face, x, y, on }) {
    const kind = `${state.avoid.includes(face) ? " forbidden" : ""}${face === this.pointed ? " pointed" : ""}`;
    const lead = Math.hypot(x - on[0], y - on[1]) > LEAD ? [draw("path.face-lead", { d: `M${on[0]} ${on[1]}L${x} ${y}` })] : [];
    const name = draw("g.face-number", { "data-face": face },
      draw("title", {}, `Face ${face}${bandWords(state.part, face)}`),
      draw("circle", { class: `face-label${kind}`, cx: x, cy: y, r: 10 }),
      draw("text", { class: `face-name${kind}`, x, y, dy: "0.36em", "text-anchor": "middle" }, String(face)));
    name.addEventListener("click", () => this.click(face));
    return [...lead, name];
  }

  /** A face was clicked, or its number. */
  click(face) {
    if (!this.view.tool) toggleFace(face);
  }

  /** Width and height of the part along its sides. */
  extent(part) {
    const [x0, y0, x1, y1] = part.bounds;
    const [[ax, ay], [bx, by]] = [this.view.page([x0, y0]), this.view.page([x1, y1])];
    const low = ay + 22;
    const aside = ax - 22;
    return [
      draw("path.dimension", { d: `M${ax} ${low}H${bx}M${ax} ${low - 5}v10M${bx} ${low - 5}v10` }),
      draw("path.dimension", { d: `M${aside} ${ay}V${by}M${aside - 5} ${ay}h10M${aside - 5} ${by}h10` }),
      draw("text.dimension-text", { x: (ax + bx) / 2, y: low + 15, "text-anchor": "middle" }, `${bareLength(x1 - x0, 2)} ${unitWord()}`),
      draw(
        "text.dimension-text",
        { "text-anchor": "middle", transform: `translate(${aside - 8} ${(ay + by) / 2}) rotate(-90)` },
        `${bareLength(y1 - y0, 2)} ${unitWord()}`,
      ),
    ];
  }
}

/**
 * Whether nothing may touch a face of a solid at the height of the pegs.
 * @param {any} part
 * @param {number} face
 */
export function isNever({ solid }, face) {
  return Boolean(solid) && solid.bands[face] === null;
}

/** The heights at which a face of a solid may be touched, after a comma; nothing where there are none to tell. */
export function bandWords({ solid }, face) {
  if (!solid) return "";
  const band = solid.bands[face];
  return band ? `, touched at heights ${bareLength(band[0], 2)} to ${length(band[1], 2)}` : ", never touched";
}

/** The path of an open chain of [x, y, bulge]. */
function chainPath(chain) {
  return segmentsOf(chain).slice(0, -1).map((segment, k) => segmentPath(segment, k === 0)).join("");
}

/**
 * Forbid a face, or allow it again.
 * @param {number} number
 */
export function toggleFace(number) {
  const rest = state.avoid.filter((face) => face !== number);
  change({ avoid: rest.length < state.avoid.length ? rest : [...rest, number].sort((a, b) => a - b) });
}
