// Wrapped lines of the text go on two blanks further in than they begin, so that the outline of the YAML stays visible.

import { Decoration, EditorView, RangeSetBuilder, ViewPlugin } from "./vendor/codemirror.min.js";

const DEEPEST = 24; // blanks; deeper lines wrap like these
const FURTHER = 2;

const marks = Array.from({ length: DEEPEST + 1 }, (_, depth) => Decoration.line({ class: `cm-hang-${depth}` }));

const plugin = ViewPlugin.fromClass(class {
  constructor(view) {
    this.decorations = indents(view);
  }

  update(step) {
    if (step.docChanged || step.viewportChanged) this.decorations = indents(step.view);
  }
}, { decorations: (plugged) => plugged.decorations });

function indents(view) {
  const found = new RangeSetBuilder();
  for (const { from, to } of view.visibleRanges) {
    for (let at = from; at <= to; ) {
      const line = view.state.doc.lineAt(at);
      const depth = Math.min(DEEPEST, line.text.length - line.text.trimStart().length);
      found.add(line.from, line.from, marks[depth]);
      at = line.to + 1;
    }
  }
  return found.finish();
}

const rules = Object.fromEntries(marks.map((_, depth) => [
  `.cm-hang-${depth}.cm-line`,
  { paddingLeft: `calc(${depth + FURTHER}ch + 6px)`, textIndent: `-${depth + FURTHER}ch` },
]));

export const hanging = [plugin, EditorView.theme(rules)];
