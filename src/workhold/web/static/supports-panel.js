/**
 * Supports under the part and a clamp on top: the best sets of the fixture shown, over the plan, from the side, in figures.
 */
import { ApiError, send } from "./api.js";
import { byId, field, make, quiet, show } from "./dom.js";
import { drawSide } from "./side-view.js";
import { fixtureDrawing, partDrawing } from "./stage-panel.js";
import { change, on, state } from "./state.js";
import { supportsCard } from "./supports-card.js";
import { areShown, supportsRequest, thicknessOf } from "./supports.js";
import { bareForce, bareLength, fieldLength, forceText, forceWord, length, readLength, readNumber, unitWord } from "./units.js";
import { ZoneTool } from "./zone-tool.js";

/** Lengths of the wish by the ids of their fields; the least that each may be. */
const LENGTHS = { "support-thickness": "thickness", "pad-radius": "pad_radius", "tip-radius": "tip_radius" };
const ZONES = { "support-below": "below", "support-above": "above" };
const VIEWS = [["side-front", "x"], ["side-right", "y"]];

/** What the server told, and of what. @type {{key: string, told: any}|null} */
let known = null;
/** Stops the question that is on its way. @type {AbortController|null} */
let asked = null;
/** @type {ZoneTool|null} */
let tool = null;

const card = () => /** @type {HTMLDetailsElement} */ (byId("supports"));

/** Make the panel and set it up. */
export function supportsPanel() {
  byId("seating").before(supportsCard());
  card().addEventListener("toggle", () => card().open !== areShown() && wish({ open: card().open }));
  for (const id of [...Object.keys(LENGTHS), "support-axial", "support-height"]) {
    field(id).addEventListener("input", quiet(read, 250));
    field(id).addEventListener("change", read);
  }
  for (const id of Object.keys(ZONES)) byId(id).addEventListener("click", () => startZone(id));
  on(["selected", "job", "supports", "force", "loads", "unit", "part", "sheet"], follow);
  on(["supports", "unit", "part", "sheet"], write);
  on(["view"], () => state.view !== "part" && tool?.stop());
  new ResizeObserver(() => told() && drawSides(told())).observe(byId("side-front"));
  write();
}

/** Change some of what is asked. */
function wish(more) {
  change({ supports: { ...state.supports, ...more } });
}

/** What is asked of which fixture. */
function keyOf() {
  const { job, selected } = state;
  const request = supportsRequest();
  return request && job?.job && selected?.rank ? JSON.stringify([job.job, selected.rank, selected.theta_deg, request]) : null;
}

/** What was told of the fixture shown, if it was. */
function told() {
  return known && known.key === keyOf() && areShown() ? known.told : null;
}

/** Ask about the fixture shown, or show what is known of it. */
function follow() {
  const key = areShown() ? keyOf() : null;
  card().open = areShown();
  if (!key || known?.key !== key) {
    asked?.abort();
    asked = null;
    fixtureDrawing.showSupports(null);
    writeAnswer();
    if (key) ask(key);
  } else writeAnswer();
}

/** Ask once there is quiet; a question that was overtaken is given up at the server too. */
const ask = quiet(async (key) => {
  if (key !== keyOf() || !areShown()) return;
  const mine = new AbortController();
  asked = mine;
  show(byId("supports-trouble"), false);
  const path = `jobs/${encodeURIComponent(state.job.job)}/fixtures/${state.selected.rank}/supports`;
  try {
    const answer = await send(path, supportsRequest(), { signal: mine.signal });
    known = { key, told: answer };
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") return;
    if (!(error instanceof ApiError)) throw error;
    if (key !== keyOf()) return;
    byId("supports-trouble").textContent = error.message;
    show(byId("supports-trouble"), true);
    return;
  }
  if (asked === mine) writeAnswer();
}, 120);

/** The set that is shown of what was told. */
function chosenOf(answer) {
  return Math.min(Math.max(state.supports.chosen ?? 1, 1), answer.sets.length) - 1;
}

/** Show the sets, and the chosen one in the drawings. */
function writeAnswer() {
  const answer = told();
  const any = Boolean(answer?.sets.length);
  show(byId("supports-table"), any);
  show(byId("supports-sides"), any);
  byId("supports-notes").replaceChildren(...(answer?.notes ?? []).map((note) => make("li", {}, note)));
  for (const [id, value] of Object.entries({ "pad-radius": answer?.pad_radius, "tip-radius": answer?.tip_radius })) field(id).placeholder = fieldLength(value) || "usual";
  if (!answer || !any) {
    fixtureDrawing.showSupports(null);
    byId("supports-words").textContent = answer || !areShown() ? "" : thicknessOf() === null ? "How thick is the part? Type it here." : "";
    return;
  }
  const chosen = chosenOf(answer);
  const one = answer.sets[chosen];
  byId("supports-words").textContent = sentence(answer, one);
  writeSets(answer, chosen);
  fixtureDrawing.showSupports({ ...one, pad_radius: answer.pad_radius, tip_radius: answer.tip_radius });
  drawSides(answer);
}

/** What the chosen set comes to, in words. */
function sentence(answer, one) {
  const force = one.clamp_force === null ? "" : one.clamp_force > 0
    ? ` The clamp has to press with ${forceText(Math.ceil(one.clamp_force))}; then no support carries more than ${forceText(one.support_force)}.`
    : " The loads keep the part down by themselves: the clamp has to add nothing.";
  const built = one.built
    ? ` Not all of these holes have a name on the plate, or the jaws stand elsewhere: build it in ${one.built.pegs.join(", ")}, supports in ${one.built.supports.join(", ")}, as on the sheet.` : "";
  const stands = one.stands ? "The part stands on them before it is clamped." : "The part tips off them until it is clamped: hold it down.";
  return `Supports in ${one.holes.join(", ")}, the clamp at ${one.at_part.map((value) => bareLength(value, 2)).join(", ")} ${unitWord()} of the part.${force} ` +
    `The clamp is ${length(one.arm, 1)} from the line about which the part would tip first. ${stands}${built}`;
}

