/**
 * The list of fixtures: only the rows in sight exist, so ten thousand scroll like ten.
 */
import { ApiError, downloadPath, fetched } from "./api.js";
import { draw, make } from "./dom.js";
import { pictureOf } from "./fixture-drawing.js";
import { writtenTurn } from "./pose.js";
import { isSame } from "./selection.js";
import { state } from "./state.js";
import { figureText, length, number, shownFigures } from "./units.js";

const ROW = 88;
/** Milliseconds that a row stays in sight before its small picture is asked for. */
const STAYS = 40;
const SPARE = 4;
/** Browsers end at about 33 million pixels; beyond this many the scroll bar is scaled. */
const HIGHEST = 12_000_000;

/** What is shown of a row that friction holds, what tells most first. */
const OF_FRICTION = ["clamp_needed", "safety_reached", "grip", "location_error", "edge_distance"];

/** A scrolling list over rows that come in pages. */
export class FixtureList {
  /**
   * @param {HTMLElement} frame scrolls, and is the listbox
   * @param {(index: number, row: any) => void} chosen
   */
  constructor(frame, chosen) {
    this.frame = frame;
    this.chosen = chosen;
    this.inner = make("div.list-inner", { role: "presentation" });
    frame.append(this.inner);
    /** @type {any[]} */
    this.figures = [];
    this.rows = null;
    this.first = 0;
    this.last = -1;
    this.index = -1;
    /** @type {Map<number, any>} elements by row index */
    this.cells = new Map();
    this.spare = [];
    frame.addEventListener("scroll", () => this.paint(), { passive: true });
    new ResizeObserver(() => this.paint()).observe(frame);
    frame.addEventListener("keydown", (event) => this.key(event));
  }

  /** Show other rows, from the top. */
  use(rows) {
    this.rows = rows;
    this.frame.scrollTop = 0;
    this.clear();
    this.paint();
  }

  /** Throw the cells away: what they show has changed. */
  clear() {
    for (const cell of this.cells.values()) this.put(cell);
    this.cells.clear();
  }

  /** Lay a cell aside for another row. */
  put(cell) {
    cell.element.remove();
    this.spare.push(cell);
  }

  /** How much taller the list is than what can be scrolled. */
  get squeeze() {
    return Math.max(1, ((this.rows?.total ?? 0) * ROW) / HIGHEST);
  }

  /** Make the rows in sight, and only those. */
  paint() {
    const total = this.rows?.total ?? 0;
    const height = this.frame.clientHeight;
    this.inner.style.height = `${Math.min(total * ROW, HIGHEST)}px`;
    const { squeeze } = this;
    const top = this.frame.scrollTop;
    const shown = squeeze === 1 ? top : (top / Math.max(1, HIGHEST - height)) * Math.max(0, total * ROW - height);
    this.shift = top - shown;
    this.first = Math.max(0, Math.floor(shown / ROW) - SPARE);
    this.last = Math.min(total - 1, Math.ceil((shown + height) / ROW) + SPARE);
    for (const [index, cell] of this.cells) {
      if (index < this.first || index > this.last) {
        this.put(cell);
        this.cells.delete(index);
      }
    }
    for (let index = this.first; index <= this.last; index += 1) this.cell(index, total);
    if (!total && this.rows && !this.rows.known) this.rows.at(0);
  }

  /** The cell of a row, filled as soon as the row is there. */
  cell(index, total) {
    let cell = this.cells.get(index);
    if (!cell) {
      cell = this.spare.pop() ?? this.made();
      cell.row = null;
      cell.element.id = `fixture-${index}`;
      cell.element.dataset.index = String(index);
      this.cells.set(index, cell);
      this.inner.append(cell.element);
    }
    cell.element.style.transform = `translateY(${index * ROW + this.shift}px)`;
    cell.element.setAttribute("aria-setsize", String(total));
    cell.element.setAttribute("aria-posinset", String(index + 1));
    const row = this.rows.at(index);
    if (row && cell.row !== row) this.fill(cell, row);
    if (!row && cell.row === null) cell.element.classList.add("coming");
    const chosen = index === this.index;
    cell.element.setAttribute("aria-selected", String(chosen));
    if (chosen) this.frame.setAttribute("aria-activedescendant", cell.element.id);
  }

  /** An empty cell. */
  made() {
    const picture = draw("svg.thumbnail.picture", { viewBox: "0 0 84 72", "aria-hidden": "true" });
    const title = make("span.row-title");
    const holes = make("span.row-holes");
    const figures = make("span.row-figures");
    const element = make("div.row", { role: "option", "aria-selected": "false" }, picture, make("span.row-words", {}, title, holes, figures));
    element.addEventListener("click", () => {
      const index = Number(element.dataset.index);
      const row = this.rows?.at(index);
      if (row) this.chosen(index, row);
    });
    return { element, picture, title, holes, figures, row: null };
  }

