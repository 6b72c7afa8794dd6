/**
 * The kinds of toolkits, as the server describes them: what each is called, and its fields.
 */
import { ask } from "./api.js";

/** @typedef {{name: string, label: string, form: string, hint: string|null, is_usual: boolean, least: string, choices: {value: any, words: string}[], when: Object<string, any>, table: string|null}} Field */
/** @typedef {{name: string, title: string, fields: Field[]}} Hardware */
/** @typedef {{name: string, kind: string, title: string, noun: string, mover: string, locked: string, closes: string, by_friction: boolean, said: Object<string, any>, start: Object<string, any>, types: {name: string, words: string}[], fields: Field[], hardware: Hardware[], roles: Object<string, string>}} Kind */

/** What a toolkit is that does not say. */
const USUAL = "vise";

/** What a toolkit has for three dimensions, and what its pins may take. */
const HARDWARE = ["supports", "top_clamp", "pins"];

/** @type {Kind[]} */
export let kinds = [];

/** Learn the kinds. */
export async function learnKinds() {
  kinds = await ask("toolkits");
}

/**
 * The kind of a toolkit's fields.
 * @param {any} toolkit
 */
export function kindOf(toolkit) {
  const name = toolkit.kind ?? USUAL;
  return kinds.find((kind) => kind.name === name) ?? kinds.find((kind) => kind.name === USUAL) ?? kinds[0];
}

/** Values that are the same to the server. */
export function same(a, b) {
  return JSON.stringify(a ?? null) === JSON.stringify(b ?? null);
}

/**
 * What a toolkit says in a field.
 * @param {any} toolkit
 * @param {Field} field
 */
export function valueOf(toolkit, { name, table }) {
  return (table ? toolkit[table] : toolkit)?.[name];
}

/**
 * Say something in a field of a toolkit; null leaves it to its usual value.
 * @param {any} toolkit
 * @param {Field} field
 * @param {any} value
 */
export function setValue(toolkit, { name, table }, value) {
  if (value === null) return;
  if (table) toolkit[table] = { ...toolkit[table], [name]: value };
  else toolkit[name] = value;
}

/**
 * The fields of a kind that there are with some values.
 * @param {Kind} kind
 * @param {any} toolkit
 */
export function fieldsOf(kind, toolkit) {
  return kind.fields.filter(({ when }) => Object.entries(when).every(([name, value]) => same(toolkit[name] ?? kind.start[name], value)));
}

/**
 * A toolkit with some fields changed; null leaves one to its usual value. A kind that says a field by its name is left for
 * the one it stands for where that field becomes another.
 * @param {any} toolkit
 * @param {Object<string, any>} fields
 */
export function withFields(toolkit, fields) {
  const kind = kindOf(toolkit);
  const left = Object.entries(kind.said).some(([name, value]) => name in fields && !same(fields[name], value));
  return tidy({ ...toolkit, ...(left ? { kind: kind.kind } : {}), ...fields });
}

/**
 * A toolkit of a kind that keeps what it can of another one.
 * @param {Kind} kind
 * @param {any} toolkit
 */
export function asKind(kind, toolkit) {
  const kept = [...kind.fields.map(({ name }) => name), ...HARDWARE].filter((name) => name in toolkit);
  return tidy({ kind: kind.name, ...kind.start, ...Object.fromEntries(kept.map((name) => [name, toolkit[name]])), ...kind.said });
}

/** Without what is null. */
function tidy(toolkit) {
  return Object.fromEntries(Object.entries(toolkit).filter(([, value]) => value !== null && value !== undefined));
}

/**
 * Words about jaws where something else presses.
 * @param {string} words
 * @param {string} mover
 */
export function pressedBy(words, mover) {
  return words.replace(/\bjaw\b/g, mover);
}
