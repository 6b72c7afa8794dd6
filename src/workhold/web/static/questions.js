/**
 * What is asked of a search and of a sheet: fields drawn from the server's description, and their values by its names.
 */
import { ask } from "./api.js";
import { field as input, quiet } from "./dom.js";
import { kindOf, same } from "./toolkits.js";
import { idOf, makeFields, readField, writeField } from "./toolkit-fields.js";
import { change, on, state } from "./state.js";

/** @typedef {import("./toolkits.js").Field & {section: string|null, help: string, needs: string}} Question */

/** @type {Object<string, Question[]>} */
let questions = {};

/** Learn what is asked. */
export async function learnQuestions() {
  questions = await ask("questions");
}

/** The fields of a question. @param {string} name */
export const askedOf = (name) => questions[name] ?? [];

/**
 * Draw fields of a question into an element, and keep what is typed there in the state.
 * @param {HTMLElement} place
 * @param {string} key of the state: the values by their names, without those left out
 * @param {Question[]} fields
 */
export function askIn(place, key, fields) {
  // What is ticked comes last, in lines of its own.
  place.append(...[false, true].flatMap((ticked) => fields.filter(({ form }) => (form === "flag") === ticked).flatMap(makeFields)));
  const read = () => {
    const values = { ...state[key] };
    for (const field of fields) {
      const { value, wrong } = readField(field, values[field.name]);
      if (wrong) continue;
      if (value === null) delete values[field.name];
      else values[field.name] = value;
    }
    if (!same(values, state[key])) change({ [key]: values });
  };
  const write = () => {
    for (const field of fields) {
      writeField(field, state[key][field.name] ?? null);
      if (field.needs) input(idOf(field)).disabled = !state[key][field.needs];
    }
  };
  place.addEventListener("input", quiet(read, 250));
  place.addEventListener("change", read);
  on([key, "unit"], write);
  write();
}

/** Whether flat jaws or straps hold the part, and not pegs. */
export function holdsByFriction() {
  return Boolean(state.toolkit && kindOf(state.toolkit)?.by_friction);
}

/** Whether the toolkit can hold a raw block, which pegs and straps cannot. */
export const takesRawBlock = () => state.toolkit?.parallels !== undefined;

/** What is asked of a search, without what needs something that is not asked, and what is of friction, or of pegs, alone. */
export function askedOfSearch() {
  const { asked } = state;
  const suits = ({ section }) => (section === "Loads" ? holdsByFriction() : section !== "Seating" || !holdsByFriction());
  const isAsked = (question) => question.name in asked && (!question.needs || question.needs in asked) && suits(question) && (question.name !== "raw" || takesRawBlock());
  const kept = askedOf("search").filter(isAsked);
  return Object.fromEntries(kept.map(({ name }) => [name, asked[name]]));
}
