/**
 * A force dragged onto the part: each peg's reaction at once, as bars and arrows, and which fixture resists it best.
 */
import { ApiError, send } from "./api.js";
import { byId, field, make, quiet, show } from "./dom.js";
import { tellForces } from "./details-panel.js";
import { centerOf, reactions } from "./forces.js";
import { inside } from "./geometry.js";
import { intoPart, intoVise } from "./pose.js";
import { searching } from "./search.js";
import { selectRank } from "./selection.js";
import { fixtureDrawing } from "./stage-panel.js";
import { change, on, state } from "./state.js";
import { kindOf } from "./toolkits.js";
import { fieldForce, fieldLength, fieldMoment, forceAlone, forceScale, forceText, number, readForce, readLength, readMoment, readNumber } from "./units.js";

/** A drag over the part's diagonal is this many newtons. */
const NEWTONS = 1000;
/** Dragging goes by so much of the unit that is shown. */
const STEPS = { mm: 5, inch: 1 };
/** What the jaw is, and how many times as stiff as a contact. */
const KINDS = ["force-kind", "force-ratio"];
const FIELDS = ["force-x", "force-y", "force-size", "force-direction", "force-moment", "force-jaw"];

/** How many newtons a millimetre of the arrow is. */
function perMillimetre() {
  const [x0, y0, x1, y1] = state.part.bounds;
  return NEWTONS / Math.hypot(x1 - x0, y1 - y0);
}

/** Set the panel up. */
export function forcesPanel() {
  byId("push").addEventListener("click", togglePush);
  byId("rank-load").addEventListener("click", rankByLoad);
  for (const id of FIELDS) field(id).addEventListener("input", read);
  for (const id of KINDS) field(id).addEventListener("input", readKind);
  fixtureDrawing.view.tool = { down: grab, move: drag, up: askBest };
  on(["force", "selected", "part", "unit"], (changed) => {
    write();
    if (changed.has("force") && !held) askBest();
  });
  on(["job"], () => {
    const list = listOf(state.job);
    if (list !== bestOf && !held) askBest();
  });
  on(["selected", "force"], () => {
    // What friction holds is reckoned with the design; pegs alone do not tell what a push does.
    const byFriction = Boolean(state.selected?.hold);
    show(byId("push"), !byFriction);
    show(byId("forces"), state.force !== null && state.selected !== null && !byFriction);
  });
}

/** Begin to push on the part, or stop. */
export function togglePush() {
  if (!state.selected) return;
  if (state.force) {
    change({ force: null });
    return;
  }
  const [x, y] = centerOf(state.part);
  change({ trial: null, force: { x, y, size: state.unit === "inch" ? 45 * forceScale() : 200, direction: 0, moment: 0, jaw: null, kind: "screw" } });
  byId("forces").scrollIntoView({ block: "nearest" });
}

/** What is held while dragging: "tip" or "tail". @type {string|null} */
let held = null;

/** Take hold of the arrow, or begin a new one where the part is. */
function grab(point) {
  if (!state.force || !state.selected) return false;
  const { view } = fixtureDrawing;
  const at = view.page(point);
  const { tail, tip } = arrowEnds();
  const far = (end) => Math.hypot(at[0] - view.page(end)[0], at[1] - view.page(end)[1]);
  if (far(tip) < 18) held = "tip";
  else if (far(tail) < 14) held = "tail";
  else {
    const own = intoPart(state.selected)(point);
    if (!inside(state.part.loops, own)) return false;
    held = "tip";
    change({ force: { ...state.force, x: own[0], y: own[1], size: 0 } });
  }
  return true;
}

/** The arrow in mm in the vise frame. */
function arrowEnds() {
  const { force, selected } = state;
  const angle = ((force.direction + selected.theta_deg) * Math.PI) / 180;
  const tail = intoVise(selected)([force.x, force.y]);
  const long = force.size / perMillimetre();
  return { tail, tip: [tail[0] + long * Math.cos(angle), tail[1] + long * Math.sin(angle)] };
}

/** The arrow follows the pointer. */
function drag(point) {
  const { force, selected } = state;
  if (!force || !held) return;
  const own = intoPart(selected)(point);
  if (held === "tail") {
    change({ force: { ...force, x: own[0], y: own[1] } });
    return;
  }
  const [dx, dy] = [own[0] - force.x, own[1] - force.y];
  const step = STEPS[state.unit] * forceScale();
  const size = Math.round((Math.hypot(dx, dy) * perMillimetre()) / step) * step;
  const direction = size ? Math.round((Math.atan2(dy, dx) * 1800) / Math.PI) / 10 : force.direction;
  change({ force: { ...force, size, direction: (direction + 360) % 360 } });
}

