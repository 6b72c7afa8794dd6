/**
 * Small pictures of fixtures on canvases, drawn only for rows in sight.
 */
import { boundsOf, outlinePath, segmentPath } from "./geometry.js";
import { intoVise, partSegments, touchableSegments, turn } from "./pose.js";

/** @type {WeakMap<any, {outline: Path2D, faces: Map<number, Path2D>}>} */
const paths = new WeakMap();
let colours = null;

/** Colours are read again, because light and dark have changed. */
export function forgetColours() {
  colours = null;
}

/** The colours of the drawing, from the style sheet. */
function inks() {
  if (!colours) {
    const style = getComputedStyle(document.documentElement);
    const ink = (name) => style.getPropertyValue(name).trim();
    colours = { part: ink("--part-fill"), line: ink("--drawing-ink"), peg: ink("--peg"), touched: ink("--touched") };
  }
  return colours;
}

/** Paths of a part, made once. */
function pathsOf(part) {
  // A part may get other outlines of carriers with heights of their own.
  const key = part.outlines ?? part;
  let known = paths.get(key);
  if (!known) {
    const faces = new Map();
    for (const { segment, face } of touchableSegments(part)) {
      faces.set(face, `${faces.get(face) ?? ""}${segmentPath(segment)}`);
    }
    known = {
      outline: new Path2D(outlinePath(part.loops)),
      faces: new Map([...faces].map(([face, d]) => [face, new Path2D(d)])),
    };
    paths.set(key, known);
  }
  return known;
}

/**
 * Draw a fixture on a canvas.
 * @param {HTMLCanvasElement} canvas
 * @param {any} part
 * @param {import("./pose.js").Row} row
 */
export function drawThumbnail(canvas, part, row) {
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const { width, height } = canvas;
  const ink = inks();
  const box = boundsOf(partSegments(part).map(({ segment }) => segment), intoVise(row));
  const radii = row.pegs.map((_, k) => row.carriers.find(({ pegs }) => pegs.includes(k))?.peg_radius ?? 0);
  for (const [k, [x, y]] of row.pegs.entries()) {
    const radius = radii[k];
    box[0] = Math.min(box[0], x - radius);
    box[1] = Math.min(box[1], y - radius);
    box[2] = Math.max(box[2], x + radius);
    box[3] = Math.max(box[3], y + radius);
  }
  const edge = 0.05 * width;
  const k = Math.min((width - 2 * edge) / (box[2] - box[0]), (height - 2 * edge) / (box[3] - box[1]));
  const [dx, dy] = [width / 2 - (k * (box[0] + box[2])) / 2, height / 2 + (k * (box[1] + box[3])) / 2];
  const [c, s] = turn(row);
  const { outline, faces } = pathsOf(part);
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.setTransform(k * c, -k * s, -k * s, -k * c, k * row.x + dx, -k * row.y + dy);
  pen.fillStyle = ink.part;
  pen.fill(outline, "evenodd");
  pen.strokeStyle = ink.touched;
  pen.lineWidth = (0.045 * width) / k;
  for (const face of new Set(row.faces.filter((_, at) => !row.corners.includes(at)))) {
    const path = faces.get(face);
    if (path) pen.stroke(path);
  }
  pen.strokeStyle = ink.line;
  pen.lineWidth = (0.014 * width) / k;
  pen.stroke(outline);
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.fillStyle = ink.peg;
  for (const [at, [x, y]] of row.pegs.entries()) {
    pen.beginPath();
    pen.arc(k * x + dx, -k * y + dy, Math.max(radii[at] * k, 0.028 * width), 0, 2 * Math.PI);
    pen.fill();
  }
}
