/**
 * Which fixture is shown, and stepping through the list in the order that it has.
 */
import { ask } from "./api.js";
import { change, state } from "./state.js";

/** @type {import("./rows.js").Rows|null} the rows of the list */
let rows = null;

/** Step through these rows from now on. */
export function selectFrom(list) {
  rows = list;
}

/**
 * Show a fixture.
 * @param {any} row
 * @param {number} index its place in the list, -1 where it has none
 */
export function select(row, index) {
  change({ selected: row, index, view: "fixture" });
}

/**
 * Show the next fixture of the list, or the one before.
 * @param {number} by 1 or -1
 */
export async function step(by) {
  const from = rows;
  if (!from?.total) return;
  const next = Math.min(from.total - 1, Math.max(0, state.index + by));
  if (next === state.index) return;
  const row = await from.whenAt(next);
  if (row && from === rows) select(row, next);
}

/**
 * Show the fixture of a rank, wherever it is in the list.
 * @param {number} rank
 */
export async function selectRank(rank) {
  const job = state.job?.job;
  if (!job) return;
  const row = await rowOfRank(job, rank);
  if (!row || state.job?.job !== job) return;
  const plain = state.list.sort === "rank" && !state.list.descending && !state.list.type && !state.list.face && !state.list.angle;
  select(row, plain ? rank - 1 : -1);
}

/**
 * A fixture by its rank; null when there is none.
 * @param {string} job
 * @param {number} rank
 */
export async function rowOfRank(job, rank) {
  try {
    return await ask(`jobs/${encodeURIComponent(job)}/fixtures/${rank}`);
  } catch {
    return null;
  }
}
