/**
 * What carriers with heights of their own meet of a solid: read from its file before a search needs it.
 */
import { ApiError, surveyPart } from "./api.js";
import { fileRead } from "./part-panel.js";
import { state } from "./state.js";
import { kindOf, same } from "./toolkits.js";

/**
 * The heights of a toolkit's carriers that have their own, by role, in mm.
 * @param {any} toolkit
 * @returns {Object<string, number[]>}
 */
export function heightsOf(toolkit) {
  if (toolkit.parallels !== undefined) return heightsOfJaws(toolkit);
  const { roles } = kindOf(toolkit);
  return Object.fromEntries(Object.keys(roles).filter((name) => toolkit[name]).map((name) => [roles[name], toolkit[name]]));
}

/** What two flat jaws cover of a part on each height of parallels, under the names that the server has for them. */
function heightsOfJaws({ jaw_height: high, parallels }) {
  if (!high) return {};
  const tops = (parallels.length ? parallels : [0]).map((under) => high - under).filter((top) => top > 0);
  return Object.fromEntries(tops.map((top) => [`jaws up to ${Number(Number(top.toFixed(6)).toPrecision(6))} mm`, [0, top]]));
}

/** See to it that the part shown has the outlines that the toolkit's carriers meet. */
export function readOutlines() {
  return outlinesOf(state.part, fileRead());
}

/**
 * See to it that a part has the outlines that the toolkit's carriers meet.
 * @param {any} part
 * @param {{file: File, how: import("./file-questions.js").How}|null} read its file, and how it was read
 */
export async function outlinesOf(part, read) {
  const { toolkit } = state;
  const heights = heightsOf(toolkit);
  const missing = Object.keys(heights).filter((role) => !same(part.outlines?.[role]?.heights, heights[role]));
  if (!part.solid || !missing.length) return;
  if (!read) throw new ApiError(`The ${missing[0]} touches at heights of its own, and what it meets there is read from the part’s STEP file: open it again.`, 400);
  const survey = await surveyPart(read.file, { ...read.how, heights: JSON.stringify(heights) });
  if (!survey.part) throw new ApiError(survey.error, 400);
  // The part stays the same one: nobody has to be told of it.
  part.outlines = survey.part.outlines;
  part.own_faces = survey.part.own_faces;
}
