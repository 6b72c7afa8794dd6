/**
 * The closing of set-ups, one after the other, as it is played.
 */

/** Milliseconds of a closing, and of a pause before and after it. */
const CLOSING = 1800;
const PAUSE = 700;

let latest = 0;

/** Stop what is being played. */
export function stopPlaying() {
  latest += 1;
}

/** Wait for a time. @param {number} milliseconds */
const waited = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/**
 * Play the closing of set-ups; who wants no motion sees them open, then closed.
 * @param {number[]} sides
 * @param {{show: (side: number) => Promise<void>, open: (share: number) => void}} stage what shows a side, and opens it by a share
 */
export async function playing(sides, { show, open }) {
  const mine = ++latest;
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  for (const side of sides) {
    await show(side);
    if (mine !== latest) return;
    open(1);
    await waited(PAUSE);
    const begun = performance.now();
    for (let share = still ? 0 : 1; share > 0 && mine === latest;) {
      await new Promise(requestAnimationFrame);
      share = Math.max(0, 1 - (performance.now() - begun) / CLOSING);
      // Fast at first, and slow where it meets the part.
      if (mine === latest) open(share * share);
    }
    if (mine !== latest) return;
    open(0);
    await waited(PAUSE);
    if (mine !== latest) return;
  }
}
