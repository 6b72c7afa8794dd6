/**
 * Bodies in three dimensions without a graphics card: triangles filled pixel by pixel, the nearest one seen, with dark edges.
 *
 * Where WebGL is drawn by the processor, this is some times as fast as it (benchmarks/in_space.py).
 */
import { HALF_FIELD, Orbit } from "./orbit.js";

/** Pixels that are filled at most while it is turned, and once it rests; a larger canvas is drawn coarser. */
const MOST_PIXELS = 420_000;
const MOST_AT_REST = 2_000_000;
/** Pixels beside each other, for each of the page's, once it rests; and after how many milliseconds it does. */
const FINE = 2;
const REST = 180;
/** Where the light comes from, in the frame of the view, and how much there is without it. */
const LAMP = [-0.37, 0.74, 0.56];
const AMBIENT = 0.62;
/** Faces that meet at less than this cosine have an edge between them. */
const EDGE = Math.cos((40 * Math.PI) / 180);
const EDGE_SHADE = 0.42;

/** A view of bodies that needs no WebGL. */
export class PlainView extends Orbit {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {CanvasRenderingContext2D} context of the canvas
   */
  constructor(canvas, context) {
    super(canvas);
    this.context = context;
    /** @type {import("./glb-reading.js").Body[]} */
    this.shown = [];
    this.opened = 0;
    this.resting = 0;
    /** What was drawn last. @type {Pixels|null} */
    this.seen = null;
  }

  /**
   * Show other bodies, seen whole.
   * @param {import("./glb-reading.js").Body[]} bodies
   * @param {boolean} [still] whether they are opened and looked at as those before
   */
  show(bodies, still = false) {
    this.shown = bodies;
    if (!still) this.opened = 0;
    this.frame(bodies, still);
  }

  /** Take away all bodies. */
  clear() {
    this.shown = [];
    this.draw();
  }

  /** Open what moves by a length in metres. */
  open(by) {
    this.opened = by;
    this.draw();
  }

  /** Draw now, and finely once it rests. */
  render() {
    clearTimeout(this.resting);
    this.rendered(1, MOST_PIXELS);
    this.resting = window.setTimeout(() => this.rendered(FINE, MOST_AT_REST), REST);
  }

  /** Draw with so many pixels for each of the page's, and no more than a number of them. */
  rendered(fine, most) {
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) return;
    const times = Math.min(fine, Math.sqrt(most / (clientWidth * clientHeight)));
    const [width, height] = [clientWidth, clientHeight].map((size) => Math.max(1, Math.round(size * times)));
    Object.assign(this.canvas, { width, height });
    const seen = new Pixels(width, height);
    for (const body of this.shown) this.fill(seen, body);
    this.context.putImageData(seen.picture(), 0, 0);
    this.seen = seen;
  }

  /** The number of the body at a place of the canvas, see Orbit. */
  bodyAt(x, y) {
    const { seen } = this;
    if (!seen) return null;
    const [column, row] = [(x * seen.width) / this.canvas.clientWidth, (y * seen.height) / this.canvas.clientHeight].map(Math.floor);
    const number = seen.which[row * seen.width + column] ?? -1;
    return number < 0 ? null : seen.triangles[number].body - 1;
  }

  /** Fill the triangles of a body that look this way. */
  fill(seen, { positions, normals, triangles, colour, colours, opens }) {
    const axes = this.axes();
    const by = opens ? opens.map((value) => value * this.opened) : [0, 0, 0];
    const scale = seen.height / 2 / HALF_FIELD;
    const count = positions.length / 3;
    const [xs, ys, nearness] = [new Float32Array(count), new Float32Array(count), new Float32Array(count)];
    for (let k = 0; k < count; k += 1) {
      const at = [0, 1, 2].map((axis) => positions[3 * k + axis] + by[axis] - this.target[axis]);
      const [right, up, out] = axes.map((way) => way[0] * at[0] + way[1] * at[1] + way[2] * at[2]);
      nearness[k] = 1 / Math.max(this.far - out, 1e-6);
      xs[k] = seen.width / 2 + scale * right * nearness[k];
      ys[k] = seen.height / 2 - scale * up * nearness[k];
    }
    const onScreen = (value) => 255 * value ** (1 / 2.2);
    const whole = colour.map(onScreen);
    seen.bodies += 1;
    for (let k = 0; k < triangles.length; k += 3) {
      const [a, b, c] = [triangles[k], triangles[k + 1], triangles[k + 2]];
      const area = (xs[b] - xs[a]) * (ys[c] - ys[a]) - (xs[c] - xs[a]) * (ys[b] - ys[a]);
      if (area >= 0) continue;
      const screen = colours ? [0, 1, 2].map((k) => onScreen((colours[3 * a + k] + colours[3 * b + k] + colours[3 * c + k]) / 3)) : whole;
      const normal = [0, 1, 2].map((axis) => (normals[3 * a + axis] + normals[3 * b + axis] + normals[3 * c + axis]) / 3);
      const [right, up, out] = axes.map((way) => way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2]);
      const light = AMBIENT + (1 - AMBIENT) * Math.max(0, right * LAMP[0] + up * LAMP[1] + out * LAMP[2]);
      seen.triangle([xs[a], ys[a], nearness[a]], [xs[b], ys[b], nearness[b]], [xs[c], ys[c], nearness[c]], area, normal, screen, light);
    }
  }
}

