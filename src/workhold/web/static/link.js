/**
 * The whole state in the fragment of the page's address, compressed: a link or a reload restores everything.
 *
 * A fragment never leaves the browser, so the server does not learn it.
 */
import { state } from "./state.js";

/** Keys of the state that a link carries. */
const CARRIED = [
  "toolkitName", "toolkit", "unit", "types", "listing", "contactMargin", "avoid", "zones", "angles", "tolerance", "loads", "ranking", "prefer", "seating",
  "list", "view", "force", "sheet",
];

let latest = 0;

/** The state as a fragment, without the "#". */
export async function fragment() {
  const carried = Object.fromEntries(CARRIED.map((key) => [key, state[key]]));
  const text = JSON.stringify({
    ...carried,
    part: state.part && { name: state.part.name, loops: state.part.loops, departure: state.part.departure ?? 0, solid: state.part.solid ?? null },
    job: state.job?.job ?? null,
    searched: state.job !== null,
    rank: state.selected?.rank ?? null,
    pinned: state.pinned?.rank ?? null,
  });
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
    return { known, part: kept.part, job: kept.job, searched: kept.searched, rank: kept.rank, pinned: kept.pinned };
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
