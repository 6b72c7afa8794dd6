"use strict";
/*
 * A step of the lesson: one value that a slider, the arrow keys, a pointer in a picture or a finger changes, the
 * pictures that follow it, and one sentence with its numbers.
 */

/**
 * What a step is made of.
 * @typedef {Object} StepParts
 * @property {Picture[]} pictures in the order in which they stand
 * @property {[number, number]} range of the value
 * @property {number} by how far an arrow key moves it
 * @property {number} start the value at first
 * @property {(value: number) => void} draw fits and fills the pictures
 * @property {(value: number) => {words: string, numbers: Object<string, any>}} say the sentence and what stands in it
 * @property {((point: number[], grabbed: any) => number)[]} drag the value for a place in each picture
 * @property {(point: number[]) => any} [grab] what is held while the first picture is dragged
 * @property {(value: number) => number} [settle] a value nearby where the picture falls into place
 */

class Step {
  /** @param {string} id of the step's section */
  constructor(id) {
    this.section = document.getElementById(id);
    this.slider = this.section.querySelector("input[type=range]");
    this.output = this.section.querySelector("output");
    this.stage = this.section.querySelector(".pictures");
    this.slider.addEventListener("input", () => this.set(Number(this.slider.value)));
    new ResizeObserver(() => this.parts && this.draw()).observe(this.stage);
  }

  /** Shows the step of another lesson. @param {StepParts} parts */
  show(parts) {
    this.parts = parts;
    this.stage.replaceChildren(...parts.pictures.map((picture) => picture.svg));
    parts.pictures.forEach((picture, k) => this.listen(picture, parts.drag[k], k === 0));
    const [low, high] = parts.range;
    Object.assign(this.slider, { min: low, max: high, step: "any" });
    this.slider.onkeydown = (event) => this.press(event);
    this.set(parts.start);
  }

  /** Arrow keys move by a step that suits the picture, since the slider itself takes any value. */
  press(event) {
    const ways = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };
    if (!(event.key in ways)) return;
    event.preventDefault();
    this.set(this.value + ways[event.key] * this.parts.by);
  }

  /** Follows a pointer that goes down on what can be dragged, until it goes up. */
  listen(picture, drag, isFirst) {
    if (!drag) return;
    const { svg } = picture;
    let held = null;
    svg.onpointerdown = (event) => {
      if (event.button !== 0 || (!picture.own && !event.target.closest(".grab"))) return;
      svg.setPointerCapture(event.pointerId);
      const point = picture.under(event);
      held = { grabbed: isFirst && this.parts.grab ? this.parts.grab(point, this.value) : null };
      svg.classList.add("held");
      if (picture.own) this.set(drag(point, held.grabbed));
    };
    svg.onpointermove = (event) => {
      if (held) this.set(drag(picture.under(event), held.grabbed));
    };
    svg.onpointerup = svg.onpointercancel = () => {
      held = null;
      svg.classList.remove("held");
    };
  }

  /** Takes a value, moved into its range. */
  set(value) {
    const { range, settle } = this.parts;
    const inside = Math.min(range[1], Math.max(range[0], value));
    this.value = settle ? settle(inside) : inside;
    this.draw();
  }

  draw() {
    this.parts.draw(this.value);
    const { words, numbers } = this.parts.say(this.value);
    this.output.textContent = words;
    this.slider.value = String(this.value);
    this.slider.setAttribute("aria-valuetext", words);
    this.section.dataset.numbers = JSON.stringify(numbers);
  }
}

/**
 * The value in a range at which something is nearest: looked for on a grid, then between its neighbours.
 * @param {[number, number]} range
 * @param {(value: number) => number} distance
 */
function nearestValue([low, high], distance) {
  const steps = 160;
  const values = Array.from({ length: steps + 1 }, (_, k) => low + ((high - low) * k) / steps);
  const best = values.reduce((one, other) => (distance(other) < distance(one) ? other : one));
  let [from, to] = [Math.max(low, best - (high - low) / steps), Math.min(high, best + (high - low) / steps)];
  for (let k = 0; k < 40; k += 1) {
    const [one, other] = [from + (to - from) / 3, to - (to - from) / 3];
    if (distance(one) < distance(other)) to = other;
    else from = one;
  }
  return (from + to) / 2;
}
