/**
 * The fixture shown in three dimensions: its bodies, opened and closed by a slider.
 */
import { ApiError, downloadPath, fetched } from "./api.js";
import { byId, field, make, show } from "./dom.js";
import { hasShape, isSent, sendShape } from "./part-shape.js";
import { SIDES, setUps } from "./set-ups.js";
import { sheetQuery } from "./sheet-fields.js";
import { playing, stopPlaying } from "./space/playing.js";
import { bodiesOf } from "./space/glb-reading.js";
import { on, state } from "./state.js";
import { supportsQuery } from "./supports.js";
import { length } from "./units.js";

const NO_WEBGL = "Drawn without WebGL, which this browser lacks or would draw slowly.";
/** How far things open at most, in parts of the extent of all bodies. */
const WIDEST = 0.3;

/** The view, once it is there. @type {import("./space/space-view.js").SpaceView|import("./space/plain-view.js").PlainView|null} */
export let view = null;
let latest = 0;

/** Make the button and the dialog, and set them up. */
export function spaceDialog() {
  const button = { id: "in-space", type: "button", "aria-haspopup": "dialog", title: "See it in three dimensions", disabled: true };
  byId("pin").before(make("button", button, "3-D"), " ");
  document.body.append(made());
  const dialog = /** @type {HTMLDialogElement} */ (byId("space"));
  const slider = field("space-opening");
  byId("in-space").addEventListener("click", openSpace);
  slider.addEventListener("input", () => {
    stopPlaying();
    opened(Number(slider.value));
  });
  byId("space-play").addEventListener("click", play);
  byId("space-first").addEventListener("click", () => view?.fit());
  byId("space-above").addEventListener("click", () => view?.fit(0, Math.PI / 2));
  byId("space-front").addEventListener("click", () => view?.fit(0, 0));
  for (const number of SIDES.keys()) byId(`space-side-${number}`).addEventListener("click", () => chooseSide(number));
  dialog.addEventListener("close", () => {
    latest += 1;
    stopPlaying();
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
    make("div.segmented", { id: "space-sides", role: "group", "aria-label": "Side of the part", hidden: true }, ...SIDES.map((words, number) => button(`space-side-${number}`, words))),
    make("p", { id: "space-words", role: "status" }),
    make("p.small", { id: "space-shape", role: "status", hidden: true }),
    make("div.trouble-box", { id: "space-trouble", role: "alert", hidden: true }),
    make("div", { id: "space-turn" },
      make("canvas", { id: "space-canvas", tabindex: "0", role: "application", "aria-label": label, "aria-describedby": "space-hint" }),
      make("output.small", { id: "space-name", for: "space-canvas" }),
      make("p.small.faint", { id: "space-hint" }, hint),
      make("label.inline", { id: "space-slider" }, "Opened by ",
        make("input", { type: "range", id: "space-opening", min: "0", max: "1", value: "0" }), " ",
        make("output", { id: "space-opened", for: "space-opening" }, "closed")),
      make("div.row-of-buttons", {},
        button("space-play", "Play"), button("space-first", "Show all"), button("space-above", "From above"), button("space-front", "From the front"))),
    make("ul.kinds.small", { id: "space-kinds", "aria-label": "Bodies by kind" }),
    make("div.row-of-buttons", {}, make("a.button", { id: "space-save", download: true }, "Save as GLB")),
    make("form", { method: "dialog" }, make("button.primary", {}, "Close")));
}

/** Open the dialog with the fixture shown. */
export async function openSpace() {
  if (!state.job || !state.selected) return;
  /** @type {HTMLDialogElement} */ (byId("space")).showModal();
  await showSide(state.sides?.shown ?? 0);
}

/** Fetch the bodies of one side's fixture and show them. @param {number} number of the side */
async function showSide(number) {
  const all = setUps();
  const shown = all.find((one) => one.number === number);
  if (!shown) return;
  const mine = ++latest;
  const trouble = byId("space-trouble");
  show(trouble, false);
  byId("space").setAttribute("aria-busy", "true");
  byId("space-words").textContent = "";
  sayOfShape("");
  byId("space-kinds").replaceChildren();
  show(byId("space-sides"), all.length > 1);
  for (const other of SIDES.keys()) byId(`space-side-${other}`).setAttribute("aria-pressed", String(other === number));
  byId("space-title").textContent = `${all.length > 1 ? `${SIDES[number]}, fixture` : "Fixture"} ${shown.rank} in three dimensions`;
  const sizes = Object.entries(sheetQuery(shown.known.sheet)).filter(([name]) => ["thickness", "peg_length", "peg_height", "unit"].includes(name));
  const supported = supportsQuery({ ...shown.known, part: shown.part, unit: state.unit });
  const path = downloadPath(shown.job, shown.rank, "assembly.glb", { ...Object.fromEntries(sizes), ...supported });
  byId("space-save").setAttribute("href", path);
  try {
    const bodies = await shownFrom(path, mine);
    if (!bodies) return;
    if (isPlain) byId("space-words").textContent = NO_WEBGL;
    byId("space-canvas").focus();
    setSlider(bodies);
    await withShape(shown, path, mine);
    await withBending(shown, path, mine);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (mine !== latest) return;
    view?.clear();
    trouble.textContent = error.status === 404 && all.length > 1 && number !== state.sides?.shown
      ? `The server has forgotten the search for the ${SIDES[number].toLowerCase()}: show that side once, and it is searched again.` : error.message;
    show(trouble, true);
  } finally {
    if (mine === latest) byId("space").setAttribute("aria-busy", "false");
  }
}

/**
 * Fetch bodies and show them.
 * @param {string} path
 * @param {number} mine what they are fetched for, which may have been overtaken meanwhile
 * @param {boolean} [still] whether they are seen as those before are
 * @returns {Promise<import("./space/glb-reading.js").Body[]|null>} null where something else is shown by now
 */
async function shownFrom(path, mine, still = false) {
  const { content } = await fetched(path);
  const bodies = bodiesOf(await content.arrayBuffer());
  const shownBy = await viewOf();
  if (mine !== latest) return null;
  tell(bodies);
  shownBy.show(bodies, still);
  return bodies;
}

/** Show the part as its file has it; where that cannot be, it stays a prism, and why is told. */
async function withShape(shown, path, mine) {
  if (isSent(shown)) return;
  if (hasShape(shown)) sayOfShape("Reading the shape of the part …");
  const why = await sendShape(shown);
  if (mine !== latest) return;
  sayOfShape(why);
  if (isSent(shown)) await shownFrom(path, mine, true);
}

/** Show the part bent and coloured, where its material is named among what stands on the sheet. */
async function withBending(shown, path, mine) {
  const { material } = sheetQuery(shown.known.sheet);
  if (mine !== latest || !material) return;
  sayOfShape("Bending the part …");
  const bent = `${path}${path.includes("?") ? "&" : "?"}material=${encodeURIComponent(material)}`;
  const bodies = await shownFrom(bent, mine, true);
  const told = bodies?.find((body) => body.bent)?.bent;
  if (!told) return;
  byId("space-save").setAttribute("href", bent);
  const [most, error] = [told.most, told.error].map((value) => (1000 * value).toPrecision(2));
  sayOfShape(`Clamping bends the part by up to ${most} µm, give or take ${error} µm: yellow the most, dark blue nothing, grey where something presses. It is shown bent ${told.times.toLocaleString("en")} times as far.${told.warnings.map((warning) => ` Beware: ${warning}`).join("")}`);
}

/** Say something about the shape of the part. @param {string} words */
function sayOfShape(words) {
  byId("space-shape").textContent = words;
  show(byId("space-shape"), words !== "");
}

/** Show a side that was asked for by hand. @param {number} number */
function chooseSide(number) {
  stopPlaying();
  return showSide(number);
}

/** Play the closing, of one side after the other where there are two. */
async function play() {
  const slider = field("space-opening");
  const sides = setUps().map(({ number }) => number);
  await playing(sides, {
    show: (number) => (sides.length > 1 ? showSide(number) : Promise.resolve()),
    open: (share) => {
      slider.value = String(share * Number(slider.max));
      opened(Number(slider.value));
    },
  });
}

/** Whether the view does without WebGL. */
let isPlain = false;

/** Renderers that stand in for a graphics card; they are slower than drawing without WebGL. */
const STAND_IN = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Whether a graphics card draws WebGL here, as far as the browser tells. */
function hasCard() {
  const context = document.createElement("canvas").getContext("webgl2");
  const told = context?.getExtension("WEBGL_debug_renderer_info");
  const name = context && told ? String(context.getParameter(told.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return Boolean(context) && !STAND_IN.test(name);
}

/** Make the view, with WebGL where a graphics card draws it. */
async function viewOf() {
  if (view) return view;
  const canvas = /** @type {HTMLCanvasElement} */ (byId("space-canvas"));
  const context = hasCard() ? canvas.getContext("webgl2", { antialias: true, alpha: true }) : null;
  if (context) {
    const { SpaceView } = await import("./space/space-view.js");
    view ??= new SpaceView(canvas, context);
  } else {
    const { PlainView } = await import("./space/plain-view.js");
    view ??= new PlainView(canvas, /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")));
    isPlain = true;
  }
  view.onPoint = (number) => {
    byId("space-name").textContent = number === null ? "" : (names[number] ?? "");
  };
  return view;
}

/** Set the slider to closed, as far as these bodies open. */
function setSlider(bodies) {
  const slider = field("space-opening");
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

/** Names of the bodies shown. @type {string[]} */
let names = [];

/** Say what there is of each kind. */
function tell(bodies) {
  names = bodies.map((body) => (body.name.startsWith(body.kind) ? body.name : `${body.kind}: ${body.name}`));
  const kinds = [...new Set(bodies.map((body) => body.kind))];
  byId("space-kinds").replaceChildren(
    ...kinds.map((kind) => {
      const names = bodies.filter((body) => body.kind === kind).map((body) => body.name);
      // A bolt belongs to its clamp.
      const counted = names.filter((name) => !name.startsWith("bolt "));
      return make(`li.${kind}`, { title: names.join(", ") }, `${kind}: ${counted.length === 1 ? counted[0] : counted.length}`);
    }),
  );
}
