/**
 * The state of the page in one place, and who wants to know when it changes.
 *
 * Settings are what a search depends on; when one of them changes, what was found before is stale.
 */

import { askedOfSearch, holdsByFriction, takesRawBlock } from "./questions.js";

/** Keys of the state that a search depends on. */
export const SETTINGS = [
  "part", "toolkit", "types", "listing", "every", "asked", "ruledOut", "avoid", "zones", "angles", "tolerance", "loads", "ranking", "prefer", "program",
];

/**
 * @typedef {Object} State
 * @property {any} part the part as the server tells it, or null
 * @property {string} reading what the part is being read from; empty where none is read
 * @property {string} toolkitName the preset chosen; "own" for own values
 * @property {any} toolkit kind and fields of the toolkit in mm
 * @property {string} unit "mm" or "inch", for reading and typing only
 * @property {string[]|null} types names of the arrangements sought; null is all
 * @property {"all"|null} listing of two clamps every pair of each seat; null is the best of each
 * @property {boolean} every whether all fixtures are wanted, however many there are
 * @property {Object<string, any>} asked what else is asked of the fixtures, by the server's names; lengths in mm
 * @property {Object<string, any>} ruledOut what else is ruled out, by the server's names
 * @property {number[]} avoid faces not to touch
 * @property {number[][][]} zones loops of [x, y, bulge] in part coordinates
 * @property {number[][]} angles ranges in degrees
 * @property {{peg: number, face: number}|null} tolerance in mm
 * @property {any[]} loads that the search ranks by
 * @property {string[]|null} ranking
 * @property {string|null} prefer what is wanted most, where no figures are named to rank by
 * @property {any} job the search as the server tells it, or null
 * @property {{sort: string, descending: boolean, type: string, face: string, angle: string, each: boolean, unfit: boolean}} list with near copies one by one, and with what is none for a workshop
 * @property {any} selected the fixture shown
 * @property {number} index its place in the list, -1 where it is not known
 * @property {any} pinned the fixture it is compared with, or null
 * @property {string} view "part", "fixture" or "draw"
 * @property {{x: number, y: number, size: number, direction: number, moment: number, jaw: number|null, kind?: string|number}|null} force with the force and kind of the jaw
 * @property {import("./trial.js").Trial|null} trial the part in the hand
 * @property {number[]|null} cut faces that this set-up cuts, so that the second side is not held by them; null is those not to touch
 * @property {import("./set-ups.js").Sides|null} sides both sides of a part that is turned over, or null
 * @property {import("./supports.js").Wish} supports what supports under the part and the clamp on top are
 * @property {import("./program-panel.js").Wish|null} program that the machine runs while the part is held
 * @property {any} programRead what the server understood of it, or null
 * @property {string|null} programName which a link speaks of
 * @property {Object<string, any>} sheet what stands on the setup sheet besides: wishes by the server's names, lengths in mm
 */

/** @type {State} */
export const state = {
  part: null,
  reading: "",
  toolkitName: "",
  toolkit: { pitch: [10, 10], columns: 2, peg_radius: 3 },
  unit: "mm",
  types: null,
  listing: null,
  every: false,
  asked: {},
  ruledOut: {},
  avoid: [],
  zones: [],
  angles: [],
  tolerance: null,
  loads: [],
  ranking: null,
  prefer: null,
  job: null,
  list: { sort: "rank", descending: false, type: "", face: "", angle: "", each: false, unfit: false },
  selected: null,
  index: -1,
  pinned: null,
  view: "part",
  force: null,
  sheet: {},
  trial: null,
  cut: null,
  sides: null,
  supports: { below: [], above: [] },
  program: null,
  programRead: null,
  programName: null,
};

/** @type {{keys: string[], call: (changed: Set<string>) => void}[]} */
const listeners = [];

/**
 * Be called whenever one of some keys has changed.
 * @param {string[]} keys
 * @param {(changed: Set<string>) => void} call
 */
export function on(keys, call) {
  listeners.push({ keys, call });
}

/**
 * Change the state and tell those who asked.
 * @param {Partial<State>} patch
 */
export function change(patch) {
  const changed = new Set(Object.keys(patch).filter((key) => patch[key] !== state[key]));
  if (!changed.size) return;
  Object.assign(state, patch);
  for (const { keys, call } of listeners) if (keys.some((key) => changed.has(key))) call(changed);
}

/** A program as the server takes it. @param {import("./program-panel.js").Wish} program */
export function programRequest(program) {
  return { ...program };
}

/** A part as the server takes it, under its own name or another. @param {any} part */
export function workpieceForm(part, name = part.name) {
  return { name, loops: part.loops, departure: part.departure ?? 0, solid: part.solid ?? null, outlines: part.outlines ?? {} };
}

/** What is asked where friction holds the part: how thick a drawn one is, and the coefficient of friction. */
function frictionAsked() {
  const { asked, part, supports, sheet } = state;
  const value = asked.friction;
  return {
    ...(part?.solid ? {} : { thickness: asked.thickness ?? supports?.thickness ?? sheet?.thickness ?? null }),
    ...(value === undefined ? {} : { friction: takesRawBlock() ? { jaw: value } : { plate: value, tip: value } }),
  };
}

/** The figures to rank by, without one that pegs alone have. */
const rankingByFriction = () => (state.ranking?.includes("load_reaction") ? null : state.ranking);

/** What the server is asked to search. */
export function request() {
  return {
    workpiece: workpieceForm(state.part),
    toolkit: state.toolkit,
    types: state.types,
    listing: state.listing,
    ...askedOfSearch(),
    restrictions: { avoid: state.avoid, zones: state.zones, angles: state.angles, ...state.ruledOut },
    ranking: holdsByFriction() ? rankingByFriction() : state.ranking,
    prefer: state.ranking ? null : state.prefer,
    tolerance: state.tolerance,
    loads: state.loads,
    ...(holdsByFriction() ? frictionAsked() : {}),
    ...(state.program ? { program: programRequest(state.program) } : {}),
  };
}