  /** Fill a cell. */
  fill(cell, row) {
    cell.row = row;
    cell.element.classList.remove("coming");
    cell.element.classList.toggle("unfit", Boolean(row.unfit));
    cell.title.replaceChildren(
      make("span", {}, make("b", {}, `${row.rank}`), ` ${row.title} `, make("span.faint", {}, `${number(writtenTurn(row), 1)}°`)),
      row.like ? make("span.faint.small", { title: `and ${row.like} like it` }, `+${row.like} alike`) : "",
    );
    // What has no room in the line is left out of it.
    cell.holes.replaceChildren(make("span", {}, row.holes.join("  ")), make("span", {}, row.settings.map((one) => `${one.sign} ${length(one.length, 2)}`).join("  ")));
    const { caught } = row;
    const opening = caught && (caught.opening === null ? "always" : length(caught.opening, 2));
    cell.figures.replaceChildren(
      ...(caught ? [make("span.row-figure", { title: "how far open the jaws may stand" }, make("i", {}, "caught "), opening)] : []),
      ...this.shownFigures(row).slice(0, caught ? 2 : 3).map((figure) =>
        make(`span.row-figure${figure.key === state.list.sort ? ".sorted" : ""}`, { title: figure.words },
          make("i", {}, `${figure.short} `), figureText(figure, shownFigures(row)[figure.key])),
      ),
    );
    this.showSmall(cell, row);
  }

  /** Show the small picture of a row, as soon as it has come. */
  async showSmall(cell, row) {
    const { job, revision, ending } = this.rows;
    if (cell.drawn && isSame(cell.drawn, row)) row.small ??= cell.drawn.small;
    else cell.picture.replaceChildren();
    if (!row.small) {
      await new Promise((resolve) => setTimeout(resolve, STAYS));
      if (cell.row !== row) return;
      try {
        row.small = await (await fetched(downloadPath(job, row.rank, "small.svg", { revision }), { signal: ending.signal })).content.text();
      } catch (error) {
        if (!(error instanceof ApiError) && error.name !== "AbortError") throw error;
      }
    }
    // Where the list has changed meanwhile there is none: other rows come, with pictures of their own.
    if (cell.row !== row || !row.small) return;
    cell.drawn = row;
    cell.picture.replaceChildren(...pictureOf(row.small).groups);
  }

  /** Three figures of a row at most: the one sorted by first, then warnings and what tells most. */
  shownFigures(row) {
    const first = this.figures.filter((figure) => figure.key === state.list.sort);
    const strong = state.loads.length ? "load_reaction" : "clamp_amplification";
    // Where friction holds the part, only figures that the row has.
    const usual = row.hold
      ? OF_FRICTION.filter((key) => typeof shownFigures(row)[key] === "number")
      : ["warnings", "location_error", strong, "closure_margin"];
    const rest = usual.map((key) => this.figures.find((figure) => figure.key === key)).filter((f) => f && f !== first[0]);
    return [...first, ...rest].slice(0, 3);
  }

  /** Rows have come or changed. */
  update() {
    this.paint();
  }

  /** Mark a row, and bring it into sight. */
  choose(index, reveal = true) {
    this.index = index;
    if (index < 0) this.frame.removeAttribute("aria-activedescendant");
    else if (reveal) this.reveal(index);
    this.paint();
  }

  /** Scroll so that a row is in sight. */
  reveal(index) {
    const { squeeze, frame } = this;
    const height = frame.clientHeight;
    if (squeeze > 1) {
      const total = this.rows.total * ROW;
      frame.scrollTop = (Math.min(index * ROW, total - height) / (total - height)) * (HIGHEST - height);
    } else if (index * ROW < frame.scrollTop) frame.scrollTop = index * ROW;
    else if ((index + 1) * ROW > frame.scrollTop + height) frame.scrollTop = (index + 1) * ROW - height;
  }

  /** Up, down, Home, End and the page keys choose. @param {KeyboardEvent} event */
  key(event) {
    const total = this.rows?.total ?? 0;
    const page = Math.max(1, Math.floor(this.frame.clientHeight / ROW) - 1);
    const moves = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -total, End: total };
    const move = moves[event.key];
    if (!move || !total) return;
    event.preventDefault();
    this.go(Math.min(total - 1, Math.max(0, this.index + move)));
  }

  /** Choose a row that may not have come yet. */
  async go(index) {
    const { rows } = this;
    this.choose(index);
    const row = await rows?.whenAt(index);
    if (row && this.rows === rows && this.index === index) this.chosen(index, row);
  }
}
