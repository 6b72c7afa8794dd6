/**
 * Does the part end up there? The part is put between the pegs by hand, what moves closes, and it comes home or does not; with from how
 * wide open it is caught, and every other place where the same pegs can hold it.
 */
import { ApiError, ask, send } from "./api.js";
import { byId, field, make, show } from "./dom.js";
import { lyingIn, seatPictures } from "./seat-pictures.js";
import { fixtureDrawing } from "./stage-panel.js";
import { change, on, state } from "./state.js";
import { kindOf } from "./toolkits.js";
import { TrialDrawing } from "./trial-drawing.js";
import { armOf, entered, inFence, lyingOf, offsetsOf, openingBeside, pegsCaught } from "./trial.js";
import { fieldLength, length, readLength, readNumber, scale } from "./units.js";

/** Fields of what is off, by their keys in the trial. */
const FIELDS = { opening: "try-opening", x: "try-x", y: "try-y", turn: "try-turn" };
/** So many wrong seats are shown at first. */
const FIRST = 11;
/** The jaws stand open at first by this part of the part's size, and no less than this part of the capture opening. */
const OPEN = 0.12;
/** Room about the part that it is moved in, by its size. */
const ROOM = 0.3;
const CAUGHT = 0.9;

/** @type {TrialDrawing} */
let drawing;
/** What the server told of the fixture, which that is, and in which unit. @type {{key: string, unit: string, told: any}|null} */
let known = null;
/** What a closing is asked under; it is stopped when the part is taken hold of again. @type {AbortController|null} */
let asked = null;
/** Whether all wrong seats are shown. */
let every = false;

/** Set the panel up. */
export function trialPanel() {
  drawing = new TrialDrawing(fixtureDrawing, { put, letGo: close, taken });
  byId("try").addEventListener("click", toggleTrial);
  byId("try-close").addEventListener("click", close);
  byId("try-back").addEventListener("click", putBack);
  field("try-over").addEventListener("change", () => state.trial && place({ ...state.trial, over: field("try-over").checked }));
  for (const [key, id] of Object.entries(FIELDS)) field(id).addEventListener("input", () => read(key, id));
  byId("seats-more").addEventListener("click", () => {
    every = true;
    writeSeats();
  });
  on(["selected", "trial", "unit", "job"], follow);
  on(["force"], () => state.force && state.trial && leaveTrial());
}

/** Take the part into the hand, or leave it to the fixture. */
export function toggleTrial() {
  if (!state.selected) return;
  if (state.trial) return leaveTrial();
  change({ force: null, view: "fixture", trial: { x: 0, y: 0, turn: 0, over: false, opening: openingBeside(state.part, state.selected, OPEN * 2 * armOf(state.part)) } });
  look(true);
  // Nothing but what is below the drawing is scrolled.
  byId("below").scrollTop += byId("seating").getBoundingClientRect().top - byId("below").getBoundingClientRect().top;
  return undefined;
}

/** See the part with room about it to be moved in, or as it was seen. @param {boolean} wide */
function look(wide) {
  const more = ROOM * armOf(state.part);
  const [x0, y0, x1, y1] = fixtureDrawing.whole;
  if (wide) fixtureDrawing.view.fit([x0 - more, y0 - more, x1 + more, y1 + more], fixtureDrawing.rim);
  else fixtureDrawing.fit();
}

/** Leave the part to the fixture. */
export function leaveTrial() {
  if (state.trial) change({ trial: null });
}

/** What the server told of the fixture shown, if it has. */
function told() {
  return known?.key === keyOf() && known.unit === state.unit ? known.told : null;
}

/** Which fixture of which search is shown. */
function keyOf() {
  return JSON.stringify([state.job?.job, state.job?.revision, state.selected?.rank]);
}

/** What is shown follows the state. */
function follow(changed) {
  const { trial, selected } = state;
  const on = trial !== null && selected !== null;
  show(byId("seating"), on);
  byId("try-close").textContent = kindOf(state.toolkit).closes;
  show(byId("try"), !selected?.hold);
  byId("try").setAttribute("aria-pressed", String(on));
  byId("try").toggleAttribute("disabled", selected === null);
  byId("close-vise").toggleAttribute("disabled", selected === null || on);
  if (!on) {
    leave();
    if (selected && changed.has("trial")) {
      drawing.show(state.part, null, 0, false);
      look(false);
    }
    if (trial) change({ trial: null });
    return;
  }
  if (changed.has("selected")) {
    leave();
    every = false;
    look(true);
    place({ ...trial, x: 0, y: 0, turn: 0 });
  }
  if (!told()) learn();
  else if (changed.has("unit")) writeFields();
}

