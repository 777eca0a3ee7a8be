// The editor of the model text: CodeMirror with YAML, and the keys of the page.

import {
  acceptCompletion, Compartment, Decoration, EditorState, EditorView, StateEffect, StateField, autocompletion, bracketMatching, closeBrackets,
  closeBracketsKeymap, codeFolding, completionKeymap, completionStatus, crosshairCursor, defaultKeymap, drawSelection, dropCursor, foldGutter,
  foldKeymap, highlightActiveLine, highlightActiveLineGutter, highlightSelectionMatches, highlightSpecialChars, history,
  historyKeymap, indentOnInput, indentUnit, indentWithTab, keymap, lineNumbers, lintGutter, nextDiagnostic, placeholder,
  previousDiagnostic, rectangularSelection, search, searchKeymap, yaml,
} from "./vendor/codemirror.min.js";
import { look } from "./editor_look.js";
import { hanging } from "./hanging.js";

const FAR = 40_000; // characters; larger texts are not marked along the lines of an element

const choose = StateEffect.define();
const chosen = StateField.define({
  create: () => Decoration.none,
  update(marks, step) {
    const found = step.effects.find((effect) => effect.is(choose));
    return found ? linesOf(step.state, found.value) : marks.map(step.changes);
  },
  provide: (field) => EditorView.decorations.from(field),
});

// `actions`: changed(view, step), moved(view), keys, paste(event, view), complete, hover
export function makeTextPane(place, nonce, actions) {
  const writable = new Compartment();
  const offers = makeOffers();
  const extensions = (text) => EditorState.create({
    doc: text,
    extensions: [
      EditorView.cspNonce.of(nonce),
      keymap.of([
        ...actions.keys,
        { key: "F8", run: nextDiagnostic, shift: previousDiagnostic },
        { key: "Enter", run: (view) => (offers.isMeant(view) ? acceptCompletion(view) : endEntry(view)) },
        ...closeBracketsKeymap, ...offers.keys, ...searchKeymap, ...foldKeymap, ...historyKeymap, ...defaultKeymap, { ...indentWithTab, run: indentBefore },
      ]),
      lineNumbers(), lintGutter({ hoverTime: 250 }), highlightActiveLineGutter(), foldGutter(), codeFolding(), highlightSpecialChars(),
      history(), drawSelection(), dropCursor(), EditorState.allowMultipleSelections.of(true), indentOnInput(), indentUnit.of("  "),
      EditorState.tabSize.of(2), bracketMatching(), closeBrackets(), rectangularSelection(), crosshairCursor(), highlightActiveLine(),
      highlightSelectionMatches(), search({ top: true }), yaml(), EditorView.lineWrapping, hanging, look, chosen,
      placeholder("Type a model, paste a mass-elastic table, or press Ctrl-Space"),
      autocompletion({ override: [actions.complete], activateOnTypingDelay: 30, icons: false, maxRenderedOptions: 60, defaultKeymap: false }),
      actions.hover,
      EditorView.contentAttributes.of({ "aria-label": "Model text", "aria-describedby": "leave", spellcheck: "false", autocorrect: "off" }),
      EditorView.updateListener.of((step) => {
        offers.follow(step);
        if (step.docChanged) actions.changed(step.view, step);
        if (step.docChanged || step.selectionSet) actions.moved(step.view);
      }),
      EditorView.inputHandler.of(blankBehindColon),
      EditorView.domEventHandlers({ paste: (event, view) => actions.paste(event, view), beforeinput: overwrite }),
      writable.of(EditorState.readOnly.of(false)),
    ],
  });
  const view = new EditorView({ state: extensions(""), parent: place });
  return {
    view,
    // Another text, with a history of its own.
    begin: (text) => view.setState(extensions(text.replaceAll("\r\n", "\n"))),
    mark: (range) => view.dispatch({ effects: choose.of(range) }),
  };
}

