/**
 * Supports under the part and the clamp on top over the plan of a fixture, in mm in the toolkit's frame.
 */
import { draw } from "./dom.js";

/** @typedef {{pads: number[][], carriers: number[], pad_radius: number, tip_radius: number, at: number[], nearest: number[]}} Shown */

/**
 * The pads that stand in one of the carriers.
 * @param {Shown|null} supports
 * @param {number} carrier
 */
export function supportPads(supports, carrier) {
  if (!supports) return [];
  const own = supports.pads.filter((_, k) => supports.carriers[k] === carrier);
  return own.map(([x, y]) => draw("circle.support-pad", { cx: x, cy: y, r: supports.pad_radius }));
}

/**
 * The triangle of the supports, the clamp's tip in it, and its distance from the side about which the part would tip first.
 * @param {Shown|null} supports
 */
export function clampFromAbove(supports) {
  if (!supports) return [];
  const { pads, at: [x, y], nearest, tip_radius: radius } = supports;
  const cross = radius / 2;
  return [
    draw("path.support-triangle", { d: `M${pads.map((pad) => pad.join(" ")).join("L")}Z` }),
    draw("path.tipping-arm", { d: `M${x} ${y}L${nearest.join(" ")}` }),
    draw("circle.clamp-tip", { cx: x, cy: y, r: radius }),
    draw("path.clamp-cross", { d: `M${x - cross} ${y}H${x + cross}M${x} ${y - cross}V${y + cross}` }),
  ];
}
