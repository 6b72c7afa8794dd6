/**
 * Small pictures of the seats of a fixture's pegs, each a button: the right one, and the wrong ones by their readings.
 */
import { draw, make } from "./dom.js";
import { boundsOf, extend, outlinePath } from "./geometry.js";
import { partSegments } from "./pose.js";
import { lyingMatrix, pegsOpen } from "./trial.js";

/** Room around part and pegs, as a share of their extent. */
const RIM = 0.05;
/** How thick a fence is drawn, in mm. */
const FENCE = 4;

/** How the part lies in a seat. */
export function lyingIn({ pose, mirrored }) {
  return { ...pose, over: mirrored };
}

/**
 * Pictures of seats, all to one scale.
 * @param {any} part
 * @param {import("./pose.js").Row} row
 * @param {any} told seats and captions as the server tells them
 * @param {number[]} chosen numbers of the seats to show
 * @param {(number: number) => void} pick called with the seat that is clicked
 */
export function seatPictures(part, row, told, chosen, pick) {
  const radii = new Map(row.carriers.flatMap((each) => each.pegs.map((k) => [k, each.peg_radius])));
  const outline = outlinePath(part.loops);
  const segments = partSegments(part).map(({ segment }) => segment);
  const scenes = chosen.map((number) => {
    const seat = told.seats[number];
    const lying = lyingIn(seat);
    const pegs = pegsOpen(row, told.clamping * seat.difference);
    const matrix = lyingMatrix(lying);
    const box = boundsOf(segments, ([px, py]) => {
      const { x, y } = matrix.transformPoint({ x: px, y: py });
      return [x, y];
    });
    if (row.flush.length) extend(box, [box[0], -FENCE]);
    for (const [k, [px, py]] of pegs.entries()) {
      if (row.flush.includes(k)) continue;
      const r = radii.get(k) ?? 0;
      extend(box, [px - r, py - r]);
      extend(box, [px + r, py + r]);
    }
    return { number, seat, lying, pegs, box };
  });
  const wide = Math.max(...scenes.map(({ box }) => box[2] - box[0])) * (1 + 2 * RIM);
  const high = Math.max(...scenes.map(({ box }) => box[3] - box[1])) * (1 + 2 * RIM);
  return scenes.map(({ number, seat, lying, pegs, box }) => {
    const touching = new Set(seat.contacts.map(({ peg }) => peg));
    const corner = [(box[0] + box[2] - wide) / 2, -(box[1] + box[3] + high) / 2];
    const world = draw("g.world", { transform: "scale(1 -1)" },
      draw("path.part-fill", { d: outline, transform: lyingMatrix(lying) }), draw("path.outline", { d: outline, transform: lyingMatrix(lying) }),
      ...(row.flush.length ? [draw("rect.plate.wall", { x: box[0], y: -FENCE, width: box[2] - box[0], height: FENCE })] : []),
      ...pegs.flatMap(([cx, cy], k) => (row.flush.includes(k) ? [] : [draw(touching.has(k) ? "circle.peg-body" : "circle.peg-idle", { cx, cy, r: Math.max(radii.get(k) ?? 0, wide / 60) })])));
    const svg = draw(`svg.seat-picture${seat.mirrored ? ".over" : ""}`, { viewBox: `${corner[0]} ${corner[1]} ${wide} ${high}`, "aria-hidden": "true" }, world);
    const [reads, ...rest] = told.captions[number];
    const button = make(`button.seat${number === told.own ? ".right" : ""}`, { type: "button", "data-seat": number, click: () => pick(number) },
      make("b", {}, reads), ...rest.map((line) => make("span", {}, line)));
    button.prepend(svg);
    return button;
  });
}