/** The table of the sets. */
function writeSets(answer, chosen) {
  const loaded = answer.with_loads;
  const heads = ["Set", "Supports in", `Clamp at ${unitWord()}`, ...(loaded ? [`Clamp force ${forceWord()}`, `Support force ${forceWord()}`] : []), `Tipping arm ${unitWord()}`, `Stands by ${unitWord()}`];
  byId("supports-heads").replaceChildren(...heads.map((words, k) => make(k > 2 ? "th.number" : "th", { scope: "col" }, words)));
  byId("supports-sets").replaceChildren(...answer.sets.map((one, k) => {
    const row = make(`tr${k === chosen ? ".marked" : ""}`, {},
      make("td", {}, make("button", { type: "button", "aria-pressed": String(k === chosen), "aria-label": `Set ${k + 1}`, click: () => wish({ chosen: k + 1 }) }, String(k + 1))),
      make("td", {}, one.holes.join(" ")), make("td", {}, one.at_part.map((value) => bareLength(value, 2)).join(", ")),
      ...(loaded ? [make("td.number", {}, bareForce(Math.ceil(one.clamp_force))), make("td.number", {}, bareForce(one.support_force))] : []),
      make("td.number", {}, bareLength(one.arm, 1)), make(`td.number${one.stands ? "" : ".bad"}`, {}, bareLength(one.standing, 1)));
    return row;
  }));
}

/** The set-up from the front and from the right. */
function drawSides(answer) {
  const chosen = chosenOf(answer);
  const one = answer.sets[chosen];
  for (const [id, across] of VIEWS) {
    const svg = /** @type {SVGSVGElement} */ (/** @type {any} */ (byId(id)));
    drawSide(svg, { ...answer, boxes: answer.boxes[chosen] }, state.selected.holes, { at: one.at, force: one.clamp_force, height: one.clamped_height }, /** @type {"x"|"y"} */ (across));
  }
}

/** A range such as "-20..60", or one number; null when it is empty, undefined where it is none. */
function readRange(text, factor = 1) {
  if (text.trim() === "") return null;
  const ends = text.split("..").map((word) => readNumber(word));
  if (ends.length > 2 || ends.some((end) => end === null || !Number.isFinite(end))) return undefined;
  const [one, other] = [ends[0], ends[ends.length - 1]].map((end) => Number(end) * factor);
  return [Math.min(one, other), Math.max(one, other)];
}

/** A range as its field holds it. */
function rangeText(range, text) {
  if (!range) return "";
  return range[0] === range[1] ? text(range[0]) : `${text(range[0])}..${text(range[1])}`;
}

/** Read the fields; one that cannot be read is marked and left as it was. */
function read() {
  const more = {};
  for (const [id, key] of Object.entries(LENGTHS)) {
    const value = readLength(field(id).value);
    const good = value === null || (Number.isFinite(value) && value > 0);
    field(id).setAttribute("aria-invalid", String(!good));
    if (good && fieldLength(value) !== fieldLength(state.supports[key])) more[key] = value;
  }
  const axial = readRange(field("support-axial").value);
  const scale = readLength("1") ?? 1;
  const heights = readRange(field("support-height").value, scale);
  const badHeight = heights === undefined || Boolean(heights && heights[0] < 0);
  field("support-axial").setAttribute("aria-invalid", String(axial === undefined));
  field("support-height").setAttribute("aria-invalid", String(badHeight));
  if (axial !== undefined) more.axial = axial;
  if (!badHeight) more.heights = heights;
  const next = { ...state.supports, ...more };
  if (JSON.stringify(next) !== JSON.stringify(state.supports)) change({ supports: { ...next, chosen: 1 } });
}

/** Write what is asked into fields that nobody is typing in. */
function write() {
  const { supports, part } = state;
  const values = { "support-axial": rangeText(supports.axial, String), "support-height": rangeText(supports.heights, fieldLength) };
  for (const [id, key] of Object.entries(LENGTHS)) values[id] = fieldLength(supports[key]);
  for (const [id, value] of Object.entries(values)) if (field(id) !== document.activeElement) field(id).value = value;
  const solid = part?.solid;
  show(byId("support-thickness-label"), !solid);
  field("support-thickness").placeholder = fieldLength(thicknessOf()) || "not known";
  for (const [id, key] of Object.entries(ZONES)) {
    byId(`${id}-zones`).replaceChildren(...supports[key].map((zone, k) => make("button", {
      type: "button", "aria-label": `Remove zone ${k + 1}`, click: () => wish({ [key]: supports[key].filter((_, other) => other !== k) }),
    }, `circle r ${length((zone[1][0] - zone[0][0]) / 2, 1)} ×`)));
  }
}

/** Draw a circle on the part that keeps pads or the clamp off, and come back to the fixture. */
function startZone(id) {
  const same = byId(id).getAttribute("aria-pressed") === "true";
  tool?.stop();
  if (same || !state.part) return;
  change({ view: "part" });
  byId(id).setAttribute("aria-pressed", "true");
  const key = ZONES[id];
  tool = new ZoneTool(partDrawing, "circle", (made) => {
    tool = null;
    byId(id).setAttribute("aria-pressed", "false");
    if (made) change({ view: "fixture" });
  }, (zone) => wish({ [key]: [...state.supports[key], zone], chosen: 1 }));
}
