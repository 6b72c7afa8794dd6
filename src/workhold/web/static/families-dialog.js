/**
 * Many parts, few set-ups: files that are dropped together, the curve of set-ups against loss, and the plan at the point that
 * is picked.
 */
import { ApiError, ask, send, surveyPart } from "./api.js";
import { byId, field, make, show } from "./dom.js";
import { outlinesOf } from "./own-outlines.js";
import { holdsByFriction } from "./questions.js";
import { state, workpieceForm } from "./state.js";
import { thicknessOf } from "./supports.js";
import { countText, fieldLength, readLength, unitWord } from "./units.js";

const POLL = 250;
/** What the dialog is for: with pegs, and in a plain vise. */
const ABOUT = [
  "This finds the patterns of pegs that hold many parts in the toolkit chosen under 2, and shows what each fewer set-up costs: the worst location error of a part, divided by the best that the part can have.",
  "This finds the parallels and places of the work stop that serve many parts in the vise chosen under 2, and shows what each fewer set-up costs: the highest grip that a part can have, divided by its grip.",
];
const ENDED = ["done", "failed", "cancelled"];

/**
 * The parts read, and files that are not parts, in the order given; the thickness of a drawn part counts where friction holds it.
 * @type {{name: string, part: any, reason: string, file: File, thickness: number|null}[]}
 */
let entries = [];
/** The job at the server, or null. @type {string|null} */
let job = null;
let latest = 0;

/** Set the dialog up. */
export function familiesDialog() {
  const files = field("family-files");
  byId("families").addEventListener("click", () => openFamily([]));
  files.addEventListener("change", () => {
    openFamily([...(files.files ?? [])]);
    files.value = "";
  });
  byId("family-search").addEventListener("click", search);
  byId("family").addEventListener("close", leave);
}

/** Whether files that are dropped go here. @param {number} count */
export function takesDrop(count) {
  return count > 1 || /** @type {HTMLDialogElement} */ (byId("family")).open;
}

/**
 * Open the dialog and read files into it, one after the other.
 * @param {File[]} files
 */
export async function openFamily(files) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("family"));
  if (!dialog.open) dialog.showModal();
  byId("family-about").textContent = ABOUT[holdsByFriction() ? 1 : 0];
  if (!files.length) return writeParts();
  leave();
  const mine = latest;
  for (const file of files) {
    say(`Reading ${file.name} …`);
    const thickness = thicknessOf({ ...state, part: null });
    let entry = { name: file.name, part: null, reason: "", file, thickness };
    try {
      const { part, error: why } = await surveyPart(file);
      entry = { name: file.name, part, reason: part ? "" : why, file, thickness };
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      entry.reason = error.message;
    }
    if (mine !== latest) return undefined;
    entries.push(entry);
    writeParts();
  }
  say("");
  return undefined;
}

/** Leave the search there is. */
function leave() {
  latest += 1;
  if (job) ask(`jobs/${encodeURIComponent(job)}`, { method: "DELETE" }).catch(() => {});
  job = null;
  show(byId("family-progress"), false);
  show(byId("family-answer"), false);
  show(byId("family-trouble"), false);
}

/** Tell what is being done. @param {string} words */
function say(words) {
  byId("family-words").textContent = words;
}

/** The parts read, each with a button that takes it away. */
function writeParts() {
  const away = (entry) => () => {
    leave();
    entries = entries.filter((each) => each !== entry);
    writeParts();
  };
  /** The field for a drawn part's thickness, where what holds it must know that. */
  const thick = (entry) => {
    if (!entry.part || entry.part.solid || !holdsByFriction()) return [];
    const input = /** @type {HTMLInputElement} */ (make("input", { inputmode: "decimal", autocomplete: "off", value: fieldLength(entry.thickness), placeholder: "not known" }));
    input.addEventListener("change", () => {
      entry.thickness = readLength(input.value);
      leave();
    });
    return [make("label.thick", {}, `Thickness of ${entry.name} `, make("span.unit", {}, unitWord()), input)];
  };
  byId("family-parts").replaceChildren(...entries.map((entry) =>
    make(entry.part ? "li.chip" : "li.chip.bad", { title: entry.reason || entry.name },
      ...(thick(entry).length ? thick(entry) : [entry.part ? entry.name : `${entry.name}: ${entry.reason}`]),
      make("button", { type: "button", click: away(entry), "aria-label": `Leave out ${entry.name}` }, "×"))));
  const count = entries.filter((entry) => entry.part).length;
  const button = /** @type {HTMLButtonElement} */ (byId("family-search"));
  button.disabled = count === 0;
  button.textContent = count ? `Find the fewest set-ups for ${count === 1 ? "one part" : `${count} parts`}` : "Find the fewest set-ups";
}

