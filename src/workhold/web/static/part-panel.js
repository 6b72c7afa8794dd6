/**
 * Step 1: a part from a file, from those built in, or drawn by hand.
 */
import { ApiError, ask, send, surveyPart } from "./api.js";
import { byId, choice, field, make, show } from "./dom.js";
import { openFamily, takesDrop } from "./families-dialog.js";
import { previewOf } from "./file-preview.js";
import { askQuestions, noQuestions, showQuestions } from "./file-questions.js";
import { openProgram, takesProgram } from "./program-panel.js";
import { start } from "./search.js";
import { showSection } from "./sections.js";
import { otherFile } from "./standing-question.js";
import { change, on, state } from "./state.js";
import { usePreset } from "./toolkit-panel.js";
import { length } from "./units.js";

/** Remarks of more letters than this are told when asked for. */
const LONG = 160;
/** What holds the example. */
const EXAMPLE_IN = "clamp-plate-20mm";

/** The file read last, to be read again otherwise. @type {File|null} */
let lastFile = null;
/** What has been answered about it. @type {import("./file-questions.js").How} */
let how = {};
/** What the server told of it. @type {any} */
let lastSurvey = null;
let reading = 0;
/** @type {import("./part-drawing.js").PartDrawing} */
let drawing;

/**
 * Set the panel up.
 * @param {{drawing: import("./part-drawing.js").PartDrawing, onDraw: () => void}} page
 */
export function partPanel({ drawing: board, onDraw }) {
  drawing = board;
  const file = field("file");
  file.addEventListener("change", () => {
    if (file.files?.length) openFile(file.files[0]);
    file.value = "";
  });
  choice("file-unit").addEventListener("change", () => lastFile && answered({ unit: choice("file-unit").value || undefined }));
  choice("builtin").addEventListener("change", takeBuiltin);
  byId("draw-part").addEventListener("click", onDraw);
  byId("example").addEventListener("click", takeExample);
  listenToDrops(openFile);
  on(["part", "unit"], tell);
  on(["view"], showQuestions);
}

/** Read a file that was just chosen; what was answered about the one before is forgotten. */
function openFile(chosen) {
  if (lastFile) choice("file-unit").value = "";
  lastFile = chosen;
  lastSurvey = null;
  change({ sides: null, cut: null });
  how = choice("file-unit").value ? { unit: choice("file-unit").value } : {};
  noQuestions();
  otherFile();
  readFile();
}

/** Read the file again, with a further answer. */
function answered(more) {
  how = { ...how, ...more };
  choice("file-unit").value = how.unit ?? "";
  readFile();
}

/** Read the file as answered, and ask what is open. */
async function readFile() {
  const chosen = /** @type {File} */ (lastFile);
  choice("builtin").value = "";
  const mine = ++reading;
  say(`Reading ${chosen.name} …`);
  change({ reading: chosen.name });
  // Pegs beside a solid are no higher than they must be, which their diameter says.
  how = { ...how, ...(isStep(chosen) && state.toolkit.peg_radius > 0 ? { peg_diameter: 2 * state.toolkit.peg_radius } : {}) };
  try {
    const survey = await surveyPart(chosen, how);
    if (mine !== reading) return;
    survey.solid = isStep(chosen);
    lastSurvey = survey;
    if (survey.part) {
      usePart(survey.part, { ...survey, chosen: how.part_number ?? null });
    } else await refuse(survey, chosen);
    if (askQuestions(survey, how, answered)) showSection("stage");
  } catch (error) {
    if (mine === reading) await trouble(error, chosen);
  } finally {
    isRead(mine);
  }
}

/** What was read under a number is read, well or badly; a search that waits for it begins. @param {number} mine */
function isRead(mine) {
  if (mine === reading) change({ reading: "" });
}

/** Whether a file holds solids. @param {File} file */
const isStep = (file) => /\.ste?p$/i.test(file.name);

/** The file with a solid that the part is of, how it was read and what was told of it; null where it is not at hand. */
export function fileRead() {
  return lastFile && lastSurvey?.solid && lastSurvey.part ? { file: lastFile, how, survey: lastSurvey } : null;
}

/** The same file read otherwise. @param {import("./file-questions.js").How} more */
export async function readOver(more) {
  const chosen = /** @type {File} */ (lastFile);
  const turned = { ...how, ...more };
  const survey = await surveyPart(chosen, turned);
  return { file: chosen, how: turned, survey: { ...survey, solid: true } };
}

/** Go on with a file as it was read; with none where it is not at hand. @param {ReturnType<typeof fileRead>} read */
export function resumeFile(read) {
  reading += 1;
  change({ reading: "" });
  lastFile = read?.file ?? null;
  how = read?.how ?? {};
  lastSurvey = read?.survey ?? null;
  if (read) askQuestions(read.survey, how, answered);
  else noQuestions();
}

