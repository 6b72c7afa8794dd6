/**
 * Lengths in mm, forces in N and stresses in MPa, and what people read and type: with inches pounds and ksi as well.
 * The program reckons in mm, N and MPa; only words and fields change.
 */
import { state } from "./state.js";

const MM_PER_INCH = 25.4;
/** N in a pound-force, and MPa in a thousand of them to the square inch. */
const POUND = 0.45359237 * 9.80665;
const KSI = (1000 * POUND) / MM_PER_INCH ** 2;

/** Millimetres in the unit that is shown. */
export function scale() {
  return state.unit === "inch" ? MM_PER_INCH : 1;
}

/** The short name of the unit that is shown. */
export function unitWord() {
  return state.unit === "inch" ? "in" : "mm";
}

/** The short name of the unit of stress that is shown. */
export function pressureWord() {
  return state.unit === "inch" ? "ksi" : "MPa";
}

/** The short name of the unit of moment that is shown. */
export function momentWord() {
  return state.unit === "inch" ? "ft lbf" : "N mm";
}

/** MPa in the unit of stress that is shown. */
function stressScale() {
  return state.unit === "inch" ? KSI : 1;
}

/** Newtons in the unit of force that is shown. */
export function forceScale() {
  return state.unit === "inch" ? POUND : 1;
}

/** N mm in the unit of moment that is shown. */
function momentScale() {
  return state.unit === "inch" ? 12 * MM_PER_INCH * POUND : 1;
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
  return fieldNumber(mm, scale());
}

/** @param {number|null|undefined} value @param {number} unit how much the unit of the field is */
function fieldNumber(value, unit) {
  return value === null || value === undefined ? "" : String(Number((value / unit).toPrecision(9)));
}

/**
 * The mm of a field; null when it is empty, NaN when it is not a number.
 * @param {string} text
 */
export function readLength(text) {
  return readTimes(text, scale());
}

/** @param {string} text @param {number} unit how much the unit of the field is */
function readTimes(text, unit) {
  const value = readNumber(text);
  return value === null ? null : value * unit;
}

/**
 * The number of a field; null when it is empty. A comma may stand for the point.
 * @param {string} text
 */
export function readNumber(text) {
  const plain = text.trim().replace(",", ".").replace("\u2212", "-");
  return plain === "" ? null : Number(plain);
}

/** The figures of a fixture; an edge distance that stands for none is null. @param {any} row */
export function shownFigures(row) {
  const figures = { ...(row.quality ?? row.figures ?? {}) };
  // Between flat jaws nothing tilts; of a part whose thickness nobody knows no height is known.
  if (row.hold && !row.hold.straps) delete figures.tilt;
  if (row.hold?.knows_height === false) for (const key of ["grip", "above", "contact_area", "max_pressure"]) delete figures[key];
  return row.edgeless ? { ...figures, edge_distance: null } : figures;
}

/**
 * A figure of quality for reading, with its unit.
 * @param {{key: string, unit: string}} figure
 * @param {number|null|undefined} value
 */
export function figureText(figure, value) {
  if (value === null && figure.key === "edge_distance") return "none";
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (figure.unit === "mm") return length(value, ["location_error", "pin_deflection", "pin_movement"].includes(figure.key) ? 4 : 2);
  if (figure.unit === "deg") return `${number(value, figure.decimals)}°`;
  if (figure.unit === "MPa") return stressText(value);
  if (figure.unit === "N") return forceText(value);
  if (figure.unit === "mm²") return state.unit === "inch" ? `${number(value / 25.4 ** 2, 2)} in²` : `${number(value, 0)} mm²`;
  // More times than there are would be a promise.
  if (["slip_reserve", "safety_reached"].includes(figure.key)) return number(Math.floor(value * 100 + 1e-6) / 100, 2);
  return number(value, figure.key === "clamp_amplification" ? 2 : figure.decimals);
}

/**
 * A force for reading, such as "1000 N"; with inches in pounds, with newtons beside them.
 * @param {number} newtons
 */
export function forceText(newtons) {
  const own = `${number(newtons, 0)} N`;
  return state.unit === "inch" ? `${forceAlone(newtons)} (${own})` : own;
}

/**
 * As {@link forceText}, in the unit that is shown alone: for places with little room.
 * @param {number} newtons
 */
export function forceAlone(newtons) {
  return `${bareForce(newtons)} ${forceWord()}`;
}

/** The short name of the unit of force that is shown. */
export function forceWord() {
  return state.unit === "inch" ? "lbf" : "N";
}

/**
 * As {@link forceAlone}, without the unit.
 * @param {number} newtons
 */
export function bareForce(newtons) {
  return number(newtons / forceScale(), 0);
}

/**
 * A stress for reading, such as "896 MPa" or "130.0 ksi".
 * @param {number} stress in MPa
 */
export function stressText(stress) {
  return `${number(stress / stressScale(), state.unit === "inch" ? 1 : 0)} ${pressureWord()}`;
}

/**
 * A stress as a field holds it: no more decimals than it has.
 * @param {number|null|undefined} stress in MPa
 */
export function fieldStress(stress) {
  return fieldNumber(stress, stressScale());
}

/**
 * The MPa of a field; null when it is empty, NaN when it is not a number.
 * @param {string} text
 */
export function readStress(text) {
  return readTimes(text, stressScale());
}

/**
 * A force as a field holds it.
 * @param {number|null|undefined} newtons
 */
export function fieldForce(newtons) {
  return fieldNumber(newtons, forceScale());
}

/**
 * The newtons of a field; null when it is empty, NaN when it is not a number.
 * @param {string} text
 */
export function readForce(text) {
  return readTimes(text, forceScale());
}

/**
 * A moment in N mm as a field holds it.
 * @param {number|null|undefined} moment
 */
export function fieldMoment(moment) {
  return fieldNumber(moment, momentScale());
}

/**
 * The N mm of a field; null when it is empty, NaN when it is not a number.
 * @param {string} text
 */
export function readMoment(text) {
  return readTimes(text, momentScale());
}

/**
 * A count with thin groups of three.
 * @param {number} count
 */
export function countText(count) {
  return String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}
