/**
 * What else stands on the setup sheet: part zero, thickness, dowels, how far the cutter keeps off, the machine's place.
 */
import { byId, choice, field } from "./dom.js";
import { askIn, askedOf } from "./questions.js";
import { change, on, state } from "./state.js";
import { length, scale } from "./units.js";

/** Forms of lengths, which are in mm here and in the unit shown at the server. */
const LENGTHS = ["length", "place"];

/** The paper asked for, or the one that users of the unit have. @param {Object<string, any>} sheet @returns {string} */
const paperOf = (sheet) => sheet.paper ?? (state.unit === "inch" ? "letter" : "a4");

/** Set the fields up. */
export function sheetFields() {
  byId("paper").addEventListener("change", (event) => change({ sheet: { ...state.sheet, paper: /** @type {HTMLSelectElement} */ (event.target).value } }));
  on(["sheet", "unit", "part", "selected"], write);
  write();
}

/** Draw the fields, once the server has told what is asked. */
export function askOnSheet() {
  askIn(byId("sheet-fields"), "sheet", askedOf("sheet"));
  field("sheet-zero").setAttribute("list", "zeros");
  write();
}

/** Write which paper it is, and in few words what else is asked. */
function write() {
  const { sheet, part } = state;
  choice("paper").value = paperOf(sheet);
  if (document.getElementById("sheet-part-name")) field("sheet-part-name").placeholder = part?.name ?? "";
  const given = [
    sheet.thickness && `${length(sheet.thickness, 2)} thick`, sheet.dowel, sheet.zero && `X0 Y0 at ${sheet.zero}`,
    sheet.seating && "seating", sheet.clearance !== undefined && `cutter ${length(sheet.clearance, 2)} off`,
  ];
  byId("sheet-words").textContent = given.filter(Boolean).join(", ");
}

/** What is asked of a sheet, as the server takes it: lengths in the unit shown. @param {Object<string, any>} [sheet] */
export function sheetQuery(sheet = state.sheet) {
  const query = { paper: paperOf(sheet), unit: state.unit };
  const own = (value) => String(Number((value / scale()).toPrecision(12)));
  for (const { name, form } of askedOf("sheet")) {
    const value = sheet[name];
    if (value === undefined || value === null) continue;
    query[name] = LENGTHS.includes(form) ? [value].flat().map(own) : String(value);
  }
  return query;
}
