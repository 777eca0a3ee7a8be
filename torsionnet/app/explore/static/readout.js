// The list of curves: which is which, and what they are at the cursor. Pins are renamed and removed here.

import { short } from "./numbers.js";

export function makeReadout(body, head, actions) {
  let rows = [];

  function list(curves) {
    const same = rows.length === curves.length && rows.every((row, k) => row.key === curves[k].key);
    if (!same) {
      rows = curves.map((curve) => makeRow(curve, actions));
      body.replaceChildren(...rows.map((row) => row.node));
    }
    rows.forEach((row, k) => fillRow(row, curves[k]));
  }

  function values(where, all) {
    head.textContent = where;
    rows.forEach((row, k) => {
      row.magnitude.textContent = short(all[k]?.[0]);
      row.phase.textContent = all[k]?.[1] == null ? "–" : `${all[k][1].toFixed(1).replace("-", "−")}°`;
    });
  }
  return { list, values };
}

function makeRow(curve, actions) {
  const node = document.createElement("tr");
  const name = document.createElement("th");
  name.scope = "row";
  const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  swatch.setAttribute("viewBox", "0 0 24 8");
  swatch.setAttribute("class", "swatch");
  swatch.setAttribute("aria-hidden", "true");
  const label = curve.pin ? pinName(curve, actions) : document.createElement("span");
  const note = document.createElement("span");
  note.className = "note";
  name.append(swatch, label, note);
  const [magnitude, phase, action] = ["td", "td", "td"].map((tag) => document.createElement(tag));
  if (curve.pin) action.append(button("×", `Remove ${curve.name}`, () => actions.remove(curve.pin)));
  if (curve.kind === "dots" || curve.hidden) action.append(eye(curve, actions));
  node.append(name, magnitude, phase, action);
  return { key: curve.key, node, swatch, label, note, magnitude, phase };
}

function fillRow(row, curve) {
  row.swatch.replaceChildren(mark(curve));
  if (curve.pin) {
    if (document.activeElement !== row.label) row.label.value = curve.name;
  } else row.label.textContent = curve.name;
  row.note.textContent = curve.note ?? "";
  row.node.classList.toggle("is-off", Boolean(curve.hidden));
}

function mark(curve) {
  const dotted = curve.kind === "dots";
  const shape = document.createElementNS("http://www.w3.org/2000/svg", dotted ? "circle" : "line");
  const place = dotted ? { cx: 12, cy: 4, r: 3, fill: curve.colour } : { x1: 0, y1: 4, x2: 24, y2: 4, stroke: curve.colour };
  for (const [key, value] of Object.entries(place)) shape.setAttribute(key, value);
  if (!dotted) shape.setAttribute("stroke-width", curve.width ?? 2.5);
  if (!dotted && curve.dashes?.length) shape.setAttribute("stroke-dasharray", curve.dashes.join(" "));
  return shape;
}

function pinName(curve, actions) {
  const field = Object.assign(document.createElement("input"), { type: "text", className: "pin-name", maxLength: 80 });
  field.setAttribute("aria-label", "Name of the pinned curve");
  field.addEventListener("change", () => actions.rename(curve.pin, field.value));
  return field;
}

function button(text, title, act) {
  const node = Object.assign(document.createElement("button"), { type: "button", className: "quiet", textContent: text, title });
  node.setAttribute("aria-label", title);
  node.addEventListener("click", act);
  return node;
}

function eye(curve, actions) {
  const node = button(curve.hidden ? "show" : "hide", curve.hidden ? "Show the test" : "Hide the test", actions.toggleTest);
  return node;
}

// Words above a plot with their unit.
export function title(place, content, inUnit) {
  const small = document.createElement("small");
  small.textContent = ` [${inUnit}]`;
  place.replaceChildren(...content, small);
}
