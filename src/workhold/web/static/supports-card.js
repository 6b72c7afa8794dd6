/**
 * The card of supports and the clamp on top, as elements.
 */
import { draw, make } from "./dom.js";
import { unitWord } from "./units.js";

const HINT = "three supports and a clamp on top keep the part from tipping";
const TOOL = "The force of a tool along its axis, downward; negative where it pulls. It acts where the part is pushed, else at its centre";
const HEIGHT = "The height above the supports at which tool and push act";
const BELOW = "Drag a circle on the part, such as where a drill comes through";
const ABOVE = "Drag a circle on the part, such as where the cutter goes";

/** A field with its words; the unit stands behind them where it is a length. */
function field(id, words, { isLength = true, title = null, placeholder = null, labelId = null } = {}) {
  const unit = isLength ? [" ", make("span.unit", {}, unitWord())] : [];
  return make("label", { id: labelId, title }, words, ...unit, make("input", { id, inputmode: isLength ? "decimal" : null, autocomplete: "off", placeholder }));
}

/** A button that begins a circle, with those that there are. */
function keepOff(id, words, title) {
  return [make("button", { id, type: "button", "aria-pressed": "false", title }, words), " ", make("span.chips", { id: `${id}-zones` })];
}

/** A view from the side. */
function view(id, words, label) {
  const svg = draw("svg.side-view", { id, role: "img", "aria-label": label });
  return make("figure", {}, make("figcaption.small.faint", {}, words), svg);
}

/** The whole card. */
export function supportsCard() {
  return make("details.card.supports.wide", { id: "supports" },
    make("summary", {}, make("h2", {}, "Supports and clamp on top"), " ", make("span.faint", {}, HINT)),
    make("div.supports-body", {},
      make("div.grid-fields.narrow", {},
        field("support-thickness", "Part thickness", { labelId: "support-thickness-label" }),
        field("pad-radius", "Pad radius"), field("tip-radius", "Tip radius"),
        field("support-axial", "Tool presses N", { isLength: false, title: TOOL, placeholder: "0, or -20..60" }),
        field("support-height", "Load at height", { title: HEIGHT, placeholder: "upper side" })),
      make("div.row-of-buttons", {}, ...keepOff("support-below", "Keep pads off …", BELOW), " ", ...keepOff("support-above", "Keep the clamp off …", ABOVE)),
      make("p.small", { id: "supports-words", role: "status" }),
      make("div.trouble-box", { id: "supports-trouble", role: "alert", hidden: true }),
      make("div.sets", { id: "supports-table", hidden: true },
        make("table", {}, make("caption.unseen", {}, "The best sets of three supports"),
          make("thead", {}, make("tr", { id: "supports-heads" })), make("tbody", { id: "supports-sets" }))),
      make("div", { id: "supports-sides", hidden: true },
        make("div.sides", {},
          view("side-front", "From the front, to scale", "The set-up from the front, to scale"),
          view("side-right", "From the right", "The set-up from the right, to scale")),
        make("ul.legend.small.faint", {},
          make("li.of-band", {}, "heights at which a peg may press"), make("li.of-support", {}, "supports"), make("li.of-clamp", {}, "clamp on top"))),
      make("ul.small.faint", { id: "supports-notes" })));
}
