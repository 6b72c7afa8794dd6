/**
 * What lies over the picture of a fixture and keeps its size: the forces under a load, and the names of supports.
 */
import { draw } from "./dom.js";
import { around, isFree } from "./labels.js";
import { programLabel } from "./program-drawing.js";
import { forceAlone } from "./units.js";

const LONGEST = 62;
const SHORTEST = 20;
/** What names of the page's own keep off. */
const TAKEN = ".flag, .face-tag, .axis-name.used, .dimension-text, [data-peg]";

/**
 * Draw it for the view as it is.
 * @param {import("./fixture-drawing.js").FixtureDrawing} drawing
 */
export function drawOver(drawing) {
  const load = drawing.open || drawing.lying ? null : drawing.load;
  const arrows = load ? [...forces(drawing).map(({ tail, tip, kind }) => arrow(tail, tip, kind)), ...loadArrow(drawing)] : [];
  const labels = [...(load ? [loadLabel(drawing)] : []), ...(drawing.lying ? [] : padLabels(drawing))];
  drawing.arrows.replaceChildren(...arrows);
  drawing.view.overlay.replaceChildren(...placed(drawing, labels), ...programLabel(drawing), ...drawing.extras());
}

/** Labels in the first of their places that is free. */
function placed({ svg, view }, labels) {
  if (!labels.length) return [];
  const frame = svg.getBoundingClientRect();
  const taken = [...svg.querySelectorAll(TAKEN)].map((each) => each.getBoundingClientRect())
    .map(({ left, top, width: w, height: h }) => ({ x: left - frame.left + w / 2, y: top - frame.top + h / 2, w, h }));
  return labels.flatMap((label) => {
    const inside = label.places.filter((place) => isWithin({ ...label, ...place }, view.size));
    const place = inside.find((one) => isFree({ ...label, ...one }, taken)) ?? inside[0] ?? label.places[0];
    taken.push({ ...label, ...place });
    const { x, y } = place;
    const { w, kind, center, text } = label;
    const words = draw(kind ? "text.hole-name" : "text.load-text", { x, y, dy: "0.36em", "text-anchor": "middle" }, text);
    if (!kind) return [words];
    const ends = { x1: center[0], y1: center[1], x2: x, y2: y };
    return [draw(`line.label-lead${kind}`, ends), draw(`rect.hole-label${kind}`, { x: x - w / 2, y: y - 10, width: w, height: 20, rx: 4 }), words];
  });
}

/** Whether a label is to be seen whole; what it is of may have been moved out of sight. */
function isWithin({ x, y, w, h }, [width, height]) {
  return x - w / 2 >= 1 && x + w / 2 <= width - 1 && y - h / 2 >= 1 && y + h / 2 <= height - 1;
}

/**
 * An arrow from pixel to pixel.
 * @param {number[]} tail
 * @param {number[]} tip
 * @param {string} kind a class
 */
function arrow(tail, tip, kind) {
  const [dx, dy] = [tip[0] - tail[0], tip[1] - tail[1]];
  const size = Math.hypot(dx, dy) || 1;
  const [ux, uy] = [dx / size, dy / size];
  const head = Math.min(11, size);
  const base = [tip[0] - head * ux, tip[1] - head * uy];
  const wing = 0.42 * head;
  const d = `M${tip[0]} ${tip[1]}L${base[0] - wing * uy} ${base[1] + wing * ux}L${base[0] + wing * uy} ${base[1] - wing * ux}Z`;
  const line = { x1: tail[0], y1: tail[1], x2: base[0], y2: base[1] };
  return draw(
    `g.arrow.${kind}`, {},
    draw("line.arrow-halo", { ...line, x2: tip[0], y2: tip[1] }), draw("line.arrow-line", line), draw("path.arrow-head", { d }),
  );
}

/** The forces that resist the load, drawn outward where a peg would have to pull. */
function forces({ row, view, load }) {
  const largest = Math.max(...load.forces.map(Math.abs), 1e-12);
  return row.contacts.flatMap((contact, k) => {
    const share = Math.abs(load.forces[k]) / largest;
    if (share < 0.004) return [];
    const long = (SHORTEST + (LONGEST - SHORTEST) * share) * (load.forces[k] < 0 ? 1 : -1);
    const tail = view.page(contact);
    const [nx, ny] = row.normals[k];
    return [{ tail, tip: [tail[0] + long * nx, tail[1] - long * ny], kind: load.forces[k] < 0 ? "pull" : "push" }];
  });
}

/** The ends of the load's arrow in pixels. */
function loadEnds({ view, load: { at, vector } }) {
  return [view.page(at), view.page([at[0] + vector[0], at[1] + vector[1]])];
}

/** The label of the load, beyond the tip of its arrow. */
function loadLabel(drawing) {
  const [tail, tip] = loadEnds(drawing);
  const long = Math.hypot(tip[0] - tail[0], tip[1] - tail[1]);
  const way = long > 1 ? [(tip[0] - tail[0]) / long, (tip[1] - tail[1]) / long] : [0, -1];
  const text = forceAlone(drawing.load.size);
  const w = 8.4 * text.length;
  return { text, w, h: 16, kind: "", center: tip, places: around(tip, way, [8 + w / 2, 14]) };
}

/** The load itself. */
function loadArrow(drawing) {
  const [tail, tip] = loadEnds(drawing);
  return [arrow(tail, tip, "load"), draw("circle.load-handle", { cx: tail[0], cy: tail[1], r: 6 })];
}

/** Labels of the supports' holes, on the side away from the clamp, and of the clamp on top. */
function padLabels({ supports, view, row, open }) {
  if (!supports) return [];
  const clamp = view.page(supports.at);
  const label = (center, way, text, radius, kind) => {
    const w = 7.6 * text.length + 12;
    return { center, text, w, h: 20, kind, places: around(center, way, [radius + 8 + w / 2, radius + 16]) };
  };
  const pads = supports.pads.map((at, k) => {
    const { clamping } = row.carriers[supports.carriers[k]];
    const [x, y] = view.page(at.map((value, axis) => value - (clamping?.[axis] ?? 0) * open));
    const far = Math.hypot(x - clamp[0], y - clamp[1]) || 1;
    return label([x, y], [(x - clamp[0]) / far, (y - clamp[1]) / far], supports.holes[k], supports.pad_radius * view.k, ".support");
  });
  if (open) return pads;
  const words = supports.clamp_force === null ? "clamp" : `clamp ${forceAlone(Math.ceil(supports.clamp_force))}`;
  return [...pads, label(clamp, [0.6, -0.8], words, supports.tip_radius * view.k, ".from-above")];
}