/** Read the typed force. */
function read() {
  if (!state.force) return;
  const { force } = state;
  const [x, y] = [typed("force-x", fieldPlace, readLength, force.x), typed("force-y", fieldPlace, readLength, force.y)];
  const [size, jaw] = [typed("force-size", fieldForce, readForce, force.size), typed("force-jaw", fieldForce, readForce, force.jaw)];
  const moment = typed("force-moment", fieldMoment, readMoment, force.moment);
  const direction = readNumber(field("force-direction").value);
  const values = { x, y, size, direction, moment: moment ?? 0, jaw, kind: state.force.kind };
  const wrong = {
    "force-x": x === null || !Number.isFinite(x), "force-y": y === null || !Number.isFinite(y),
    "force-size": !(size !== null && size >= 0), "force-direction": direction === null || !Number.isFinite(direction),
    "force-moment": moment !== null && !Number.isFinite(moment), "force-jaw": jaw !== null && !(jaw >= 0),
  };
  for (const [id, bad] of Object.entries(wrong)) field(id).setAttribute("aria-invalid", String(bad));
  if (!Object.values(wrong).some(Boolean)) change({ force: values });
}

/** What a field holds; what it held before where nobody typed into it, so that no rounding comes in. */
function typed(id, write, take, before) {
  const text = field(id).value;
  return text !== "" && text === write(before) ? before : take(text);
}

/** Read what the jaw is. */
function readKind() {
  if (!state.force) return;
  const chosen = field("force-kind").value;
  const ratio = readNumber(field("force-ratio").value);
  const wrong = chosen === "ratio" && !(ratio !== null && ratio >= 0);
  field("force-ratio").setAttribute("aria-invalid", String(wrong));
  show(byId("force-ratio-label"), chosen === "ratio");
  if (!wrong) change({ force: { ...state.force, kind: chosen === "ratio" ? ratio : chosen } });
}

/** What presses is called: the jaw, or a clamp. */
function mover() {
  return state.selected?.mover ?? "jaw";
}

/** What the jaw is, in words. */
function kindWords(kind) {
  if (kind === "constant") return `a ${mover()} that keeps its force`;
  const { locked } = kindOf(state.toolkit);
  return typeof kind === "number" ? `${locked.replace(/,$/, "")} ${number(kind, 3)} times as stiff as a contact` : locked.split(",")[0];
}

/** Show the force and what it does. */
function write() {
  const { force, selected, part } = state;
  byId("push").setAttribute("aria-pressed", String(force !== null));
  if (!force || !selected || !part || selected.hold) {
    tellForces(null);
    fixtureDrawing.showLoad(null);
    return;
  }
  const texts = [
    fieldPlace(force.x), fieldPlace(force.y), fieldForce(force.size), String(force.direction),
    force.moment ? fieldMoment(force.moment) : "", fieldForce(force.jaw),
  ];
  FIELDS.forEach((id, k) => {
    if (field(id) !== document.activeElement) field(id).value = texts[k];
  });
  const pressing = `${mover()[0].toUpperCase()}${mover().slice(1)}`;
  byId("force-jaw-name").textContent = `${pressing} force`;
  byId("force-kind-name").textContent = pressing;
  byId("force-kind").title = `What the closed ${mover()} does under a load`;
  const ratio = typeof force.kind === "number";
  if (field("force-kind") !== document.activeElement) field("force-kind").value = ratio ? "ratio" : (force.kind ?? "screw");
  if (ratio && field("force-ratio") !== document.activeElement) field("force-ratio").value = String(force.kind);
  show(byId("force-ratio-label"), field("force-kind").value === "ratio");
  const answer = answered(part, selected, force);
  if (answer === undefined) return;
  if (!answer) {
    byId("force-words").textContent = "The pegs of this fixture do not determine the forces.";
    return;
  }
  const { tail, tip } = arrowEnds();
  fixtureDrawing.showLoad({ at: tail, vector: [tip[0] - tail[0], tip[1] - tail[1]], forces: answer.forces, size: force.size });
  tellForces(answer.forces);
  writeBars(selected, answer);
}

/** What the server has told of a load on a fixture that the page does not solve. @type {{key: string, answer: any}|null} */
let told = null;

