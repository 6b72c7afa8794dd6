"use strict";
/*
 * Pictures of a part in a vise, in SVG: y points up, lengths in mm, and letters as large as those of the page.
 */
const SVG = "http://www.w3.org/2000/svg";

/** An element of SVG. @param {string} name @param {Object<string, any>} given @param {...any} inside */
function svgNode(name, given = {}, ...inside) {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(given)) node.setAttribute(key, String(value));
  node.append(...inside);
  return node;
}

/** An element of the page. @param {string} name @param {Object<string, any>} given @param {...any} inside */
function pageNode(name, given = {}, ...inside) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(given)) node.setAttribute(key, String(value));
  node.append(...inside);
  return node;
}

/** A number as it is shown, without a minus before zero. @param {number} value @param {number} digits */
function shown(value, digits = 2) {
  const words = value.toFixed(digits);
  return (/^-0\.?0*$/.test(words) ? words.slice(1) : words).replace("-", "−");
}

/** SVG path data of closed loops of [x, y, bulge], in their own coordinates. */
function loopsPath(loops) {
  return loops.map((loop) => {
    const pieces = loop.map(([x, y, bulge], k) => {
      const [nextX, nextY] = loop[(k + 1) % loop.length];
      if (Math.abs(bulge) < 1e-12) return `L${nextX} ${nextY}`;
      const radius = (Math.hypot(nextX - x, nextY - y) * (1 + bulge * bulge)) / (4 * Math.abs(bulge));
      return `A${radius} ${radius} 0 ${Math.abs(bulge) > 1 ? 1 : 0} ${bulge > 0 ? 1 : 0} ${nextX} ${nextY}`;
    });
    return `M${loop[0][0]} ${loop[0][1]}${pieces.join("")}Z`;
  }).join("");
}

/** Points that lie all along closed loops, arcs in short chords. */
function pointsOfLoops(loops) {
  return loops.flatMap((loop) => loop.flatMap(([x, y, bulge], k) => {
    const [nextX, nextY] = loop[(k + 1) % loop.length];
    if (Math.abs(bulge) < 1e-12) return [[x, y]];
    const aside = (1 - bulge * bulge) / (4 * bulge);
    const center = [(x + nextX) / 2 - (nextY - y) * aside, (y + nextY) / 2 + (nextX - x) * aside];
    const steps = Math.ceil(Math.abs(4 * Math.atan(bulge)) * 8);
    return Array.from({ length: steps }, (_, i) => {
      const [dx, dy] = turned([x - center[0], y - center[1]], (4 * Math.atan(bulge) * i) / steps);
      return [center[0] + dx, center[1] + dy];
    });
  }));
}

