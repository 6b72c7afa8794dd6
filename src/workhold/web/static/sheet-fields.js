/**
 * What else stands on the setup sheet: part zero, thickness, dowels, how far the cutter keeps off, the machine's place.
 */
import { byId, choice, quiet } from "./dom.js";
import { change, on, state } from "./state.js";
import { fieldLength, length, readLength, readNumber, scale } from "./units.js";

/**
 * Fields by the server's names: lengths above 0 unless said otherwise, numbers, and words.
 * @type {{name: string, form: string, least?: string}[]}
 */
const FIELDS = [
  { name: "zero", form: "words" },
  { name: "thickness", form: "length" },
  { name: "peg_length", form: "length" },
  { name: "peg_height", form: "length" },
  { name: "dowel", form: "words" },
  { name: "clearance", form: "length", least: "0" },
  { name: "machine_x", form: "length", least: "any" },
  { name: "machine_y", form: "length", least: "any" },
  { name: "friction", form: "number" },
  { name: "part_name", form: "words" },
];

/** @returns {HTMLInputElement} */
const field = ({ name }) => /** @type {HTMLInputElement} */ (byId(name.replaceAll("_", "-")));

/** Whether the sheet tells where else the part can come to rest. @returns {HTMLInputElement} */
const seating = () => /** @type {HTMLInputElement} */ (byId("sheet-seating"));

/** The paper asked for, or the one that users of the unit have. @param {Object<string, any>} sheet @returns {string} */
const paperOf = (sheet) => sheet.paper ?? (state.unit === "inch" ? "letter" : "a4");

/** Set the fields up. */
export function sheetFields() {
  byId("sheet-details").addEventListener("input", quiet(read, 200));
  byId("sheet-details").addEventListener("change", read);
  byId("paper").addEventListener("change", (event) => change({ sheet: { ...state.sheet, paper: /** @type {HTMLSelectElement} */ (event.target).value } }));
  on(["sheet", "unit", "part", "selected"], write);
  write();
}

/** Read the fields; one that cannot be read is marked and left as it was. */
function read() {
  const sheet = state.sheet.paper ? { paper: state.sheet.paper } : {};
  if (seating().checked) sheet.seating = true;
  for (const each of FIELDS) {
    const text = field(each).value;
    const known = state.sheet[each.name];
    let value = text.trim() || null;
    if (each.form === "length") value = text !== "" && text === fieldLength(known) ? known : readLength(text);
    else if (each.form === "number") value = readNumber(text);
    const wrong = typeof value === "number" && !(each.least === "any" ? Number.isFinite(value) : value > 0 || (each.least === "0" && value === 0));
    field(each).setAttribute("aria-invalid", String(wrong));
    if (wrong) sheet[each.name] = known;
    else if (value !== null) sheet[each.name] = value;
  }
  if (JSON.stringify(sheet) !== JSON.stringify(state.sheet)) change({ sheet });
}

/** Write what is known into fields that nobody is typing in. */
function write() {
  const { sheet, selected, part } = state;
  choice("paper").value = paperOf(sheet);
  seating().checked = sheet.seating === true;
  for (const each of FIELDS) {
    const input = field(each);
    if (input === document.activeElement) continue;
    input.value = each.form === "length" ? fieldLength(sheet[each.name]) : String(sheet[each.name] ?? "");
    input.setAttribute("aria-invalid", "false");
  }
  field({ name: "part_name" }).placeholder = part?.name ?? "";
  for (const place of document.querySelectorAll(".first-hole")) place.textContent = selected?.origin ?? "";
  const given = [
    sheet.thickness && `${length(sheet.thickness, 2)} thick`, sheet.dowel, sheet.zero && `X0 Y0 at ${sheet.zero}`,
    sheet.seating && "seating", sheet.clearance !== undefined && `cutter ${length(sheet.clearance, 2)} off`,
  ];
  byId("sheet-words").textContent = given.filter(Boolean).join(", ");
}

/** What is asked of a sheet, as the server takes it: lengths in the unit shown. @param {Object<string, any>} [sheet] */
export function sheetQuery(sheet = state.sheet) {
  const query = { paper: paperOf(sheet), unit: state.unit };
  if (sheet.seating) query.seating = "true";
  for (const { name, form } of FIELDS) {
    const value = sheet[name];
    if (value === undefined || value === null) continue;
    query[name] = form === "length" ? String(Number((value / scale()).toPrecision(12))) : String(value);
  }
  return query;
}
