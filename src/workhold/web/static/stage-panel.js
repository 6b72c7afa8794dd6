/**
 * The middle of the page: part or fixture, one or two drawings, stepping, closing the vise, zoom.
 */
import { byId, show } from "./dom.js";
import { DrawingTool } from "./drawing-tool.js";
import { FixtureDrawing } from "./fixture-drawing.js";
import { PartDrawing } from "./part-drawing.js";
import { usePart } from "./part-panel.js";
import { forceOf } from "./pose.js";
import { isSame, rowOfRank, step } from "./selection.js";
import { change, on, state } from "./state.js";
import { kindOf, kinds } from "./toolkits.js";
import { countText, forceText, number } from "./units.js";

/** @type {PartDrawing} */
export let partDrawing;
/** @type {FixtureDrawing} */
export let fixtureDrawing;
/** @type {FixtureDrawing} */
let pinnedDrawing;
/** @type {DrawingTool|null} */
let tool = null;
/** How many fixtures the list has. */
let listTotal = 0;
/** The nearest miss, when there is no fixture. @type {any} */
let miss = null;

/** Set the panel up. */
export function stagePanel() {
  const svg = (id) => /** @type {SVGSVGElement} */ (/** @type {any} */ (byId(id)));
  partDrawing = new PartDrawing(svg("drawing-part"));
  fixtureDrawing = new FixtureDrawing(svg("drawing-fixture"), (k, at) => pointPeg(k, at, state.selected ?? miss), pictureIn);
  pinnedDrawing = new FixtureDrawing(svg("drawing-pinned"), (k, at) => pointPeg(k, at, state.pinned, false), pictureIn);
  byId("view-part").addEventListener("click", () => change({ view: "part" }));
  byId("view-fixture").addEventListener("click", () => change({ view: "fixture" }));
  byId("previous").addEventListener("click", () => step(-1));
  byId("next").addEventListener("click", () => step(1));
  byId("close-vise").addEventListener("click", closeVise);
  byId("pin").addEventListener("click", togglePin);
  byId("unpin").addEventListener("click", () => change({ pinned: null }));
  byId("zoom-in").addEventListener("click", () => views().forEach((view) => view.zoom(1.4)));
  byId("zoom-out").addEventListener("click", () => views().forEach((view) => view.zoom(1 / 1.4)));
  byId("zoom-fit").addEventListener("click", () => views().forEach((view) => view.fit()));
  byId("draw-cancel").addEventListener("click", () => change({ view: "part" }));
  on(["part"], () => {
    show(byId("stage-empty"), state.part === null);
    if (state.view !== "draw") partDrawing.show();
  });
  on(["avoid"], () => partDrawing.paint());
  on(["avoid", "unit"], () => partDrawing.letter());
  on(["zones"], () => partDrawing.build());
  on(["view"], showView);
  on(["selected"], showSelected);
  on(["pinned"], showPinned);
  on(["selected", "index", "job"], showPlace);
  on(["toolkit"], () => (byId("close-vise").textContent = kinds.length ? kindOf(state.toolkit).closes : "Close"));
  on(["sheet"], () => [fixtureDrawing, pinnedDrawing].forEach((drawing) => drawing.keepOff(state.sheet.clearance ?? null)));
  on(["unit"], () => [fixtureDrawing, pinnedDrawing].forEach((drawing) => drawing.row && drawing.slide(drawing.open)));
}

/** The picture of a fixture of the search on show in a frame of another size; null where there is none any more. */
async function pictureIn(row, frame) {
  const other = state.job?.job ? await rowOfRank(state.job.job, row.rank, frame) : null;
  return other && isSame(other, row) ? other.picture : null;
}

/** The views on show. */
function views() {
  if (state.view !== "fixture") return [partDrawing.view];
  return state.pinned ? [fixtureDrawing.view, pinnedDrawing.view] : [fixtureDrawing.view];
}

/** Show the part, a fixture, or a part being drawn. */
export function showView() {
  const { view } = state;
  const fixture = view === "fixture";
  byId("view-part").setAttribute("aria-pressed", String(!fixture));
  byId("view-fixture").setAttribute("aria-pressed", String(fixture));
  // SVG elements know no hidden property, but the attribute does.
  show(byId("drawing-part"), !fixture);
  show(byId("drawing-fixture"), fixture);
  show(byId("board-pinned"), fixture && state.pinned !== null);
  show(byId("below"), fixture && state.selected !== null);
  show(byId("board-title"), fixture && byId("board-title").textContent !== "");
  show(byId("draw-bar"), view === "draw");
  show(byId("draw-words"), view === "draw");
  if (view === "draw" && !tool) {
    show(byId("stage-empty"), false);
    tool = new DrawingTool(partDrawing, (part) => {
      change({ sides: null, cut: null });
      usePart(part);
    });
    byId("drawing-part").focus();
  } else if (view !== "draw" && tool) {
    tool.stop();
    tool = null;
    partDrawing.show();
    show(byId("stage-empty"), state.part === null);
  }
  if (fixture && fixtureDrawing.row) fixtureDrawing.view.fit();
  else if (!fixture) partDrawing.letter();
}

