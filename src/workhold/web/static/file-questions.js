/**
 * What a file leaves open, asked beside its drawing: the unit, which of its parts, which gaps are to be joined.
 */
import { byId, draw, make, show } from "./dom.js";
import { boundsOf, segmentPath, segmentsOf } from "./geometry.js";
import { standingQuestion } from "./standing-question.js";
import { state } from "./state.js";
import { bareLength, countText, length, number, unitWord } from "./units.js";

/** @typedef {{unit?: string, part_number?: number, layers?: string[], join_tolerance?: number, fit?: number, axis?: string, peg_height?: number, head_room?: number, least_band?: number, peg_diameter?: number}} How what has been answered so far */

/** Gaps up to this many mm are joined without asking. */
const JOINED = 0.001;
const MM_PER_INCH = 25.4;
/** A gap below this share of the drawing may be meant to be closed. */
const SLIP = 0.01;
/** In mm: how far arcs may be from the curves that they stand for. */
const FITS = [0.01, 0.05, 0.1, 0.5];
/** Parts that are listed; all of them can be clicked. */
const LISTED = 24;

/** The size in its own unit of a drawing whose unit was asked. @type {number[]|null} */
let bare = null;
/** Its size in pixels; only SVG drawings have one. @type {number[]|null} */
let barePixels = null;
/** Pixels to an inch that programs write drawings with. */
const PIXELS = [72, 90, 96];

/** Whether anything is asked. */
let any = false;

/** Questions stand beside the part, not beside a fixture. */
export function showQuestions() {
  show(byId("file-asks"), any && state.view === "part");
}

/** Nothing is asked. */
export function noQuestions() {
  bare = null;
  any = false;
  showQuestions();
}

/**
 * Ask what a file leaves open.
 * @param {any} survey as the server tells it
 * @param {How} how
 * @param {(more: How) => void} answer called with a further answer
 * @returns {boolean} whether there is anything to ask
 */
export function askQuestions(survey, how, answer) {
  if (survey.asked.includes("unit")) [bare, barePixels] = [survey.size, survey.pixels];
  if (!how.unit && !survey.asked.includes("unit")) bare = null;
  const unit = unitQuestion(how, answer);
  // Sizes of parts and gaps mean nothing before there is a unit.
  const rest = unit && !how.unit ? [] : [layerQuestion, fitQuestion, partQuestion, gapQuestion, standingQuestion].map((each) => each(survey, how, answer));
  const asked = [unit, ...rest].filter((question) => question !== null);
  byId("file-asks").replaceChildren(...asked);
  any = asked.length > 0;
  showQuestions();
  // A folded list is not a question.
  return asked.some((each) => !(each instanceof HTMLDetailsElement) || each.open);
}

/** A question with its answers. */
function question(words, ...children) {
  return make("fieldset.plain.ask", {}, make("legend", {}, words), ...children);
}

/** The unit, with the size that the drawing has in each. */
function unitQuestion(how, answer) {
  if (!bare) return null;
  const size = (factor, decimals, sides = bare) => `${number(sides[0] * factor, decimals)} × ${number(sides[1] * factor, decimals)}`;
  const choice = (unit, words) => make("button", {
    type: "button", "data-unit": unit, "aria-pressed": String(how.unit === unit), click: () => answer({ unit }),
  }, words);
  return question("The drawing does not say its unit. Which size is right?", make("div.row-of-buttons", {},
    choice("mm", `Drawn in mm: ${size(1, 2)} mm`),
    choice("inch", `Drawn in inches: ${size(1, 3)} in = ${size(MM_PER_INCH, 0)} mm`),
    choice("cm", `cm: ${size(10, 0)} mm`),
    ...(barePixels ? PIXELS : []).map((count) => choice(`px${count}`, `${count} pixels to the inch: ${size(MM_PER_INCH / count, 1, barePixels)} mm`))));
}

