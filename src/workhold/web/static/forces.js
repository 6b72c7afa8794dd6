/**
 * Peg forces under a load, solved in the page so that they follow the mouse.
 *
 * With c the centre of the part, a peg at q with outward unit normal n presses on the part with a force f along -n. For a
 * load with force g and moment m about c, and a force F on the carrier that slides, along the direction d in which it clamps,
 *
 *   sum f n = g,   sum f (q - c) x n = m,   sum over that carrier of f n . (-d) = F.
 *
 * Four equations for four forces, so f = f0 + F h for a jaw that keeps its force. A screw vise is locked once it is closed with F:
 * what its jaw takes of the load changes its push, and of f0 the part at right angles to h is left; of a jaw s times as stiff as
 * a contact, f0 - h (h . f0) / (1 / s + h . h) is. Contacts are without
 * friction (docs/quality.md).
 */
import { intoVise } from "./pose.js";

/**
 * Coefficients (4, 4) of a fixture: the force of each peg per unit of g_x, g_y, m and F, in the vise frame.
 * @param {any} part
 * @param {import("./pose.js").Row} row
 * @returns {number[][]|null} null where the contacts do not determine the forces
 */
export function coefficients(part, row) {
  const center = intoVise(row)(centerOf(part));
  const size = Math.hypot(part.bounds[2] - part.bounds[0], part.bounds[3] - part.bounds[1]) / 2;
  const matrix = [0, 1, 2, 3].map((equation) =>
    row.contacts.map((contact, k) => {
      const normal = row.normals[k];
      if (equation < 2) return normal[equation];
      if (equation === 2) {
        return ((contact[0] - center[0]) * normal[1] - (contact[1] - center[1]) * normal[0]) / size;
      }
      const { clamping } = row.carriers.find(({ pegs }) => pegs.includes(k)) ?? {};
      // The force is told as positive: against the way in which the carrier pushes.
      return clamping ? -clamping[0] * normal[0] - clamping[1] * normal[1] : 0;
    }),
  );
  const inverse = inverted(matrix);
  return inverse && inverse.map(([x, y, moment, jaw]) => [x, y, moment / size, jaw]);
}

/**
 * The centre of a part's bounding box.
 * @param {any} part
 */
export function centerOf(part) {
  return [(part.bounds[0] + part.bounds[2]) / 2, (part.bounds[1] + part.bounds[3]) / 2];
}

/**
 * What a load does to a fixture.
 * @param {any} part
 * @param {import("./pose.js").Row} row
 * @param {{x: number, y: number, size: number, direction: number, moment: number, jaw: number|null, kind?: string|number}} load
 *   force in N at a point of the part, direction in degrees from the part's x axis, moment in N mm, and of the jaw its force
 *   and what it is: "screw", "constant", or how many times as stiff as one contact
 * @returns {{forces: number[], needed: number, jaw: number, loose: number}|null} peg forces, the jaw force needed so that no
 *   peg lets go, the jaw force they are told for, and which peg lets go first
 */
export function reactions(part, row, load) {
  const rows = coefficients(part, row);
  if (!rows) return null;
  const center = centerOf(part);
  const angle = (load.direction * Math.PI) / 180;
  const moment = load.size * ((load.x - center[0]) * Math.sin(angle) - (load.y - center[1]) * Math.cos(angle)) + load.moment;
  const turned = angle + (row.theta_deg * Math.PI) / 180;
  const [gx, gy] = [load.size * Math.cos(turned), load.size * Math.sin(turned)];
  const free = rows.map(([x, y, m]) => x * gx + y * gy + m * moment);
  const squares = rows.reduce((sum, line) => sum + line[3] * line[3], 0);
  const stiffness = load.kind === "constant" ? 0 : typeof load.kind === "number" ? load.kind : Infinity;
  const along = rows.reduce((sum, line, k) => sum + line[3] * free[k], 0);
  const taken = stiffness > 0 ? along / (1 / stiffness + squares) : 0;
  const bare = rows.map((line, k) => free[k] - taken * line[3]);
  const needs = rows.map((line, k) => -bare[k] / line[3]);
  const loose = needs.indexOf(Math.max(...needs));
  const needed = Math.max(0, needs[loose]);
  const jaw = load.jaw ?? needed;
  return { forces: rows.map((line, k) => bare[k] + jaw * line[3]), needed, jaw, loose };
}

/**
 * The inverse of a square matrix by elimination with pivots; null where there is none.
 * @param {number[][]} matrix
 * @returns {number[][]|null}
 */
export function inverted(matrix) {
  const count = matrix.length;
  const rows = matrix.map((line, i) => [...line, ...line.map((_, j) => (i === j ? 1 : 0))]);
  for (let k = 0; k < count; k += 1) {
    let best = k;
    for (let i = k + 1; i < count; i += 1) if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    [rows[k], rows[best]] = [rows[best], rows[k]];
    const pivot = rows[k][k];
    if (!(Math.abs(pivot) > 1e-12)) return null;
    rows[k] = rows[k].map((value) => value / pivot);
    for (let i = 0; i < count; i += 1) {
      if (i === k) continue;
      const factor = rows[i][k];
      rows[i] = rows[i].map((value, j) => value - factor * rows[k][j]);
    }
  }
  return rows.map((line) => line.slice(count));
}
