/**
 * Lengths in mm and what people read and type: mm or inches. The program reckons in mm; only words and fields change.
 */
import { state } from "./state.js";

const MM_PER_INCH = 25.4;

/** Millimetres in the unit that is shown. */
export function scale() {
  return state.unit === "inch" ? MM_PER_INCH : 1;
}

/** The short name of the unit that is shown. */
export function unitWord() {
  return state.unit === "inch" ? "in" : "mm";
}

/**
 * A number with few decimals, its minus sign a real one.
 * @param {number} value
 * @param {number} decimals
 */
export function number(value, decimals) {
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}

/**
 * A length for reading, such as "73.166 mm".
 * @param {number} mm
 * @param {number} [decimals] of millimetres; inches get one more
 */
export function length(mm, decimals = 3) {
  return `${bareLength(mm, decimals)} ${unitWord()}`;
}

/**
 * As {@link length}, without the unit.
 * @param {number} mm
 * @param {number} [decimals]
 */
export function bareLength(mm, decimals = 3) {
  return number(mm / scale(), decimals + (state.unit === "inch" ? 1 : 0));
}

/**
 * A length as a field holds it: no more decimals than it has.
 * @param {number|null|undefined} mm
 */
export function fieldLength(mm) {
  return mm === null || mm === undefined ? "" : String(Number((mm / scale()).toPrecision(9)));
}

/**
 * The mm of a field; null when it is empty, NaN when it is no number.
 * @param {string} text
 */
export function readLength(text) {
  const value = readNumber(text);
  return value === null ? null : value * scale();
}

/**
 * The number of a field; null when it is empty. A comma may stand for the point.
 * @param {string} text
 */
export function readNumber(text) {
  const plain = text.trim().replace(",", ".").replace("\u2212", "-");
  return plain === "" ? null : Number(plain);
}

/**
 * A figure of quality for reading, with its unit.
 * @param {{key: string, unit: string}} figure
 * @param {number|null|undefined} value
 */
export function figureText(figure, value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (figure.unit === "mm") return length(value, ["location_error", "pin_deflection", "pin_movement"].includes(figure.key) ? 4 : 2);
  if (figure.unit === "deg") return `${number(value, figure.decimals)}°`;
  if (figure.unit === "MPa") return `${number(value, 0)} MPa`;
  if (figure.unit === "N") return `${number(value, 0)} N`;
  return number(value, figure.key === "clamp_amplification" ? 2 : figure.decimals);
}

/**
 * A count with thin groups of three.
 * @param {number} count
 */
export function countText(count) {
  return String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}