/** Search for the curve. */
async function search() {
  leave();
  const mine = latest;
  const bar = /** @type {HTMLProgressElement} */ (byId("family-progress"));
  bar.removeAttribute("value");
  show(bar, true);
  try {
    const read = entries.filter((entry) => entry.part);
    for (const { part, file } of read) await outlinesOf(part, { file, how: {} });
    if (mine !== latest) return;
    const workpieces = read.map(({ name, part }) => workpieceForm(part, name));
    const thicknesses = holdsByFriction() ? { thicknesses: read.map(({ part, thickness }) => (part.solid ? null : thickness)) } : {};
    const margin = holdsByFriction() ? 0 : state.asked.contact_margin ?? 0;
    const asked = { workpieces, toolkit: state.toolkit, types: state.types, contact_margin: margin, tolerance: state.tolerance, ...thicknesses };
    const begun = await send("families", asked);
    if (mine !== latest) {
      ask(`jobs/${encodeURIComponent(begun.job)}`, { method: "DELETE" }).catch(() => {});
      return;
    }
    job = begun.job;
    for (;;) {
      const answer = await ask(`jobs/${encodeURIComponent(begun.job)}`);
      if (mine !== latest) return;
      if (answer.fraction > 0) bar.value = answer.fraction;
      say(`${countText(answer.found)} fixtures found …`);
      if (answer.error) throw new ApiError(answer.error, 400);
      if (ENDED.includes(answer.state)) break;
      await new Promise((resolve) => setTimeout(resolve, POLL));
    }
    const family = await ask(`jobs/${encodeURIComponent(begun.job)}/family`);
    if (mine === latest) writeAnswer(family);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (mine === latest) {
      byId("family-trouble").textContent = error.message;
      show(byId("family-trouble"), true);
    }
  } finally {
    if (mine === latest) {
      show(bar, false);
      say("");
    }
  }
}

/** The address of a paper of the family. @param {string} kind @param {number|null} setups */
function paper(kind, setups = null) {
  const query = new URLSearchParams(setups === null ? {} : { setups: String(setups), unit: state.unit });
  return `api/jobs/${encodeURIComponent(job ?? "")}/family/${kind}${query.size ? `?${query}` : ""}`;
}

/** A loss as a bound that holds. @param {number|null} loss */
function lossText(loss) {
  return loss === null ? "any" : (Math.ceil(loss * 1000 - 1e-6) / 1000).toFixed(3);
}

/** The curve, what is left out, and the first plan. */
function writeAnswer(family) {
  byId("family-left").replaceChildren(...family.left_out.map(({ name, reason }) => make("li", {}, `${name} is left out: ${reason}.`)));
  const lines = family.points.map((point) => {
    const proven = point.is_least && point.at_least === point.setups;
    return make("tr", {},
      make("th.number", { scope: "row" }, point.at_least === point.setups ? point.setups : `${point.at_least} to ${point.setups}`),
      make("td.number", {}, lossText(point.loss) + (proven ? "" : " or less")),
      make("td.number", {}, point.pegs_moved ?? point.changes), make("td", {}, point.worst),
      make("td", {}, make("button", { type: "button", click: () => pick(point.setups), "aria-label": `Plan with ${point.setups} set-ups` }, "Plan")));
  });
  const heads = ["Set-ups", "Worst loss", holdsByFriction() ? "Changes" : "Pegs moved", "Worst part", ""];
  byId("family-table").replaceChildren(...(lines.length ? [
    make("table", {}, make("caption.unseen", {}, "The least worst loss for each number of set-ups"),
      make("thead", {}, make("tr", {}, ...heads.map((words, k) => make(words ? (k < 3 ? "th.number" : "th") : "td", words ? { scope: "col" } : {}, words)))),
      make("tbody", {}, ...lines)),
  ] : [make("p.trouble-box", {}, `No ${holdsByFriction() ? "set-up" : "pattern of pegs"} holds any of these parts: choose another toolkit under 2.`)]));
  show(byId("family-plan"), lines.length > 0);
  show(byId("family-answer"), true);
  if (lines.length) pick(family.points[0].setups);
}

/** Show the plan with so many set-ups. @param {number} setups */
function pick(setups) {
  byId("family-curve").setAttribute("src", paper("curve.svg", setups));
  byId("family-sheets").setAttribute("src", paper("sheets.svg", setups));
  byId("family-sheets").setAttribute("alt", `The sheets of the plan with ${setups} set-ups`);
  byId("family-pdf").setAttribute("href", paper("sheets.pdf", setups));
  byId("family-json").setAttribute("href", paper("plans.json"));
  for (const button of byId("family-table").querySelectorAll("button")) {
    button.setAttribute("aria-pressed", String(button.getAttribute("aria-label") === `Plan with ${setups} set-ups`));
  }
}
