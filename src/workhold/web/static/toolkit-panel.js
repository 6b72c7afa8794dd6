/**
 * Step 2: what holds the part, from what a user has by name or in own values; the fields are those of its kind.
 */
import { ask } from "./api.js";
import { byId, field, make, quiet, show } from "./dom.js";
import { change, on, state } from "./state.js";
import { makeFields, readField, writeField } from "./toolkit-fields.js";
import { asKind, fieldsOf, kindOf, kinds, learnKinds, same, setValue, valueOf } from "./toolkits.js";
import { fieldLength, forceWord, momentWord, pressureWord, readLength, unitWord } from "./units.js";

const TOLERANCES = ["tolerance-peg", "tolerance-face"];
const OWN = "own";

/** @type {any[]} */
let presets = [];
/** The fields there are, by their names. */
let shown = "";

/** Set the panel up. */
export function toolkitPanel() {
  const typed = quiet(read, 250);
  for (const box of ["toolkit-usual", "toolkit-more"]) {
    byId(box).addEventListener("input", typed);
    byId(box).addEventListener("change", read);
  }
  for (const id of TOLERANCES) {
    field(id).addEventListener("input", typed);
    field(id).addEventListener("change", read);
  }
  byId("preset").addEventListener("change", (event) => usePreset(/** @type {HTMLSelectElement} */ (event.target).value));
  byId("toolkit").addEventListener("change", (event) => useKind(/** @type {HTMLSelectElement} */ (event.target).value));
  byId("unit").addEventListener("change", (event) => change({ unit: /** @type {HTMLSelectElement} */ (event.target).value }));
  on(["toolkit", "toolkitName", "unit", "tolerance"], write);
}

/** Offer what there is. */
export async function offerToolkits() {
  [presets] = await Promise.all([ask("presets"), learnKinds()]);
  const groups = kinds.map((kind) => [kind, presets.filter((preset) => preset.kind === kind.name)]);
  byId("preset").replaceChildren(
    ...groups.filter(([, own]) => own.length).map(([kind, own]) =>
      make("optgroup", { label: kind.title }, ...own.map((preset) => make("option", { value: preset.name }, preset.title)))),
    make("option", { value: OWN }, "something else: own values"),
  );
  byId("toolkit").replaceChildren(...kinds.map((kind) => make("option", { value: kind.name }, kind.title)));
  usePreset(presets[0].name);
}

/**
 * Take a preset: its fields, how far its pegs are off, and its unit.
 * @param {string} name
 */
export function usePreset(name) {
  const preset = presets.find((each) => each.name === name);
  if (!preset) {
    change({ toolkitName: OWN });
    return;
  }
  const { kind, tolerance } = preset;
  const toolkit = asKind(kinds.find((each) => each.name === kind), preset.fields);
  const given = Object.fromEntries(Object.entries(preset.fields).filter(([, value]) => value !== null));
  change({ toolkitName: name, toolkit: { ...toolkit, ...given }, tolerance, types: typesOf({ kind }), unit: preset.unit ?? state.unit });
}

/** What a preset is, in words. @param {string} name */
export function titleOf(name) {
  return presets.find((each) => each.name === name)?.title ?? null;
}

/** Take a kind in own values, with what it has in common with the toolkit there was. */
function useKind(name) {
  const kind = kinds.find((each) => each.name === name);
  if (kind) change({ toolkitName: OWN, toolkit: asKind(kind, state.toolkit), types: typesOf({ kind: name }) });
}

/** What is left of the types sought in another kind; null for all. */
function typesOf(toolkit) {
  const types = state.types?.filter((type) => kindOf(toolkit).types.some((each) => each.name === type));
  return types?.length ? types : null;
}