/** Show the fixture selected; the vise closes on one that was chosen by itself, not while stepping quickly. */
let shownAt = 0;
function showSelected() {
  const row = state.selected;
  pegWords(null, null, null);
  show(byId("below"), row !== null && state.view === "fixture");
  byId("view-fixture").toggleAttribute("disabled", row === null && miss === null);
  for (const id of ["close-vise", "push", "pin"]) byId(id).toggleAttribute("disabled", row === null);
  show(byId("close-vise"), !row?.hold?.straps);
  if (!row) {
    if (!miss) fixtureDrawing.clear();
    return;
  }
  miss = null;
  // The title first: it takes room from the drawing.
  showTitle(state.pinned ? `Shown: ${row.rank}` : "");
  fixtureDrawing.show(state.toolkit, row);
  const now = performance.now();
  if (now - shownAt > 700) fixtureDrawing.close();
  shownAt = now;
}

/**
 * Show what came nearest to being a fixture, or leave it.
 * @param {any} row
 * @param {string} [words]
 */
export function showMiss(row, words = "") {
  miss = row;
  byId("view-fixture").toggleAttribute("disabled", row === null && state.selected === null);
  showTitle(row ? "The nearest miss" : "");
  if (!row) {
    if (!state.selected) fixtureDrawing.clear();
    if (state.view === "fixture" && !state.selected) change({ view: "part" });
    return;
  }
  change({ view: "fixture" });
  fixtureDrawing.show(state.toolkit, row);
  byId("drawing-fixture").setAttribute("aria-label", `The nearest miss: ${words}`);
}

/** Write above the main drawing. */
function showTitle(words) {
  byId("board-title").textContent = words;
  show(byId("board-title"), words !== "" && state.view === "fixture");
}

/** Show the pinned fixture beside the other, or only the other. */
function showPinned() {
  const row = state.pinned;
  show(byId("board-pinned"), row !== null && state.view === "fixture");
  if (row) {
    if (state.selected) showTitle(`Shown: ${state.selected.rank}`);
    byId("pinned-title").textContent = `Pinned: ${row.rank}`;
    pinnedDrawing.show(state.toolkit, row);
  } else {
    pinnedDrawing.clear();
    if (state.selected) showTitle("");
  }
  byId("pin").setAttribute("aria-pressed", String(row !== null));
}

/** Keep the fixture shown beside the next ones, or leave the pinned one. */
export function togglePin() {
  if (state.selected) change({ pinned: state.pinned ? null : state.selected });
}

/** Show the vise closing. */
export function closeVise() {
  if (state.view === "fixture" && state.selected && !state.trial) fixtureDrawing.close();
}

/** Where in the list the fixture shown is. */
function showPlace() {
  const { selected, index } = state;
  byId("place").textContent = !selected ? "–" : index < 0 ? `rank ${selected.rank}` : `${countText(index + 1)} of ${countText(listTotal)}`;
  byId("previous").toggleAttribute("disabled", !selected || index <= 0);
  byId("next").toggleAttribute("disabled", !selected || index >= listTotal - 1);
}

/** Learn how many fixtures the list has. */
export function tellTotal(total) {
  listTotal = total;
  showPlace();
}

/** A peg is pointed at or focused: tell its hole, face and force beside it, and mark it in the table. */
function pointPeg(k, at, row, inTable = true) {
  if (inTable) {
    for (const [index, line] of [...byId("pegs").children].entries()) line.classList.toggle("marked", index === k);
  }
  pegWords(k, at, row);
}

/** The words beside a peg. */
function pegWords(k, at, row) {
  const box = byId("peg-words");
  show(box, k !== null && row !== null);
  if (k === null || !row) return;
  const force = fixtureDrawing.load && row === state.selected ? forceText(fixtureDrawing.load.forces[k]) : `${number(row.forces[k], 3)} N for each N of ${forceOf(row)}`;
  box.textContent = `${row.holes[k]} · face ${row.touched[k]}${row.hold ? "" : ` · ${force}`}`;
  const wide = box.offsetWidth;
  box.style.left = `${Math.max(6, Math.min(innerWidth - wide - 6, at.left + at.width / 2 - wide / 2))}px`;
  box.style.top = `${at.bottom + 8 + box.offsetHeight > innerHeight ? at.top - box.offsetHeight - 8 : at.bottom + 8}px`;
}

/** Leave the tool that draws a part. */
export function leaveDrawing() {
  if (state.view === "draw") change({ view: "part" });
}
