/**
 * Elements made and found in few words. Nothing here writes markup from text, so no name of a part can become code.
 */

const SVG = "http://www.w3.org/2000/svg";

/**
 * The element with an id that is known to be there.
 * @param {string} id
 * @returns {HTMLElement}
 */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`no element ${id}`);
  return element;
}

/** A field to type in or to tick, by its id. @param {string} id */
export const field = (id) => /** @type {HTMLInputElement} */ (byId(id));

/** A list to choose from, by its id. @param {string} id */
export const choice = (id) => /** @type {HTMLSelectElement} */ (byId(id));

/**
 * Give an element its attributes: functions become listeners, true and false set and remove, null is left out.
 * @param {Element} element
 * @param {Object<string, any>} attributes
 */
export function setAttributes(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (value === true) element.setAttribute(name, "");
    else if (value === false || value === null || value === undefined) element.removeAttribute(name);
    else element.setAttribute(name, String(value));
  }
}

/**
 * Make an HTML element.
 * @param {string} tag may carry classes, such as "td.number"
 * @param {Object<string, any>} [attributes]
 * @param {...(Node|string|number)} children
 * @returns {HTMLElement}
 */
export function make(tag, attributes = {}, ...children) {
  const [name, ...classes] = tag.split(".");
  const element = document.createElement(name);
  if (classes.length) element.className = classes.join(" ");
  setAttributes(element, attributes);
  element.append(...children.map((child) => (typeof child === "number" ? String(child) : child)));
  return element;
}

/**
 * Make an SVG element.
 * @param {string} tag may carry classes, such as "circle.peg"
 * @param {Object<string, any>} [attributes]
 * @param {...(Node|string)} children
 * @returns {SVGElement}
 */
export function draw(tag, attributes = {}, ...children) {
  const [name, ...classes] = tag.split(".");
  const element = /** @type {SVGElement} */ (document.createElementNS(SVG, name));
  if (classes.length) element.setAttribute("class", classes.join(" "));
  setAttributes(element, attributes);
  element.append(...children);
  return element;
}

/**
 * Show or hide an element.
 * @param {Element} element
 * @param {boolean} shown
 */
export function show(element, shown) {
  element.toggleAttribute("hidden", !shown);
}

/**
 * Call a function once things have been quiet for a while.
 * @param {(...values: any[]) => void} call
 * @param {number} milliseconds
 */
export function quiet(call, milliseconds) {
  let timer = 0;
  return (...values) => {
    clearTimeout(timer);
    timer = window.setTimeout(() => call(...values), milliseconds);
  };
}
