/**
 * When a solid has no fixture with pegs as high as they are: which other heights of the pegs hold it, each tried.
 */
import { ApiError, ask, send } from "./api.js";
import { make } from "./dom.js";
import { fileRead, readOver, resumeFile, usePart } from "./part-panel.js";
import { start } from "./search.js";
import { change, request, state, workpieceForm } from "./state.js";
import { length } from "./units.js";

/** So many other heights are tried, those at which most can be touched first. */
const MOST_TRIED = 6;
const PAUSE = 300;
const ENDED = ["done", "failed", "cancelled"];
/** Of heights in mm. */
const NEAR = 1e-6;

/**
 * Faces of a part that are of the same faces of its solid as some of another outline of it.
 * @param {any} part
 * @param {any} other
 * @param {number[]} numbers faces of the other
 */
export function sameFaces(part, other, numbers) {
  return facesOver(part, new Set(numbers.flatMap((face) => solidFaces(other, face))));
}

/** Faces of the solid over a face of an outline of it. */
function solidFaces(part, face) {
  return part.segments.filter((segment) => segment.face === face).flatMap(({ number }) => part.solid.faces[number]);
}

/** Faces of an outline that some faces of the solid are over. @param {any} part @param {Set<number>} over */
function facesOver(part, over) {
  return part.faces.map(({ number }) => number).filter((face) => solidFaces(part, face).some((one) => over.has(one)));
}

/** Faces of the solid that the first side cuts, whether the outline of the second shows them or not. @type {number[]} */
let cutBefore = [];

/** Remember what a set-up cuts, for its other side. @param {any} part @param {number[]} cut */
export function rememberCut(part, cut) {
  cutBefore = cut.flatMap((face) => solidFaces(part, face));
}

/** What must not be touched of another outline: faces ruled out on the one shown, and those that the first side cuts. */
function ruledOut(other, part) {
  const shown = state.avoid.flatMap((face) => solidFaces(part, face));
  return facesOver(other, new Set([...shown, ...(state.sides?.shown ? cutBefore : [])]));
}

/**
 * Other heights to try, in mm.
 * @param {{low: number, high: number, touchable: number}[]} heights as the server tells them of a solid
 * @param {number} used the height of the pegs now
 */
export function otherHeights(heights, used) {
  return heights
    .filter(({ low, high, touchable }) => touchable > 0 && !(low < used - NEAR && used <= high + NEAR))
    .sort((a, b) => b.touchable - a.touchable || b.high - a.high)
    .slice(0, MOST_TRIED)
    .map(({ high }) => high);
}

/**
 * Try other heights of the pegs one after the other, and offer those that hold the part.
 * @param {string} job the search that found nothing
 * @returns {HTMLElement|null} what tells it; null where the part is not a solid whose file is at hand
 */
export function heightHelp(job) {
  const { part } = state;
  const read = fileRead();
  if (!part?.solid?.faces?.length || !read) return null;
  const heights = otherHeights(read.survey.heights ?? [], part.solid.peg_height);
  if (!heights.length) return null;
  const words = make("p.small", { id: "height-words" });
  const buttons = make("div.helps");
  tryEach(job, part, heights, words, buttons);
  return make("div", { id: "height-help" }, make("h3", {}, "Pegs of another height"), words, buttons);
}

/** Try heights as long as the search that found nothing is the one on show. */
async function tryEach(job, part, heights, words, buttons) {
  const gone = () => state.job?.job !== job;
  let helping = 0;
  try {
    for (const [k, height] of heights.entries()) {
      words.textContent = `Trying pegs of ${length(height, 2)}, height ${k + 1} of ${heights.length} …`;
      const found = await tried(part, height, gone);
      if (gone()) return;
      if (!found) continue;
      helping += 1;
      buttons.append(make("button", { type: "button", "data-height": height, click: () => take(found, part) }, `Pegs of ${length(height, 2)} hold the part`));
    }
    words.textContent = helping ? "Pegs of these heights hold the part, on the faces that may be touched:"
      : `Pegs of ${heights.map((height) => length(height, 2)).join(", ")} do not hold the part either: try another side up, or another toolkit.`;
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    words.textContent = error.message;
  }
}

/** How the part is read with pegs of a height, and what must not be touched then, where that has a fixture; else null. */
async function tried(part, height, gone) {
  const read = await readOver({ peg_height: height });
  const other = read.survey.part;
  if (!other?.solid?.faces?.length || gone()) return null;
  const avoid = ruledOut(other, part);
  if (avoid.length === other.faces.length) return null;
  const asked = request();
  const body = { ...asked, workpiece: workpieceForm(other), restrictions: { ...asked.restrictions, avoid }, best: 1 };
  const { job } = await send("jobs?when_left=cancel", body);
  try {
    for (;;) {
      const answer = await ask(`jobs/${encodeURIComponent(job)}`);
      if (ENDED.includes(answer.state)) return answer.found ? { read, other } : null;
      if (gone()) return null;
      await new Promise((resolve) => setTimeout(resolve, PAUSE));
    }
  } finally {
    ask(`jobs/${encodeURIComponent(job)}`, { method: "DELETE" }).catch(() => {});
  }
}

/** Go on with pegs of a height that holds the part; what was ruled out stays so. */
function take({ read, other }, part) {
  const avoid = ruledOut(other, part);
  resumeFile(read);
  usePart(other, { ...read.survey, chosen: read.how.part_number ?? null });
  change({ cut: state.sides?.shown ? [] : null, avoid });
  start();
}
