/**
 * The card that offers the second side of a part, and the switch between both sides, as elements.
 */
import { make } from "./dom.js";
import { unitWord } from "./units.js";

/** The card. */
export function turnCard() {
  return make("section.card.turn.wide", { id: "turn-card", "aria-labelledby": "turn-title", hidden: true },
    make("h2", { id: "turn-title" }, "Then the second side"),
    make("p.small", { id: "turn-words" }),
    make("div.chips", { id: "turn-faces" }),
    make("div.row-of-buttons", {},
      make("button.strong", { id: "second-side", type: "button" }, "Second side"), " ",
      make("label.inline", {}, "Peg height there ", make("span.unit", {}, unitWord()), make("input.short", { id: "turn-height", inputmode: "decimal", autocomplete: "off" }))),
    make("div.trouble-box", { id: "turn-trouble", role: "alert", hidden: true }));
}

/** A button for each side. @param {string[]} words what the sides are called */
export function sideSwitch(words) {
  return make("div.segmented", { id: "sides", role: "group", "aria-label": "Side of the part", hidden: true },
    ...words.map((word, number) => make("button", { id: `side-${number}`, type: "button", "aria-pressed": "false" }, word)));
}
