/**
 * The shape of a part of a STEP file: sent once for each search, so that bodies show it instead of a prism.
 */
import { ApiError, sendFile } from "./api.js";
import { fileOf } from "./set-ups.js";

/** Searches whose part has its shape at the server. @type {Set<string>} */
const known = new Set();

/**
 * Whether a set-up's part has a shape that is known, or can be.
 * @param {{number: number, job: string, part: any}} setUp
 */
export function hasShape({ number, job, part }) {
  return Boolean(part?.solid) && (known.has(job) || fileOf(number) !== null);
}

/** Whether the shape of a set-up's part has been sent. @param {{job: string}} setUp */
export const isSent = ({ job }) => known.has(job);

/**
 * See to it that the server has the shape of a set-up's part.
 * @param {{number: number, job: string, part: any}} setUp
 * @returns {Promise<string>} why it has none, in a sentence; empty where it has
 */
export async function sendShape(setUp) {
  if (known.has(setUp.job)) return "";
  const read = setUp.part?.solid ? fileOf(setUp.number) : null;
  if (!read) return setUp.part?.solid ? "The part is drawn as a prism of its outline: open its STEP file again to see its shape." : "";
  try {
    await sendFile("parts/shape", read.file, { job: setUp.job });
    known.add(setUp.job);
    return "";
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    return `The part is drawn as a prism of its outline. ${error.message}`;
  }
}
