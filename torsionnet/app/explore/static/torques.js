// Mean torques of elements as a table, where something gives mean torques.

import { short } from "./numbers.js";

const KILO = 1000;

export function drawTorques(place, table, elements) {
  const rows = Object.entries(elements).filter(([, one]) => one.mean_torque !== undefined);
  place.hidden = !rows.length;
  const isLarge = rows.some(([, one]) => Math.abs(one.mean_torque) >= 10 * KILO);
  const head = document.createElement("thead");
  head.append(line("th", ["element", "nodes", `mean torque [${isLarge ? "kN·m" : "N·m"}]`]));
  const body = document.createElement("tbody");
  body.append(...rows.map(([name, one]) => line("td", [name, one.nodes.join(", "), short(one.mean_torque / (isLarge ? KILO : 1))])));
  table.replaceChildren(head, body);
}

function line(tag, texts) {
  const node = document.createElement("tr");
  node.append(...texts.map((text, k) => {
    const cell = Object.assign(document.createElement(k ? tag : "th"), { textContent: text, className: ["name", "nodes", "torque"][k] });
    if (cell.tagName === "TH") cell.scope = tag === "th" ? "col" : "row";
    return cell;
  }));
  return node;
}