/** Which of several parts. */
function partQuestion({ parts, part }, how, answer) {
  if (parts.length < 2) return null;
  const used = how.part_number ?? 1;
  const buttons = parts.slice(0, LISTED).map((each) => {
    const [x0, y0, x1, y1] = each.bounds;
    return make("button", {
      type: "button", "data-part": each.number, "aria-pressed": String(part !== null && each.number === used), click: () => answer({ part_number: each.number }),
    }, `${each.number}: ${bareLength(x1 - x0, 1)} × ${bareLength(y1 - y0, 1)} ${unitWord()}`);
  });
  const more = parts.length > LISTED ? [make("span.faint", {}, `and ${countText(parts.length - LISTED)} smaller ones`)] : [];
  return question(`The file holds ${countText(parts.length)} parts. Which one? They can be clicked.`, make("div.row-of-buttons", {}, ...buttons, ...more));
}

/** Which gaps are to be joined, up to the largest; asked where one may be a slip of the drawing. */
function gapQuestion({ asked, gaps, size }, how, answer) {
  const open = gaps.filter((gap) => gap > JOINED);
  const slip = open.length && open[0] < SLIP * Math.hypot(...size);
  if (!slip && !(open.length && (asked.includes("join_tolerance") || how.join_tolerance !== undefined))) return null;
  const words = make("output", { for: "join" });
  const at = open.filter((gap) => gap <= (how.join_tolerance ?? JOINED)).length;
  const slider = /** @type {HTMLInputElement} */ (make("input", { type: "range", id: "join", min: 0, max: open.length, step: 1, value: at, "aria-label": "Join gaps up to" }));
  const tell = () => {
    const count = Number(slider.value);
    words.textContent = count ? `${length(open[count - 1], 3)} (${count} of ${open.length} widths)` : "none";
    slider.setAttribute("aria-valuetext", words.textContent);
  };
  slider.addEventListener("input", tell);
  // A little more than the gap, so that rounding leaves none open.
  slider.addEventListener("change", () => answer({ join_tolerance: Number(slider.value) ? open[Number(slider.value) - 1] * (1 + 1e-5) : JOINED }));
  tell();
  return question(`There are loose ends, with gaps from ${length(open[0], 3)} to ${length(open[open.length - 1], 3)}. Join gaps up to`, make("div.join", {}, slider, words));
}

/** Which layers, each with a picture; open where the file was refused. */
function layerQuestion({ layers, error }, how, answer) {
  if (layers.length < 2) return null;
  const usual = layers.filter(({ hidden }) => !hidden).map(({ name }) => name);
  const used = how.layers ?? usual;
  const box = boundsOf(layers.flatMap(({ strokes }) => strokes.flatMap((chain) => segmentsOf(chain).slice(0, -1))));
  const [wide, high] = [box[2] - box[0] || 1, box[3] - box[1] || 1];
  const rows = layers.map(({ name, hidden, strokes }) => {
    const tick = make("input", { type: "checkbox", value: name, checked: used.includes(name) });
    const d = strokes.map((chain) => segmentsOf(chain).slice(0, -1).map((segment, k) => segmentPath(segment, k === 0)).join("")).join("");
    const view = `${box[0] - wide * 0.04} ${-box[3] - high * 0.04} ${wide * 1.08} ${high * 1.08}`;
    const picture = draw("svg", { class: "layer-picture", viewBox: view, "aria-hidden": "true" }, draw("path", { d, transform: "scale(1 -1)" }));
    return make("label.check", {}, tick, picture, `${name}${hidden ? " (hidden)" : ""}`);
  });
  const list = make("div.layers", {
    change: () => {
      const chosen = [...list.querySelectorAll("input")].filter((tick) => tick.checked).map((tick) => tick.value);
      if (chosen.length) answer({ layers: String(chosen) === String(usual) ? undefined : chosen });
    },
  }, ...rows);
  return make("details", { open: Boolean(error) || how.layers !== undefined }, make("summary", {}, `Layers: ${used.length} of ${layers.length} read`), list);
}

/** How far lines and arcs may be from curves that are neither. */
function fitQuestion({ asked, part }, how, answer) {
  if (!asked.includes("fit") && how.fit === undefined) return null;
  const buttons = FITS.map((fit) => make("button", {
    type: "button", "data-fit": fit, "aria-pressed": String(how.fit === fit), click: () => answer({ fit }),
  }, length(fit, 2)));
  const off = part?.departure ? [make("span", {}, `The fitted arcs are off by ${length(part.departure, 4)} at most, which counts in the location error.`)] : [];
  return question("Some curves are neither lines nor arcs. Fit curves within", make("div.row-of-buttons", {}, ...buttons, ...off));
}
