// Modes as a table: frequencies, damping, kind, and the sentence about each.

import { short } from "./numbers.js";

const COLUMNS = [["", "mode"], ["f₀ [Hz]", "natural"], ["f_d [Hz]", "damped"], ["ζ [%]", "ratio"], ["kind", "kind"], ["", "words"]];

export function drawModes(table, modes) {
  const head = document.createElement("thead");
  head.append(row(COLUMNS.map(([text, kind]) => cell("th", kind, text === "f_d [Hz]" ? damped() : text))));
  const body = document.createElement("tbody");
  body.append(...modes.natural.map((_, k) => row(cells(modes, k))));
  const foot = document.createElement("caption");
  foot.textContent = modes.notes.join("; ");
  table.replaceChildren(foot, head, body);
}

function cells(modes, k) {
  const vibrates = modes.damped[k] > 0;
  const ratio = modes.kinds[k] === "rigid body" || modes.ratio[k] === null ? "–" : short(100 * modes.ratio[k], 4);
  return [
    cell("th", "mode", modes.numbers[k] === null ? "–" : String(modes.numbers[k])),
    cell("td", "natural", short(modes.natural[k], 5)),
    cell("td", "damped", vibrates ? short(modes.damped[k], 5) : "–"),
    cell("td", "ratio", ratio),
    cell("td", "kind", modes.kinds[k]),
    cell("td", "words", modes.descriptions[k]),
  ];
}

function damped() {
  const node = document.createDocumentFragment();
  const sub = document.createElement("sub");
  sub.textContent = "d";
  node.append("f", sub, " [Hz]");
  return node;
}

function row(all) {
  const node = document.createElement("tr");
  node.append(...all);
  return node;
}

function cell(tag, kind, content) {
  const node = document.createElement(tag);
  node.className = kind;
  if (tag === "th") node.scope = kind === "mode" && content ? "row" : "col";
  node.append(content);
  return node;
}
