/**
 * The part in the hand by keys: arrows move it, comma and point turn it, Enter lets it go.
 */
import { state } from "./state.js";
import { turned } from "./trial.js";
import { scale } from "./units.js";

/** A step in mm, or in inches, and in degrees. */
const STEP = { mm: 1, inch: 0.05 };
const TURN = 1;
const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const TURNS = { ",": TURN, ".": -TURN };

/**
 * A listener to keys.
 * @param {() => import("./trial.js").Lying|null} lying
 * @param {(lying: import("./trial.js").Lying) => void} put
 * @param {() => void} letGo
 */
export function arrowKeys(lying, put, letGo) {
  return (event) => {
    const now = lying();
    if (!now || event.shiftKey || event.ctrlKey || event.altKey || event.metaKey) return;
    const step = STEP[state.unit] * scale();
    if (MOVES[event.key]) put({ ...now, x: now.x + step * MOVES[event.key][0], y: now.y + step * MOVES[event.key][1] });
    else if (TURNS[event.key]) put(turned(state.part, now, TURNS[event.key]));
    else if (event.key === "Enter") letGo();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
}
