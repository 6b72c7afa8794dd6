/**
 * Which of all suits the part: the sweep over the presets, as a table whose lines can be taken.
 */
import { ApiError, ask, send } from "./api.js";
import { byId, make, show } from "./dom.js";
import { request, state } from "./state.js";
import { countText, figureText, shownFigures } from "./units.js";
import { titleOf, usePreset } from "./toolkit-panel.js";

const POLL = 250;
let latest = 0;
/** @type {any[]} */
let figures = [];

/** @param {any[]} known the figures of quality */
export function comparisonDialog(known) {
  figures = known;
  byId("sweep").addEventListener("click", openComparison);
  byId("comparison").addEventListener("close", () => (latest += 1));
}

/** Open the dialog and let the server compare. */
export async function openComparison() {
  if (!state.part) return;
  const mine = ++latest;
  const dialog = /** @type {HTMLDialogElement} */ (byId("comparison"));
  const bar = /** @type {HTMLProgressElement} */ (byId("comparison-progress"));
  byId("comparison-table").replaceChildren();
  bar.removeAttribute("value");
  show(bar, true);
  dialog.showModal();
  let job = null;
  try {
    const { toolkit, seating, opening, foolproof, ...rest } = request();
    ({ job } = await send("explore", { ...rest, tolerance: null, toolkits: null }));
    for (;;) {
      const answer = await ask(`jobs/${encodeURIComponent(job)}`);
      if (mine !== latest) break;
      write(answer.table ?? []);
      if (answer.fraction > 0) bar.value = answer.fraction;
      if (answer.error) throw new ApiError(answer.error, 400);
      if (["done", "failed", "cancelled"].includes(answer.state)) break;
      await new Promise((resolve) => setTimeout(resolve, POLL));
    }
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (mine === latest) byId("comparison-table").replaceChildren(make("p.trouble-box", {}, error.message));
  } finally {
    if (mine === latest) show(bar, false);
    if (job) ask(`jobs/${encodeURIComponent(job)}`, { method: "DELETE" }).catch(() => {});
  }
}

/** The table as far as it is known. */
function write(table) {
  if (!table.length) return;
  const shown = figures.filter((figure) => table.some((line) => figure.key in shownFigures(line)));
  const usual = ["warnings", "tilt", "location_error", "clamp_amplification", "closure_margin"];
  const columns = usual.map((key) => shown.find((figure) => figure.key === key)).filter(Boolean);
  const lines = table.map((line) => {
    const name = line.name ?? line.title ?? line.toolkit?.name ?? line.toolkit?.title ?? "";
    const total = line.fixtures ?? 0;
    const first = shownFigures(line);
    const take = () => {
      /** @type {HTMLDialogElement} */ (byId("comparison")).close();
      usePreset(name);
    };
    return make(total && !line.fit ? "tr.unfit" : "tr", {},
      make("th", { scope: "row", title: titleOf(name) }, name), make("td.number", {}, line.error ? "–" : `${line.estimated ? "about " : ""}${countText(total)}`),
      ...columns.map((figure) => make("td.number", {}, total ? figureText(figure, first[figure.key]) : "–")),
      make("td", {}, make("button", { type: "button", click: take, "aria-label": `Use ${name}` }, "Use")));
  });
  const heads = ["What you have", "Fixtures", ...columns.map((figure) => figure.words), ""];
  byId("comparison-table").replaceChildren(
    make("table", {}, make("caption.unseen", {}, "The first choice in each"),
      make("thead", {}, make("tr", {}, ...heads.map((words, k) => make(k && words ? "th.number" : words ? "th" : "td", words ? { scope: "col" } : {}, words)))),
      make("tbody", {}, ...lines)),
  );
}
