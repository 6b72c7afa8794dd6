/**
 * Fields for the values of a toolkit or a question, made from their description: how each looks, is read and is written.
 */
import { field as input, make } from "./dom.js";
import { same } from "./toolkits.js";
import { fieldForce, fieldLength, fieldStress, forceWord, pressureWord, readForce, readLength, readNumber, readStress, unitWord } from "./units.js";

/** @typedef {import("./toolkits.js").Field} Field */

/** Labels of forms that take two inputs. */
const PAIRS = { pitch: ["x", "y"], place: ["x", "y"], span: ["least", "most"] };

/** Where a raw block is larger than the part, in the order in which that is typed. */
const MARGINS = ["side", "top", "bottom"];

/** Forms of numbers in a unit of their own, besides lengths: how they are written and read. */
const UNITS = { stress: [fieldStress, readStress], force: [fieldForce, readForce], number: [(value) => String(value ?? ""), readNumber] };

/** The name of a field's element. @param {Field} field */
export function idOf({ name, table }) {
  return [table, name].filter(Boolean).join("-").replaceAll("_", "-");
}

/** The names of the inputs of a field of one or two numbers. @param {Field} field */
function idsOf(field) {
  return PAIRS[field.form]?.map((part) => `${idOf(field)}-${part}`) ?? [idOf(field)];
}

/**
 * The elements of a field.
 * @param {Field} field
 * @returns {HTMLElement[]}
 */
export function makeFields(field) {
  const id = idOf(field);
  if (field.form === "several") {
    const boxes = field.choices.map(({ words }, k) => make("label.check", {}, make("input", { type: "checkbox", id: `${id}-${k}` }), ` ${words}`));
    return [make("fieldset.plain.wide", { id, title: field.hint }, make("legend", {}, field.label), make("div.choices", {}, ...boxes))];
  }
  if (field.form === "one") {
    const options = field.choices.map(({ words }, k) => make("option", { value: k }, words));
    return [make("label", {}, field.label, make("select", { id }, ...options))];
  }
  if (field.form === "flag") return [make("label.check.wide", { title: field.help }, make("input", { type: "checkbox", id }), ` ${field.label}`)];
  const mode = field.form === "count" ? "numeric" : ["faces", "holes", "lengths", "margins", "rings", "text"].includes(field.form) ? "text" : "decimal";
  const unit = ["length", "lengths", "margins", "pitch", "place", "span", "rings"].includes(field.form) ? [" ", make("span.unit", {}, unitWord())] : [];
  if (field.form === "stress") unit.push(" ", make("span.pressure", {}, pressureWord()));
  if (field.form === "force") unit.push(" ", make("span.force-unit", {}, forceWord()));
  return idsOf(field).map((each, k) => {
    const label = PAIRS[field.form] ? `${field.label}${field.form === "span" ? "," : ""} ${PAIRS[field.form][k]}` : field.label;
    return make("label", { title: field.help }, label, ...unit.map((part) => (typeof part === "string" ? part : part.cloneNode(true))),
      make("input", { id: each, inputmode: mode, autocomplete: "off", placeholder: field.hint }));
  });
}

/**
 * What a field holds: its value in mm, null for none, and whether it is wrong.
 * @param {Field} field
 * @param {any} known the value written last, which is kept to the last digit where its text still stands
 * @returns {{value: any, wrong: boolean}}
 */
export function readField(field, known) {
  const id = idOf(field);
  if (field.form === "several") {
    const chosen = field.choices.filter((_, k) => input(`${id}-${k}`).checked).map(({ value }) => value);
    return { value: chosen.length ? chosen : null, wrong: false };
  }
  if (field.form === "one") return { value: field.choices[Number(input(id).value)]?.value ?? null, wrong: false };
  if (field.form === "flag") return { value: input(id).checked || null, wrong: false };
  if (field.form === "text") return { value: input(id).value.trim() || null, wrong: false };
  if (field.form === "holes") {
    const names = input(id).value.split(/[\s,;]+/).filter(Boolean).map((name) => name.toUpperCase());
    return { value: names.length ? names : null, wrong: false };
  }
  if (field.form === "faces") {
    const numbers = input(id).value.split(/[\s,;]+/).filter(Boolean).map(Number);
    const wrong = !numbers.every((number) => Number.isInteger(number) && number >= 0);
    input(id).setAttribute("aria-invalid", String(wrong));
    return { value: numbers.length ? numbers : null, wrong };
  }
  if (field.form === "lengths") {
    const before = known ?? [], text = input(id).value;
    const values = text === lengthsText(before) ? before : text.split(/[\s;]+|,(?=\s)/).filter(Boolean).map(readLength);
    const wrong = !values.every((one) => Number.isFinite(one) && one >= 0);
    input(id).setAttribute("aria-invalid", String(wrong));
    return { value: values.length ? values : null, wrong };
  }
  if (field.form === "margins") {
    const margins = marginsOf(input(id).value, known);
    input(id).setAttribute("aria-invalid", String(margins === undefined));
    return { value: margins ?? null, wrong: margins === undefined };
  }
  if (field.form === "rings") {
    const rings = ringsOf(input(id).value, known);
    const wrong = rings === null;
    input(id).setAttribute("aria-invalid", String(wrong));
    return { value: rings?.length ? rings : null, wrong };
  }
  const ids = idsOf(field);
  const before = ids.length > 1 ? (known ?? []) : [known];
  const values = ids.map((each, k) => {
    const text = input(each).value;
    if (field.form === "count") return readNumber(text);
    const [written, read] = UNITS[field.form] ?? [fieldLength, readLength];
    return text !== "" && text === written(before[k]) ? before[k] : read(text);
  });
  const empty = values.every((value) => value === null);
  const wrong = values.map((value) => (value === null ? field.hint === null || !empty : !fits(field, value)));
  if (field.form === "span" && !wrong.includes(true) && !empty && values[0] > values[1]) wrong[1] = true;
  ids.forEach((each, k) => input(each).setAttribute("aria-invalid", String(wrong[k])));
  if (wrong.includes(true)) return { value: null, wrong: true };
  return { value: empty ? null : values.length > 1 ? values : values[0], wrong: false };
}

