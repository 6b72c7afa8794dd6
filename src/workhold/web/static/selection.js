/**
 * Which fixture is shown, and stepping through the list in the order that it has.
 */
import { ask } from "./api.js";
import { byId } from "./dom.js";
import { UNITS } from "./fixture-drawing.js";
import { change, state } from "./state.js";

let latest = 0;
/** @type {import("./rows.js").Rows|null} the rows of the list */
let rows = null;

/** Step through these rows from now on. */
export function selectFrom(list) {
  rows = list;
}

/**
 * Show the fixture of a rank, as soon as it has come, unless another one is asked for meanwhile; the list marks it at once.
 * @param {number} rank
 * @param {number} index its place in the list, -1 where it has none
 */
export async function select(rank, index) {
  const job = state.job?.job;
  const mine = ++latest;
  change({ index });
  const row = job ? await rowOfRank(job, rank) : null;
  if (row && mine === latest && state.job?.job === job) change({ selected: row, index, view: "fixture" });
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
  if (row && from === rows) await select(row.rank, next);
}

/**
 * Show the fixture of a rank, wherever it is in the list.
 * @param {number} rank
 */
export async function selectRank(rank) {
  await select(rank, rows?.placeOf(rank) ?? -1);
}

/**
 * A fixture by its rank, with a picture for a frame; null when there is none.
 * @param {string} job
 * @param {number} rank
 * @param {number[]} [frame] width and height in pixels
 */
export async function rowOfRank(job, rank, frame = frameOf()) {
  const [width, height] = frame.map((pixels) => Math.max(Math.round(pixels * UNITS), 100));
  try {
    return await ask(`jobs/${encodeURIComponent(job)}/fixtures/${rank}?width=${width}&height=${height}`);
  } catch {
    return null;
  }
}

/** Whether two rows are one fixture, whatever their ranks. */
export function isSame(row, other) {
  return String(row.holes) === String(other.holes) && String(row.faces) === String(other.faces) && Math.abs(row.theta_deg - other.theta_deg) < 1e-6;
}

/** The frame in which a fixture is shown, or would be. */
function frameOf() {
  const shown = [byId("drawing-fixture"), byId("stages")].find(({ clientWidth }) => clientWidth);
  return shown ? [shown.clientWidth, shown.clientHeight] : [560, 420];
}
