/**
 * What the explanation says would help, as a change of the settings.
 */

/**
 * The change of the state that a help in words means; null for words that are not known here.
 * @param {string} words as the server says them
 * @param {import("./state.js").State} state
 * @returns {Partial<import("./state.js").State>|null}
 */
export function appliedHelp(words, state) {
  const { vise } = state;
  const without = (...keys) => ({
    vise: Object.fromEntries(Object.entries(vise).filter(([key]) => !keys.includes(key))), viseName: "own",
  });
  const face = /^touching face (\d+) too$/.exec(words);
  if (face) return { avoid: state.avoid.filter((number) => number !== Number(face[1])) };
  const gap = /^with a smallest gap of ([\d.e+-]+) mm$/.exec(words);
  if (gap) return { vise: { ...vise, min_gap: 2 * vise.peg_radius }, viseName: "own" };
  if (/^with the right jaw's rows offset by /.test(words)) {
    return { vise: { ...vise, row_offset: vise.pitch[1] / 2 }, viseName: "own" };
  }
  if (/^touching faces /.test(words)) return { avoid: [] };
  switch (words) {
    case "without the keep-out zones":
      return { zones: [] };
    case "at any angle":
      return { angles: [] };
    case "without a contact margin":
      return { contactMargin: 0 };
    case "with pegs without a shoulder":
      return without("body_radius");
    case "with no hole blocked":
      return without("blocked");
    case "with as many rows as needed":
      return without("rows");
    case "with a larger opening":
      return without("max_opening");
    case "with one more column on each jaw":
      return { vise: { ...vise, columns: vise.columns + 1 }, viseName: "own" };
    case "with half the pitch": {
      const pitch = vise.pitch.map((value) => value / 2);
      const { blocked, ...rest } = vise;
      const gapThen = vise.min_gap === undefined ? {} : { min_gap: Math.min(vise.min_gap, pitch[0]) };
      return { vise: { ...rest, pitch, ...gapThen }, viseName: "own" };
    }
    default:
      return null;
  }
}
