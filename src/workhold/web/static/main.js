/**
 * The page: sets up its panels, asks the server what there is, and takes up the state that the address holds.
 */
import { ask } from "./api.js";
import { detailsPanel } from "./details-panel.js";
import { byId, choice, quiet, show } from "./dom.js";
import { familiesDialog } from "./families-dialog.js";
import { loadsPanel } from "./loads-panel.js";
import { forcesPanel } from "./forces-panel.js";
import { listenToKeys } from "./keys.js";
import { keep, restored } from "./link.js";
import { offerParts, partPanel } from "./part-panel.js";
import { learnQuestions } from "./questions.js";
import { resultsPanel } from "./results-panel.js";
import { askInRules, rulesPanel } from "./rules-panel.js";
import { listenToSections } from "./sections.js";
import { restore, setUpsPanel } from "./set-ups.js";
import { askOnSheet } from "./sheet-fields.js";
import { spaceDialog } from "./space-dialog.js";
import { programPanel, takeUpProgram } from "./program-panel.js";
import { partDrawing, showView, stagePanel } from "./stage-panel.js";
import { change, on, state, workpieceForm } from "./state.js";
import { supportsPanel } from "./supports-panel.js";
import { takePanel } from "./take-panel.js";
import { trialPanel } from "./trial-panel.js";
import { unitWord } from "./units.js";
import { offerToolkits, toolkitPanel } from "./toolkit-panel.js";
import { comparisonDialog } from "./comparison-dialog.js";
import { warningsPanel } from "./warnings-panel.js";
import { whyPanel } from "./why-panel.js";

/** Distances of the drawing grid in the unit shown. */
const GRIDS = { mm: [1, 2, 5, 10, 20], inch: [0.0625, 0.125, 0.25, 0.5, 1] };

/** Offer grids in the unit shown. */
function writeGrids() {
  const select = choice("draw-grid");
  select.replaceChildren(...GRIDS[state.unit].map((step) => new Option(`${step} ${unitWord()}`, String(step))), new Option("none", "0"));
  select.selectedIndex = 2;
}

/** Take up the state that the address holds. */
async function takeUpState() {
  const kept = await restored(location.hash);
  if (!kept) return;
  takeUpProgram(kept.known.programName);
  change({ sides: kept.sides });
  await restore(kept);
}

/** Hand the part over to the page that explains the method: what a file left open is answered here, once. */
function handOver() {
  try {
    if (state.part) sessionStorage.setItem("workhold-lesson", JSON.stringify(workpieceForm(state.part)));
    else sessionStorage.removeItem("workhold-lesson");
  } catch {
    // A browser may have no room, or keep nothing: that page begins with an example then.
  }
}

/** The next frame, or a tenth of a second where none is drawn. */
function painted() {
  return new Promise((resolve) => {
    requestAnimationFrame(() => setTimeout(resolve));
    setTimeout(resolve, 100);
  });
}

/** Set everything up. */
async function begin() {
  await painted();
  stagePanel();
  rulesPanel(partDrawing, () => change({ view: "part" }));
  toolkitPanel();
  partPanel({ drawing: partDrawing, onDraw: () => change({ view: "draw" }) });
  listenToSections();
  listenToKeys();
  byId("show-method").addEventListener("click", handOver);
  writeGrids();
  on(["unit"], writeGrids);
  partDrawing.show();
  showView();
  const [about, figures] = await Promise.all([ask("about"), ask("figures"), offerParts(), offerToolkits(), learnQuestions()]);
  askInRules();
  byId("step-word").textContent = about.step ? ", STEP" : "";
  detailsPanel(figures);
  forcesPanel();
  trialPanel();
  resultsPanel(figures);
  whyPanel();
  comparisonDialog(figures);
  familiesDialog();
  takePanel(about);
  askOnSheet();
  spaceDialog();
  supportsPanel();
  loadsPanel();
  setUpsPanel();
  warningsPanel();
  programPanel();
  await takeUpState().catch(() => {});
  const keepSoon = quiet(keep, 150);
  on(Object.keys(state), keepSoon);
  // Another link in the same window; the page's own changes of the address are not told.
  addEventListener("hashchange", () => location.reload());
  document.body.dataset.ready = "true";
}

begin().catch((error) => {
  const box = byId("part-trouble");
  box.textContent = error.message;
  show(box, true);
});
