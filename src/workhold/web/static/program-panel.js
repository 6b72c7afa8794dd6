/**
 * The machine's program beside the part: a file and its table of tools, what was understood of them, and what its tools come near to.
 */
import { ApiError, send } from "./api.js";
import { byId, field, make, quiet, show } from "./dom.js";
import { colourOf } from "./program-drawing.js";
import { fixtureDrawing, partDrawing } from "./stage-panel.js";
import { change, on, programRequest, state } from "./state.js";
import { bareLength, countText, fieldForce, fieldLength, length, readForce, readLength } from "./units.js";

/** @typedef {{name: string, text: string, tools: {name: string, text: string}|null, zero: number[], z_zero: "top"|"bottom"|number, clearance: number, rapid: "straight"|"box", unit: "mm"|"inch"|null, start: number[]|null, whole_numbers: "units"|"thousandths", cutting: {cutting_force: number}|null, stock: {side: number, top: number, shape: "outline"|"block"}|null, thickness: number|null, peg_height: number|null}} Wish */

const PROGRAMS = /\.(nc|ngc|cnc|tap|gcode|gc|mpf|eia|iso|min|fnc|h|txt)$/i;
const TABLES = /\.(toml|csv|tbl)$/i;
const KEPT = "workhold-program";
/** Programs longer than this are not kept over a reload. */
const LONGEST_KEPT = 2_000_000;
/** More lines than this are told when asked for. */
const MANY = 4;

let latest = 0;

/** Set the panel up. */
export function programPanel() {
  for (const [id, take] of [["program-file", openProgram], ["tools-file", openProgram]]) {
    field(id).addEventListener("change", () => {
      take([...(field(id).files ?? [])]);
      field(id).value = "";
    });
  }
  byId("program-none").addEventListener("click", () => change({ program: null, programRead: null }));
  byId("program-fields").addEventListener("change", takeFields);
  on(["program", "part", "unit"], writeFields);
  on(["program", "part"], readSoon);
  on(["program"], keepOver);
  on(["programRead", "unit"], tell);
  on(["programRead"], () => {
    partDrawing.build();
    fixtureDrawing.showProgram(state.programRead);
  });
  on(["selected", "unit"], tellPassing);
  writeFields();
  tell();
}

/** Whether files that were dropped are a program, a table of tools, or both. @param {File[]} files */
export function takesProgram(files) {
  return files.length > 0 && files.every(({ name }) => PROGRAMS.test(name) || TABLES.test(name));
}

/** Take a program, a table of tools, or both. @param {File[]} files */
export async function openProgram(files) {
  const table = files.find(({ name }) => TABLES.test(name));
  const program = files.find((file) => file !== table);
  const before = state.program;
  const tools = table ? { name: table.name, text: await table.text() } : before?.tools ?? null;
  if (!program && !before) {
    waiting = tools;
    say(`${table?.name} is a table of tools: open the program that uses them too.`);
    return;
  }
  const known = before ?? { zero: [0, 0], z_zero: "top", clearance: 1, rapid: "straight", unit: null, start: null, whole_numbers: "units", cutting: null, stock: null, thickness: state.supports.thickness ?? state.sheet.thickness ?? null, peg_height: state.sheet.peg_height ?? null };
  const file = program ? { name: program.name, text: await program.text() } : { name: known.name, text: known.text };
  change({ program: { ...known, ...file, tools: tools ?? waiting } });
  waiting = null;
}

/** A table that came before its program. @type {{name: string, text: string}|null} */
let waiting = null;

/** Show what went wrong, or nothing. */
function say(words) {
  byId("program-trouble").textContent = words;
  show(byId("program-trouble"), words !== "");
}

