/**
 * The fixtures of a result in a notebook: step through them, push the part, close what holds it.
 *
 * Python draws the picture and computes all forces; here they are shown, and what the user does is sent. An arrow is
 * [x, y, x of the tip, y of the tip] in units of the picture. There are no ids, so many widgets share a page.
 */

const SVG = "http://www.w3.org/2000/svg";
/** Pixels within which the ends of the arrow are taken hold of. */
const HOLD = 20;
/** Units of the picture that a key moves an end by, and with Shift. */
const STEP = 8;
const FINE = 1;
/** Milliseconds after which Python is missed, and that a closing takes at least and at most. */
const PATIENCE = 4000;
const SHORTEST = 700;
const LONGEST = 2400;
const MISSED = "No Python answers here: the picture stands as it was stored. Run the cell again.";

/** Make an element of HTML, or of SVG where it is one of its names. */
function make(tag, attributes = {}, ...children) {
  const [name, ...classes] = tag.split(".");
  const drawn = ["circle", "g", "line", "path", "text"].includes(name);
  const element = drawn ? document.createElementNS(SVG, name) : document.createElement(name);
  if (classes.length) element.setAttribute("class", classes.map((one) => `workhold-${one}`).join(" "));
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(key, value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(key, value === true ? "" : String(value));
  }
  element.append(...children);
  return element;
}

/** An arrow with its head, of a class. */
function arrow([x, y, toX, toY], kind) {
  const length = Math.hypot(toX - x, toY - y);
  if (length < 1) return make("g");
  const [dx, dy] = [(toX - x) / length, (toY - y) / length];
  const head = Math.min(13, length);
  const back = [toX - head * dx, toY - head * dy];
  const wing = 0.36 * head;
  const points = [[toX, toY], [back[0] - wing * dy, back[1] + wing * dx], [back[0] + wing * dy, back[1] - wing * dx]];
  const d = `M${points.map((point) => point.join(" ")).join("L")}Z`;
  const ends = { x1: x, y1: y, x2: back[0] + 1 * dx, y2: back[1] + 1 * dy };
  return make(`g.${kind}`, {}, make("line.rim", ends), make("path.rim", { d }), make("line.shaft", ends), make("path.head", { d }));
}

/** One view of the widget. */
class View {
  constructor(model, el) {
    this.model = model;
    this.el = el;
    /** The arrow as it is dragged; null where Python's stands. */
    this.held = null;
    this.end = "";
    this.waiting = 0;
    this.next = null;
    this.number = 0;
    this.frame = 0;
    this.timer = 0;
    this.build();
    this.listen();
    this.draw();
    this.write();
  }

  /** Make what stays. */
  build() {
    const button = (words, label, click) => make("button.button", { type: "button", "aria-label": label, title: label, click }, words);
    this.rank = make("input.rank", { type: "number", min: 1, step: 1, "aria-label": "Number of the fixture", change: () => this.step(Number(this.rank.value)) });
    this.of = make("span");
    this.jaw = make("input.jaw", { type: "number", min: 0, step: 50, placeholder: "as needed", change: () => this.press() });
    this.mover = make("span");
    this.closeButton = button("Close", "Close what holds the part, from open", () => this.close());
    this.picture = make("div.picture");
    this.title = make("p.title");
    this.bars = make("div.bars");
    this.words = make("p.words", { "aria-live": "polite" });
    this.figures = make("p.figures");
    this.note = make("p.note", { role: "status" });
    this.el.append(
      make("div.widget", {},
        make("div.tools", {},
          button("‹", "The fixture before", () => this.step(this.model.get("rank") - 1)),
          make("label", {}, "Fixture ", this.rank, this.of),
          button("›", "The next fixture", () => this.step(this.model.get("rank") + 1)),
          this.closeButton,
          button("Push", "Push the middle of the part with a force", () => this.pushMiddle()),
          button("No force", "Take the force away", () => this.send([0, 0, 0, 0])),
          make("label", {}, this.mover, this.jaw, " N")),
        this.title, this.picture, this.bars, this.words, this.figures, this.note),
    );
  }

