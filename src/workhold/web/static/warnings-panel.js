/**
 * What to beware of with the fixture shown: the sentences of its setup sheet, for the force on the part if there is one.
 */
import { ApiError, ask } from "./api.js";
import { byId, make, quiet, show } from "./dom.js";
import { loadOf } from "./forces-panel.js";
import { on, state } from "./state.js";

/** Set the panel up. */
export function warningsPanel() {
  on(["selected", "force", "unit"], askSoon);
}

/**
 * What is asked about loads and jaw, for the sentences and for the sheet.
 * @param {any} [of] the state of this side or of the other
 * @returns {Object<string, string>}
 */
export function loadQuery({ force, loads } = state) {
  if (!force) return {};
  const query = {};
  if (force.jaw) query.jaw_force = String(force.jaw);
  if (force.kind !== undefined) query.jaw = String(force.kind);
  if (force.size > 0 || force.moment) {
    const pushed = loadOf(force);
    const others = loads.filter((load) => load.name !== pushed.name);
    query.loads = JSON.stringify([...others, pushed]);
  }
  return query;
}

let asked = 0;
const askSoon = quiet(async () => {
  const mine = ++asked;
  const { selected, job } = state;
  if (!selected?.rank || !job?.job) {
    show(byId("warnings-card"), false);
    show(byId("why-first"), false);
    return;
  }
  const query = new URLSearchParams({ unit: state.unit, ...loadQuery() });
  try {
    const found = await ask(`jobs/${encodeURIComponent(job.job)}/fixtures/${selected.rank}/warnings?${query}`);
    if (mine !== asked) return;
    const { warnings } = found;
    const reason = byId("why-first");
    reason.textContent = found.why_first ?? "";
    show(reason, Boolean(found.why_first));
    byId("warnings").replaceChildren(...warnings.map(({ kind, sentence }) => make(`li.${kind}`, {}, sentence)));
    show(byId("warnings-card"), warnings.length > 0);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (mine === asked) show(byId("warnings-card"), false);
  }
}, 120);
