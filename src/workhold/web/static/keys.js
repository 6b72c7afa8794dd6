/**
 * Keys that work all over the page, except where something is typed.
 */
import { byId } from "./dom.js";
import { togglePush } from "./forces-panel.js";
import { stopZone } from "./rules-panel.js";
import { step } from "./selection.js";
import { closeVise, leaveDrawing, togglePin } from "./stage-panel.js";
import { state } from "./state.js";
import { leaveTrial, toggleTrial } from "./trial-panel.js";

const KEYS = {
  ArrowLeft: () => step(-1),
  ArrowRight: () => step(1),
  c: closeVise,
  f: togglePush,
  p: togglePin,
  t: toggleTrial,
};

/** Listen to the keys. */
export function listenToKeys() {
  byId("show-keys").addEventListener("click", () => /** @type {HTMLDialogElement} */ (byId("keys")).showModal());
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    const target = /** @type {HTMLElement} */ (event.target);
    if (target.closest("input:not([type=checkbox]), select, textarea, dialog")) return;
    if (event.key === "Escape") {
      stopZone();
      leaveDrawing();
      leaveTrial();
      return;
    }
    if (event.shiftKey || state.view !== "fixture" || !state.selected) return;
    const call = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!call) return;
    event.preventDefault();
    call();
  });
}
