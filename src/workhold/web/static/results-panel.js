/**
 * The fixtures: how many there are so far, filters, the list, and what is said when there are none.
 */
import { byId, choice, field, make, show } from "./dom.js";
import { FixtureList } from "./fixture-list.js";
import { Rows } from "./rows.js";
import { cancel, searching, start } from "./search.js";
import { isSame, rowOfRank, select, selectFrom } from "./selection.js";
import { tellTotal } from "./stage-panel.js";
import { change, on, state } from "./state.js";
import { countText } from "./units.js";
import { explain } from "./why-panel.js";

/** Short names of figures where there is little room. */
const SHORT = {
  closure_margin: "margin", clamp_amplification: "clamp", wrench_radius: "wrench", location_error: "error",
  end_distance: "to end", load_reaction: "load", edge_distance: "to edge", jaw_force_needed: "needs", smallest_face: "face",
  pin_deflection: "pins bend", pin_stress: "pin stress", pin_movement: "pins move",
  clamp_needed: "needs", safety_reached: "holds times", slip_reserve: "rated times",
};

/** The part of a search after which what it found is put in order. */
const LISTING = 0.9;

/** @type {FixtureList} */
let list;
/** @type {Rows|null} */
let rows = null;
/** What a restored link still wants to see. @type {{rank: number|null, pinned: number|null, view: string}|null} */
let wanted = null;
/** Whether a fixture was chosen by the user, and not just the first one. */
let chosenByUser = false;

/** @param {any[]} figures */
export function resultsPanel(figures) {
  const known = figures.map((figure) => ({ ...figure, short: SHORT[figure.key] ?? figure.words }));
  list = new FixtureList(byId("list"), (index, row) => {
    chosenByUser = true;
    select(row.rank, index);
  });
  list.figures = known;
  choice("sort").append(
    make("option", { value: "rank" }, "rank"), ...known.filter(({ sorts }) => sorts).map((figure) => make("option", { value: figure.key }, figure.words)),
  );
  for (const id of ["search", "search-here"]) byId(id).addEventListener("click", start);
  byId("cancel").addEventListener("click", cancel);
  choice("sort").addEventListener("change", () => {
    const figure = known.find((each) => each.key === choice("sort").value);
    setList({ sort: choice("sort").value, descending: figure?.more_is_better ?? false });
  });
  byId("descending").addEventListener("click", () => setList({ descending: !state.list.descending }));
  choice("filter-type").addEventListener("change", () => setList({ type: choice("filter-type").value }));
  choice("filter-face").addEventListener("change", () => setList({ face: choice("filter-face").value }));
  byId("filter-angle").addEventListener("change", readAngle);
  for (const key of ["each", "unfit"]) byId(key).addEventListener("change", () => setList({ [key]: field(key).checked }));
  choice("prefer").addEventListener("change", () => {
    change({ prefer: choice("prefer").value || null, ranking: null });
    start();
  });
  on(["job"], showJob);
  on(["part"], writeFaces);
  on(["job"], writeTypes);
  on(["list"], () => {
    writeFilters();
    openRows();
  });
  on(["index", "selected"], () => list.choose(state.index));
  on(["unit"], () => {
    list.clear();
    list.paint();
  });
  on(["part", "job", "reading"], () => {
    byId("search").toggleAttribute("disabled", state.part === null && !state.reading);
    show(byId("search-there"), state.part !== null && state.job === null);
    byId("search").textContent = state.job ? "Search again" : "Find every fixture";
  });
}

/** Open the results of a link: these ranks are shown once they are known. */
export function want(rank, pinned, view) {
  wanted = { rank, pinned, view };
}

/** Sort or filter otherwise. */
function setList(patch) {
  change({ list: { ...state.list, ...patch } });
}

/** Read the filter of angles: a range such as 0..90. */
function readAngle() {
  const input = field("filter-angle");
  const text = input.value.trim().replace(/\s*(\.\.|to|–)\s*/, "..");
  const match = /^(-?\d+(?:\.\d+)?)\.\.(-?\d+(?:\.\d+)?)$/.exec(text);
  input.setAttribute("aria-invalid", String(text !== "" && !match));
  if (text === "" || match) setList({ angle: text });
}

