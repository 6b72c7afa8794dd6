/**
 * What keeps its size on the drawing of a fixture: names of holes and faces, the travel, arrows of forces.
 */
import { draw } from "./dom.js";
import { along, apart, isFree } from "./labels.js";
import { columnLetters, place } from "./pose.js";
import { programLabel } from "./program-drawing.js";
import { forceAlone, length, number } from "./units.js";

const LONGEST = 62;
const SHORTEST = 20;
const NEXT_LINE = 28;

/**
 * Draw the lettering of a fixture for the view as it is.
 * @param {import("./fixture-drawing.js").FixtureDrawing} drawing
 */
export function drawLettering(drawing) {
  const { overlay } = drawing.view;
  const closed = drawing.open === 0 && drawing.lying === null;
  const axes = [...columnNames(drawing), ...rowNames(drawing)];
  const dimensions = travels(drawing);
  const parts = [...axes.map(({ text, x, y, kind, anchor }) => word(text, [x, y], kind, anchor)), ...dimensions.flatMap(({ nodes }) => nodes)];
  if (closed) {
    parts.push(...forces(drawing).map(({ tail, tip, kind }) => arrow(tail, tip, kind)));
    if (drawing.load) parts.push(...loadArrow(drawing));
  }
  parts.push(...labels(drawing, closed, [...axes.filter(({ kind }) => kind === USED), ...dimensions]));
  overlay.replaceChildren(...parts, ...programLabel(drawing), ...drawing.extras());
}

/**
 * An arrow from pixel to pixel.
 * @param {number[]} tail
 * @param {number[]} tip
 * @param {string} kind a class
 */
