// Faults of the text: marks in it, a list below it, and what mends them.

import { setDiagnostics } from "./vendor/codemirror.min.js";
import { decide, paragraph } from "./dialogs.js";
import { applyEdits, select } from "./edits.js";

const KINDS = ["error", "warning", "note"];
const QUIET = 700; // ms without change until the faults are read aloud
const at = (id) => document.getElementById(id);

export function makeFaults(view) {
  let faults = [];
  let quiet = 0;

  function show(found) {
    const end = view.state.doc.length;
    faults = found.map((fault) => ({ ...fault, from: Math.min(fault.from, end), to: Math.min(fault.to, end) }));
    view.dispatch(setDiagnostics(view.state, faults.map((fault) => diagnostic(fault))));
    at("fault-count").textContent = counted(faults);
    at("faults").classList.toggle("is-sound", !faults.some(({ severity }) => severity === "error"));
    const focused = document.activeElement?.closest?.("#fault-list li")?.dataset.at;
    at("fault-list").replaceChildren(...faults.map((fault, k) => row(view, faults, fault, k)));
    if (focused !== undefined) (at("fault-list").children[Math.min(focused, faults.length - 1)]?.querySelector("button") ?? view.contentDOM).focus();
    clearTimeout(quiet);
    quiet = setTimeout(() => (at("fault-live").textContent = counted(faults) + (faults.length ? `: ${said(faults[0])}` : "")), QUIET);
  }

  // The fixes at the cursor, or of its line; more than one are offered.
  async function mend() {
    const { head } = view.state.selection.main;
    const line = view.state.doc.lineAt(head);
    const here = faults.filter(({ from, to }) => from <= line.to && to >= line.from);
    const exact = here.filter(({ from, to }) => from <= head && head <= to);
    const fixes = (exact.some(({ fixes: some }) => some.length) ? exact : here).flatMap((fault) => fault.fixes);
    if (!fixes.length) return;
    const words = fixes.map(({ title }, k) => [String(k), title]);
    const which = fixes.length === 1 ? "0" : await decide("Mend", [paragraph(here[0].message)], words);
    if (which) applyEdits(view, fixes[Number(which)].edits, "fix");
    view.focus();
  }
  return { show, mend, count: () => faults.length };
}

function diagnostic({ from, to, severity, kind, message, fixes }) {
  const actions = fixes.map(({ title, edits }) => ({ name: title, apply: (view) => applyEdits(view, edits, "fix") }));
  return { from, to: Math.max(from, to), severity: severity === "note" ? "info" : severity, source: kind || undefined, message, actions };
}

function counted(faults) {
  const parts = KINDS.flatMap((word) => {
    const count = faults.filter(({ severity }) => severity === word).length;
    return count ? [`${count} ${word}${count > 1 ? "s" : ""}`] : [];
  });
  return parts.length ? parts.join(", ") : "No faults";
}

function said({ line, message }) {
  return `line ${line}: ${message}`;
}

// Of several faults of one kind, those with the edits of their first fix, none of which meets another.
function alike(faults, kind) {
  const found = [];
  for (const fault of faults.filter((one) => one.kind === kind && one.fixes.length)) {
    const meets = ({ from, to }) => found.some((edit) => from <= edit.to && edit.from <= to);
    if (!fault.fixes[0].edits.some(meets)) found.push(...fault.fixes[0].edits);
  }
  return found.sort((one, other) => one.from - other.from);
}

function row(view, faults, fault, k) {
  const node = document.createElement("li");
  node.className = fault.severity;
  node.dataset.at = k;
  const place = Object.assign(document.createElement("span"), { className: "place", textContent: `${fault.line}:${fault.column}` });
  const go = Object.assign(document.createElement("button"), { type: "button", className: "go" });
  const code = Object.assign(document.createElement("code"), { textContent: fault.kind });
  go.append(place, fault.message, ...(fault.kind ? [" ", code] : []));
  go.setAttribute("aria-label", `${node.className}, ${said(fault)}`);
  go.addEventListener("click", () => select(view, fault.from, fault.to));
  const fixes = fault.fixes.map(({ title, edits }) => {
    const button = Object.assign(document.createElement("button"), { type: "button", className: "fix", textContent: title });
    button.addEventListener("click", () => applyEdits(view, edits, "fix"));
    return button;
  });
  const same = faults.filter((one) => one.kind === fault.kind && one.fixes.length);
  if (same.length > 1 && same[0] === fault) {
    const all = Object.assign(document.createElement("button"), { type: "button", className: "fix", textContent: `Mend all ${same.length} of this kind` });
    all.addEventListener("click", () => applyEdits(view, alike(faults, fault.kind), "fix"));
    fixes.push(all);
  }
  node.append(go, ...fixes);
  return node;
}
