/**
 * What keeps its size on the drawing of a fixture: names of holes and faces, the jaw separation, arrows of forces.
 */
import { draw } from "./dom.js";
import { columnLetters, holeOf } from "./pose.js";
import { length, number } from "./units.js";

const LONGEST = 62;
const SHORTEST = 20;

/**
 * Draw the lettering of a fixture for the view as it is.
 * @param {import("./fixture-drawing.js").FixtureDrawing} drawing
 */
export function drawLettering(drawing) {
  const { overlay } = drawing.view;
  const closed = drawing.open === 0;
  const parts = [...columnNames(drawing), ...rowNames(drawing), ...separation(drawing)];
  if (closed) {
    parts.push(...forceArrows(drawing), ...faceNames(drawing));
    if (drawing.load) parts.push(...loadArrow(drawing));
  }
  parts.push(...holeNames(drawing));
  overlay.replaceChildren(...parts);
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

/** Letters above the columns, as many as there is room for; those with pegs always. */
function columnNames({ jaws, view, row, vise, open }) {
  const used = row.holes.map(holeOf);
  return jaws.flatMap((jaw) => {
    const names = [];
    const room = vise.pitch[0] * view.k;
    const step = Math.max(1, Math.ceil(22 / room));
    for (let column = jaw.columns[0]; column <= jaw.columns[1]; column += 1) {
      const peg = used.some((hole) => hole.right === jaw.right && hole.column === column);
      if (!peg && column % step) continue;
      const x = jaw.x0 + column * vise.pitch[0] + (jaw.right ? open : 0);
      const [px, py] = view.page([x, jaw.plate[3]]);
      names.push(word(columnLetters(column), [px, py - 11], peg ? "hole-axis used" : "hole-axis"));
    }
    return names;
  });
}

/** Numbers beside the rows. */
function rowNames({ jaws, view, row, vise, open }) {
  const used = row.holes.map(holeOf);
  return jaws.flatMap((jaw) => {
    const names = [];
    const step = Math.max(1, Math.ceil(17 / (vise.pitch[1] * view.k)));
    for (let index = jaw.rows[0]; index <= jaw.rows[1]; index += 1) {
      const peg = used.some((hole) => hole.right === jaw.right && hole.row === index);
      if (!peg && (index + 1) % step) continue;
      const x = jaw.right ? jaw.plate[2] + open : jaw.plate[0];
      const [px, py] = view.page([x, jaw.y0 + index * vise.pitch[1]]);
      const kind = peg ? "hole-axis used" : "hole-axis";
      names.push(word(String(index + 1), [px + (jaw.right ? 9 : -9), py], kind, jaw.right ? "start" : "end"));
    }
    return names;
  });
}

/** The jaw separation as a dimension above the jaws. */
function separation({ jaws, view, vise, row, open }) {
  const [left, right] = jaws;
  const last = (vise.columns - 1) * vise.pitch[0];
  const top = Math.max(left.plate[3], right.plate[3]);
  const [a, b] = [view.page([last, top]), view.page([right.x0 + open, top])];
  const y = a[1] - 30;
  const text = `S = ${length(row.jaw_separation + open)}`;
  const middle = (a[0] + b[0]) / 2;
  const wide = 8.2 * text.length + 10;
  const extension = [a, b].map(([x]) => draw("line.dimension", { x1: x, y1: y - 5, x2: x, y2: y + 12 }));
  const rule = draw("line.dimension", { x1: a[0], y1: y, x2: b[0], y2: y });
  const heads = [[a[0], 1], [b[0], -1]].map(([x, way]) =>
    draw("path.dimension-head", { d: `M${x} ${y}l${way * 9} -3.2v6.4Z` }),
  );
  const above = b[0] - a[0] < wide + 24;
  const back = draw("rect.label-back", { x: middle - wide / 2, y: y - 9 - (above ? 13 : 0), width: wide, height: 18 });
  return [...extension, rule, ...heads, above ? "" : back, word(text, [middle, y - (above ? 13 : 0)], "dimension-text")].filter(Boolean);
}

/** Places for labels of some size near anchors, pushed apart until none lies on another or on a peg. */
function apart(labels, pegs) {
  for (let round = 0; round < 40; round += 1) {
    let moved = false;
    for (const a of labels) {
      for (const b of [...labels, ...pegs]) {
        if (a === b) continue;
        const [ox, oy] = [a.w / 2 + b.w / 2 + 3 - Math.abs(a.x - b.x), a.h / 2 + b.h / 2 + 3 - Math.abs(a.y - b.y)];
        if (ox <= 0 || oy <= 0) continue;
        moved = true;
        const share = b.fixed ? 1 : 0.5;
        if (oy <= ox) a.y += share * oy * (a.y >= b.y ? 1 : -1);
        else a.x += share * ox * (a.x >= b.x ? 1 : -1);
      }
    }
    if (!moved) return;
  }
}

/** The name of each peg's hole, on the side away from the part. */
function holeNames(drawing) {
  const { row, view, contacts, vise, open } = drawing;
  const radius = Math.max(vise.peg_radius * view.k, 4);
  const centers = row.pegs.map(([x, y], k) => view.page([x + (row.holes[k].startsWith("R") ? open : 0), y]));
  const labels = centers.map(([x, y], k) => {
    const [nx, ny] = contacts[k].normal;
    const w = 8.4 * row.holes[k].length + 12;
    return { x: x + nx * (radius + 8 + w / 2), y: y - ny * (radius + 18), w, h: 20 };
  });
  apart(labels, centers.map(([x, y]) => ({ x, y, w: 2 * radius, h: 2 * radius, fixed: true })));
  return labels.flatMap((label, k) => [
    draw("line.label-lead", { x1: centers[k][0], y1: centers[k][1], x2: label.x, y2: label.y }),
    draw("rect.hole-label", { x: label.x - label.w / 2, y: label.y - 10, width: label.w, height: 20, rx: 4 }),
    word(row.holes[k], [label.x, label.y], "hole-name"),
  ]);
}

/** The number of each touched face, beside the contact. */
function faceNames({ row, view, contacts }) {
  const seen = new Set();
  return contacts.flatMap(({ at, normal }, k) => {
    if (seen.has(row.faces[k])) return [];
    seen.add(row.faces[k]);
    const [x, y] = view.page(at);
    // Inside the part, to the left of the arrow of the force.
    const [px, py] = [x - 14 * normal[0] + 20 * normal[1], y + 14 * normal[1] + 20 * normal[0]];
    return [draw("circle.face-label", { cx: px, cy: py, r: 9.5 }), word(String(row.faces[k]), [px, py], "face-name")];
  });
}

/** The force of each peg on the part; with a load those that resist it, drawn outward where a peg would have to pull. */
function forceArrows({ row, view, contacts, load }) {
  const forces = load ? load.forces : row.forces;
  const largest = Math.max(...forces.map(Math.abs), 1e-12);
  return contacts.flatMap(({ at, normal }, k) => {
    const share = Math.abs(forces[k]) / largest;
    if (load && share < 0.004) return [];
    const long = SHORTEST + (LONGEST - SHORTEST) * share;
    const way = forces[k] < 0 ? 1 : -1;
    const tail = view.page(at);
    const tip = [tail[0] + way * long * normal[0], tail[1] - way * long * normal[1]];
    return [arrow(tail, tip, forces[k] < 0 ? "pull" : "push")];
  });
}

/** The load itself. */
function loadArrow({ view, load }) {
  const tail = view.page(load.at);
  const tip = view.page([load.at[0] + load.vector[0], load.at[1] + load.vector[1]]);
  const long = Math.hypot(tip[0] - tail[0], tip[1] - tail[1]);
  const [ux, uy] = long > 1 ? [(tip[0] - tail[0]) / long, (tip[1] - tail[1]) / long] : [0, -1];
  return [
    arrow(tail, tip, "load"),
    draw("circle.load-handle", { cx: tail[0], cy: tail[1], r: 6 }),
    word(`${number(load.size, 0)} N`, [tip[0] + 28 * ux, tip[1] + 14 * uy], "load-text"),
  ];
}