/** Pixels with the nearest triangle of each. */
class Pixels {
  /**
   * @param {number} width
   * @param {number} height
   */
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.bodies = 0;
    this.nearest = new Float32Array(width * height);
    this.which = new Int32Array(width * height).fill(-1);
    /** @type {{body: number, normal: number[], colour: number[]}[]} */
    this.triangles = [];
  }

  /** Fill a triangle with corners (x, y, one over the distance), clockwise on the screen. */
  triangle(a, b, c, area, normal, screen, light) {
    const number = this.triangles.push({ body: this.bodies, normal, colour: screen.map((value) => value * light) }) - 1;
    const first = Math.max(0, Math.ceil(Math.min(a[1], b[1], c[1]) - 0.5));
    const last = Math.min(this.height - 1, Math.floor(Math.max(a[1], b[1], c[1]) - 0.5));
    // One over the distance runs evenly over the screen.
    const slopeX = ((b[2] - a[2]) * (c[1] - a[1]) - (c[2] - a[2]) * (b[1] - a[1])) / area;
    const slopeY = ((c[2] - a[2]) * (b[0] - a[0]) - (b[2] - a[2]) * (c[0] - a[0])) / area;
    for (let row = first; row <= last; row += 1) {
      const y = row + 0.5;
      let [from, to] = [Infinity, -Infinity];
      for (const [p, q] of [[a, b], [b, c], [c, a]]) {
        if (p[1] === q[1] || y < Math.min(p[1], q[1]) || y > Math.max(p[1], q[1])) continue;
        const x = p[0] + ((q[0] - p[0]) * (y - p[1])) / (q[1] - p[1]);
        from = Math.min(from, x);
        to = Math.max(to, x);
      }
      const end = Math.min(this.width - 1, Math.floor(to - 0.5));
      for (let column = Math.max(0, Math.ceil(from - 0.5)); column <= end; column += 1) {
        const near = a[2] + (column + 0.5 - a[0]) * slopeX + (y - a[1]) * slopeY;
        const at = row * this.width + column;
        if (near > this.nearest[at]) {
          this.nearest[at] = near;
          this.which[at] = number;
        }
      }
    }
  }

  /** Whether there is an edge between two pixels. */
  isEdge(at, other) {
    const [one, two] = [this.which[at], this.which[other]];
    if (one === two) return false;
    if (one < 0 || two < 0) return true;
    const [a, b] = [this.triangles[one], this.triangles[two]];
    return a.body !== b.body || a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1] + a.normal[2] * b.normal[2] < EDGE;
  }

  /** What is seen, as pixels of a canvas. */
  picture() {
    const { width, height } = this;
    const image = new ImageData(width, height);
    for (let at = 0; at < this.which.length; at += 1) {
      const number = this.which[at];
      if (number < 0) continue;
      const edge = (at % width && this.isEdge(at, at - 1)) || (at >= width && this.isEdge(at, at - width));
      const shade = edge ? EDGE_SHADE : 1;
      this.triangles[number].colour.forEach((value, k) => (image.data[4 * at + k] = value * shade));
      image.data[4 * at + 3] = 255;
    }
    return image;
  }
}