/** Show what a refused file holds, and where it is wrong. */
async function refuse({ error, place, strokes, parts, asked }, chosen) {
  change({ part: null, avoid: [], ruledOut: {}, zones: [], view: "part" });
  say("");
  // Where nothing is wrong but the unit is open, the question says it all.
  const plain = asked.length === 1 && asked[0] === "unit";
  byId("part-trouble").textContent = error.charAt(0).toUpperCase() + error.slice(1);
  show(byId("part-trouble"), !plain);
  const shown = strokes.length ? strokes : await previewOf(chosen).catch(() => []);
  show(byId("stage-empty"), !shown.length && !place);
  drawing.others = asked.includes("unit") ? null : { parts, take: (part) => answered({ part_number: part }) };
  if (shown.length || place) drawing.showTrouble(shown, place, error);
}

/** Show what went wrong with a file that could not even be looked at. */
function trouble(error, chosen) {
  if (!(error instanceof ApiError)) throw error;
  return refuse({ error: error.message, place: error.place, strokes: [], parts: [], asked: [] }, chosen);
}

/** Take a part that comes with the program. */
async function takeBuiltin() {
  const { value } = choice("builtin");
  if (!value) return;
  lastFile = null;
  lastSurvey = null;
  change({ sides: null, cut: null });
  const mine = ++reading;
  noQuestions();
  change({ reading: value });
  try {
    const part = await ask(`parts/${encodeURIComponent(value)}`);
    if (mine === reading) usePart(part, { name: value });
  } catch (error) {
    if (mine === reading) await trouble(error, new File([], value));
  } finally {
    isRead(mine);
  }
}

/** A part and what holds it, and its search, in one click. */
async function takeExample() {
  lastFile = null;
  lastSurvey = null;
  change({ sides: null, cut: null });
  const mine = ++reading;
  noQuestions();
  const example = await (await fetch("static/example.json")).json();
  const part = await send("parts/check", example);
  if (mine !== reading) return;
  change({ reading: "" });
  usePreset(EXAMPLE_IN);
  usePart(part);
  start();
}

/** Files may be dropped anywhere on the page. */
function listenToDrops(readDropped) {
  let depth = 0;
  const over = (delta) => {
    depth = Math.max(0, depth + delta);
    document.body.classList.toggle("dropping", depth > 0);
  };
  addEventListener("dragenter", () => over(1));
  addEventListener("dragleave", () => over(-1));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    over(-depth);
    const dropped = [...(event.dataTransfer?.files ?? [])];
    if (takesProgram(dropped)) openProgram(dropped);
    else if (dropped.length && takesDrop(dropped.length)) openFamily(dropped);
    else if (dropped.length) readDropped(dropped[0]);
  });
}

/**
 * Take a part: what was ruled out on another one is gone.
 * @param {any} part
 * @param {{name?: string, parts?: any[], strokes?: number[][][], gaps?: number[], chosen?: number|null}} [from] the built-in part
 *   that it is, or the parts of its file, the one chosen, and all that is drawn, which is shown where it has gaps
 */
export function usePart(part, { name = "", parts = [], strokes = [], gaps = [], chosen = null } = {}) {
  show(byId("part-trouble"), false);
  choice("builtin").value = name;
  const others = parts.length > 1 ? parts.filter((each) => each.number !== (chosen ?? 1)) : [];
  drawing.others = { parts: others, strokes: gaps.length ? strokes : [], take: (other) => answered({ part_number: other }), isChosen: chosen !== null };
  // How thick it is was that of another part.
  const { thickness: _, ...asked } = state.asked;
  change({ part, asked, avoid: [], ruledOut: {}, zones: [], cut: null, supports: { ...state.supports, below: [], above: [] }, force: null, loads: [], view: "part" });
}

/** Offer the parts that come with the program. */
export async function offerParts() {
  const parts = await ask("parts");
  byId("builtin").append(...parts.map((part) => make("option", { value: part.name }, `${part.name}: ${part.title}`)));
}

/** Say something about the part. */
function say(words, remarks = []) {
  const more = remarks.join(" ");
  const notes = make("details", { open: more.length < LONG }, make("summary", {}, "How it was read"), more);
  byId("part-words").replaceChildren(words, ...(more ? [notes] : []));
}

/** Whether a loop runs clockwise, as the borders of holes do. @param {number[][]} loop of x, y in mm and bulge */
function isHole(loop) {
  const area = loop.reduce((sum, [x, y, bulge], k) => {
    const [u, v] = loop[(k + 1) % loop.length];
    const turn = 4 * Math.atan(bulge);
    const sagged = bulge ? ((u - x) ** 2 + (v - y) ** 2) * ((1 + bulge ** 2) / (4 * bulge)) ** 2 * (turn - Math.sin(turn)) : 0;
    return sum + x * v - u * y + sagged;
  }, 0);
  return area < 0;
}

/** Name, size and remarks of the part. */
function tell() {
  const { part } = state;
  if (!part) return;
  const [x0, y0, x1, y1] = part.bounds;
  const holes = part.loops.filter(isHole).length;
  const size = `${length(x1 - x0, 2)} × ${length(y1 - y0, 2)}`;
  const words = `${part.name}: ${size}, ${part.faces.length} face${part.faces.length === 1 ? "" : "s"}${holes ? `, ${holes} hole${holes > 1 ? "s" : ""}` : ""}.`;
  say(words, part.remarks ?? []);
}
