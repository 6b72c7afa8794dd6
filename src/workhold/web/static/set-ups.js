/**
 * Two set-ups one after the other: the part turned over, held by faces that the first side leaves, and a switch between both.
 */
import { ApiError, send } from "./api.js";
import { byId, field, make, show } from "./dom.js";
import { rememberCut, sameFaces } from "./height-help.js";
import { snapshot } from "./link.js";
import { isNever } from "./part-drawing.js";
import { fileRead, readOver, resumeFile, usePart } from "./part-panel.js";
import { want, writeFilters } from "./results-panel.js";
import { writeRules } from "./rules-panel.js";
import { searching, start, takeUp } from "./search.js";
import { partDrawing } from "./stage-panel.js";
import { axisWords, turnedOver } from "./standing-question.js";
import { change, on, state } from "./state.js";
import { fieldLength, readLength, unitWord } from "./units.js";

/** @typedef {import("./link.js").Kept} Kept */
/** @typedef {{shown: number, kept: (Kept|null)[]}} Sides which side is on show, and what restores each that is not */

export const SIDES = ["First side", "Second side"];

/** What is known of the file of each side; it does not outlive the page. @type {any[]} */
let files = [null, null];
let turning = false;

/** Make the card and the switch, and set them up. */
export function setUpsPanel() {
  byId("seating").before(turnCard());
  byId("fixture-tools").before(sideSwitch(SIDES));
  byId("second-side").addEventListener("click", turnOver);
  for (const number of [0, 1]) byId(`side-${number}`).addEventListener("click", () => goTo(number));
  on(["selected", "part", "avoid", "cut", "sides", "job"], write);
  write();
}

/**
 * Take up a state that was kept.
 * @param {Kept} kept
 */
export async function restore(kept) {
  change({ unit: kept.known.unit ?? "mm", view: "part" });
  if (!kept.part) {
    change(kept.known);
    return;
  }
  const part = await send("parts/check", kept.part);
  change({ part });
  change({ ...kept.known, view: "part" });
  writeRules(partDrawing);
  writeFilters();
  if (kept.searched) {
    want(kept.rank, kept.pinned, kept.known.view);
    await takeUp(kept.job);
  }
}

/** Faces that the set-up shown cuts. */
function cutFaces() {
  return state.cut ?? state.avoid;
}

/** Show what can be done. */
function write() {
  const { part, selected, sides } = state;
  const solid = part?.solid;
  const both = sides !== null && sides.kept.length > 1;
  show(byId("sides"), both);
  for (const number of [0, 1]) byId(`side-${number}`).setAttribute("aria-pressed", String(both && sides?.shown === number));
  const offered = Boolean(selected && solid?.faces?.length && !both);
  show(byId("turn-card"), offered);
  if (!offered) return;
  show(byId("turn-trouble"), false);
  const touched = new Set(selected.faces);
  byId("turn-faces").replaceChildren(...part.faces
    .filter(({ number }) => !touched.has(number) && !isNever(part, number))
    .map(({ number }) => make("button", {
      type: "button", "data-face": number, "aria-pressed": String(cutFaces().includes(number)), "aria-label": `Face ${number}`,
      click: () => toggleCut(number), pointerenter: () => partDrawing.point(number), pointerleave: () => partDrawing.point(null),
    }, String(number))));
  const file = fileRead();
  field("turn-height").placeholder = file?.how.peg_height ? fieldLength(file.how.peg_height) : "the part’s";
  byId("second-side").textContent = `Second side: ${axisWords(turnedOver(solid.axis))} up`;
  byId("second-side").toggleAttribute("disabled", !file || turning || searching());
  byId("turn-words").textContent = turning ? "The part is being turned over …" : file
    ? `The part turned over, with ${axisWords(turnedOver(solid.axis))} of its file up. The second set-up must not locate on the faces that this set-up cuts:`
    : "To turn the part over, the page needs its STEP file: open it again.";
}

/** A face is cut in this set-up, or is not. */
function toggleCut(face) {
  const cut = cutFaces();
  change({ cut: cut.includes(face) ? cut.filter((one) => one !== face) : [...cut, face].sort((a, b) => a - b) });
}

