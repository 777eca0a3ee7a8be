// Changes of the text: what the server answers as edits becomes one step of the editor, to be undone at once.

import { isolateHistory } from "./vendor/codemirror.min.js";

export function applyEdits(view, edits, what) {
  if (!edits.length) return false;
  const changes = edits.map(({ from, to, text }) => ({ from, to, insert: text }));
  const step = view.state.update({ changes, userEvent: `input.${what}`, annotations: isolateHistory.of("full"), scrollIntoView: true });
  view.dispatch(step);
  return true;
}

// Another whole text: only the stretch that differs is replaced, so that the cursor keeps its place.
export function replaceText(view, text, what) {
  const old = view.state.doc.toString();
  const wanted = text.replaceAll("\r\n", "\n");
  if (old === wanted) return false;
  const most = Math.min(old.length, wanted.length);
  let before = 0;
  while (before < most && old[before] === wanted[before]) before += 1;
  let after = 0;
  while (after < most - before && old[old.length - 1 - after] === wanted[wanted.length - 1 - after]) after += 1;
  return applyEdits(view, [{ from: before, to: old.length - after, text: wanted.slice(before, wanted.length - after) }], what);
}

export function select(view, from, to = from, { focus = true } = {}) {
  const end = view.state.doc.length;
  view.dispatch({ selection: { anchor: Math.min(from, end), head: Math.min(to, end) }, scrollIntoView: true, userEvent: "select" });
  if (focus) view.focus();
}