/** The smallest box [x0, y0, x1, y1] around points. */
function boxAround(points) {
  const [xs, ys] = [points.map((point) => point[0]), points.map((point) => point[1])];
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

/** A picture: what is drawn stands in mm, or in the units of a plot where the axes have scales of their own. */
class Picture {
  /**
   * @param {string} label what a screen reader says of it
   * @param {number} ratio height over width, at most
   * @param {number} tallest largest height in pixels
   */
  constructor(label, ratio, tallest = 420) {
    this.svg = svgNode("svg", { role: "img", "aria-label": label });
    [this.ratio, this.tallest] = [ratio, tallest];
    this.box = [0, 0, 1, 1];
    this.own = false;
    // A finger on what can be dragged must not scroll the page, whatever shape that has.
    const keep = (event) => event.target.closest(".grab") && event.preventDefault();
    this.svg.addEventListener("touchstart", keep, { passive: false });
  }

  /** Room for a box of mm, or with ``own`` for a plot that fills the picture. @param {number[]} box */
  fit(box, own = false) {
    [this.box, this.own] = [box, own];
    const width = this.svg.clientWidth || 320;
    const [x0, y0, x1, y1] = box;
    this.edge = own ? { left: 46, right: 12, top: 12, bottom: 34 } : { left: 8, right: 8, top: 8, bottom: 8 };
    const inner = width - this.edge.left - this.edge.right;
    const tall = own ? width * this.ratio : Math.min((inner * (y1 - y0)) / (x1 - x0) + 16, width * this.ratio);
    const height = Math.min(tall, this.tallest);
    [this.width, this.height] = [width, height];
    this.scaleX = inner / (x1 - x0);
    this.scaleY = (height - this.edge.top - this.edge.bottom) / (y1 - y0);
    if (!own) this.scaleX = this.scaleY = Math.min(this.scaleX, this.scaleY);
    this.left = this.edge.left + (inner - this.scaleX * (x1 - x0)) / 2;
    this.foot = this.edge.top + (height - this.edge.top - this.edge.bottom + this.scaleY * (y1 - y0)) / 2;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.setAttribute("height", String(height));
    this.svg.replaceChildren();
  }

  /** Where a point is in the picture. @param {number[]} point */
  at([x, y]) {
    return [this.left + (x - this.box[0]) * this.scaleX, this.foot - (y - this.box[1]) * this.scaleY];
  }

  /** The point under a pointer. @param {{clientX: number, clientY: number}} event */
  under(event) {
    const frame = this.svg.getBoundingClientRect();
    const [px, py] = [event.clientX - frame.left, event.clientY - frame.top];
    const grown = this.width / frame.width;
    return [this.box[0] + (px * grown - this.left) / this.scaleX, this.box[1] + (this.foot - py * grown) / this.scaleY];
  }

  add(node) {
    this.svg.append(node);
    return node;
  }

  line(from, to, kind) {
    const [[x1, y1], [x2, y2]] = [this.at(from), this.at(to)];
    return this.add(svgNode("line", { x1, y1, x2, y2, class: kind }));
  }

  /** A line through points. */
  curve(points, kind) {
    return this.add(svgNode("polyline", { points: points.map((point) => this.at(point).join(" ")).join(","), class: kind }));
  }

  dot(point, pixels, kind) {
    const [cx, cy] = this.at(point);
    return this.add(svgNode("circle", { cx, cy, r: pixels, class: kind }));
  }

  disc(point, radius, kind) {
    return this.dot(point, radius * this.scaleX, kind);
  }

  /** Words beside a point, moved by pixels. */
  words(point, text, kind = "", moved = [0, 0]) {
    const [x, y] = this.at(point);
    const place = { x: Math.min(Math.max(x + moved[0], 4), this.width - 4), y: Math.min(Math.max(y + moved[1], 12), this.height - 4) };
    return this.add(svgNode("text", { ...place, class: kind }, text));
  }

  /** An arrow of a length in pixels, with its head at a point or its tail. */
  arrow(point, [dx, dy], pixels, kind, at = "head") {
    const size = Math.hypot(dx, dy);
    const [ux, uy] = [dx / size, -dy / size];
    const [x, y] = this.at(point);
    const [hx, hy] = at === "head" ? [x, y] : [x + ux * pixels, y + uy * pixels];
    const [tx, ty] = [hx - ux * pixels, hy - uy * pixels];
    const head = Math.min(10, pixels);
    const [bx, by] = [hx - ux * head, hy - uy * head];
    const path = `M${tx} ${ty}L${bx} ${by}M${hx} ${hy}L${bx - uy * head * 0.45} ${by + ux * head * 0.45}L${bx + uy * head * 0.45} ${by - ux * head * 0.45}Z`;
    return this.add(svgNode("path", { d: path, class: `arrow ${kind}` }));
  }

  /** The part in a pose. */
  part(lesson, pose = { theta: 0, x: 0, y: 0 }) {
    const [ox, oy] = this.at([0, 0]);
    const [c, s, k] = [Math.cos(pose.theta), Math.sin(pose.theta), this.scaleX];
    const matrix = [k * c, -k * s, -k * s, -k * c, ox + k * pose.x, oy - k * pose.y];
    return this.add(svgNode("path", { d: loopsPath(lesson.loops), transform: `matrix(${matrix.join(" ")})`, class: "part" }));
  }

  /** A peg with its number. */
  peg(point, radius, number, kind = "") {
    this.disc(point, radius, `peg ${kind}`);
    this.words(point, String(number), "peg-number", [0, 4]);
  }

  /** Holes of a jaw, in columns at places along x, in rows that lie in the picture. */
  holes(xs, firstY, pitch, radius, kind) {
    const low = Math.ceil((this.box[1] - firstY) / pitch);
    const high = Math.floor((this.box[3] - firstY) / pitch);
    for (const x of xs) for (let row = low; row <= high; row += 1) this.disc([x, firstY + row * pitch], radius, kind);
  }

  /** The axes of a plot: whole numbers of steps along both. */
  axes(nameX, nameY, unitX = "") {
    const [x0, y0, x1, y1] = this.box;
    for (const x of ticks(x0, x1, Math.max(4, Math.floor(this.width / 55)))) {
      this.line([x, y0], [x, y1], "grid");
      this.words([x, y0], `${tickWords(x, x1 - x0)}${unitX}`, "tick middle", [0, 15]);
    }
    for (const y of ticks(y0, y1, 5)) {
      this.line([x0, y], [x1, y], "grid");
      this.words([x0, y], tickWords(y, y1 - y0), "tick end", [-5, 4]);
    }
    this.words([x1, y0], nameX, "tick end", [0, 29]);
    this.words([x0, y1], nameY, "tick", [6, 12]);
  }
}

/** A tick's number, with digits as its range needs. */
function tickWords(value, range) {
  return shown(value, range < 1 ? 2 : range < 8 ? 1 : 0);
}

/** Round numbers between two numbers, about so many. */
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * decade).find((size) => size >= rough);
  const out = [];
  for (let tick = Math.ceil(low / step); tick * step <= high; tick += 1) out.push(tick * step);
  return out;
}
