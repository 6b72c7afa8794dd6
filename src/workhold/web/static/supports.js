/**
 * What is asked of supports under the part and a clamp on top, as the server takes it; lengths in mm.
 */
import { centerOf } from "./forces.js";
import { loadOf } from "./forces-panel.js";
import { boundsOf, segmentsOf } from "./geometry.js";
import { takesRawBlock } from "./questions.js";
import { state } from "./state.js";

/**
 * @typedef {Object} Wish
 * @property {boolean} [open] whether the supports are shown; where nobody said, those of a solid are
 * @property {number|null} [thickness] of a part from a drawing
 * @property {number|null} [pad_radius] the usual one where it is not given
 * @property {number|null} [tip_radius] likewise
 * @property {number[]|null} [axial] least and greatest force downward in N
 * @property {number[]|null} [heights] at which the load acts, in mm; null is the upper side
 * @property {number[][][]} below zones that no pad stands in
 * @property {number[][][]} above zones that the clamp does not stand in
 * @property {number} [chosen] of the sets that are answered, from 1
 */

/** Sets of three supports that are shown. */
const BEST = 3;

/** Whether the supports of the fixture are shown. */
export function areShown({ supports, part } = state) {
  // Between flat jaws the part lies on parallels.
  return !takesRawBlock() && (supports.open ?? Boolean(part?.solid));
}

/** How thick the part is in mm; null where nobody knows. */
export function thicknessOf({ part, asked, supports, sheet } = state) {
  return part?.solid?.height ?? asked?.thickness ?? supports.thickness ?? sheet.thickness ?? null;
}

/** The loads on the part: the force that is pushed with and that of a tool downward, and those that the search ranks by. */
export function spatialLoads({ force, loads, supports, part } = state) {
  const pushed = force && (force.size > 0 || force.moment) ? loadOf(force) : null;
  const others = loads.filter((load) => load.name !== pushed?.name);
  const down = supports.axial?.some((value) => value !== 0) ? supports.axial : null;
  if (!pushed && !down) return others;
  const bounds = part.bounds ?? boundsOf(part.loops.flatMap(segmentsOf));
  const [x, y] = force ? [force.x, force.y] : centerOf({ bounds });
  const own = pushed ?? { name: "tool", points: [[x, y]], force: 0, directions: [0, 360], moment: 0 };
  return [...others, { ...own, axial: down ?? [0, 0], heights: supports.heights ?? null }];
}

/** The request for the supports of a state; null where the thickness is not known. @param {any} [of] */
export function supportsRequest(of = state) {
  const { part, supports, force, unit } = of;
  const thickness = thicknessOf(of);
  if (!part || thickness === null) return null;
  return {
    thickness: part.solid ? null : thickness,
    pad_radius: supports.pad_radius ?? null, tip_radius: supports.tip_radius ?? null,
    bottom_zones: supports.below, top_zones: supports.above,
    loads: spatialLoads(of), jaw_force: force?.jaw ?? null, best: BEST, unit,
  };
}

/** As a value of an address: which set stands on the sheet and in three dimensions; nothing where none is shown. */
export function supportsQuery(of = state) {
  const request = areShown(of) ? supportsRequest(of) : null;
  return request && of.supports.chosen !== 0 ? { supports: JSON.stringify({ ...request, chosen: of.supports.chosen ?? 1 }) } : {};
}
