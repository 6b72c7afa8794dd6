/**
 * Step 3: what is ruled out: faces, zones, angles, margins, types.
 */
import { byId, field, make, quiet, show } from "./dom.js";
import { bandWords, isNever, toggleFace } from "./part-drawing.js";
import { change, on, state } from "./state.js";
import { askIn, askedOf, holdsByFriction, takesRawBlock } from "./questions.js";
import { kindOf, kinds } from "./toolkits.js";
import { forceText, length, number, readLength, readNumber } from "./units.js";
import { circleLoop, ZoneTool } from "./zone-tool.js";

/** @type {ZoneTool|null} */
let tool = null;

/**
 * Set the panel up.
 * @param {import("./part-drawing.js").PartDrawing} drawing
 * @param {() => void} showPart
 */
export function rulesPanel(drawing, showPart) {
  for (const kind of ["circle", "polygon"]) {
    byId(`zone-${kind}`).addEventListener("click", () => startZone(drawing, kind, showPart));
  }
  byId("zone-add").addEventListener("click", addTyped);
  for (const id of ["angle-low", "angle-high"]) {
    field(id).addEventListener("input", quiet(read, 250));
    field(id).addEventListener("change", read);
  }
  on(["part"], () => writeFaces(drawing));
  on(["avoid"], markFaces);
  on(["zones", "unit"], writeZones);
  on(["angles", "unit"], write);
  on(["toolkit", "types"], writeTypes);
  on(["toolkit"], () => {
    show(byId("friction-box"), holdsByFriction());
    show(byId("seating-box"), !holdsByFriction());
  });
  field("every-pair").addEventListener("change", () => change({ listing: field("every-pair").checked ? "all" : null }));
  field("every-fixture").addEventListener("change", () => change({ every: field("every-fixture").checked }));
  on(["toolkit", "listing", "every"], writeListing);
  on(["loads", "unit", "toolkit"], writeLoads);
  on(["view"], () => state.view !== "part" && stopZone());
}

/** Draw what else is asked, once the server has told what that is. */
export function askInRules() {
  const isSeating = ({ section }) => section === "Seating";
  const isOfLoads = ({ section }) => section === "Loads";
  askIn(byId("search-fields"), "ruledOut", askedOf("restrictions"));
  askIn(byId("search-fields"), "asked", askedOf("search").filter((field) => !isSeating(field) && !isOfLoads(field)));
  askIn(byId("friction-fields"), "asked", askedOf("search").filter(isOfLoads));
  askIn(byId("seating-fields"), "asked", askedOf("search").filter(isSeating));
  on(["toolkit"], showRawBlock);
  showRawBlock();
}

/** Ask for a raw block only where the toolkit can hold one. */
function showRawBlock() {
  show(/** @type {Element} */ (byId("search-raw").parentElement), takesRawBlock());
}

/** A button for each face; pressed means forbidden. */
function writeFaces(drawing) {
  const faces = state.part?.faces ?? [];
  byId("faces").replaceChildren(
    ...faces.map((face) => {
      const kind = face.kind === "line" ? `line of ${length(face.size, 1)}` : `arc of radius ${length(face.size, 1)}`;
      const size = `${kind}${bandWords(state.part, face.number)}`;
      return make(`button${isNever(state.part, face.number) ? ".never-touched" : ""}`, {
        type: "button", title: size, "aria-label": `Face ${face.number}, ${size}`, "data-face": face.number,
        click: () => toggleFace(face.number),
        pointerenter: () => drawing.point(face.number), pointerleave: () => drawing.point(null),
        focus: () => drawing.point(face.number), blur: () => drawing.point(null),
      }, String(face.number));
    }),
  );
  markFaces();
}

/** Show which faces are forbidden. */
function markFaces() {
  for (const button of byId("faces").querySelectorAll("button")) {
    button.setAttribute("aria-pressed", String(state.avoid.includes(Number(button.dataset.face))));
  }
}

/** Begin to draw a zone, or leave it. */
function startZone(drawing, kind, showPart) {
  const same = tool?.kind === kind;
  tool?.stop();
  if (same || !state.part) return;
  showPart();
  byId(`zone-${kind}`).setAttribute("aria-pressed", "true");
  tool = new ZoneTool(drawing, kind, () => {
    tool = null;
    for (const each of ["circle", "polygon"]) byId(`zone-${each}`).setAttribute("aria-pressed", "false");
  });
}