// Chromium gives what is typed over a selection a style of its own, which the page forbids: the editor inserts it itself.
function overwrite(event, view) {
  const { from, to, empty } = view.state.selection.main;
  const text = event.data;
  if (event.inputType !== "insertText" || empty || view.composing || !text) return false;
  const insert = () => view.state.update(view.state.replaceSelection(text), { userEvent: "input.type", scrollIntoView: true });
  const isHandled = view.state.facet(EditorView.inputHandler).some((handle) => handle(view, from, to, text, insert));
  if (!isHandled) view.dispatch(insert());
  event.preventDefault();
  return true;
}

// Enter takes an offer only after an arrow key, or where the offer goes on with the word that is written.
function makeOffers() {
  let isChosen = false;
  const keys = completionKeymap.filter(({ key }) => key !== "Enter").map((one) => ({
    ...one,
    run: (view) => {
      const did = one.run(view);
      isChosen ||= did && /^(Arrow|Page)/.test(one.key);
      return did;
    },
  }));
  return {
    keys,
    follow: (step) => (isChosen &&= !step.docChanged && completionStatus(step.state) === "active"),
    isMeant(view) {
      if (completionStatus(view.state) !== "active") return false;
      const { head } = view.state.selection.main;
      const line = view.state.doc.lineAt(head);
      const [word] = /[\w.*/^]*$/.exec(line.text.slice(0, head - line.from));
      const marked = view.dom.querySelector(".cm-tooltip-autocomplete [aria-selected] .cm-completionLabel")?.textContent ?? "";
      return isChosen || (word !== "" && marked.toLowerCase().startsWith(word.toLowerCase()));
    },
  };
}

// Enter within brackets that nothing but their ends follows ends the entry; a blank behind a colon does not stay alone.
function endEntry(view) {
  const { head, empty } = view.state.selection.main;
  const line = view.state.doc.lineAt(head);
  const [before, after] = [line.text.slice(0, head - line.from), line.text.slice(head - line.from)];
  if (empty && /^( [\w*^/]+)?[\]} ]*[\]}] *$/.test(after) && !/[[{,]\s*$/.test(before)) view.dispatch({ selection: { anchor: line.to } });
  else if (empty && !after && /\w: $/.test(before)) view.dispatch({ changes: { from: head - 1, to: head } });
  return false; // the new line is made by the editor
}

// A blank follows the colon behind a key at the end of a line; one that is typed all the same is this one.
function blankBehindColon(view, from, to, text) {
  const line = view.state.doc.lineAt(from);
  const before = line.text.slice(0, from - line.from);
  if (from !== to || from !== line.to) return false;
  if (text === " " && /^\s*(- )?[\w.-]+: $/.test(before)) return true;
  if (text !== ":" || !/^\s*(- )?[\w.-]+$/.test(before)) return false;
  view.dispatch({ changes: { from, insert: ": " }, selection: { anchor: from + 2 }, userEvent: "input.type" });
  return true;
}

// Tab behind the first word of a line goes to the next line that waits for a first entry; it would move the line out of
// its section.
function indentBefore(view) {
  const { from, to } = view.state.selection.main;
  const { doc } = view.state;
  const line = doc.lineAt(from);
  if (to > line.to || !line.text.slice(0, from - line.from).trim()) return indentWithTab.run(view);
  for (let number = line.number + 1; number <= doc.lines; number += 1) {
    const next = doc.line(number);
    if (!/^ +$/.test(next.text) || !/^\w+:\s*$/.test(doc.line(number - 1).text)) continue;
    view.dispatch({ selection: { anchor: next.to }, scrollIntoView: true });
    break;
  }
  return true;
}

function linesOf(state, range) {
  if (!range || range.to - range.from > FAR || range.from > state.doc.length) return Decoration.none;
  const lines = [];
  const last = state.doc.lineAt(Math.min(range.to, state.doc.length)).number;
  for (let number = state.doc.lineAt(range.from).number; number <= last; number += 1) {
    lines.push(Decoration.line({ class: "cm-chosenElement" }).range(state.doc.line(number).from));
  }
  return Decoration.set(lines);
}