/** Read the fields into the state; what cannot be read is marked and changes nothing. */
function read() {
  const kind = kindOf(state.toolkit);
  const toolkit = { kind: kind.name, ...kind.said };
  let bad = "";
  for (const each of [...fieldsOf(kind, state.toolkit), ...kind.hardware.flatMap(({ fields }) => fields)]) {
    const { value, wrong } = readField(each, valueOf(state.toolkit, each));
    if (wrong) bad = bad || each.label;
    else setValue(toolkit, each, value);
  }
  // What belongs to another choice than the one just made is left behind.
  const left = fieldsOf(kind, state.toolkit).filter((each) => !fieldsOf(kind, toolkit).includes(each));
  for (const { name } of left) delete toolkit[name];
  const off = TOLERANCES.map((id) => readLength(field(id).value) ?? 0.01);
  TOLERANCES.forEach((id, k) => field(id).setAttribute("aria-invalid", String(!(off[k] >= 0))));
  let words = "";
  if (bad) words = `${bad} is not a number that can be used.`;
  else if (toolkit.pitch && 2 * toolkit.peg_radius > Math.min(...toolkit.pitch)) words = "Pegs would overlap in neighbouring holes: take a smaller peg or a larger pitch.";
  byId("toolkit-trouble").textContent = words;
  show(byId("toolkit-trouble"), words !== "");
  if (words || !off.every((value) => value >= 0)) return;
  const fit = toolkit.peg_radius === state.toolkit.peg_radius ? (state.tolerance?.fit ?? null) : null;
  const tolerance = { peg: off[0], face: off[1], fit };
  const unchanged = same(sorted(toolkit), sorted(withoutUnsaid({ kind: kind.name, ...state.toolkit })));
  const sameOff = off[0] === (state.tolerance?.peg ?? 0.01) && off[1] === (state.tolerance?.face ?? 0.01)
    && fit === (state.tolerance?.fit ?? null);
  if (unchanged && sameOff) return;
  change({ ...(unchanged ? {} : { toolkit, toolkitName: OWN }), ...(sameOff ? {} : { tolerance }) });
}

/** A toolkit without hardware of which nothing is said, and without what nobody says of it. */
function withoutUnsaid(toolkit) {
  const said = { ...toolkit };
  for (const { name } of kindOf(toolkit).hardware) {
    const figures = Object.entries(said[name] ?? {}).filter(([, value]) => value !== null);
    if (figures.length) said[name] = Object.fromEntries(figures);
    else delete said[name];
  }
  return said;
}

/** An object's entries in the order of their keys, and so those of objects in it. */
function sorted(values) {
  const whole = ([key, value]) => [key, value && typeof value === "object" && !Array.isArray(value) ? sorted(value) : value];
  return Object.entries(values).map(whole).sort(([a], [b]) => (a < b ? -1 : 1));
}

/** Write the state into the fields, but not under the user's fingers. */
function write() {
  if (!kinds.length) return;
  const { toolkit } = state;
  const kind = kindOf(toolkit);
  const fields = fieldsOf(kind, toolkit);
  const wanted = JSON.stringify([kind.name, fields.map(({ name, when }) => [name, when])]);
  if (wanted !== shown) {
    shown = wanted;
    byId("toolkit-usual").replaceChildren(...fields.filter((each) => each.is_usual).flatMap(makeFields));
    byId("toolkit-more").replaceChildren(...fields.filter((each) => !each.is_usual).flatMap(makeFields),
      ...kind.hardware.map((one) => make("fieldset.plain.wide", {}, make("legend", {}, one.title), make("div.grid-fields", {}, ...one.fields.flatMap(makeFields)))));
  }
  for (const each of [...fields, ...kind.hardware.flatMap((one) => one.fields)]) writeField(each, valueOf(toolkit, each));
  const off = [state.tolerance?.peg, state.tolerance?.face];
  TOLERANCES.forEach((id, k) => {
    if (field(id) !== document.activeElement) field(id).value = fieldLength(off[k]);
  });
  const units = { ".unit": unitWord(), ".pressure": pressureWord(), ".force-unit": forceWord(), ".moment-unit": momentWord() };
  for (const [each, words] of Object.entries(units)) {
    for (const word of document.querySelectorAll(each)) word.textContent = words;
  }
  byId("more-title").textContent = `More about the ${kind.noun}`;
  field("toolkit").value = kind.name;
  field("preset").value = state.toolkitName || OWN;
  field("unit").value = state.unit;
  const preset = presets.find((each) => each.name === state.toolkitName);
  const assumed = preset?.assumed.length ? ` Assumed: ${preset.assumed.join(", ").replaceAll("_", " ")}.` : "";
  byId("preset-words").textContent = preset ? `${preset.name}. Source: ${preset.source}.${assumed}` : "Own values.";
}
