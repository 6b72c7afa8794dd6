/**
 * Step 2: the vise, from a preset or in own values, in mm or inches.
 */
import { ask } from "./api.js";
import { byId, make, quiet, show } from "./dom.js";
import { change, on, state } from "./state.js";
import { fieldLength, readLength, readNumber, unitWord } from "./units.js";

/** Fields of the vise: the element, how it is read, and whether it may be left empty. */
const FIELDS = [
  { id: "pitch-x", key: "pitch-x", kind: "length" },
  { id: "pitch-y", key: "pitch-y", kind: "length" },
  { id: "columns", key: "columns", kind: "whole" },
  { id: "peg-radius", key: "peg_radius", kind: "length", zero: true },
  { id: "rows", key: "rows", kind: "whole", optional: true },
  { id: "row-offset", key: "row_offset", kind: "length", optional: true, zero: true, negative: true },
  { id: "min-gap", key: "min_gap", kind: "length", optional: true, zero: true },
  { id: "max-opening", key: "max_opening", kind: "length", optional: true },
  { id: "body-radius", key: "body_radius", kind: "length", optional: true, zero: true },
];
const TOLERANCES = ["tolerance-peg", "tolerance-face"];
const OWN = "own";

/** @type {any[]} */
let presets = [];

/** @returns {HTMLInputElement} */
const field = (id) => /** @type {HTMLInputElement} */ (byId(id));

/** Set the panel up. */
export function visePanel() {
  const typed = quiet(read, 250);
  for (const id of [...FIELDS.map((each) => each.id), "blocked", ...TOLERANCES]) {
    field(id).addEventListener("input", typed);
    field(id).addEventListener("change", read);
  }
  byId("preset").addEventListener("change", (event) => usePreset(/** @type {HTMLSelectElement} */ (event.target).value));
  byId("unit").addEventListener("change", (event) => change({ unit: /** @type {HTMLSelectElement} */ (event.target).value }));
  on(["vise", "viseName", "unit", "tolerance"], write);
}

/** Offer the presets, and take one unless the state came with a vise. */
export async function offerVises(chosen) {
  presets = await ask("vises");
  byId("preset").replaceChildren(
    ...presets.map((preset) => make("option", { value: preset.name }, preset.title)),
    make("option", { value: OWN }, "own values"),
  );
  const usual = presets.find((preset) => preset.name === "gripper-two-columns") ?? presets[0];
  if (chosen) change({ arrangements: (presets.find((preset) => preset.name === state.viseName) ?? usual).arrangements });
  else usePreset(usual.name);
  write();
}

/**
 * Take a preset: its fields, how far its pegs are off, and its unit.
 * @param {string} name
 */
export function usePreset(name) {
  const preset = presets.find((each) => each.name === name);
  if (!preset) {
    change({ viseName: OWN });
    return;
  }
  const fields = Object.fromEntries(Object.entries(preset.fields).filter(([, value]) => value !== null));
  const { arrangements, tolerance } = preset;
  const types = state.types?.filter((type) => arrangements.some((each) => each.name === type));
  change({ viseName: name, vise: fields, arrangements, types: types?.length ? types : null, tolerance, unit: preset.unit ?? state.unit });
}

/** Read the fields into the state; what cannot be read is marked and changes nothing. */
function read() {
  const values = {};
  let bad = null;
  for (const each of FIELDS) {
    const input = field(each.id);
    const value = each.kind === "length" ? readLength(input.value) : readNumber(input.value);
    const wrong = value === null ? !each.optional : !fits(each, value);
    input.setAttribute("aria-invalid", String(wrong));
    if (wrong) bad = bad ?? input;
    else if (value !== null) values[each.key] = value;
  }
  const off = TOLERANCES.map((id) => readLength(field(id).value) ?? 0.01);
  TOLERANCES.forEach((id, k) => field(id).setAttribute("aria-invalid", String(!(off[k] >= 0))));
  const { "pitch-x": x, "pitch-y": y, ...rest } = values;
  let words = "";
  if (bad) words = `${bad.labels?.[0].firstChild?.textContent?.trim() ?? "This"} is not a number that can be used.`;
  else if (2 * values.peg_radius > Math.min(x, y)) words = "Pegs would overlap in neighbouring holes: take a smaller peg or a larger pitch.";
  byId("vise-trouble").textContent = words;
  show(byId("vise-trouble"), words !== "");
  if (words || !off.every((value) => value >= 0)) return;
  const blocked = field("blocked").value.split(/[\s,;]+/).filter(Boolean).map((name) => name.toUpperCase());
  const vise = { pitch: [x, y], ...rest, ...(blocked.length ? { blocked } : {}) };
  const fit = vise.peg_radius === state.vise.peg_radius ? (state.tolerance?.fit ?? null) : null;
  const tolerance = { peg: off[0], face: off[1], fit };
  const same = JSON.stringify(sorted(vise)) === JSON.stringify(sorted(state.vise));
  const sameOff = off[0] === (state.tolerance?.peg ?? 0.01) && off[1] === (state.tolerance?.face ?? 0.01)
    && fit === (state.tolerance?.fit ?? null);
  if (same && sameOff) return;
  change({ ...(same ? {} : { vise, viseName: OWN }), ...(sameOff ? {} : { tolerance }) });
}

/** Whether a number suits a field. */
function fits(each, value) {
  if (!Number.isFinite(value)) return false;
  if (each.kind === "whole" && !(Number.isInteger(value) && value >= 1)) return false;
  return each.negative || value > 0 || (Boolean(each.zero) && value === 0);
}

/** An object's entries in the order of their keys. */
function sorted(values) {
  return Object.entries(values).sort(([a], [b]) => (a < b ? -1 : 1));
}

/** Write the state into the fields, but not under the user's fingers. */
function write() {
  const { vise } = state;
  for (const each of FIELDS) {
    const value = each.key.startsWith("pitch") ? vise.pitch[each.key === "pitch-x" ? 0 : 1] : vise[each.key];
    put(each.id, each.kind === "length" ? fieldLength(value) : String(value ?? ""));
  }
  put("blocked", (vise.blocked ?? []).join(", "));
  put("tolerance-peg", fieldLength(state.tolerance?.peg));
  put("tolerance-face", fieldLength(state.tolerance?.face));
  for (const word of document.querySelectorAll(".unit")) word.textContent = unitWord();
  /** @type {HTMLSelectElement} */ (byId("preset")).value = state.viseName || OWN;
  /** @type {HTMLSelectElement} */ (byId("unit")).value = state.unit;
  const preset = presets.find((each) => each.name === state.viseName);
  byId("preset-words").textContent = preset ? `${preset.name}. Source: ${preset.source}.` : "Own values.";
}

/** Put a value into a field that nobody is typing in. */
function put(id, value) {
  const input = field(id);
  if (input !== document.activeElement) {
    input.value = value;
    input.setAttribute("aria-invalid", "false");
  }
}
