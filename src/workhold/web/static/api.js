/**
 * The server, in the words of its API. Every failure is an {@link ApiError} with one plain sentence.
 */

const SILENT = "The server does not answer: see whether workhold serve still runs.";

/** What went wrong, in one sentence, and where in the drawing. */
export class ApiError extends Error {
  /**
   * @param {string} message
   * @param {number} status of HTTP; 0 when the server was not reached
   * @param {{x: number, y: number}|null} place in mm in the drawing
   */
  constructor(message, status, place = null) {
    super(message.charAt(0).toUpperCase() + message.slice(1));
    this.status = status;
    this.place = place;
  }
}

/**
 * Ask the server.
 * @param {string} path after /api/
 * @param {RequestInit} [options]
 * @returns {Promise<any>} what it answers; null for nothing
 */
export async function ask(path, options = {}) {
  let response;
  try {
    response = await fetch(`api/${path}`, options);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new ApiError(SILENT, 0);
  }
  if (response.status === 204) return null;
  const text = await response.text();
  let answer = null;
  try {
    answer = JSON.parse(text);
  } catch {
    answer = null;
  }
  if (response.ok && answer !== null) return answer;
  throw new ApiError(answer?.error ?? `The server answered ${response.status}.`, response.status, answer?.place ?? null);
}

/**
 * A file of the server and what it is to be called.
 * @param {string} path
 * @param {RequestInit} [options]
 * @returns {Promise<{content: Blob, name: string}>}
 */
export async function fetched(path, options = {}) {
  let response;
  try {
    response = await fetch(path, options);
  } catch {
    throw new ApiError(SILENT, 0);
  }
  if (response.ok) {
    const named = /filename="([^"]+)"/.exec(response.headers.get("Content-Disposition") ?? "");
    return { content: await response.blob(), name: named?.[1] ?? path.split("?")[0].split("/").pop() ?? "file" };
  }
  const answer = await response.json().catch(() => null);
  throw new ApiError(answer?.error ?? `The server answered ${response.status}.`, response.status);
}

/**
 * Send JSON.
 * @param {string} path
 * @param {any} body
 * @param {RequestInit} [options]
 */
export function send(path, body, options = {}) {
  const headers = { "Content-Type": "application/json" };
  return ask(path, { method: "POST", headers, body: JSON.stringify(body), ...options });
}

/**
 * See what a file holds and leaves open, with the part if it can be read.
 * @param {File} file
 * @param {Object<string, any>} how unit, part_number, layers (several), join_tolerance, axis, heights; those that are undefined are not sent
 */
export function surveyPart(file, how = {}) {
  return sendFile("parts/survey", file, how);
}

/**
 * Send a file as it is.
 * @param {string} path after /api/
 * @param {File} file
 * @param {Object<string, any>} [how] values of the address; those that are undefined are not sent
 */
export function sendFile(path, file, how = {}) {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(how)) {
    for (const each of Array.isArray(value) ? value : [value]) if (each !== undefined) query.append(name, String(each));
  }
  const headers = { "X-Filename": encodeURIComponent(file.name), "Content-Type": "application/octet-stream" };
  return ask(`${path}${query.size ? `?${query}` : ""}`, { method: "POST", headers, body: file });
}

/**
 * The address of a download of a fixture or of a whole search.
 * @param {string} job
 * @param {number|null} rank
 * @param {string} what such as "sheet.pdf"
 * @param {Object<string, string>} [query]
 */
export function downloadPath(job, rank, what, query = {}) {
  const search = new URLSearchParams(Object.entries(query).flatMap(([name, value]) => [value].flat().map((one) => [name, one]))).toString();
  const place = rank === null ? what : `fixtures/${rank}/${what}`;
  return `api/jobs/${encodeURIComponent(job)}/${place}${search ? `?${search}` : ""}`;
}