/** Offer the faces of the part as a filter. */
function writeFaces() {
  const faces = state.part?.faces ?? [];
  choice("filter-face").replaceChildren(
    make("option", { value: "" }, "any"), ...faces.map(({ number }) => make("option", { value: number }, String(number))),
  );
  if (state.list.face && !faces.some(({ number }) => String(number) === state.list.face)) setList({ face: "" });
  choice("filter-face").value = state.list.face;
}

/** Offer what fixtures of the search can be told apart by, where there is more than one. */
let offered = "";
function writeTypes() {
  const titles = (state.job?.arrangements ?? []).map(({ title }) => title);
  if (!titles.length || String(titles) === offered) return;
  offered = String(titles);
  show(byId("filter-type-label"), titles.length > 1);
  choice("filter-type").replaceChildren(
    make("option", { value: "" }, "all"), ...titles.map((title) => make("option", { value: title }, title.replace("-", "\u2212"))),
  );
  if (state.list.type && !titles.includes(state.list.type)) setList({ type: "" });
  choice("filter-type").value = state.list.type;
}

/** Show how the list is sorted and filtered. */
export function writeFilters() {
  const { sort, descending, type, face, angle, each, unfit } = state.list;
  field("each").checked = Boolean(each);
  field("unfit").checked = Boolean(unfit);
  choice("prefer").value = state.prefer ?? "";
  choice("sort").value = sort;
  choice("filter-type").value = type;
  choice("filter-face").value = face;
  field("filter-angle").value = angle;
  byId("descending").setAttribute("aria-pressed", String(descending));
  byId("descending").textContent = descending ? "↓ largest first" : "↑ smallest first";
}

/** Open the list of the job there is. */
function openRows() {
  rows?.leave();
  rows = null;
  const job = state.job?.job;
  if (job) {
    const changed = () => {
      tellTotal(opened.total);
      list.update();
      firstRow(opened);
      tellMatches();
    };
    rows = new Rows(job, state.list, changed, start);
    const opened = rows;
    if (state.selected) change({ index: -1 });
  }
  selectFrom(rows);
  tellTotal(0);
  list.use(rows);
  if (job && state.selected && !searching()) followSelected(job);
}

/** The first row whose fixture is on its way. @type {any} */
let coming = null;

/** Show the first fixture as soon as there is one, or the one a link asks for. */
async function firstRow(from) {
  if (from !== rows) return;
  const first = from.at(0);
  if (searching() && wanted) return;
  if (wanted && first) {
    const { rank, pinned, view } = wanted;
    wanted = null;
    const job = state.job.job;
    const [row, other] = await Promise.all([rank, pinned].map((each) => (each ? rowOfRank(job, each) : null)));
    if (from !== rows) return;
    const plain = state.list.sort === "rank" && !state.list.descending && !state.list.type && !state.list.face && !state.list.angle && state.list.each && state.list.unfit;
    if (row) change({ selected: row, index: plain ? rank - 1 : -1 });
    if (other) change({ pinned: other });
    if (row && view === "fixture") change({ view });
    return;
  }
  if (!first) return;
  const { selected, index } = state;
  const same = selected !== null && isSame(first, selected);
  // Of two fixtures with one rank, the one on show is of an earlier stage of the search.
  const moved = selected !== null && !same && !chosenByUser && (index === 0 || first.rank === selected.rank);
  if (!selected || moved) {
    if (coming === first) return;
    coming = first;
    const row = await rowOfRank(state.job.job, first.rank);
    if (!row || from !== rows || coming !== first || state.selected !== selected) return;
    change({ selected: row, index: 0, ...(selected || state.view === "draw" ? {} : { view: "fixture" }) });
  } else if (index < 0 && same) change({ index: 0 });
}

/** The search has moved on. */
let shownJob = null;
let shownRevision = -1;
function showJob() {
  const { job } = state;
  const id = job?.job ?? null;
  if (id !== shownJob) {
    shownJob = id;
    shownRevision = -1;
    chosenByUser = false;
    show(byId("why"), false);
    openRows();
  }
  writeSummary();
  const any = Boolean(job && job.found > 0);
  show(byId("list"), any);
  show(byId("filters"), any);
  if (id && rows && job.revision !== shownRevision && job.revision > 0) {
    shownRevision = job.revision;
    const refreshed = rows.refresh(list.first, list.last).then(() => list.paint());
    // The first row has been compared with the fixture on show as it came.
    if (!searching()) refreshed.then(() => (chosenByUser || state.index !== 0) && followSelected(id));
  }
  if (id && job.state === "done" && job.found === 0 && job.complete) explain(id);
}