/** Read the fields into the state. */
function takeFields() {
  if (!state.program) return;
  const size = (id) => {
    const value = readLength(field(id).value);
    return value === null || !Number.isFinite(value) ? null : value;
  };
  const at = field("program-z").value;
  const height = size("program-z-height");
  show(byId("program-z-label"), at === "height");
  const program = {
    ...state.program,
    thickness: size("program-thickness"),
    peg_height: size("program-pegs"),
    zero: [size("program-x") ?? 0, size("program-y") ?? 0],
    z_zero: at === "height" ? height ?? 0 : at,
    clearance: size("program-clearance") ?? 1,
    rapid: field("program-rapid").value,
    unit: field("program-unit").value || null,
    start: startOf(field("program-start").value),
    whole_numbers: field("program-whole").value,
    cutting: forceOf(field("program-force").value, state.program.cutting),
    stock: { side: size("program-side") ?? 5, top: size("program-top") ?? 5, shape: field("program-stock").value },
  };
  const { thickness } = program;
  const sheet = thickness && !state.sheet.thickness ? { sheet: { ...state.sheet, thickness } } : {};
  const supports = thickness && !state.supports.thickness ? { supports: { ...state.supports, thickness } } : {};
  change({ program, ...sheet, ...supports });
}

/** A force in N for every tool, or null. @param {string} words @param {{cutting_force: number}|null} before */
function forceOf(words, before) {
  if (before && words === fieldForce(before.cutting_force)) return before;
  const value = readForce(words);
  return value === null || !Number.isFinite(value) || value < 0 ? null : { cutting_force: value };
}

/** Three lengths in mm of a place with commas or spaces between them, or null. @param {string} words */
function startOf(words) {
  const values = words.trim().split(/[\s,;]+/).map((word) => readLength(word));
  return values.length === 3 && values.every((value) => value !== null && Number.isFinite(value)) ? values : null;
}

/** Write the state into the fields. */
function writeFields() {
  const { program, part } = state;
  show(byId("program-fields"), program !== null);
  show(byId("program-none"), program !== null);
  byId("program-name").textContent = program ? `${program.name}${program.tools ? ` with ${program.tools.name}` : ""}` : "";
  for (const id of ["program-thickness", "program-pegs"]) show(/** @type {Element} */ (byId(id).parentElement), !part?.solid);
  if (!program) return;
  field("program-thickness").value = fieldLength(program.thickness);
  field("program-pegs").value = fieldLength(program.peg_height);
  field("program-x").value = program.zero[0] ? fieldLength(program.zero[0]) : "";
  field("program-y").value = program.zero[1] ? fieldLength(program.zero[1]) : "";
  const height = typeof program.z_zero === "number";
  field("program-z").value = height ? "height" : program.z_zero;
  field("program-z-height").value = height ? fieldLength(program.z_zero) : "";
  show(byId("program-z-label"), height);
  field("program-clearance").value = program.clearance === 1 ? "" : fieldLength(program.clearance);
  field("program-rapid").value = program.rapid;
  field("program-unit").value = program.unit ?? "";
  field("program-start").value = program.start ? program.start.map((value) => fieldLength(value)).join(", ") : "";
  field("program-whole").value = program.whole_numbers ?? "units";
  field("program-force").value = fieldForce(program.cutting?.cutting_force);
  const { side = 5, top = 5, shape = "outline" } = program.stock ?? {};
  field("program-side").value = side === 5 ? "" : fieldLength(side);
  field("program-top").value = top === 5 ? "" : fieldLength(top);
  field("program-stock").value = shape;
}

/** Have the program read as it stands now. */
const readSoon = quiet(async () => {
  const mine = ++latest;
  const { program, part } = state;
  if (!program) {
    // What is said of a table that waits for its program stays, also when the part comes in meanwhile.
    if (!waiting) say("");
    return;
  }
  const solid = part?.solid ?? null;
  if (!solid && !program.thickness && (program.z_zero === "top" || !program.peg_height)) {
    say("The part’s thickness is not known: fill in “Part thickness”.");
    change({ programRead: null });
    return;
  }
  try {
    const read = await send("programs", { program: programRequest(program), height: solid?.height ?? null, peg_height: solid?.peg_height ?? null });
    if (mine !== latest) return;
    say("");
    change({ programRead: read });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (mine !== latest) return;
    say(error.message);
    change({ programRead: null });
  }
}, 60);