/** Leave the zone that is being drawn. */
export function stopZone() {
  tool?.stop();
}

/** Add a circle from its typed numbers. */
function addTyped() {
  const values = ["zone-x", "zone-y", "zone-radius"].map((id) => {
    const value = readLength(field(id).value);
    const wrong = value === null || !Number.isFinite(value) || (id === "zone-radius" && value <= 0);
    field(id).setAttribute("aria-invalid", String(wrong));
    return wrong ? null : value;
  });
  if (values.includes(null)) return;
  change({ zones: [...state.zones, circleLoop([values[0], values[1]], values[2])] });
  for (const id of ["zone-x", "zone-y", "zone-radius"]) field(id).value = "";
}

/** A chip for each zone, which removes it. */
function writeZones() {
  byId("zones").replaceChildren(
    ...state.zones.map((zone, k) => {
      const circle = zone.length === 2 && zone.every(([, , bulge]) => bulge === 1);
      const words = circle ? `circle r ${length((zone[1][0] - zone[0][0]) / 2, 1)}` : `polygon of ${zone.length}`;
      return make("button", {
        type: "button", "aria-label": `Remove the ${words}`,
        click: () => change({ zones: state.zones.filter((_, other) => other !== k) }),
      }, `${words} ×`);
    }),
  );
}

/** Read angles into the state. */
function read() {
  const [low, high] = ["angle-low", "angle-high"].map((id) => readNumber(field(id).value));
  const one = (low === null) !== (high === null);
  const badAngle = low !== null && high !== null && !(low <= high);
  for (const id of ["angle-low", "angle-high"]) field(id).setAttribute("aria-invalid", String(badAngle));
  if (badAngle || one) return;
  const angles = low === null ? [] : [[low, high]];
  if (JSON.stringify(angles) !== JSON.stringify(state.angles)) change({ angles });
}

/** Write angles and margin. */
function write() {
  const values = {
    "angle-low": state.angles.length ? String(state.angles[0][0]) : "",
    "angle-high": state.angles.length ? String(state.angles[0][1]) : "",
  };
  for (const [id, value] of Object.entries(values)) if (field(id) !== document.activeElement) field(id).value = value;
}

/** Whether every fixture is listed, and every pair of clamps where there are two. */
function writeListing() {
  show(byId("pairs-box"), state.toolkit.clamps === 2);
  field("every-pair").checked = state.listing === "all";
  field("every-fixture").checked = state.every;
}

/** A box for each type of fixture where there are several; ticked means sought. */
function writeTypes() {
  if (!kinds.length) return;
  const { types } = kindOf(state.toolkit);
  show(byId("types-box"), types.length > 1);
  byId("types").replaceChildren(
    ...types.map(({ name, words }) => {
      const box = make("input", { type: "checkbox", value: name, checked: !state.types || state.types.includes(name), change: readTypes });
      return make("label.check", {}, box, ` ${words}`);
    }),
  );
}

/** Read which types are sought; one is. */
function readTypes(event) {
  const boxes = [...byId("types").querySelectorAll("input")];
  if (!boxes.some((box) => box.checked)) event.target.checked = true;
  change({ types: boxes.every((box) => box.checked) ? null : boxes.filter((box) => box.checked).map((box) => box.value) });
}

/** Tell which load the search ranks by, and offer to drop it. */
function writeLoads() {
  const words = byId("load-words");
  // Where friction holds the part they stand in a list of their own.
  show(words, state.loads.length > 0 && !holdsByFriction());
  words.replaceChildren(
    ...state.loads.map((load) => `Ranked by a load of ${forceText(load.force)} at (${load.points[0].map((v) => length(v, 1)).join(", ")}). `),
    make("button", { type: "button", click: () => change({ loads: [], ranking: null }) }, "Drop the load"),
  );
}

/** Write everything anew, after a state was restored. */
export function writeRules(drawing) {
  writeFaces(drawing);
  writeZones();
  write();
  writeTypes();
  writeLoads();
}