/** Lengths as they are typed, with commas between them. @param {number[]|null} lengths */
function lengthsText(lengths) {
  return (lengths ?? []).map((one) => fieldLength(one)).join(", ");
}

/** The margins of a raw block as they are typed: side, top and bottom, with commas between them. @param {Object<string, number>|null} margins */
function marginsText(margins) {
  return margins ? MARGINS.map((name) => fieldLength(margins[name] ?? 0) || "0").join(", ") : "";
}

/** Margins of a text in mm, those known where it still stands for them; null for none, undefined for anything else. */
function marginsOf(text, known) {
  if (!text.trim()) return null;
  if (text === marginsText(known)) return known;
  const bare = /^[^\s;,]+,[^\s;,]+,[^\s;,]+$/.test(text.trim());
  const values = text.trim().split(bare ? "," : /[\s;]+|,(?=\s)/).filter(Boolean).map(readLength);
  const good = values.length === MARGINS.length && values.every((one) => Number.isFinite(one) && one >= 0);
  return good ? Object.fromEntries(MARGINS.map((name, k) => [name, values[k]])) : undefined;
}

/** Rings as they are typed: x, y, least and most of each, with semicolons between them. @param {number[][]|null} rings */
function ringsText(rings) {
  return (rings ?? []).map((ring) => ring.map((one) => fieldLength(one)).join(", ")).join("; ");
}

/** Rings of a text in mm, those known where it still stands for them; null for what is none. */
function ringsOf(text, known) {
  if (text === ringsText(known)) return known ?? [];
  const rings = text.split(";").filter((part) => part.trim()).map((part) => part.split(",").map((one) => readLength(one)));
  const good = rings.every((ring) => ring.length === 4 && ring.every(Number.isFinite) && ring[2] >= 0 && ring[2] <= ring[3]);
  return good ? rings : null;
}

/** Whether a number suits a field. */
function fits({ form, least }, value) {
  if (!Number.isFinite(value)) return false;
  if (form === "count") return Number.isInteger(value) && value >= 1;
  return least === "any" || form === "place" || value > 0 || (least === "0" && value === 0);
}

/**
 * Write a value into a field that nobody is typing in.
 * @param {Field} field
 * @param {any} value
 */
export function writeField(field, value) {
  const id = idOf(field);
  if (field.form === "several") {
    field.choices.forEach((choice, k) => (input(`${id}-${k}`).checked = (value ?? []).some((each) => same(each, choice.value))));
    return;
  }
  if (field.form === "one") {
    input(id).value = String(Math.max(0, field.choices.findIndex((choice) => same(choice.value, value))));
    return;
  }
  if (field.form === "flag") {
    input(id).checked = value === true;
    return;
  }
  const ids = idsOf(field);
  const values = ids.length > 1 ? (value ?? [null, null]) : [value];
  ids.forEach((each, k) => {
    if (input(each) === document.activeElement) return;
    if (["faces", "holes"].includes(field.form)) input(each).value = (value ?? []).join(", ");
    else if (field.form === "rings") input(each).value = ringsText(value);
    else if (field.form === "margins") input(each).value = marginsText(value);
    else if (field.form === "lengths") input(each).value = lengthsText(value);
    else if (["count", "text"].includes(field.form)) input(each).value = String(values[k] ?? "");
    else input(each).value = (UNITS[field.form] ?? [fieldLength])[0](values[k]);
    input(each).setAttribute("aria-invalid", "false");
  });
}