/** Forces and what is needed: solved here for four pegs, else told by the server; undefined until it has. */
function answered(part, row, force) {
  if (row.pegs.length === 4 || !row.rank) return reactions(part, row, force);
  const key = keyOf(row, force);
  if (told?.key === key) return told.answer;
  tellSoon(key, row.rank, force);
  return undefined;
}

/** Which fixture of which search is under which load. */
function keyOf(row, force) {
  return JSON.stringify([state.job?.job, row?.rank, force]);
}

const tellSoon = quiet(async (key, rank, force) => {
  // Nobody waits for it any more when another fixture, or none, is on show by now.
  if (key !== keyOf(state.selected, state.force) || !(force.size > 0 || force.moment)) return;
  const body = { loads: [loadOf(force)], jaw_force: force.jaw, jaw: force.kind ?? "screw" };
  try {
    const { cases: [worst] } = await send(`jobs/${encodeURIComponent(state.job.job)}/fixtures/${rank}/loads`, body);
    told = { key, answer: { forces: worst.largest, needed: worst.needed.value, jaw: worst.jaw_force, loose: worst.needed.peg } };
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    told = { key, answer: null };
  }
  write();
}, 80);

/** A coordinate as a field holds it. @param {number} mm */
function fieldPlace(mm) {
  return fieldLength(Math.round(mm * 1000) / 1000);
}

/** A bar for each peg. */
function writeBars(row, { forces, needed, jaw, loose }) {
  const most = Math.max(...forces.map(Math.abs), 1e-9);
  byId("bars").replaceChildren(
    ...forces.map((force, k) => {
      const pulls = force < -1e-6 * most;
      const fill = make("div.bar-fill");
      fill.style.transform = `scaleX(${Math.abs(force) / most})`;
      return make(`div.bar${pulls ? ".pulls" : ""}`, {},
        make("b", {}, row.holes[k]), make("div.bar-track", { "aria-hidden": "true" }, fill),
        make("span.number", {}, pulls ? "lets go" : forceText(force)));
    }),
  );
  const enough = jaw >= needed * (1 - 1e-9);
  const told = state.force?.jaw === null && needed > 0 ? `that ${mover()} force` : `a ${mover()} force of ${forceText(jaw)}`;
  byId("force-words").textContent = [
    needed === 0
      ? `No peg lets go, however little the ${mover()} presses.`
      : `The ${mover()} must press with ${forceText(Math.ceil(needed))} so that no peg lets go; below that ${row.holes[loose]} does.`,
    enough ? `Forces are for ${told} of ${kindWords(state.force?.kind)}, without friction.` : `With ${forceText(jaw)} a peg lets go.`,
  ].join(" ");
}

/** Which fixtures there are to choose from: the first of a search, then all of it; null while there is none. */
function listOf(job) {
  return job?.job && job.listed ? `${job.job} ${searching()}` : null;
}

let asked = 0;
/** The fixtures that were asked for the best. @type {string|null} */
let bestOf = null;
const askSoon = quiet(async () => {
  const mine = ++asked;
  const { force, job } = state;
  bestOf = listOf(job);
  if (!force || !(force.size > 0 || force.moment)) return;
  if (!bestOf) {
    byId("resist-words").replaceChildren();
    return;
  }
  try {
    const { best } = await send(`jobs/${encodeURIComponent(job.job)}/resist`, { loads: [loadOf(force)] });
    if (mine === asked && state.force && state.job?.job === job.job) writeBest(best);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (mine === asked) byId("resist-words").textContent = error.status === 404 ? "" : error.message;
  }
}, 160);

/** Ask which fixture resists the force best, once it is let go. */
function askBest() {
  held = null;
  askSoon();
}

/** Links to the fixtures that resist best. */
function writeBest(best) {
  const links = best.slice(0, 4).map(({ rank, load_reaction: most }) =>
    make("button", { type: "button", click: () => selectRank(rank) }, `${rank}: ${forceAlone(most)}`),
  );
  byId("resist-words").replaceChildren("Resisted best, by the largest peg force: ", ...links.flatMap((link) => [link, " "]));
}

/** The force as a load of the API. */
export function loadOf(force) {
  return {
    name: "pushed", points: [[force.x, force.y]], force: force.size, directions: [force.direction, force.direction], moment: force.moment,
  };
}

/** Search anew, ranked by how well this load is resisted. */
function rankByLoad() {
  const { force } = state;
  if (force) change({ loads: [loadOf(force)], ranking: ["load_reaction"] });
}
