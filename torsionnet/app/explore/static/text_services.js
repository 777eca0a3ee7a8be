// What the server knows of the text at a place: completion, hover, definition, renaming, formatting, outline.

import { hoverTooltip, snippet } from "./vendor/codemirror.min.js";
import { ask, quietly } from "./api.js";
import { chooseOne, writeOne } from "./dialogs.js";
import { applyEdits, select } from "./edits.js";
import { say } from "./saying.js";

const BEGUN = /[\w.]$|\w\*$|[:,[{]\s$|:\s+[-+.\deE]+\s$/; // typing on here asks for words by itself
const NUMBER = /^\.?\d/;
const GAP = /(?<=: )(?=[,}\n]| Hz|$)|(?<=\[)(?=, |\])|(?<=, )(?=\])/g; // a value that is still to be written; Tab goes from one to the next
const KINDS = { "element type": "type", entry: "property", node: "variable", parameter: "constant", unit: "unit", size: "enum" };

export async function complete(context) {
  const { state, pos: at } = context;
  const line = state.doc.lineAt(at);
  if (!context.explicit && !BEGUN.test(line.text.slice(0, at - line.from))) return null;
  const begun = context.matchBefore(/[\w.]+/);
  if (begun && NUMBER.test(begun.text)) return null; // Enter ends a number, and nothing may hang on to it
  const text = state.doc.toString();
  // A question that came too late has taken the place of this one: it is asked again, unless nobody waits for it.
  const offered = async (place) => {
    const found = await ask("complete", { text, at: place }).catch(() => ({}));
    return found.superseded && !context.aborted ? offered(place) : (found.options ?? []);
  };
  // What was typed meanwhile is a question of its own, which the editor asks only behind an answer.
  const nothing = () => (context.view && context.view.state.doc !== state.doc ? { from: at, options: [] } : null);
  let options = await offered(at);
  if (context.aborted) return null;
  if (!options.length && begun) options = await offered(begun.from); // what may stand here, for the editor to choose from
  if (!options.length || context.aborted) return nothing();
  const [only] = options;
  if (options.length === 1 && state.sliceDoc(only.from, only.to) === only.insert) return nothing(); // it stands there already
  const from = Math.min(...options.map((one) => one.from));
  return { from, options: options.map((one, k) => option(one, from, at, k)), validFor: /^(?!\.?\d)[\w.]*$/ };
}

function option({ label, kind, detail, documentation, insert, from, to }, start, at, place) {
  return {
    label,
    type: KINDS[kind] ?? "text",
    detail: detail || kind,
    info: documentation || undefined,
    boost: -Math.min(place, 90) / 10, // the server's order, unless what is typed speaks for another
    apply: (view, _, begin, end) => {
      const [first, last] = [begin + from - start, end + Math.max(0, to - at)];
      if (/: (?=[,}\n])|\[(?=,)|, \]/.test(insert)) {
        const indent = /^ */.exec(view.state.doc.lineAt(begin).text)[0]; // the editor indents lines as the first, the server has done so
        return snippet(insert.replaceAll(`\n${indent}`, "\n").replaceAll(GAP, "${}"))(view, null, first, last);
      }
      return view.dispatch({ changes: { from: first, to: last, insert }, selection: { anchor: first + insert.length }, userEvent: "input.complete", scrollIntoView: true });
    },
  };
}

export const hover = hoverTooltip(async (view, at) => {
  const found = await quietly("hover", { text: view.state.doc.toString(), at }).catch(() => ({}));
  if (!found.html_free_text) return null;
  return { pos: found.from, end: found.to, above: true, create: () => ({ dom: drawn(found.html_free_text) }) };
}, { hoverTime: 350 });

// Paragraphs, lists, **bold** and `code` of Markdown as elements; whatever else stands there stays text.
function drawn(text) {
  const box = Object.assign(document.createElement("div"), { className: "cm-hover" });
  for (const line of text.split("\n").filter((one) => one.trim())) {
    const paragraph = document.createElement("p");
    for (const part of line.replace(/^[-*] /, "• ").split(/((?<!\\)\*\*[^*]+\*\*|(?<!\\)`[^`]+`)/)) {
      const tag = part.startsWith("**") ? "strong" : part.startsWith("`") ? "code" : null;
      const shown = tag === "code" ? part.slice(1, -1) : unescaped(tag ? part.slice(2, -2) : part);
      paragraph.append(tag ? Object.assign(document.createElement(tag), { textContent: shown }) : shown);
    }
    box.append(paragraph);
  }
  return box;
}

// Signs of Markdown in names and texts of a model stand behind a backslash; inside code they are as they are.
function unescaped(text) {
  return text.replaceAll(/\\([\\`*_<>[\]])/g, "$1");
}

function place(view) {
  return { text: view.state.doc.toString(), at: view.state.selection.main.head };
}

export async function goToDefinition(view) {
  const { ranges = [] } = await ask("definition", place(view));
  if (!ranges.length) return say("The cursor stands on no name that is defined in this text.");
  select(view, ranges[0].from, ranges[0].to);
}

export async function showReferences(view) {
  const { ranges = [] } = await ask("references", place(view));
  if (!ranges.length) return say("The cursor stands on no name of this text.");
  const rows = ranges.map(({ from, to }) => {
    const line = view.state.doc.lineAt(from);
    return { name: `${line.number}`, detail: line.text.trim(), from, to };
  });
  const found = await chooseOne(`Places of ${view.state.sliceDoc(ranges[0].from, ranges[0].to)}`, rows);
  if (found) select(view, found.from, found.to);
  else view.focus();
}

export async function rename(view) {
  const asked = place(view);
  const word = view.state.wordAt(asked.at);
  const old = word ? view.state.sliceDoc(word.from, word.to) : "";
  await writeOne(old ? `New name instead of ${old}` : "New name", old, async (name) => {
    const answer = await ask("rename", { ...asked, name });
    if (answer.refused) return answer.refused.join(" ");
    applyEdits(view, answer.edits, "rename");
    say(`Renamed at ${answer.edits.length} ${answer.edits.length === 1 ? "place" : "places"}. Ctrl-Z takes it back.`);
    return "";
  });
  view.focus();
}

export async function format(view) {
  const { edits = [] } = await ask("format", { text: view.state.doc.toString() });
  say(applyEdits(view, edits, "format") ? "Formatted. Ctrl-Z takes it back." : "Nothing to format: the layout is in order, or the text is not sound.");
}

export async function showOutline(view) {
  const { items = [] } = await ask("outline", { text: view.state.doc.toString() });
  const rows = flat(items, 0);
  if (!rows.length) return say("The text has no entries yet.");
  const found = await chooseOne("Outline", rows);
  if (found) select(view, found.name_from, found.name_to);
  else view.focus();
}

export function flat(items, depth) {
  return items.flatMap((item) => [{ ...item, depth }, ...flat(item.children ?? [], depth + 1)]);
}