/** Nothing of a closing is waited for or shown any more. */
function leave() {
  asked?.abort();
  asked = null;
  drawing.stop();
}

/** Ask the server about the fixture shown. */
async function learn() {
  const key = keyOf();
  const { job, selected, unit } = state;
  const first = known?.key !== key;
  if ((!first && known?.unit === unit) || !job?.job || !selected?.rank) return;
  const mine = (known = { key, unit, told: null });
  for (const id of ["seating-answer", "seating-trouble"]) show(byId(id), false);
  byId("try-close").toggleAttribute("disabled", false);
  say("Working it out \u2026");
  try {
    const answer = await ask(`jobs/${encodeURIComponent(job.job)}/fixtures/${selected.rank}/seating?unit=${unit}`);
    if (known !== mine) return;
    show(byId("seating-answer"), true);
    for (const id of ["try-fields", "try-hint"]) show(byId(id), !answer.by_hand);
    if (answer.by_hand) {
      tellByHand(answer.by_hand);
      return;
    }
    mine.told = answer;
    writeSteps(answer.steps, answer.words);
    byId("try-done").textContent = answer.done;
    writeSeats();
    if (!state.trial) return;
    const opening = Math.max(state.trial.opening, CAUGHT * Math.min(answer.capture_opening ?? 0, armOf(state.part)));
    place(first ? { ...state.trial, opening: openingBeside(state.part, state.selected, opening) } : state.trial);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (known !== mine) return;
    byId("seating-trouble").textContent = error.message;
    show(byId("seating-trouble"), true);
    // What comes of closing is not known, but where the pegs stand is: the part can be moved between them.
    byId("try-close").toggleAttribute("disabled", true);
    if (state.trial) place(state.trial);
  }
}

/** Two clamps close on nothing by themselves: what to do by hand stands there instead, and the part stays where it lies. */
function tellByHand(answer) {
  writeSteps(answer.steps, []);
  byId("seats").replaceChildren();
  show(byId("seats-more"), false);
  say(answer.why);
  markEntered([]);
  drawing.show(state.part, null, 0, false);
}

/** What to do, step by step, and what to beware of. @param {string[]} steps @param {string[]} words */
function writeSteps(steps, words) {
  byId("seating-steps").replaceChildren(...steps.map((step) => make("li", {}, step)));
  byId("seating-words").textContent = words.join(" ");
}

/** Tell what happens. @param {string} words @param {string} [kind] "good" or "bad" */
function say(words, kind = "") {
  const box = byId("try-words");
  box.textContent = words;
  box.className = `verdict ${kind}`;
}

/** Put the part somewhere, the jaws open. @param {import("./trial.js").Trial} trial */
function place(wanted) {
  leave();
  const trial = { ...wanted, opening: Math.min(wanted.opening, told()?.widest ?? Infinity) };
  change({ trial });
  const { part, selected } = state;
  const lying = lyingOf(part, selected, trial);
  drawing.show(part, lying, trial.opening, true, pegsCaught(selected, told()));
  tellEntered(lying, trial.opening);
  writeFields();
  markSeat(null);
}

/** The part is dragged or turned. @param {import("./trial.js").Lying} lying */
function put(lying) {
  if (state.trial) place({ ...state.trial, ...offsetsOf(state.part, state.selected, lying) });
}

/** The part is taken hold of where it lies, also in a seat; the jaws open. */
function taken() {
  if (drawing.lying) put(drawing.lying);
}

/** Put the part back where the fixture has it. */
function putBack() {
  if (state.trial) place({ ...state.trial, x: 0, y: 0, turn: 0, over: false });
}

/** Mark the pegs that stand in the part, and say so. */
function tellEntered(lying, opening) {
  const { part, selected } = state;
  const pegs = entered(part, selected, lying, opening);
  markEntered(pegs);
  const holes = pegs.map((k) => selected.holes[k]).join(" and ");
  if (pegs.length) say(`The peg${pegs.length > 1 ? "s" : ""} in ${holes} ${pegs.length > 1 ? "stand" : "stands"} in the part here.`, "bad");
  else if (inFence(part, selected, lying)) say("The part lies in the fence here.", "bad");
  else say(`${told()?.done ?? "Opened"} by ${length(opening, 2)}${caughtWords(opening)}. ${told() ? "Drag the part and let go." : "Drag the part to see where it has room."}`);
}