export function arrow(tail, tip, kind) {
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

/** A word at a pixel. */
function word(text, [x, y], kind, anchor = "middle") {
  return draw(`text.${kind}`, { x, y, "text-anchor": anchor, dy: "0.36em" }, text);
}

/** The class of the name of a column or row in which something stands. */
const USED = "hole-axis used";

/** The name of a column or a row, and the room that it takes. */
function axisName(text, [x, y], peg, anchor = "middle") {
  const w = 8 * text.length;
  const middle = anchor === "middle" ? x : anchor === "end" ? x - w / 2 : x + w / 2;
  return { text, x, y, anchor, kind: peg ? USED : "hole-axis", room: { x: middle, y, w, h: 12 } };
}

/** Letters above the columns, as many as there is room for; those with pegs always. */
function columnNames(drawing) {
  const { view, row } = drawing;
  return row.carriers.flatMap((carrier) => {
    const names = [];
    const [dx, dy] = drawing.shift(carrier);
    const step = Math.max(1, Math.ceil(22 / (carrier.pitch[0] * view.k)));
    // Holes before column A and below row 1 have no names.
    for (let column = Math.max(carrier.columns[0], 0); column <= carrier.columns[1]; column += 1) {
      const peg = carrier.used_columns.includes(column);
      if (!peg && column % step) continue;
      const [px, py] = view.page([place(carrier, column, 0)[0] + dx, carrier.plate[3] + dy]);
      names.push(axisName(columnLetters(column), [px, py - 11], peg));
    }
    return names;
  });
}

/** Numbers beside the rows. */
function rowNames(drawing) {
  const { view, row } = drawing;
  return row.carriers.flatMap((carrier) => {
    const names = [];
    const [dx, dy] = drawing.shift(carrier);
    const right = carrier.names_at === "right";
    const step = Math.max(1, Math.ceil(17 / (carrier.pitch[1] * view.k)));
    for (let index = Math.max(carrier.rows[0], 0); index <= carrier.rows[1]; index += 1) {
      const peg = carrier.used_rows.includes(index);
      if (!peg && (index + 1) % step) continue;
      const [px, py] = view.page([carrier.plate[right ? 2 : 0] + dx, place(carrier, 0, index)[1] + dy]);
      names.push(axisName(String(index + 1), [px + (right ? 9 : -9), py], peg, right ? "start" : "end"));
    }
    return names;
  });
}

/** Whether a carrier slides up or down rather than across. */
const runsUp = ({ clamping }) => Math.abs(clamping[1]) > Math.abs(clamping[0]);

/** A value between two limits; nearer to the lower one where they leave no room. */
const between = (value, low, high) => Math.max(low, Math.min(value, high));

/** How far a carrier has slid, as a dimension above the plates, or at their right when it slides upward. */
function travels(drawing) {
  const { view, row } = drawing;
  const [width, height] = view.size;
  const plates = row.carriers.map(({ plate }) => plate);
  const [right, top] = view.page([2, 3].map((side) => Math.max(...plates.map((plate) => plate[side]))));
  const sliding = row.carriers.filter((carrier) => carrier.clamping);
  return sliding.flatMap((carrier, number) => {
    if (!carrier.measured) return [];
    const setting = row.settings[number];
    const upright = runsUp(carrier);
    const [dx, dy] = drawing.shift(carrier);
    const [start, end] = carrier.measured;
    const [a, b] = [view.page(start), view.page([end[0] + dx, end[1] + dy])].map((p) => p[upright ? 1 : 0]).sort((p, q) => p - q);
    // Of two along the same way the second stands farther out.
    const nearer = sliding.slice(0, number).filter((each) => each.measured && runsUp(each) === upright).length;
    const rim = upright ? right + 16 + NEXT_LINE * nearer : top - 30 - NEXT_LINE * nearer;
    const line = (x1, y1, x2, y2) => draw("line.dimension", upright ? { x1: y1, y1: x1, x2: y2, y2: x2 } : { x1, y1, x2, y2 });
    const text = `${setting.sign} = ${length(drawing.open ? (b - a) / view.k : setting.length)}`;
    const wide = 8.2 * text.length + 10;
    const above = upright || b - a < wide + 24;
    // A long word stays in the drawing, and off one that runs upward beside it.
    const beside = !upright && above && sliding.some((each) => each.measured && runsUp(each)) ? right + 12 : width;
    const [x, y] = upright
      ? [rim + 15, between((a + b) / 2, wide / 2, height - wide / 2)]
      : [between((a + b) / 2, wide / 2, beside - wide / 2), rim - (above ? 13 : 0)];
    const heads = [[a, 1], [b, -1]].map(([at, way]) =>
      draw("path.dimension-head", { d: upright ? `M${rim} ${at}l-3.2 ${way * 9}h6.4Z` : `M${at} ${rim}l${way * 9} -3.2v6.4Z` }),
    );
    const words = word(text, [x, y], "dimension-text");
    // Along its line, as on a drawing: beside it there may be no room.
    if (upright) words.setAttribute("transform", `rotate(-90 ${x} ${y})`);
    const back = above ? [] : [draw("rect.label-back", { x: x - wide / 2, y: y - 9, width: wide, height: 18 })];
    const room = upright ? { x, y, w: 18, h: wide } : { x, y, w: wide, h: 18 };
    return [{ room, nodes: [line(a, rim - 5, a, rim + 12), line(b, rim - 5, b, rim + 12), line(a, rim, b, rim), ...heads, ...back, words] }];
  });
}

/** Degrees to either side of the wanted way, and how many times as far, a label may stand; those wanted most first. */
const TURNS = [0, 25, -25, 50, -50, 80, -80, 115, -115, 150, -150, 180];
const FARTHER = [1, 1.4, 1.9];

/** Places around a middle: on an ellipse towards a unit vector (y downward), and then ever more aside and farther. */
function around([x, y], [ux, uy], [far, high]) {
  return FARTHER.flatMap((times) => TURNS.map((turn) => {
    const [c, s] = [Math.cos((turn * Math.PI) / 180), Math.sin((turn * Math.PI) / 180)];
    return { x: x + times * far * (c * ux - s * uy), y: y + times * high * (s * ux + c * uy) };
  }));
}

/** Labels of the pegs' holes, on the side away from the part; that of a clamp beside its body. */
function holeLabels(drawing) {
  const { row, view, contacts } = drawing;
  const radius = pegSize(drawing);
  return pegCenters(drawing).map((center, k) => {
    const [nx, ny] = contacts[k].normal;
    const w = 8.4 * row.holes[k].length + 12;
    const pushed = row.carriers.find((each) => each.clamp && each.pegs.includes(k));
    const [middle, way] = pushed
      ? [pushed.clamp.hole ? view.page(pushed.clamp.hole) : center, pushed.clamping[0] ? [0, 1] : [-1, 0]]
      : [center, [nx, -ny]];
    return { center, text: row.holes[k], w, h: 20, places: around(middle, way, [radius + 10 + w / 2, radius + 19]) };
  });
}

/** Labels of the supports' holes, on the side away from the clamp, and of the clamp on top. */
function padLabels(drawing) {
  const { supports, view, row } = drawing;
  if (!supports) return [];
  const clamp = view.page(supports.at);
  const label = (center, way, text, radius, kind) => {
    const w = 7.6 * text.length + 12;
    return { center, text, w, h: 20, kind, places: around(center, way, [radius + 8 + w / 2, radius + 16]) };
  };
  const pads = supports.pads.map((at, k) => {
    const [dx, dy] = drawing.shift(row.carriers[supports.carriers[k]]);
    const [x, y] = view.page([at[0] + dx, at[1] + dy]);
    const far = Math.hypot(x - clamp[0], y - clamp[1]) || 1;
    return label([x, y], [(x - clamp[0]) / far, (y - clamp[1]) / far], supports.holes[k], supports.pad_radius * view.k, ".support");
  });
  if (drawing.open) return pads;
  const words = supports.clamp_force === null ? "clamp" : `clamp ${forceAlone(Math.ceil(supports.clamp_force))}`;
  return [...pads, label(clamp, [0.6, -0.8], words, supports.tip_radius * view.k, ".from-above")];
}

/** What supports and the clamp on top take of the drawing, in pixels. */
function supportRooms({ supports, view, lying, open }) {
  if (!supports || lying) return [];
  const room = ([x, y], radius) => ({ x, y, w: 2 * radius * view.k, h: 2 * radius * view.k });
  const pads = supports.pads.map((at) => room(view.page(at), supports.pad_radius));
  return open ? [] : [...pads, room(view.page(supports.at), supports.tip_radius)];
}

/** Where the pegs are shown, in pixels. */
function pegCenters(drawing) {
  const { row, view } = drawing;
  const shifts = new Map(row.carriers.flatMap((each) => each.pegs.map((k) => [k, drawing.shift(each)])));
  return row.pegs.map(([x, y], k) => view.page([x + shifts.get(k)[0], y + shifts.get(k)[1]]));
}

/** How large the largest peg is shown, in pixels. */
function pegSize({ row, view }) {
  return Math.max(...row.carriers.map((each) => each.peg_radius * view.k), 4);
}

/** Pixels along a face from its contact at which its number may stand, those wanted most first. */
const BESIDE = [20, -20, 34, -34, 50, -50, 68, -68];

/** Labels of the numbers of touched faces, each with the places beside its contact where it may be, inside the part. */
function faceLabels({ row, view, contacts }) {
  const seen = new Set();
  return contacts.flatMap(({ at, normal: [nx, ny] }, k) => {
    if (seen.has(row.faces[k]) || row.corners.includes(k)) return [];
    seen.add(row.faces[k]);
    const [x, y] = view.page(at);
    const places = BESIDE.map((aside) => ({ x: x - 14 * nx + aside * ny, y: y + 14 * ny + aside * nx }));
    return [{ places, w: 19, h: 19, text: String(row.faces[k]) }];
  });
}

/** Whether a label is to be seen whole; what it is of may have been moved out of sight. */
function isWithin({ x, y, w, h }, [width, height]) {
  return x - w / 2 >= 1 && x + w / 2 <= width - 1 && y - h / 2 >= 1 && y + h / 2 <= height - 1;
}

/** Names of holes, numbers of faces and the size of the load, none on another, on a peg or on an arrow. */
function labels(drawing, closed, axes) {
  const radius = pegSize(drawing);
  const taken = axes.map(({ room }) => room);
  taken.push(...pegCenters(drawing).map(([x, y]) => ({ x, y, w: 2 * radius, h: 2 * radius })));
  taken.push(...supportRooms(drawing));
  const load = closed && drawing.load ? [loadLabel(drawing)] : [];
  if (closed) taken.push(...forces(drawing).flatMap(({ tail, tip }) => along(tail, tip, 8)));
  if (load.length) taken.push(...along(load[0].tail, load[0].tip, 10));
  const faces = closed ? faceLabels(drawing) : [];
  const holes = [...holeLabels(drawing), ...(drawing.lying ? [] : padLabels(drawing))];
  // Where there is room for none they are pushed apart at last.
  const crowded = [];
  for (const label of [...load, ...holes, ...faces]) {
    const inside = label.places.filter((place) => isWithin({ ...label, ...place }, drawing.view.size));
    const free = inside.find((place) => isFree({ ...label, ...place }, taken));
    Object.assign(label, free ?? inside[0] ?? label.places[0]);
    if (free) taken.push(label);
    else crowded.push(label);
  }
  apart(crowded, taken);
  return [
    ...faces.flatMap(({ x, y, text }) => [draw("circle.face-label", { cx: x, cy: y, r: 9.5 }), word(text, [x, y], "face-name")]),
    ...holes.flatMap(({ x, y, w, center, text, kind = "" }) => [
      draw(`line.label-lead${kind}`, { x1: center[0], y1: center[1], x2: x, y2: y }),
      draw(`rect.hole-label${kind}`, { x: x - w / 2, y: y - 10, width: w, height: 20, rx: 4 }),
      word(text, [x, y], "hole-name"),
    ]),
    ...load.map(({ x, y, text }) => word(text, [x, y], "load-text")),
  ];
}

/** The force of each peg on the part; with a load those that resist it, drawn outward where a peg would have to pull. */
function forces({ row, view, contacts, load }) {
  const sizes = load ? load.forces : row.forces;
  const largest = Math.max(...sizes.map(Math.abs), 1e-12);
  return contacts.flatMap(({ at, normal }, k) => {
    const share = Math.abs(sizes[k]) / largest;
    if (load && share < 0.004) return [];
    const long = SHORTEST + (LONGEST - SHORTEST) * share;
    const way = sizes[k] < 0 ? 1 : -1;
    const tail = view.page(at);
    const tip = [tail[0] + way * long * normal[0], tail[1] - way * long * normal[1]];
    return [{ tail, tip, kind: sizes[k] < 0 ? "pull" : "push" }];
  });
}

/** The ends of the load's arrow in pixels, and its label beyond the tip. */
function loadLabel({ view, load }) {
  const tail = view.page(load.at);
  const tip = view.page([load.at[0] + load.vector[0], load.at[1] + load.vector[1]]);
  const long = Math.hypot(tip[0] - tail[0], tip[1] - tail[1]);
  const [ux, uy] = long > 1 ? [(tip[0] - tail[0]) / long, (tip[1] - tail[1]) / long] : [0, -1];
  const text = forceAlone(load.size);
  const w = 8.4 * text.length;
  return { tail, tip, text, w, h: 16, places: around(tip, [ux, uy], [8 + w / 2, 14]) };
}

/** The load itself. */
function loadArrow(drawing) {
  const { tail, tip } = loadLabel(drawing);
  return [arrow(tail, tip, "load"), draw("circle.load-handle", { cx: tail[0], cy: tail[1], r: 6 })];
}
