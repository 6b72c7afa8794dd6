/**
 * The whole state in the fragment of the page's address, compressed: a link or a reload restores everything.
 *
 * A fragment never leaves the browser, so the server does not learn it.
 */
import { state, workpieceForm } from "./state.js";

/** Keys of the state that a link carries. */
const CARRIED = [
  "toolkitName", "toolkit", "unit", "types", "listing", "every", "asked", "ruledOut", "avoid", "zones", "angles", "tolerance", "loads", "ranking", "prefer",
  "list", "view", "force", "sheet", "cut", "supports", "programName",
];
/** @typedef {{known: Object<string, any>, part: any, job: string|null, searched: boolean, rank: number|null, pinned: number|null}} Kept what restores a state */

let latest = 0;

/** What restores all that is seen of one side of a part. @returns {Kept} */
export function snapshot() {
  const { part, job, selected, pinned } = state;
  return {
    known: Object.fromEntries(CARRIED.map((key) => [key, state[key]])),
    part: part && workpieceForm(part),
    job: job?.job ?? null,
    searched: job !== null,
    rank: selected?.rank ?? null,
    pinned: pinned?.rank ?? null,
  };
}

/** The state as a fragment, without the "#". */
export async function fragment() {
  const { known, ...rest } = snapshot();
  const text = JSON.stringify({ ...known, ...rest, sides: state.sides });
  const bytes = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** Put the state into the page's address. */
export async function keep() {
  const mine = ++latest;
  const text = await fragment();
  if (mine === latest) history.replaceState(null, "", `#${text}`);
}

/**
 * What a fragment holds; null when it holds nothing that can be read.
 * @param {string} text with or without "#"
 * @returns {Promise<any>}
 */
export async function restored(text) {
  const plain = text.replace(/^#/, "");
  if (!plain) return null;
  try {
    const binary = atob(plain.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
    const whole = await through(bytes, new DecompressionStream("deflate-raw"));
    const kept = JSON.parse(new TextDecoder().decode(whole));
    const known = Object.fromEntries(CARRIED.filter((key) => key in kept).map((key) => [key, kept[key]]));
    return { known, part: kept.part, job: kept.job, searched: kept.searched, rank: kept.rank, pinned: kept.pinned, sides: kept.sides ?? null };
  } catch {
    return null;
  }
}

/**
 * Bytes sent through a transforming stream.
 * @param {Uint8Array} bytes
 * @param {GenericTransformStream} stream
 */
async function through(bytes, stream) {
  const piped = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(piped).arrayBuffer());
}
