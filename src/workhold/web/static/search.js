/**
 * One search at a time: submit, follow, cancel, and forget what settings have overtaken.
 *
 * A search that is asked for while the part is being read waits for it.
 *
 * Every search has a token; an answer that comes under an old one is dropped, and its job is deleted at the server.
 */
import { ApiError, ask, send } from "./api.js";
import { quiet } from "./dom.js";
import { readOutlines } from "./own-outlines.js";
import { SETTINGS, change, on, request, state } from "./state.js";

const ENDED = ["done", "failed", "cancelled"];
const POLL = 400;

let token = 0;
/** @type {EventSource|null} */
let events = null;
/** Whether a change of settings searches at once: from the first search on, until the user cancels. */
let live = false;
/** Whether settings have changed since a search was begun with them. */
let changedSince = false;
/** Whether a search was asked for that waits for the part to be read. */
let waiting = false;

/** Whether a search is under way. */
export function searching() {
  return state.job !== null && !ENDED.includes(state.job.state);
}

/** A search that the server does not have, in a state. @param {string} state */
const withoutServer = (state) => ({ job: null, state, fraction: 0, found: 0, revision: 0, notes: [] });

/** Leave the search there is: no answer of it is shown any more, and the server forgets it. */
export function leave() {
  token += 1;
  events?.close();
  events = null;
  const old = state.job?.job;
  const isKept = state.sides?.kept.some((side) => side?.job === old);
  // First nothing more is asked of it.
  change({ job: null, selected: null, pinned: null, index: -1 });
  if (old && !isKept) forget(old);
}

/** Search with the settings as they are; while a part is being read, as soon as it is. */
export async function start() {
  leave();
  changedSince = false;
  waiting = state.reading !== "";
  if (waiting) {
    change({ job: withoutServer("waiting") });
    return;
  }
  if (!state.part) return;
  live = true;
  const mine = token;
  change({ job: withoutServer("queued") });
  try {
    await readOutlines();
    if (mine !== token) return;
    const { job } = await send("jobs", { ...request(), every: state.every });
    if (mine === token) follow(job, mine);
    else forget(job);
  } catch (error) {
    if (mine === token) failed(error);
  }
}

/**
 * Take up a search that the server still knows, or search anew.
 * @param {string|null} job
 */
export async function takeUp(job) {
  const mine = ++token;
  live = true;
  if (!job) return start();
  try {
    const answer = await ask(`jobs/${encodeURIComponent(job)}`);
    if (mine !== token) return undefined;
    change({ job: answer });
    if (!ENDED.includes(answer.state)) follow(job, mine);
  } catch {
    if (mine === token) return start();
  }
  return undefined;
}

/** Stop the search; what it found so far stays where the server keeps it. */
export async function cancel() {
  const job = state.job?.job;
  if (!searching()) return;
  live = false;
  waiting = false;
  if (!job) return cancelled();
  const mine = token;
  try {
    await ask(`jobs/${encodeURIComponent(job)}/cancel`, { method: "POST" });
  } catch {
    if (mine === token) cancelled();
  }
  return undefined;
}

/** Say that the search was stopped, where the server keeps nothing of it. */
function cancelled() {
  leave();
  change({ job: withoutServer("cancelled") });
}

/** @param {string} job */
function forget(job) {
  ask(`jobs/${encodeURIComponent(job)}`, { method: "DELETE" }).catch(() => {});
}

/**
 * Show what a job does until it ends.
 * @param {string} job
 * @param {number} mine the token it runs under
 */
function follow(job, mine) {
  const source = new EventSource(`api/jobs/${encodeURIComponent(job)}/events`);
  events = source;
  source.addEventListener("state", (event) => {
    if (mine !== token) return source.close();
    const answer = JSON.parse(event.data);
    change({ job: answer });
    if (ENDED.includes(answer.state)) source.close();
    return undefined;
  });
  source.onerror = () => {
    source.close();
    if (mine === token) poll(job, mine);
  };
}

/** As {@link follow}, by asking again and again. */
async function poll(job, mine) {
  while (mine === token && searching()) {
    try {
      const answer = await ask(`jobs/${encodeURIComponent(job)}`);
      if (mine !== token) return;
      change({ job: answer });
    } catch (error) {
      if (mine === token) failed(error);
      return;
    }
    await new Promise((resolve) => setTimeout(resolve, POLL));
  }
}

/** Show why there is no answer. */
function failed(error) {
  const words = error instanceof ApiError ? error.message : "The search could not be started.";
  change({ job: { ...withoutServer("failed"), error: words } });
}

/** A search that was begun by hand meanwhile stays, and what its user has chosen there. */
const again = quiet(() => changedSince && live && state.part && start(), 350);

on(["reading"], () => {
  if (state.reading || !waiting) return;
  waiting = false;
  if (state.part) start();
  else leave();
});

on(SETTINGS, (changed) => {
  leave();
  changedSince = true;
  if (changed.has("part")) live = false;
  else if (live) again();
});
