/**
 * When there is no fixture: which rule took the last candidates away, the nearest miss, and what would help.
 */
import { ApiError, ask } from "./api.js";
import { byId, make, show } from "./dom.js";
import { heightHelp } from "./height-help.js";
import { showMiss } from "./stage-panel.js";
import { change, on, state } from "./state.js";
import { openComparison } from "./comparison-dialog.js";
import { withFields } from "./toolkits.js";
import { countText } from "./units.js";

let asked = null;

/** Leave the explanation with the search it belongs to. */
export function whyPanel() {
  on(["job"], () => {
    if ((state.job?.job ?? null) === asked) return;
    asked = null;
    show(byId("why"), false);
    showMiss(null);
  });
}

/**
 * Explain why a job found nothing.
 * @param {string} job
 */
export async function explain(job) {
  if (asked === job) return;
  asked = job;
  const box = byId("why");
  show(box, true);
  box.replaceChildren(make("p.faint", {}, "Looking for the reason …"));
  try {
    const answer = await ask(`jobs/${encodeURIComponent(job)}/explanation`);
    if (asked !== job) return;
    write(box, answer, heightHelp(job));
    if (answer.nearest) showMiss({ rank: null, ...answer.nearest.row }, answer.nearest.words);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (asked === job) box.replaceChildren(make("p", {}, error.message));
  }
}

/** Write the explanation. */
function write(box, { contacts, no_contacts, removals, nearest, helps, asked_words }, heights) {
  const parts = [make("p", {}, contacts
    ? `Four pegs can touch the part at the same time in ${countText(contacts)} ways. Each rule takes some of them away:`
    : no_contacts)];
  if (removals.length) {
    const lines = removals.map((removal, k) =>
      make(k === removals.length - 1 ? "tr.last" : "tr", {},
        make("td", {}, removal.rule), make("td.number", {}, countText(removal.before - removal.after)), make("td.number", {}, countText(removal.after))));
    parts.push(make("table", {}, make("caption.unseen", {}, "What each rule takes away"),
      make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "Rule"), make("th.number", { scope: "col" }, "takes"), make("th.number", { scope: "col" }, "leaves"))),
      make("tbody", {}, ...lines)));
  }
  if (asked_words) parts.push(make("p", {}, asked_words));
  if (nearest) parts.push(make("h3", {}, "The nearest miss, as drawn"), make("p", {}, sentence(nearest.words)));
  if (heights) parts.push(heights);
  parts.push(make("h3", {}, "What would help"));
  if (helps.length) parts.push(make("div.helps", {}, ...helps.map(helpButton)));
  else parts.push(make("p", {}, "No single change that was tried gives a fixture."));
  parts.push(make("div", {}, make("button.strong", { type: "button", click: openComparison }, "Try all others")));
  box.replaceChildren(...parts);
}

/** A change that helps, as a button where the page can make it. */
function helpButton(help) {
  const count = `${help.complete ? "" : "over "}${countText(help.fixtures)}`;
  const words = `${help.change}: ${count} fixture${help.fixtures === 1 ? "" : "s"}`;
  // What helps only together is more than one change of the settings.
  const patch = help.rules.length > 1 ? null : help.toolkit ? { toolkit: withFields(state.toolkit, help.toolkit), toolkitName: "own" } : appliedHelp(help.change, state);
  if (!patch) return make("p", {}, words);
  return make("button", { type: "button", click: () => change(patch) }, words);
}

/** Words with a capital letter. */
function sentence(words) {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/**
 * The change of the settings that a help in words means, where it is not a change of the toolkit; null for words that are not known here.
 * @param {string} words as the server says them
 * @param {import("./state.js").State} state
 * @returns {Partial<import("./state.js").State>|null}
 */
function appliedHelp(words, state) {
  const face = /^touching face (\d+) too$/.exec(words);
  if (face) return { avoid: state.avoid.filter((number) => number !== Number(face[1])) };
  if (/^touching faces /.test(words)) return { avoid: [] };
  if (words.startsWith("without the keep-out zones")) return { zones: [] };
  if (words.startsWith("at any angle")) return { angles: [] };
  if (words.startsWith("without a contact margin")) return { asked: { ...state.asked, contact_margin: 0 } };
  return null;
}
