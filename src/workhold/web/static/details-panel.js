/**
 * Below the drawing: the table of pegs, which says in words what the drawing shows, and the figures of quality.
 */
import { byId, make, show } from "./dom.js";
import { forceOf, writtenTurn } from "./pose.js";
import { loadWords } from "./loads-panel.js";
import { on, state } from "./state.js";
import { pressedBy } from "./toolkits.js";
import { bareForce, bareLength, figureText, forceText, forceWord, length, number, shownFigures } from "./units.js";

/** @type {any[]} */
let figures = [];
/** Forces under the load, or null. @type {number[]|null} */
let loaded = null;

/** @param {any[]} known the figures of quality */
export function detailsPanel(known) {
  figures = known;
  on(["selected", "pinned", "unit"], write);
}

/** Tell the forces under a load instead of those by clamping alone. */
export function tellForces(forces) {
  loaded = forces;
  if (state.selected) writePegs(state.selected);
}

/** Write everything. */
function write() {
  const row = state.selected;
  if (!row) return;
  writePegs(row);
  writeQuality(row, state.pinned);
}

/** The table of pegs. */
function writePegs(row) {
  // Between flat jaws there are none.
  show(byId("pegs").parentElement, row.holes.length > 0);
  byId("pegs-title").textContent = row.hold ? "Set up" : "Pegs";
  byId("force-title").textContent = loaded ? `Force ${forceWord()}` : "Force";
  byId("force-title").title = loaded ? "Under the load" : `For each newton of ${forceOf(row)}`;
  byId("pegs").replaceChildren(
    ...row.holes.map((hole, k) =>
      make("tr", {},
        make("td", {}, hole), make("td", {}, row.touched[k]),
        make("td.number", {}, bareLength(row.pegs[k][0] + row.placed[0])), make("td.number", {}, bareLength(row.pegs[k][1] + row.placed[1])),
        make("td.number", {}, row.hold ? "–" : loaded ? bareForce(loaded[k]) : number(row.forces[k], 3)),
      ),
    ),
  );
  const lacking = row.hold?.knows_height === false ? " How thick the part is, is not known: type it under 3 for the grip and the forces." : "";
  const settings = settingWords(row).map(capital).join(", ");
  byId("pose-words").textContent =
    `${settings ? `${settings}. ` : ""}${row.order ? `${row.order} ` : ""}Part turned by ${number(writtenTurn(row), 3)}°, its zero at ` +
    `${bareLength(row.x + row.placed[0])}, ${length(row.y + row.placed[1])} from ${row.flush.length || !row.holes.length ? "" : "hole "}${row.origin}. ` + overhangWords(row) +
    (row.hold?.steps ? [...row.hold.steps, ...(row.hold.straps ? row.hold.warnings : []).map(sentence)].join(" ") : row.hold || loaded ? "" : `Forces are for each newton of ${forceOf(row)}.`) + lacking;
}

/** Words that begin with a small letter, as a sentence of their own. @param {string} words */
const sentence = (words) => `${words[0].toUpperCase()}${words.slice(1)}`;

/** How far the part stands out beyond a jaw, or hangs over its plates. */
function overhangWords({ hangs_over, stands_out_of: wall }) {
  const sides = Object.entries(hangs_over).map(([side, by]) => `${length(by)} at the ${side}${side.endsWith("er") ? " side" : ""}`);
  if (!sides.length) return "";
  return `The part ${wall ? `stands out beyond the ${wall}` : "hangs over the plate"}: ${sides.join(", ")}. `;
}

/** What there is to set, with its length; of several clamps with the name of each. */
function settingWords({ settings, holes }) {
  const named = (k) => (settings.length > 1 ? `${holes[holes.length - settings.length + k]} ` : "");
  return settings.map((one, k) => `${named(k)}${one.name} ${length(one.length)}`);
}

/** A word that begins a sentence. */
const capital = (words, k) => (k ? words : `${words[0].toUpperCase()}${words.slice(1)}`);

/** The figures of quality; beside those of the pinned fixture, the better one of each marked. */
function writeQuality(row, pinned) {
  const heads = ["Figure", ...(pinned ? [`${pinned.rank} pinned`] : []), pinned ? `${row.rank} shown` : `Fixture ${row.rank}`];
  byId("quality-heads").replaceChildren(...heads.map((words, k) => make(k ? "th.number" : "th", { scope: "col" }, words)));
  const [known, beside] = [shownFigures(row), pinned ? shownFigures(pinned) : {}];
  const lines = figures
    .filter((figure) => figure.key in known)
    .map((figure) => {
      const own = known[figure.key];
      const cells = [];
      if (pinned) {
        const other = beside[figure.key];
        const size = (value) => value ?? (figure.key === "edge_distance" ? Infinity : NaN);
        const more = (a, b) =>
          (figure.more_is_better ? size(a) > size(b) : size(a) < size(b)) && figureText(figure, a) !== figureText(figure, b);
        cells.push(figureCell(figure, other, more(other, own)), figureCell(figure, own, more(own, other)));
      } else {
        cells.push(figureCell(figure, own, false));
      }
      return make("tr", { title: pressedBy(figure.meaning, row.mover) }, make("th", { scope: "row" }, pressedBy(figure.words, row.mover)), ...cells);
    });
  if (pinned && row.settings.length) {
    const cells = [pinned, row].map((each) => make("td.number", {}, each.settings.map((one) => length(one.length, 2)).join(", ")));
    // Clamps that push other ways are told by other lengths.
    const names = [...new Set([pinned, row].map((each) => each.settings[0].name))];
    lines.push(make("tr", {}, make("th", { scope: "row" }, names.join(" or ")), ...cells));
  }
  byId("quality").replaceChildren(...lines);
  writeNeeds(row);
}

/** What each force on the part asks for, and how many times it is held, where friction holds the part. */
function writeNeeds({ hold }) {
  const needs = hold?.clamp_needed_each ?? [];
  const loads = state.loads.length === needs.length ? state.loads : [];
  show(byId("needs-box"), loads.length > 0);
  const times = hold?.safety_each ?? null;
  byId("needs-title").textContent = `${hold?.straps ? "Each strap" : "Jaw force"}${times ? ", and how often yours holds it" : ""}`;
  byId("needs").replaceChildren(...loads.map((load, place) => {
    const need = needs[place];
    const held = times ? ` (${times[place] === null ? "any" : times[place]} times)` : "";
    return make("tr", {}, make("th", { scope: "row" }, loadWords(load)), make("td.number", {}, need === null ? "no force holds it" : `${forceText(need)}${held}`));
  }));
}

/** A figure in a table. */
function figureCell(figure, value, better) {
  const text = figureText(figure, value);
  return make(`td.number${better ? ".better" : ""}`, {}, better ? `${text} ✓` : text);
}