/** Once a search has ended: keep the fixture on show if it still has its rank, else show the first. */
async function followSelected(job) {
  const { selected } = state;
  if (!selected?.rank) return;
  const row = await rowOfRank(job, selected.rank);
  if (state.selected !== selected || state.job?.job !== job) return;
  if (row && isSame(row, selected)) return;
  const first = await rows?.whenAt(0);
  const best = first && (await rowOfRank(job, first.rank));
  if (best && state.selected === selected) change({ selected: best, index: 0 });
}

/** How many there are, in words; told to screen readers only now and then. */
let announced = "";
function writeSummary() {
  const { job } = state;
  document.body.dataset.search = job?.state ?? "none";
  const busy = searching();
  show(byId("progress-row"), busy);
  const bar = /** @type {HTMLProgressElement} */ (byId("progress"));
  if (busy && job.fraction > 0) bar.value = job.fraction;
  else if (busy) bar.removeAttribute("value");
  const trouble = byId("search-trouble");
  show(trouble, job?.state === "failed");
  trouble.textContent = job?.error ?? "";
  const [title, words] = summary(job, busy);
  byId("count").textContent = title;
  byId("count-words").textContent = words;
  byId("tab-count").textContent = job && job.found ? countText(job.found) : "";
  const announcement = busy ? "Searching." : job ? `${title}. ${words}` : "";
  if (announcement !== announced) {
    announced = announcement;
    byId("announce").textContent = announcement;
  }
}

/** The summary of a job: a title, and a sentence. */
function summary(job, busy) {
  if (!job) return ["No search yet", "Fixtures appear here, the best first."];
  const many = job.found === 1 ? "1 fixture" : `${countText(job.found)} fixtures`;
  if (job.state === "waiting") return ["The part first", `${state.reading || "The part"} is being read; the search begins as soon as it is.`];
  if (busy) return underWay(job, many);
  if (job.state === "failed") return ["The search failed", ""];
  if (job.state === "cancelled") return [job.found ? `${many}, not all` : "Search cancelled", job.found ? "The search was cancelled; the fixtures found so far are valid." : "Press Search again to start anew."];
  if (job.found === 0 && job.complete) return ["There is no fixture", "Every place was searched; the reason is below."];
  if (job.found === 0) return ["None found so far", ["The search was not complete.", ...(job.notes ?? [])].join(" ")];
  const counts = Object.entries(job.counts ?? {});
  const types = counts.length > 1 ? counts.map(([type, count]) => `${countText(count)} of type ${type}`) : [];
  const seconds = typeof job.seconds === "number" ? [`found in ${job.seconds.toFixed(job.seconds < 10 ? 1 : 0)} s`] : [];
  const found = sentence([...types, ...seconds].join(", "));
  return [many, [...(found ? [`${found}.`] : []), ...(job.notes ?? [])].join(" ")];
}

/** The summary of a search that is not over yet; what is searched is never all of it. */
function underWay({ state: stage, fraction, found, best }, many) {
  if (stage === "queued") return ["Searching", "Waiting for its turn."];
  const share = `${Math.min(99, Math.floor(100 * fraction))} % searched`;
  if (!found) return ["Looking for the best", fraction >= LISTING ? "The fixtures found are being put in order." : `${share}.`];
  if (!best) return [`${many} so far`, `${share}.`];
  const others = found > best ? `; ${many} so far` : "";
  return [best > 1 ? `The best ${countText(best)}` : "The best one", `No other fixture is better. The rest is searched meanwhile: ${share}${others}.`];
}

/** Words with a capital letter. */
function sentence(words) {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** How many match the filters. */
function tellMatches() {
  const filtered = state.list.type || state.list.face || state.list.angle;
  if (!rows?.known || searching()) return;
  if (!filtered) {
    writeSummary();
    const { unfit } = rows;
    if (unfit) byId("count-words").append(` ${countText(unfit)} of them ${unfit === 1 ? "is" : "are"} of no use in a workshop and not listed.`);
  } else byId("count-words").textContent = `${countText(rows.total)} match the filters.`;
}