  /** Listen to Python and to the pointer. */
  listen() {
    const heard = {
      "change:picture": () => this.draw(),
      "change:answer": () => this.answered(),
      "change:closing": () => this.closed(),
      "change:count": () => this.write(),
      "change:rank": () => this.write(),
      "change:jaw_force": () => this.write(),
    };
    for (const [name, call] of Object.entries(heard)) this.model.on(name, call);
    this.forget = () => {
      cancelAnimationFrame(this.frame);
      clearTimeout(this.timer);
      for (const [name, call] of Object.entries(heard)) this.model.off(name, call);
    };
    this.picture.addEventListener("pointerdown", (event) => this.down(event));
    this.picture.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) this.picture.addEventListener(name, () => (this.end = ""));
  }

  /** Put Python's picture in its place. */
  draw() {
    cancelAnimationFrame(this.frame);
    const { svg, title } = this.model.get("picture");
    const read = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
    this.svg = document.importNode(read, true);
    for (const name of ["width", "height"]) this.svg.removeAttribute(name);
    this.svg.setAttribute("role", "group");
    this.svg.setAttribute("aria-label", title);
    this.part = this.svg.querySelector("g.part");
    this.movers = [...this.svg.querySelectorAll("g.moves")].map((group) => this.moverOf(group));
    this.over = make("g.over");
    this.svg.append(this.over);
    this.picture.replaceChildren(this.svg);
    this.held = null;
    this.heard();
    this.write();
  }

  /** What moves: its group and its way; a bolted clamp stays, and its bars grow as its tip goes out. */
  moverOf(group) {
    const way = group.dataset.way.split(" ").map(Number);
    const bars = group.querySelector(".clamp .bolt") ? [...group.querySelectorAll('.clamp > path[stroke-linecap="round"]')] : [];
    return { group, way, bars: bars.map((bar) => ({ bar, at: bar.getAttribute("d").match(/-?[\d.]+/g).map(Number) })) };
  }

  /** Write the words around the picture, and its arrows. */
  write() {
    const { model } = this;
    const { title, figures, mover } = model.get("picture");
    this.rank.value = model.get("rank");
    this.rank.max = model.get("count");
    this.of.textContent = ` of ${model.get("count")}`;
    this.title.textContent = title;
    this.mover.textContent = `Force of the ${mover} `;
    if (document.activeElement !== this.jaw) this.jaw.value = model.get("jaw_force") || "";
    this.figures.textContent = figures.map(([name, value]) => `${name} ${value}`).join(" · ");
    this.arrows();
  }

  /** Write what the force does. */
  arrows() {
    const answer = this.model.get("answer");
    const own = this.held ?? answer.arrow;
    const focused = this.over.querySelector(":focus")?.dataset.end;
    this.over.replaceChildren(
      ...answer.forces.map((one) => arrow(one.arrow, one.pulls ? "pulls" : "force")),
      ...(own ? [arrow(own, "push"), this.size(own, answer.size), this.handle(own, "at"), this.handle(own, "tip")] : []),
    );
    if (focused) this.over.querySelector(`[data-end="${focused}"]`)?.focus();
    this.bars.replaceChildren(
      ...answer.forces.flatMap((one) => {
        const fill = make(one.pulls ? "div.fill.pulling" : "div.fill");
        fill.style.width = `${100 * one.share}%`;
        return [make("b", {}, one.hole), make("div.track", { "aria-hidden": "true" }, fill), make("span.number", {}, one.words)];
      }),
    );
    const sign = answer.holds === null || answer.holds === undefined ? "" : answer.holds ? "Holds. " : "The part is not held. ";
    const said = `${sign}${answer.words}`;
    if (this.words.textContent !== said) this.words.textContent = said;
    this.words.classList.toggle("workhold-lost", answer.holds === false);
  }

  /** The size of the force beside the tip of its arrow. */
  size([x, y, toX, toY], words) {
    const length = Math.hypot(toX - x, toY - y) || 1;
    const at = { x: toX + (26 * (toX - x)) / length, y: toY + (16 * (toY - y)) / length + 5 };
    return make("text.size", { ...at, "text-anchor": "middle" }, words ?? "");
  }

  /** An end of the arrow that is taken hold of, also by keys. */
  handle(own, end) {
    const [cx, cy] = end === "at" ? own : own.slice(2);
    const label = end === "at" ? "Where the force acts: arrow keys move it" : "How the force points: arrow keys turn and stretch it";
    return make(`circle.handle.${end}`, {
      cx, cy, r: 7, tabindex: 0, role: "button", "aria-label": label, "data-end": end, keydown: (event) => this.key(event, end),
    });
  }

  /** The point of the picture under a pointer. */
  under(event) {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    return [point.x, point.y];
  }

  /** Take hold of an end, or begin a new arrow. */
  down(event) {
    if (event.button !== 0 || !this.svg) return;
    event.preventDefault();
    this.still();
    const [x, y] = this.under(event);
    const unit = this.svg.getScreenCTM().a || 1;
    const own = this.model.get("answer").arrow;
    const near = (px, py) => Math.hypot(px - x, py - y) * unit < HOLD;
    this.held = own ? [...own] : null;
    if (own && near(own[2], own[3])) this.end = "tip";
    else if (own && near(own[0], own[1])) this.end = "at";
    else {
      this.end = "tip";
      this.held = [x, y, x, y];
    }
    this.from = [x, y];
    this.picture.setPointerCapture(event.pointerId);
  }

  /** The end that is held follows the pointer. */
  move(event) {
    if (!this.end) return;
    const [x, y] = this.under(event);
    if (this.end === "tip") this.held = [this.held[0], this.held[1], x, y];
    else this.held = this.held.map((value, k) => value + (k % 2 ? y - this.from[1] : x - this.from[0]));
    this.from = [x, y];
    this.arrows();
    this.send(this.held);
  }

  /** Arrow keys move an end. */
  key(event, end) {
    const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const way = ways[event.key];
    if (!way) return;
    // A notebook has keys of its own.
    event.preventDefault();
    event.stopPropagation();
    const by = event.shiftKey ? FINE : STEP;
    const own = [...(this.held ?? this.model.get("answer").arrow)];
    for (const k of end === "at" ? [0, 1, 2, 3] : [2, 3]) own[k] += by * way[k % 2];
    this.held = own;
    this.arrows();
    this.send(own);
  }

  /** Push the middle of the part downward. */
  pushMiddle() {
    const [x, y] = this.model.get("closing").center;
    this.held = [x, y, x, y + 100];
    this.arrows();
    this.send(this.held);
  }

  /** Send an arrow to Python; while it computes, the last one waits. */
  send(own) {
    this.still();
    if (this.waiting) {
      this.next = own;
      return;
    }
    this.waiting = ++this.number;
    this.set("dragged", [...own, this.number]);
    this.miss();
  }

  /** Python has said what the force does. */
  answered() {
    const { number } = this.model.get("answer");
    this.heard();
    if (number && number !== this.waiting) return;
    const next = this.next;
    this.waiting = 0;
    this.next = null;
    if (next) this.send(next);
    else if (!this.end) this.held = null;
    this.arrows();
  }

  /** Show another fixture. */
  step(rank) {
    const next = Math.min(Math.max(Math.round(rank) || 1, 1), this.model.get("count"));
    this.rank.value = next;
    if (next === this.model.get("rank")) return;
    this.set("rank", next);
    this.miss();
  }

  /** Press with another force. */
  press() {
    this.set("jaw_force", Math.max(Number(this.jaw.value) || 0, 0));
    this.miss();
  }

  /** Ask Python how it closes. */
  close() {
    this.words.textContent = "…";
    this.set("asked_closing", this.model.get("asked_closing") + 1);
    this.miss(() => this.play());
  }

  /** Python has said how it closes. */
  closed() {
    this.heard();
    const { number } = this.model.get("closing");
    if (number && number === this.model.get("asked_closing")) this.play();
  }

  /** Set a trait, where there is somebody to hear it. */
  set(name, value) {
    this.model.set(name, value);
    try {
      this.model.save_changes();
    } catch {
      // Without a kernel; what is missed is said.
    }
  }

  /** Say after a while that Python is missed. */
  miss(then = () => {}) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.note.textContent = MISSED;
      this.waiting = 0;
      this.next = null;
      this.held = null;
      then();
      this.arrows();
    }, this.constructor.patience);
  }

  /** Python is there. */
  heard() {
    clearTimeout(this.timer);
    this.note.textContent = "";
  }

  /** Show a moment of a closing. */
  place([turned, dx, dy, open]) {
    const [x, y] = this.model.get("closing").center;
    this.part.setAttribute("transform", `translate(${dx} ${dy}) rotate(${-turned} ${x} ${y})`);
    for (const { group, way, bars } of this.movers) {
      const [ax, ay] = [-way[0] * open, -way[1] * open];
      for (const { bar, at } of bars) bar.setAttribute("d", `M${at[0]} ${at[1]}L${at[2] + ax} ${at[3] + ay}`);
      if (!bars.length) group.setAttribute("transform", `translate(${ax} ${ay})`);
    }
  }

  /** Nothing moves; all is in its place. */
  still() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.place([0, 0, 0, 0]);
    this.over.removeAttribute("visibility");
  }

  /** Show the closing, at once for those who want no motion. */
  play() {
    cancelAnimationFrame(this.frame);
    const { keyframes, words } = this.model.get("closing");
    const ended = () => {
      this.place(keyframes.at(-1));
      this.over.removeAttribute("visibility");
      if (words) this.words.textContent = words;
      else this.arrows();
    };
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) {
      ended();
      return;
    }
    this.over.setAttribute("visibility", "hidden");
    this.place(keyframes[0]);
    const takes = Math.min(Math.max(SHORTEST, 25 * keyframes.length), LONGEST);
    const begun = performance.now();
    const frame = (now) => {
      const share = Math.min(1, Math.max(0, (now - begun) / takes));
      const along = (1 - (1 - share) ** 2) * (keyframes.length - 1);
      const before = Math.min(Math.floor(along), keyframes.length - 2);
      const [one, other] = [keyframes[Math.max(before, 0)], keyframes[before + 1] ?? keyframes.at(-1)];
      this.place(one.map((value, k) => value + (along - before) * (other[k] - value)));
      if (share < 1) this.frame = requestAnimationFrame(frame);
      else ended();
    };
    this.frame = requestAnimationFrame(frame);
  }
}
View.patience = PATIENCE;

/** Show a model in an element; what is returned ends it. */
function render({ model, el }) {
  const view = new View(model, el);
  return () => view.forget();
}

export default { render };
