/**
 * Step 1: a part from a file, from those built in, or drawn by hand.
 */
import { ApiError, ask, sendPart } from "./api.js";
import { byId, make, show } from "./dom.js";
import { previewOf } from "./file-preview.js";
import { change, on, state } from "./state.js";
import { length } from "./units.js";

/** The file read last, to be read again in another unit. */
let lastFile = null;
let reading = 0;

/**
 * Set the panel up.
 * @param {{drawing: import("./part-drawing.js").PartDrawing, about: any, onDraw: () => void}} page
 */
export function partPanel({ drawing, onDraw }) {
  const file = /** @type {HTMLInputElement} */ (byId("file"));
  const builtin = /** @type {HTMLSelectElement} */ (byId("builtin"));
  const unit = /** @type {HTMLSelectElement} */ (byId("file-unit"));

  const readFile = async (chosen) => {
    lastFile = chosen;
    builtin.value = "";
    const mine = ++reading;
    say(`Reading ${chosen.name} …`);
    try {
      const part = await sendPart(chosen, unit.value ? { unit: unit.value } : {});
      if (mine === reading) usePart(part);
    } catch (error) {
      if (mine === reading) await trouble(error, chosen);
    }
  };

  const trouble = async (error, chosen) => {
    if (!(error instanceof ApiError)) throw error;
    change({ part: null, avoid: [], zones: [], view: "part" });
    say("");
    const box = byId("part-trouble");
    box.textContent = error.message;
    show(box, true);
    const strokes = await previewOf(chosen).catch(() => []);
    show(byId("stage-empty"), !strokes.length && !error.place);
    if (strokes.length || error.place) drawing.showTrouble(strokes, error.place, error.message);
  };

  file.addEventListener("change", () => {
    if (file.files?.length) readFile(file.files[0]);
    file.value = "";
  });
  unit.addEventListener("change", () => lastFile && readFile(lastFile));
  builtin.addEventListener("change", async () => {
    if (!builtin.value) return;
    lastFile = null;
    const mine = ++reading;
    try {
      const part = await ask(`parts/${encodeURIComponent(builtin.value)}`);
      if (mine === reading) usePart(part, builtin.value);
    } catch (error) {
      if (mine === reading) await trouble(error, new File([], builtin.value));
    }
  });
  byId("draw-part").addEventListener("click", onDraw);
  listenToDrops(readFile);
  on(["part", "unit"], tell);
}

/** Files may be dropped anywhere on the page. */
function listenToDrops(readFile) {
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
    const dropped = event.dataTransfer?.files[0];
    if (dropped) readFile(dropped);
  });
}

/**
 * Take a part: what was ruled out on another one is gone.
 * @param {any} part
 * @param {string} [name] of the built-in part that it is
 */
export function usePart(part, name = "") {
  show(byId("part-trouble"), false);
  /** @type {HTMLSelectElement} */ (byId("builtin")).value = name;
  change({ part, avoid: [], zones: [], force: null, loads: [], view: "part" });
}

/** Offer the parts that come with the program. */
export async function offerParts() {
  const parts = await ask("parts");
  byId("builtin").append(...parts.map((part) => make("option", { value: part.name }, `${part.name}: ${part.title}`)));
}

/** Say something about the part. */
function say(words) {
  byId("part-words").textContent = words;
}

/** Name, size and remarks of the part. */
function tell() {
  const { part } = state;
  if (!part) return;
  const [x0, y0, x1, y1] = part.bounds;
  const holes = part.loops.length - 1;
  const size = `${length(x1 - x0, 2)} × ${length(y1 - y0, 2)}`;
  const words = `${part.name}: ${size}, ${part.faces.length} faces${holes ? `, ${holes} hole${holes > 1 ? "s" : ""}` : ""}.`;
  say([words, ...(part.remarks ?? [])].join(" "));
}