/** A time as minutes and seconds. @param {number} seconds */
const minutes = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.round(seconds) % 60).padStart(2, "0")}`;

/** What was understood. */
function tell() {
  const read = state.programRead;
  show(byId("program-read"), read !== null);
  if (!read) return;
  const heads = ["Tool", `Ø ${state.unit === "inch" ? "in" : "mm"}`, "Lines", "Cuts", "Lowest cut"];
  const lines = read.tools.map((one, place) =>
    make("tr", { title: one.name || null },
      make("th", { scope: "row" }, make("span.program-swatch", { "data-place": place }), `T${one.tool}`),
      make("td.number", {}, bareLength(one.diameter, 2)), make("td.number", {}, `${one.first_line}–${one.last_line}`),
      make("td.number", {}, minutes(one.seconds)), make("td.number", {}, one.lowest_cut === null ? "–" : bareLength(one.lowest_cut, 2))));
  byId("program-tools").replaceChildren(
    make("thead", {}, make("tr", {}, ...heads.map((words, k) => make(k ? "th.number" : "th", { scope: "col" }, words)))),
    make("tbody", {}, ...lines),
  );
  for (const swatch of byId("program-tools").querySelectorAll(".program-swatch")) {
    /** @type {HTMLElement} */ (swatch).style.background = colourOf(Number(/** @type {HTMLElement} */ (swatch).dataset.place));
  }
  const [low, high] = read.box;
  const span = (k) => `${bareLength(low[k], 2)} to ${bareLength(high[k], 2)}`;
  byId("program-words").textContent =
    `${countText(read.lines)} lines in ${read.unit}, ${countText(read.moves)} moves. Tips go from X ${span(0)}, Y ${span(1)}, ` +
    `Z ${bareLength(low[2], 2)} to ${length(high[2], 2)} over the part’s lower side.${aboveWords(read)}`;
  const notes = byId("program-notes");
  notes.replaceChildren(make("summary", {}, "How it was read"), make("ul", {}, ...read.notes.map((note) => make("li", {}, note))));
  notes.toggleAttribute("open", read.notes.length < MANY);
  show(notes, read.notes.length > 0);
}

/** Which tools stay above all that holds the part. */
function aboveWords({ tools, peg_height: high }) {
  const above = high === null ? [] : tools.filter(({ lowest }) => lowest > high).map(({ tool }) => `T${tool}`);
  if (!above.length) return "";
  const listed = above.length > 1 ? `${above.slice(0, -1).join(", ")} and ${above[above.length - 1]} stay` : `${above[0]} stays`;
  return ` ${listed} above pegs ${length(high, 1)} high all the way.`;
}

/** What the tools come nearest to at the fixture shown: in words, and lit up in the drawing. */
function tellPassing() {
  const { selected, program } = state;
  show(byId("passing-card"), selected !== null && program !== null);
  const { passing = null, program_forces: asksFor = null } = (program && selected) || {};
  fixtureDrawing.showPassing(passing);
  byId("passing").textContent = selected?.hold && program
    ? [`The tools keep ${length(program.clearance, 2)} or more from ${selected.hold.straps ? "locators and straps" : "jaws, work stop, parallels and bed"}.`, ...(selected.vise_clearance ?? [])].join(" ")
    : passing
    ? `T${passing.tool} comes nearest in line ${passing.line}: ${length(passing.distance)} from the ${passing.element}. ${length(program.clearance, 2)} is asked for.`
    : "No tool comes down to where anything holds the part.";
  byId("passing").append(...(asksFor ? [make("br"), asksFor.words.join(" ")] : []));
}

/** Keep the program over a reload; a link does not carry it. */
function keepOver() {
  change({ programName: state.program?.name ?? null });
  try {
    const text = JSON.stringify(state.program);
    if (state.program && text.length < LONGEST_KEPT) sessionStorage.setItem(KEPT, text);
    else sessionStorage.removeItem(KEPT);
  } catch {
    // A browser may have no room, or keep nothing.
  }
}

/** Take the program up again that a link or a reload speaks of. @param {string|null|undefined} name */
export function takeUpProgram(name) {
  if (!name) return;
  let kept = null;
  try {
    kept = JSON.parse(sessionStorage.getItem(KEPT) ?? "null");
  } catch {
    kept = null;
  }
  if (kept?.name === name) change({ program: kept });
  else say(`This link was made with the program ${name}, which it does not carry: open it here, and search again.`);
}
