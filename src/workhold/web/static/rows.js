/**
 * The fixtures of a search as the list shows them, fetched in pages as they come into sight.
 */
import { ApiError, ask } from "./api.js";

const PAGE = 40;
const MOST_PAGES = 300;

/** Fixtures of one job in one order. */
export class Rows {
  /**
   * @param {string} job
   * @param {{sort: string, descending: boolean, type: string, face: string, angle: string, each?: boolean, unfit?: boolean}} list
   * @param {() => void} changed called when rows or their number are known
   * @param {() => void} gone called when the server has forgotten the job
   */
  constructor(job, list, changed, gone) {
    this.job = job;
    this.list = list;
    this.changed = changed;
    this.gone = gone;
    this.total = 0;
    /** How many are left out because they are none for a workshop. */
    this.unfit = 0;
    /** The total is known. */
    this.known = false;
    this.revision = -1;
    /** @type {Map<number, any[]>} */
    this.pages = new Map();
    /** @type {Map<number, Promise<void>>} */
    this.asked = new Map();
    this.left = false;
    /** Ends what is fetched for these rows once they are left. */
    this.ending = new AbortController();
  }

  /** The address of some rows. */
  path(offset, limit) {
    const query = new URLSearchParams({ offset: String(offset), limit: String(limit), sort: this.list.sort });
    query.set("descending", String(this.list.descending));
    query.set("together", String(!this.list.each));
    query.set("unfit", String(Boolean(this.list.unfit)));
    for (const key of ["type", "face", "angle"]) if (this.list[key]) query.set(key, this.list[key]);
    return `jobs/${encodeURIComponent(this.job)}/fixtures?${query}`;
  }

  /** A row, or undefined until it has come; asking for it fetches it. */
  at(index) {
    const page = Math.floor(index / PAGE);
    const rows = this.pages.get(page);
    if (!rows) this.fetch(page);
    return rows?.[index - page * PAGE];
  }

  /** The place of the fixture of a rank, among the rows that have come; -1 where it is not one of them. @param {number} rank */
  placeOf(rank) {
    for (const [page, rows] of this.pages) {
      const place = rows.findIndex((row) => row.rank === rank);
      if (place >= 0) return page * PAGE + place;
    }
    return -1;
  }

  /** A row as soon as it has come; undefined when there is none. */
  async whenAt(index) {
    const page = Math.floor(index / PAGE);
    if (!this.pages.has(page)) await this.fetch(page);
    return this.pages.get(page)?.[index - page * PAGE];
  }

  /** Fetch a page once. */
  fetch(page) {
    const under = this.asked.get(page);
    if (under || this.left) return under ?? Promise.resolve();
    const going = ask(this.path(page * PAGE, PAGE))
      .then((answer) => {
        if (this.left) return;
        this.total = answer.total;
        this.unfit = answer.unfit;
        this.known = true;
        this.revision = answer.revision;
        this.pages.set(page, answer.rows);
        if (this.pages.size > MOST_PAGES) this.pages.delete(this.pages.keys().next().value);
        this.changed();
      })
      .catch((error) => {
        if (!(error instanceof ApiError)) throw error;
        if (error.status === 404 && !this.left) this.gone();
      })
      .finally(() => this.asked.delete(page));
    this.asked.set(page, going);
    return going;
  }

  /** Fetch again what is in sight, because more fixtures are known; what is shown stays until then. */
  async refresh(first, last) {
    const pages = [];
    for (let page = Math.floor(first / PAGE); page <= Math.floor(Math.max(first, last) / PAGE); page += 1) pages.push(page);
    await Promise.all(this.asked.values());
    for (const page of [...this.pages.keys()]) if (!pages.includes(page)) this.pages.delete(page);
    await Promise.all(pages.map((page) => this.fetch(page)));
  }

  /** No answer is wanted any more. */
  leave() {
    this.left = true;
    this.ending.abort();
  }
}
