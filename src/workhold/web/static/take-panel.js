/**
 * Take away: the setup sheet and the other files of the fixture shown, all fixtures as files, and a link to all of it.
 */
import { ApiError, downloadPath, fetched } from "./api.js";
import { byId, make, show } from "./dom.js";
import { keep } from "./link.js";
import { sendShape } from "./part-shape.js";
import { searching } from "./search.js";
import { sheetFields, sheetQuery } from "./sheet-fields.js";
import { firstSideQuery, SIDES, setUps } from "./set-ups.js";
import { on, state } from "./state.js";
import { supportsQuery } from "./supports.js";
import { loadQuery } from "./warnings-panel.js";

/** Links to what is made for the fixture shown. */
const PAPERS = ["take-sheet", "take-other", "take-svg", "take-dxf", "take-step", "take-pins", "take-picture"];

/** @param {any} about what the server can do */
export function takePanel(about) {
  show(byId("take-step"), Boolean(about.step));
  sheetFields();
  on(["part", "selected", "job", "unit", "force", "sheet", "supports", "sides", "loads"], write);
  for (const id of PAPERS) byId(id).addEventListener("click", save);
  byId("print").addEventListener("click", () => print());
  byId("copy-link").addEventListener("click", copyLink);
}

/** Point every link at what is shown, and name the page after it. */
function write() {
  const job = state.job?.job;
  const rank = state.selected?.rank;
  const name = [state.part?.name, rank && `fixture ${rank}`].filter(Boolean).join(", ");
  document.title = name ? `${name} – workhold` : "workhold: every way to hold a part";
  byId("print-title").textContent = name;
  if (!job || !rank) return;
  const date = new Date();
  const day = [date.getFullYear(), date.getMonth() + 1, date.getDate()].map((n) => String(n).padStart(2, "0")).join("-");
  const sheet = { ...sheetQuery(), day, ...loadQuery(), ...supportsQuery(), ...firstSideQuery(state.sides?.shown ?? 0) };
  // Files are made of a whole search only; until then a link leads nowhere.
  const over = !searching();
  const point = (id, path) => {
    const link = byId(id);
    if (over || id === "take-picture") link.setAttribute("href", path);
    else link.removeAttribute("href");
    link.setAttribute("aria-disabled", String(!link.hasAttribute("href")));
    link.title = link.hasAttribute("href") ? "" : "When the search is over";
  };
  point("take-sheet", downloadPath(job, rank, "sheet.pdf", sheet));
  point("take-svg", downloadPath(job, rank, "sheet.svg", sheet));
  point("take-dxf", downloadPath(job, rank, "setup.dxf", sheet));
  point("take-step", downloadPath(job, rank, "setup.step", sheet));
  point("take-pins", downloadPath(job, rank, "pins.csv", sheet));
  point("take-picture", downloadPath(job, rank, "picture.svg"));
  const other = setUps().find(({ number }) => number !== (state.sides?.shown ?? 0));
  show(byId("take-other"), Boolean(other));
  if (other) {
    const known = { ...other.known, part: other.part, unit: state.unit };
    byId("take-other").textContent = `Sheet of the ${SIDES[other.number].toLowerCase()}`;
    point("take-other", downloadPath(other.job, other.rank, "sheet.pdf", { ...sheetQuery(known.sheet), day, ...loadQuery(known), ...supportsQuery(known), ...firstSideQuery(other.number) }));
  }
  point("take-json", downloadPath(job, null, "result.json"));
  point("take-csv", downloadPath(job, null, "result.csv"));
}

/** Save what is made for one fixture; what it is refused for is told here, not by the browser. */
async function save(event) {
  event.preventDefault();
  const link = /** @type {HTMLAnchorElement} */ (event.currentTarget);
  const path = link.getAttribute("href");
  const box = byId("take-trouble");
  show(box, false);
  if (!path || link.getAttribute("aria-busy") === "true") return;
  link.setAttribute("aria-busy", "true");
  try {
    if (link.id === "take-step") await withShape();
    const { content, name } = await fetched(path);
    const address = URL.createObjectURL(content);
    make("a", { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    box.textContent = error.message;
    show(box, true);
  } finally {
    link.removeAttribute("aria-busy");
  }
}

/** See to it that the set-up shows the shape of the part, or say that it is a prism. */
async function withShape() {
  const shown = setUps().find(({ number }) => number === (state.sides?.shown ?? 0));
  const why = shown ? await sendShape(shown) : "";
  if (why) toast(why);
}

/** Copy the page's address, which holds the whole state. */
async function copyLink() {
  await keep();
  try {
    await navigator.clipboard.writeText(location.href);
    toast("Link copied. It restores all that you see.");
  } catch {
    toast("The address of this page is the link: copy it from the address bar.");
  }
}

let timer = 0;

/** Say something for a moment. */
function toast(words) {
  const box = byId("toast");
  box.textContent = words;
  show(box, true);
  clearTimeout(timer);
  timer = window.setTimeout(() => show(box, false), 2600);
}
