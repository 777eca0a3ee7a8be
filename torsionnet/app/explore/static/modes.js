// Modes as a table: frequencies, damping, kind, and the sentence about each.

import { short } from "./numbers.js";

const COLUMNS = [["", "mode"], ["f₀ [Hz]", "natural"], ["f_d [Hz]", "damped"], ["ζ [%]", "ratio"], ["kind", "kind"], ["", "words"]];

let choose = null; // what shows a mode on the schematic
let chosen = []; // places of the modes that are shown

// From now on a mode of the table can be chosen; `choose` is told its place, and whether the others stay.
export function modesAreChosen(act) {
  choose = act;
}

export function markModes(table, shown) {
  chosen = shown;
  table.querySelectorAll("tbody tr").forEach((node, at) => {
    node.classList.toggle("is-shown", shown.includes(at));
    node.querySelector("button")?.setAttribute("aria-pressed", String(shown.includes(at)));
  });
}

// Poles of the drivetrain cut at a sensor (`isCut`) are no modes of what is drawn.
export function drawModes(table, modes, isCut) {
  const head = document.createElement("thead");
  head.append(row(COLUMNS.map(([text, kind]) => cell("th", kind, text === "f_d [Hz]" ? damped() : text))));
  const body = document.createElement("tbody");
  body.append(...modes.natural.map((_, k) => Object.assign(row(cells(modes, k, !isCut && choose)), { title: modes.descriptions[k] })));
  const foot = document.createElement("caption");
  foot.textContent = modes.notes.join("; ");
  table.replaceChildren(foot, head, body);
  if (!isCut) markModes(table, chosen);
}

function cells(modes, k, canChoose) {
  const vibrates = modes.damped[k] > 0;
  const ratio = modes.kinds[k] === "rigid body" || modes.ratio[k] === null ? "–" : short(100 * modes.ratio[k], 4);
  return [
    cell("th", "mode", canChoose ? button(modes, k) : numbered(modes, k)),
    cell("td", "natural", short(modes.natural[k], 5)),
    cell("td", "damped", vibrates ? short(modes.damped[k], 5) : "–"),
    cell("td", "ratio", ratio),
    cell("td", "kind", modes.kinds[k]),
    cell("td", "words", modes.descriptions[k]),
  ];
}

function numbered({ numbers }, k) {
  return numbers[k] === null ? "–" : String(numbers[k]);
}

function button(modes, k) {
  const node = Object.assign(document.createElement("button"), { type: "button", className: "quiet", textContent: numbered(modes, k) });
  node.title = "Show this mode on the schematic; with Shift beside the others";
  const name = modes.numbers[k] === null ? `Mode without number, ${k + 1} of the table,` : `Mode ${numbered(modes, k)}`;
  node.setAttribute("aria-label", `${name} on the schematic`);
  node.addEventListener("click", (event) => choose(k, event.shiftKey));
  return node;
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
