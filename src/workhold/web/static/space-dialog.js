/**
 * The fixture shown in three dimensions: its bodies, opened and closed by a slider.
 */
import { ApiError, downloadPath, fetched } from "./api.js";
import { byId, make, show } from "./dom.js";
import { sheetQuery } from "./sheet-fields.js";
import { bodiesOf } from "./space/glb-reading.js";
import { on, state } from "./state.js";
import { length } from "./units.js";

const NO_WEBGL = "This browser has no WebGL, so nothing can be turned here: save the GLB, which any viewer of such files opens.";
/** How far things open at most, in parts of the extent of all bodies. */
const WIDEST = 0.3;

/** The view, once it is there; null where WebGL is missing. @type {import("./space/space-view.js").SpaceView|null} */
export let view = null;
let latest = 0;

/** Make the button and the dialog, and set them up. */
export function spaceDialog() {
  const button = { id: "in-space", type: "button", "aria-haspopup": "dialog", title: "See it in three dimensions", disabled: true };
  byId("pin").before(make("button", button, "3-D"), " ");
  document.body.append(made());
  const dialog = /** @type {HTMLDialogElement} */ (byId("space"));
  const slider = /** @type {HTMLInputElement} */ (byId("space-opening"));
  byId("in-space").addEventListener("click", openSpace);
  slider.addEventListener("input", () => opened(Number(slider.value)));
  byId("space-first").addEventListener("click", () => view?.fit());
  byId("space-above").addEventListener("click", () => view?.look(0, Math.PI / 2));
  byId("space-front").addEventListener("click", () => view?.look(0, 0));
  dialog.addEventListener("close", () => {
    latest += 1;
    view?.clear();
  });
  on(["selected"], () => byId("in-space").toggleAttribute("disabled", !state.selected));
}

/** The dialog's elements. */
function made() {
  const button = (id, words) => make("button", { id, type: "button" }, words);
  const label = "Bodies of the fixture: arrows turn them, plus and minus zoom, 0 shows all";
  const hint = "Drag to turn, with Shift or two fingers to move; wheel or pinch to zoom. Keys: arrows, + and −, 0.";
  return make("dialog.wide", { id: "space", "aria-labelledby": "space-title" },
    make("h2", { id: "space-title" }),
    make("p", { id: "space-words", role: "status" }),
    make("div.trouble-box", { id: "space-trouble", role: "alert", hidden: true }),
    make("div", { id: "space-turn" },
      make("canvas", { id: "space-canvas", tabindex: "0", role: "application", "aria-label": label, "aria-describedby": "space-hint" }),
      make("p.small.faint", { id: "space-hint" }, hint),
      make("label.inline", { id: "space-slider" }, "Opened by ",
        make("input", { type: "range", id: "space-opening", min: "0", max: "1", value: "0" }), " ",
        make("output", { id: "space-opened", for: "space-opening" }, "closed")),
      make("div.row-of-buttons", {},
        button("space-first", "Show all"), button("space-above", "From above"), button("space-front", "From the front"))),
    make("ul.kinds.small", { id: "space-kinds", "aria-label": "Bodies by kind" }),
    make("div.row-of-buttons", {}, make("a.button", { id: "space-save", download: true }, "Save as GLB")),
    make("form", { method: "dialog" }, make("button.primary", {}, "Close")));
}

/** Open the dialog and fetch the bodies of the fixture shown. */
export async function openSpace() {
  const { job, selected } = state;
  if (!job || !selected) return;
  const mine = ++latest;
  const trouble = byId("space-trouble");
  show(trouble, false);
  byId("space-words").textContent = "";
  byId("space-kinds").replaceChildren();
  byId("space-title").textContent = `Fixture ${selected.rank} in three dimensions`;
  const sizes = Object.entries(sheetQuery()).filter(([name]) => ["thickness", "peg_length", "peg_height", "unit"].includes(name));
  const path = downloadPath(job.job, selected.rank, "assembly.glb", Object.fromEntries(sizes));
  byId("space-save").setAttribute("href", path);
  /** @type {HTMLDialogElement} */ (byId("space")).showModal();
  try {
    const { content } = await fetched(path);
    const bodies = bodiesOf(await content.arrayBuffer());
    const canBeTurned = await viewOf();
    if (mine !== latest) return;
    tell(bodies);
    show(byId("space-turn"), canBeTurned);
    if (!canBeTurned) {
      byId("space-words").textContent = NO_WEBGL;
      return;
    }
    view?.show(bodies);
    byId("space-canvas").focus();
    setSlider(bodies);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (mine !== latest) return;
    trouble.textContent = error.message;
    show(trouble, true);
  }
}

/** Make the view where there is WebGL, and say whether there is. */
async function viewOf() {
  if (view) return true;
  const canvas = /** @type {HTMLCanvasElement} */ (byId("space-canvas"));
  const context = canvas.getContext("webgl2", { antialias: true, alpha: true });
  if (!context) return false;
  const { SpaceView } = await import("./space/space-view.js");
  view ??= new SpaceView(canvas, context);
  return true;
}

/** Set the slider to closed, as far as these bodies open. */
function setSlider(bodies) {
  const slider = /** @type {HTMLInputElement} */ (byId("space-opening"));
  const widest = WIDEST * (view?.size ?? 1) * 1000;
  show(byId("space-slider"), bodies.some((body) => body.opens));
  slider.max = String(widest);
  slider.step = String(widest / 200);
  slider.value = "0";
  opened(0);
}

/** Open by a length in mm. */
function opened(by) {
  view?.open(by / 1000);
  byId("space-opened").textContent = by ? length(by, 1) : "closed";
}

/** Say what there is of each kind. */
function tell(bodies) {
  const kinds = [...new Set(bodies.map((body) => body.kind))];
  byId("space-kinds").replaceChildren(
    ...kinds.map((kind) => {
      const names = bodies.filter((body) => body.kind === kind).map((body) => body.name);
      return make(`li.${kind}`, { title: names.join(", ") }, `${kind}: ${names.length === 1 ? names[0] : names.length}`);
    }),
  );
}
