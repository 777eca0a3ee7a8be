// The editor of the model text: CodeMirror with YAML, and the keys of the page.

import {
  Compartment, Decoration, EditorState, EditorView, StateEffect, StateField, autocompletion, bracketMatching, closeBrackets,
  closeBracketsKeymap, codeFolding, completionKeymap, crosshairCursor, defaultKeymap, drawSelection, dropCursor, foldGutter,
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
  const extensions = (text) => EditorState.create({
    doc: text,
    extensions: [
      EditorView.cspNonce.of(nonce),
      keymap.of([
        ...actions.keys,
        { key: "F8", run: nextDiagnostic, shift: previousDiagnostic },
        ...closeBracketsKeymap, ...completionKeymap, ...searchKeymap, ...foldKeymap, ...historyKeymap, ...defaultKeymap, { ...indentWithTab, run: indentBefore },
      ]),
      lineNumbers(), lintGutter({ hoverTime: 250 }), highlightActiveLineGutter(), foldGutter(), codeFolding(), highlightSpecialChars(),
      history(), drawSelection(), dropCursor(), EditorState.allowMultipleSelections.of(true), indentOnInput(), indentUnit.of("  "),
      EditorState.tabSize.of(2), bracketMatching(), closeBrackets(), rectangularSelection(), crosshairCursor(), highlightActiveLine(),
      highlightSelectionMatches(), search({ top: true }), yaml(), EditorView.lineWrapping, hanging, look, chosen,
      placeholder("Type a model, paste a mass-elastic table, or press Ctrl-Space"),
      autocompletion({ override: [actions.complete], activateOnTypingDelay: 30, icons: false, maxRenderedOptions: 60 }),
      actions.hover,
      EditorView.contentAttributes.of({ "aria-label": "Model text", "aria-describedby": "leave", spellcheck: "false", autocorrect: "off" }),
      EditorView.updateListener.of((step) => {
        if (step.docChanged) actions.changed(step.view, step);
        if (step.docChanged || step.selectionSet) actions.moved(step.view);
      }),
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

// Tab behind the first word of a line does nothing: it would move the line out of its section.
function indentBefore(view) {
  const { from, to } = view.state.selection.main;
  const line = view.state.doc.lineAt(from);
  const isWithin = to <= line.to && line.text.slice(0, from - line.from).trim();
  return isWithin ? true : indentWithTab.run(view);
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