/** How far pegs reach on the second side, in mm; as on the first where nobody says. */
function pegHeight(file) {
  const value = readLength(field("turn-height").value);
  return value !== null && value > 0 ? value : file.how.peg_height;
}

/** Turn the part over, rule out what was cut, and search. */
async function turnOver() {
  const { part } = state;
  const file = fileRead();
  if (!file || turning) return;
  const first = snapshot();
  const cut = cutFaces();
  turning = true;
  write();
  try {
    const read = await readOver({ axis: turnedOver(part.solid.axis), peg_height: pegHeight(file) });
    if (state.part !== part) return;
    const other = read.survey.part;
    if (!other?.solid?.faces?.length) throw new ApiError(read.survey.error ?? "The other side has no upright faces to locate on.", 400);
    files = [file, read];
    rememberCut(part, cut);
    change({ sides: { shown: 1, kept: [{ ...first, known: { ...first.known, cut } }, null] } });
    resumeFile(read);
    usePart(other, { ...read.survey, chosen: read.how.part_number ?? null });
    change({ cut: [], avoid: sameFaces(other, part, cut) });
    await start();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    turning = false;
    write();
    byId("turn-trouble").textContent = error.message;
    show(byId("turn-trouble"), true);
  } finally {
    turning = false;
  }
}

/** Show the other side, and keep this one. */
export async function goTo(number) {
  const { sides } = state;
  if (!sides || sides.shown === number) return;
  const next = sides.kept[number];
  if (!next) return;
  files[sides.shown] = fileRead();
  const kept = sides.kept.map((side, k) => (k === sides.shown ? snapshot() : k === number ? null : side));
  change({ sides: { shown: number, kept } });
  resumeFile(files[number]);
  await restore({ ...next, known: { ...next.known, unit: state.unit } });
}

/**
 * The set-ups there are, with the search, the fixture and what stands on the sheet of each that has one.
 * @returns {{number: number, job: string, rank: number, part: any, known: Object<string, any>}[]}
 */
export function setUps() {
  const { sides } = state;
  const all = sides ? sides.kept.map((side, k) => (k === sides.shown ? snapshot() : side)) : [snapshot()];
  return all.flatMap((side, number) => (side?.job && side.rank ? [{ number, job: side.job, rank: side.rank, part: side.part, known: side.known }] : []));
}

/** The file of a side's part, how it was read and what was told of it; null where it is not at hand. @param {number} number of the side */
export function fileOf(number) {
  return !state.sides || state.sides.shown === number ? fileRead() : files[number];
}

/** As a value of an address: the first side's set-up, for the sheet of the second; nothing for that of the first. @param {number} number of the side */
export function firstSideQuery(number) {
  const first = number ? setUps().find((one) => one.number === 0) : undefined;
  return first ? { first_side: JSON.stringify({ job: first.job, rank: first.rank, cut: first.known.cut ?? first.known.avoid }) } : {};
}

/** The card that offers the second side of a part. */
function turnCard() {
  return make("section.card.turn.wide", { id: "turn-card", "aria-labelledby": "turn-title", hidden: true },
    make("h2", { id: "turn-title" }, "Then the second side"),
    make("p.small", { id: "turn-words" }),
    make("div.chips", { id: "turn-faces" }),
    make("div.row-of-buttons", {},
      make("button.strong", { id: "second-side", type: "button" }, "Second side"), " ",
      make("label.inline", {}, "Peg height there ", make("span.unit", {}, unitWord()), make("input.short", { id: "turn-height", inputmode: "decimal", autocomplete: "off" }))),
    make("div.trouble-box", { id: "turn-trouble", role: "alert", hidden: true }));
}

/** A button for each side. @param {string[]} words what the sides are called */
function sideSwitch(words) {
  return make("div.segmented", { id: "sides", role: "group", "aria-label": "Side of the part", hidden: true },
    ...words.map((word, number) => make("button", { id: `side-${number}`, type: "button", "aria-pressed": "false" }, word)));
}
