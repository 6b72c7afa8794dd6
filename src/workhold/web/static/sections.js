/**
 * On a phone one section of the page is shown at a time: the drawing first.
 */
import { byId } from "./dom.js";

/**
 * Show a section where there is room for one only.
 * @param {string} name "stage", "settings" or "results"
 */
export function showSection(name) {
  document.body.dataset.section = name;
  for (const button of document.querySelectorAll(".sections button")) {
    if (/** @type {HTMLElement} */ (button).dataset.to === name) button.setAttribute("aria-current", "true");
    else button.removeAttribute("aria-current");
  }
}

/** Listen to the tabs, and go where an action leads. */
export function listenToSections() {
  for (const button of document.querySelectorAll(".sections button")) {
    button.addEventListener("click", () => showSection(/** @type {HTMLElement} */ (button).dataset.to ?? "stage"));
  }
  const leads = { search: "results", "search-here": "results", example: "stage", "draw-part": "stage", list: "stage", "zone-circle": "stage", "zone-polygon": "stage" };
  for (const [id, name] of Object.entries(leads)) byId(id).addEventListener("click", () => showSection(name));
}