/** Whether a part in its place is caught so far open, in words that go on. */
function caughtWords(opening) {
  const answer = told();
  if (!answer?.pass) return "";
  const caught = length(answer.capture_opening, 2);
  return opening < answer.capture_opening ? `, less than the ${caught} up to which the part settles` : `, beyond the ${caught} up to which the part settles`;
}

/** Mark some pegs, and no others. @param {number[]} pegs */
function markEntered(pegs) {
  for (const peg of byId("drawing-fixture").querySelectorAll("[data-peg]")) {
    peg.classList.toggle("entered", pegs.includes(Number(/** @type {HTMLElement} */ (peg).dataset.peg)));
  }
}

/** Close the jaws from where the part is. */
async function close() {
  const { trial, selected, job, part, unit } = state;
  if (!trial || !selected?.rank || !job?.job || !told()) return;
  leave();
  const mine = (asked = new AbortController());
  const { over, ...pose } = lyingOf(part, selected, trial);
  try {
    const body = { ...pose, turned_over: over, opening: trial.opening, unit };
    const answer = await send(`jobs/${encodeURIComponent(job.job)}/fixtures/${selected.rank}/closing`, body, { signal: mine.signal });
    if (mine !== asked) return;
    say("Closing \u2026");
    markEntered([]);
    drawing.play(answer.way, over, () => {
      say(answer.words, answer.ending === "right" ? "good" : "bad");
      markSeat(answer.seat);
    });
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") return;
    if (!(error instanceof ApiError)) throw error;
    if (mine === asked) say(error.message, "bad");
  }
}

/** Read a field; one that cannot be read is marked and left as it was. */
function read(key, id) {
  if (!state.trial) return;
  const value = key === "turn" ? readNumber(field(id).value) : readLength(field(id).value);
  const wrong = value === null || !Number.isFinite(value) || (key === "opening" && value < 0);
  field(id).setAttribute("aria-invalid", String(wrong));
  if (!wrong) place({ ...state.trial, [key]: value });
}

/** Write what is off into fields that nobody is typing in. */
function writeFields() {
  const { trial } = state;
  if (!trial) return;
  field("try-over").checked = trial.over;
  for (const [key, id] of Object.entries(FIELDS)) {
    if (field(id) === document.activeElement) continue;
    const [unit, fine] = key === "turn" || state.unit === "mm" ? [1, 1e3] : [scale(), 1e4];
    const value = (Math.round((trial[key] / unit) * fine) / fine) * unit;
    field(id).value = key === "turn" ? String(value) : fieldLength(value);
    field(id).setAttribute("aria-invalid", "false");
  }
}

/** The pictures of the seats: the right one, and the wrong ones that read most like it. */
function writeSeats() {
  const answer = told();
  if (!answer) return;
  const { nearest, own } = answer;
  const chosen = [own, ...(every ? nearest : nearest.slice(0, FIRST))];
  byId("seats").replaceChildren(...seatPictures(state.part, state.selected, answer, chosen, showSeat));
  const rest = nearest.length + 1 - chosen.length;
  show(byId("seats-more"), rest > 0);
  byId("seats-more").textContent = `Show ${rest} more, whose readings are off by more`;
}

/** Show how the part lies in a seat. */
function showSeat(number) {
  const answer = told();
  if (!answer || !state.trial) return;
  leave();
  const seat = answer.seats[number];
  change({ trial: { ...state.trial, ...offsetsOf(state.part, state.selected, lyingIn(seat)) } });
  drawing.show(state.part, lyingIn(seat), answer.clamping * seat.difference, true, pegsCaught(state.selected, answer));
  markEntered([]);
  writeFields();
  say(answer.captions[number].join(", "), number === answer.own ? "good" : "bad");
  markSeat(number);
}

/** Mark the picture of the seat that the part lies in. */
function markSeat(number) {
  for (const button of byId("seats").querySelectorAll(".seat")) {
    button.setAttribute("aria-pressed", String(Number(/** @type {HTMLElement} */ (button).dataset.seat) === number));
  }
}
