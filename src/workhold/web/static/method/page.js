"use strict";
/* Which part the lesson is about: an example that comes with the page, or one that a server of workhold has read. */

/** Whether the page comes from a server of workhold, which can read parts; the manual's copy has examples alone. */
const API = /\/static\/method\/[^/]*$/.test(location.pathname) && location.protocol.startsWith("http") ? "../../api/" : null;

const steps = {
  onePeg: new Step("one-peg"),
  twoPegs: new Step("two-pegs"),
  crossing: new Step("crossing"),
  closing: new Step("closing"),
  closure: new ClosureStep(),
  everyOne: new Step("every-one"),
};
const chooser = document.getElementById("example");
const trouble = document.getElementById("trouble");
let latest = 0;

/** Shows every step of a lesson. */
function showLesson(lesson) {
  steps.onePeg.show(onePeg(lesson));
  steps.twoPegs.show(twoPegs(lesson));
  steps.crossing.show(crossing(lesson));
  steps.closing.show(closing(lesson));
  steps.closure.show(lesson);
  steps.everyOne.show(everyOne(lesson));
  document.getElementById("about-part").textContent = aboutPart(lesson);
  document.body.dataset.lesson = lesson.name;
}

/** One or two sentences about the part and the vise that was chosen for it. */
function aboutPart(lesson) {
  const { pitch, peg_radius: radius, columns } = lesson.toolkit;
  const holes = `holes ${shown(pitch[0], 1)} mm apart in ${columns === 1 ? "one column" : `${columns} columns`} on each jaw`;
  const left = lesson.faces_left_out ? ` Its ${lesson.faces_left_out} shortest faces are left alone.` : "";
  const kept = lesson.fixtures.length;
  const cut = kept < lesson.on_curves ? ` The best ${kept} of these are shown.` : "";
  return `${lesson.name} in a vise with ${holes} and pegs of radius ${shown(radius, 1)} mm. ` +
    `There are ${lesson.found} ways to hold it with two pegs on each jaw; in ${lesson.on_curves} of them both pairs can slide, as shown here.${cut}${left}`;
}

/** What a server answers, or its sentence as an error. */
async function asked(path, given) {
  const answer = await fetch(API + path, given);
  const content = await answer.json();
  if (!answer.ok) throw new Error(content.error);
  return content;
}

/** Takes a part that the server knows how to read. @param {() => Promise<any>} read */
async function take(read) {
  latest += 1;
  const mine = latest;
  trouble.hidden = true;
  document.body.classList.add("busy");
  try {
    const { name, loops, departure = 0, solid = null } = await read();
    const body = JSON.stringify({ name, loops, departure, solid });
    const lesson = await asked("lesson", { method: "POST", body, headers: { "Content-Type": "application/json" } });
    if (mine === latest) showLesson(lesson);
  } catch (error) {
    if (mine === latest) tell(error instanceof TypeError ? "The server does not answer: start workhold serve again." : error.message);
  } finally {
    if (mine === latest) document.body.classList.remove("busy");
  }
}

/** The part that the page which finds fixtures handed over, or null. */
function handedOver() {
  try {
    return JSON.parse(sessionStorage.getItem("workhold-lesson") ?? "null");
  } catch {
    return null;
  }
}

/** Says what went wrong. */
function tell(words) {
  trouble.textContent = words;
  trouble.hidden = false;
}

/** Reads a file that was chosen or dropped. @param {File} file */
function takeFile(file) {
  const unit = document.getElementById("unit").value;
  const headers = { "X-Filename": encodeURIComponent(file.name), "Content-Type": "application/octet-stream" };
  chooser.value = "";
  return take(() => asked(`parts${unit && `?unit=${unit}`}`, { method: "POST", body: file, headers }).catch((error) => {
    if (error instanceof TypeError) throw error;
    throw new Error(`${error.message} “Find fixtures” asks what a file leaves open; from there “How it works” brings the part here.`);
  }));
}

/** Sets the page up. */
async function begin() {
  for (const lesson of EXAMPLES) chooser.append(pageNode("option", { value: lesson.name }, lesson.name));
  chooser.addEventListener("change", () => {
    const known = EXAMPLES.find((lesson) => lesson.name === chooser.value);
    latest += 1;
    trouble.hidden = true;
    document.body.classList.remove("busy");
    if (known) showLesson(known);
    else if (chooser.value) take(() => asked(`parts/${encodeURIComponent(chooser.value)}`));
  });
  document.body.classList.add(API ? "served" : "manual");
  chooser.value = EXAMPLES[0].name;
  showLesson(EXAMPLES[0]);
  document.body.dataset.ready = "";
  if (!API) return;
  const part = handedOver();
  if (part) {
    chooser.value = "";
    take(async () => part);
  }
  const file = document.getElementById("file");
  file.addEventListener("change", () => {
    if (file.files[0]) takeFile(file.files[0]);
    file.value = "";
  });
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    if (event.dataTransfer.files[0]) takeFile(event.dataTransfer.files[0]);
  });
  for (const { name } of await asked("parts").catch(() => [])) {
    if (!EXAMPLES.some((lesson) => lesson.name === name)) chooser.append(pageNode("option", { value: name }, name));
  }
}

begin();
