/**
 * How a solid stands: which way is up, how far pegs reach, which solid of several; and what other heights would offer.
 */
import { make } from "./dom.js";
import { bareLength, fieldLength, length, number, readLength, unitWord } from "./units.js";

/** @typedef {import("./file-questions.js").How} How */

const AXES = ["x", "y", "z", "-x", "-y", "-z"];
/** A height of the pegs within this many mm of a row's end is in it. */
const NEAR = 1e-6;
/** Heights that a file is read with where nobody says, in mm. */
const HEAD_ROOM = 0.5;
const LEAST_BAND = 1;
/** So many solids have a button each; of more one is chosen from a list. */
const MOST_BUTTONS = 12;

/** The solids of the file. @type {{number: number, name: string, size: number[]}[]} */
let solids = [];

/** Forget the solids of the file before. */
export function otherFile() {
  solids = [];
}

/** An axis for reading. @param {string} axis */
export const axisWords = (axis) => axis.replace("-", "\u2212");

/** The axis that points up when the part is turned over. @param {string} axis */
export const turnedOver = (axis) => (axis.startsWith("-") ? axis.slice(1) : `-${axis}`);

/**
 * The question, with its answers; null for a file that holds no solid.
 * @param {any} survey as the server tells it
 * @param {How} how
 * @param {(more: How) => void} answer
 */
export function standingQuestion({ solid, part, heights = [], solids: listed = [] }, how, answer) {
  if (!solid) return null;
  if (listed.length) solids = listed;
  return make("fieldset.plain.ask.standing", {},
    make("legend", {}, "How does the part stand?"),
    ...which(how, answer),
    make("div.row-of-buttons", {}, make("span", { id: "up-words" }, "Points up:"), axes(how, answer)),
    make("p.small", { id: "standing-words" }, words(part?.solid ?? null, how)),
    fields(part?.solid ?? null, how, answer),
    ...heightTable(heights, part?.solid ?? null, answer));
}

/** Which of several solids. */
function which(how, answer) {
  if (solids.length < 2) return [];
  const used = how.part_number ?? 1;
  const words = ({ number: own, name, size }) => `${own}${name && ` ${name}`}: ${size.map((one) => bareLength(one, 1)).join(" × ")} ${unitWord()}`;
  if (solids.length > MOST_BUTTONS) {
    const options = solids.map((each) => make("option", { value: each.number, selected: each.number === used }, words(each)));
    const list = /** @type {HTMLSelectElement} */ (make("select", { id: "which-solid", change: () => answer({ part_number: Number(list.value) }) }, ...options));
    return [make("label", {}, `Of its ${solids.length} solids`, list)];
  }
  const button = (each) => make("button", {
    type: "button", "data-solid": each.number, "aria-pressed": String(each.number === used), click: () => answer({ part_number: each.number }),
  }, words(each));
  return [make("div.row-of-buttons", {}, make("span", {}, "Of its solids:"), ...solids.map(button))];
}

/** The six ways that can point up. */
function axes(how, answer) {
  const used = how.axis ?? "z";
  return make("div.segmented", { role: "group", "aria-labelledby": "up-words" }, ...AXES.map((axis) => make("button", {
    type: "button", "data-axis": axis, "aria-pressed": String(used === axis), click: () => answer({ axis }),
  }, axisWords(axis))));
}

/** What the picture is of. */
function words(stands, how) {
  const axis = axisWords(how.axis ?? "z");
  const seen = `The drawing shows the part from above, as it lies with ${axis} of its file up.`;
  if (!stands) return seen;
  const pegs = how.peg_height || stands.peg_height < stands.height - NEAR ? `what pegs of ${length(stands.peg_height, 2)} can meet` : "its silhouette";
  return `${seen} It is ${length(stands.height, 2)} high, and the outline is ${pegs}${stands.bands.includes(null) ? "; dashed pieces are never touched" : ""}.`;
}

/** The heights that can be typed. */
function fields(stands, how, answer) {
  const field = (key, words, usual, title) => {
    const input = /** @type {HTMLInputElement} */ (make("input", {
      id: `stands-${key.replace("_", "-")}`, inputmode: "decimal", autocomplete: "off", value: fieldLength(how[key]), placeholder: usual,
    }));
    input.addEventListener("change", () => {
      const value = readLength(input.value);
      const good = value === null || (Number.isFinite(value) && (key === "peg_height" ? value > 0 : value >= 0));
      input.setAttribute("aria-invalid", String(!good));
      if (good) answer({ [key]: value ?? undefined });
    });
    return make("label", { title }, words, " ", make("span", {}, unitWord()), input);
  };
  return make("div.grid-fields.three", {},
    field("peg_height", "Peg height", stands ? (stands.peg_height < stands.height - NEAR ? `${bareLength(stands.peg_height, 2)}, as needed` : `${bareLength(stands.height, 2)}, the part’s`) : "the part’s", "Height that pegs reach above the plane on which the part lies"),
    field("head_room", "Head room", bareLength(HEAD_ROOM, 1), "Clearance between the pegs and anything that hangs over them"),
    field("least_band", "Least band", bareLength(LEAST_BAND, 1), "Least height of an upright face that a peg may touch"));
}

/** What other heights offer, each to be chosen; open where the height in use touches less than another would. */
function heightTable(heights, stands, answer) {
  if (heights.length < 2 || !stands) return [];
  const most = Math.max(...heights.map((row) => row.touchable), 1e-9);
  const used = heights.findIndex((row) => stands.peg_height <= row.high + NEAR);
  const rows = heights.map((row, k) => {
    const best = row.touchable >= most * (1 - 1e-9);
    const bar = make("span.share", { "aria-hidden": "true" });
    bar.style.setProperty("--share", String(row.touchable / most));
    return make(`tr${k === used ? ".marked" : ""}`, {},
      make("td", {}, make("button", { type: "button", "data-height": row.high, "aria-pressed": String(k === used), click: () => answer({ peg_height: row.high }) },
        `up to ${bareLength(row.high, 2)}`)),
      make("td.number", {}, bareLength(row.border, 1)),
      make(`td.number.touchable${best ? ".better" : ""}`, {}, bar, bareLength(row.touchable, 1)),
      make("td.number", {}, row.touchable > 0 ? bareLength(row.band, 1) : "–"));
  });
  const head = (text, title) => make("th.number", { scope: "col", title }, text);
  const chosen = heights[used];
  const share = chosen ? `: ${number((100 * chosen.touchable) / most, 0)} % of the most that can be touched` : "";
  return [make("details.heights", { open: Boolean(chosen && chosen.touchable < most * (1 - 1e-9)) }, make("summary", {}, `Which height of the pegs${share}`),
    make("table", {}, make("caption.unseen", {}, "What pegs of other heights can touch"),
      make("thead", {}, make("tr", {}, make("th", { scope: "col" }, `Pegs ${unitWord()}`), head(`Outline ${unitWord()}`, "Length of outline that such pegs can meet"),
        head(`Touchable ${unitWord()}`, "Length of outline that they may touch"), head(`Least band ${unitWord()}`, "Height of the lowest face that may be touched"))),
      make("tbody", {}, ...rows)))];
}
