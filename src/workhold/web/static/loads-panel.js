/**
 * What cuts the part, where friction holds it: its thickness, the coefficient of friction, and forces at places of the part.
 */
import { byId, field, make, quiet, show } from "./dom.js";
import { centerOf } from "./forces.js";
import { holdsByFriction, takesRawBlock } from "./questions.js";
import { change, on, state } from "./state.js";
import { thicknessOf } from "./supports.js";
import { fieldLength, forceText, length, number, readForce, readLength, readNumber } from "./units.js";

/** Fields of one force. */
const FIELDS = ["load-force", "load-direction", "load-upward", "load-x", "load-y", "load-height"];

/** Set the panel up. */
export function loadsPanel() {
  const readSoon = quiet(readPart, 250);
  for (const id of ["part-thickness", "part-friction"]) {
    field(id).addEventListener("input", readSoon);
    field(id).addEventListener("change", readPart);
  }
  byId("load-add").addEventListener("click", addLoad);
  for (const id of FIELDS) {
    field(id).addEventListener("keydown", (event) => {
      if (event.key === "Enter") addLoad();
    });
  }
  on(["loads", "unit", "toolkit", "part", "asked", "sheet", "supports"], write);
  write();
}

/** Keep a value that is asked, or leave it out. @param {string} name @param {number|null} value */
function ask(name, value) {
  const { [name]: before, ...rest } = state.asked;
  if ((before ?? null) !== value) change({ asked: value === null ? rest : { ...rest, [name]: value } });
}

/** Read thickness and friction. */
function readPart() {
  const known = [["thickness", "part-thickness", readLength, (value) => value > 0], ["friction", "part-friction", readNumber, (value) => value >= 0]];
  for (const [name, id, take, fits] of known) {
    const value = take(field(id).value);
    const wrong = value !== null && !(Number.isFinite(value) && fits(value));
    field(id).setAttribute("aria-invalid", String(wrong));
    if (!wrong && (value !== null || name in state.asked)) ask(name, value);
  }
}

/** A force as it is typed; null, with the wrong fields marked, where it cannot be used. */
function typed() {
  const [x, y] = centerOf(state.part);
  const values = {
    "load-force": readForce(field("load-force").value) ?? 0, "load-direction": readNumber(field("load-direction").value),
    "load-upward": readForce(field("load-upward").value) ?? 0,
    "load-x": readLength(field("load-x").value) ?? x, "load-y": readLength(field("load-y").value) ?? y,
    "load-height": readLength(field("load-height").value),
  };
  const isNothing = !values["load-force"] && !values["load-upward"];
  const wrong = Object.fromEntries(FIELDS.map((id) => [id, values[id] !== null && !Number.isFinite(values[id])]));
  wrong["load-force"] = wrong["load-force"] || values["load-force"] < 0 || isNothing;
  wrong["load-height"] = wrong["load-height"] || (values["load-height"] !== null && values["load-height"] < 0);
  for (const id of FIELDS) field(id).setAttribute("aria-invalid", String(wrong[id]));
  if (Object.values(wrong).some(Boolean)) return null;
  const direction = values["load-direction"];
  return {
    points: [[values["load-x"], values["load-y"]]], force: values["load-force"], directions: direction === null ? [0, 360] : [direction, direction],
    upward: values["load-upward"], height: values["load-height"],
  };
}

/** Add the force that is typed to the loads. */
function addLoad() {
  if (!state.part) return;
  const load = typed();
  if (!load) return;
  for (const id of FIELDS) field(id).value = "";
  change({ loads: [...state.loads, load], ranking: null });
}

/** A load in words. @param {any} load */
export function loadWords({ points, force, directions: [low, high], upward = 0, height = null, name = "" }) {
  const way = low === high ? `toward ${number(low, 1)}°` : high - low >= 360 ? "in any direction" : `toward ${number(low, 1)}° to ${number(high, 1)}°`;
  const parts = [force ? `${forceText(force)} ${way}` : "", upward ? `${forceText(Math.abs(upward))} ${upward > 0 ? "up" : "down"}` : ""];
  const places = points.map((point) => `(${point.map((value) => length(value, 1)).join(", ")})`).join(", ");
  return `${name ? `${name}: ` : ""}${parts.filter(Boolean).join(", ")} at ${places}, ${height === null ? "on top" : `${length(height, 1)} high`}`;
}

/** Show what is known, and the loads with a button that takes each away. */
function write() {
  show(byId("part-thickness-label"), !state.part?.solid);
  // Between flat jaws nothing stands, and nothing is located by pegs.
  for (const id of ["zones-box", "supports"]) show(byId(id), !takesRawBlock());
  for (const id of ["search-contact-margin", "search-max-location-error"]) {
    const box = document.getElementById(id)?.parentElement;
    if (box) show(box, !takesRawBlock());
  }
  if (!holdsByFriction()) return;
  if (field("part-thickness") !== document.activeElement) field("part-thickness").value = fieldLength(state.asked.thickness ?? null);
  const known = thicknessOf({ ...state, part: null, asked: {} });
  field("part-thickness").placeholder = known === null ? "not known" : fieldLength(known);
  if (field("part-friction") !== document.activeElement) field("part-friction").value = state.asked.friction === undefined ? "" : String(state.asked.friction);
  byId("loads").replaceChildren(...state.loads.map((load, place) =>
    make("li.chip", {}, loadWords(load),
      make("button", {
        type: "button", "aria-label": `Leave out force ${place + 1}`,
        click: () => change({ loads: state.loads.filter((each) => each !== load), ranking: null }),
      }, "×"))));
}
