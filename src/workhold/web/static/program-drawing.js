/**
 * The paths of a program's tools over the part, in the part's coordinates, and the move that comes nearest to what holds it.
 */
import { draw } from "./dom.js";
import { pointAt, segmentPath, segmentsOf } from "./geometry.js";
import { length } from "./units.js";

/** A colour for each tool, in the order in which they move. */
export const COLOURS = ["#1f6fb4", "#d1660d", "#2a8f4d", "#8a4fb0", "#c0392b", "#138a8a", "#8a6d1f", "#b8437f"];

/** @param {number} place of the tool */
export const colourOf = (place) => COLOURS[place % COLOURS.length];

/**
 * The paths as the server tells them: bands as wide as the tools, rapid moves dashed, cuts darker where they are lower.
 * @param {any} read what was understood of the program, or null
 */
export function programPaths(read) {
  if (!read) return [];
  const shapes = read.paths.map(({ place, kind, level, d }) => {
    if (kind === "rapid") return draw("path.program-rapid", { d });
    const stroke = colourOf(place);
    if (kind === "band") return draw("path.program-band", { d, stroke, "stroke-width": 10 * read.tools[place].diameter, "data-tool": read.tools[place].tool });
    return draw(`path.program-${kind}`, { d, stroke, "stroke-opacity": 1 - (0.55 * level) / (read.levels - 1) });
  });
  return [draw("g.program", { transform: "scale(0.1 -0.1)", "aria-hidden": "true" }, ...shapes)];
}

/** The segment of the nearest move; null for an upright one. */
function segmentOf({ path }) {
  return path.length > 1 ? segmentsOf(path)[0] : null;
}

/**
 * The nearest move with the breadth of its tool.
 * @param {any} passing as the server tells it, or null
 */
export function nearestMove(passing) {
  if (!passing) return [];
  const segment = segmentOf(passing);
  if (!segment) {
    const [x, y] = passing.path[0];
    return [draw("circle.program-nearest-band", { cx: x, cy: y, r: passing.radius, "stroke-width": 0 }), draw("circle.program-nearest", { cx: x, cy: y, r: passing.radius })];
  }
  const d = segmentPath(segment);
  return [draw("path.program-nearest-band", { d, "stroke-width": 2 * passing.radius }), draw("path.program-nearest", { d })];
}

/** Where the label of the nearest move stands, in the part's coordinates. */
function middleOf(passing) {
  const segment = segmentOf(passing);
  return segment ? pointAt(segment, 0.5) : passing.path[0];
}

/** What the label of the nearest move says. */
export function passingLabel({ line, tool, distance }) {
  return `line ${line}, T${tool}: ${length(distance, 2)}`;
}

/**
 * The label of the nearest move in the lower corner of the drawing of a fixture, clear of all names, with a line to it.
 * @param {import("./fixture-drawing.js").FixtureDrawing} drawing
 */
export function programLabel(drawing) {
  const { passing, view } = drawing;
  if (!passing || drawing.open || drawing.lying) return [];
  const [x, y] = view.page(drawing.toVise(middleOf(passing)));
  const words = passingLabel(passing);
  const wide = 7.6 * words.length + 12;
  const low = view.size[1] - 18;
  return [
    draw("line.program-lead", { x1: x, y1: y, x2: 10 + wide / 2, y2: low }),
    draw("rect.program-label-box", { x: 10, y: low - 11, width: wide, height: 22, rx: 4 }),
    draw("text.program-label", { x: 10 + wide / 2, y: low, "text-anchor": "middle", dy: "0.36em" }, words),
  ];
}
