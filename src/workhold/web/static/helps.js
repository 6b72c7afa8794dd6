/**
 * What the explanation says would help, as a change of the settings, where it is not a change of the toolkit.
 */

/**
 * The change of the state that a help in words means; null for words that are not known here.
 * @param {string} words as the server says them
 * @param {import("./state.js").State} state
 * @returns {Partial<import("./state.js").State>|null}
 */
export function appliedHelp(words, state) {
  const face = /^touching face (\d+) too$/.exec(words);
  if (face) return { avoid: state.avoid.filter((number) => number !== Number(face[1])) };
  if (/^touching faces /.test(words)) return { avoid: [] };
  if (words.startsWith("without the keep-out zones")) return { zones: [] };
  if (words.startsWith("at any angle")) return { angles: [] };
  if (words.startsWith("without a contact margin")) return { contactMargin: 0 };
  return null;
}
