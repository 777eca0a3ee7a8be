// Masses and shafts as a table: what each element is, where, with which values, and its mean torque where there is one.

import { short } from "./numbers.js";

const KILO = 1000;

export function drawMasses(table, elements) {
  const rows = Object.entries(elements);
  const torques = rows.flatMap(([, one]) => one.mean_torque ?? []);
  const isLarge = torques.some((one) => Math.abs(one) >= 10 * KILO);
  const torque = (one) => (one.mean_torque === undefined ? "–" : short(one.mean_torque / (isLarge ? KILO : 1)));
  const columns = ["element", "type", "nodes", "values", ...(torques.length ? [`mean torque [${isLarge ? "kN·m" : "N·m"}]`] : [])];
  const head = document.createElement("thead");
  head.append(line("th", columns));
  const body = document.createElement("tbody");
  body.append(...rows.map(([name, one]) => line("td", [name, one.type, one.nodes.join(", "), one.values, torque(one)].slice(0, columns.length))));
  table.replaceChildren(head, body);
}

function line(tag, texts) {
  const node = document.createElement("tr");
  node.append(...texts.map((text, k) => {
    const cell = Object.assign(document.createElement(k ? tag : "th"), { textContent: text, className: ["name", "type", "nodes", "values", "torque"][k] });
    if (cell.tagName === "TH") cell.scope = tag === "th" ? "col" : "row";
    return cell;
  }));
  return node;
}
