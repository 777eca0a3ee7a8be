// Configurations as tabs, a row for each axis; arrow keys move along a row.

export function drawTabs(place, axes, choice, choose) {
  const focused = document.activeElement?.dataset?.tab;
  place.replaceChildren(...Object.entries(axes).map(([axis, names]) => row(axis, names, choice[axis], choose)));
  if (focused) [...place.querySelectorAll("[data-tab]")].find((tab) => tab.dataset.tab === focused)?.focus();
}

function row(axis, names, chosen, choose) {
  const list = document.createElement("div");
  list.className = "tabs";
  list.setAttribute("role", "tablist");
  list.setAttribute("aria-label", `Configuration: ${axis}`);
  const title = document.createElement("span");
  title.className = "axis";
  title.textContent = axis;
  title.setAttribute("aria-hidden", "true");
  const tabs = ["", ...names].map((name) => tab(axis, name, (chosen ?? "") === name, choose));
  list.append(...tabs);
  list.addEventListener("keydown", (event) => move(event, tabs));
  const line = document.createElement("div");
  line.className = "axis-row";
  line.append(title, list);
  return line;
}

function tab(axis, name, selected, choose) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = name || "as written";
  button.dataset.tab = `${axis}=${name}`;
  button.setAttribute("role", "tab");
  if (!name) button.setAttribute("aria-label", `${axis}: as written`);
  button.setAttribute("aria-selected", String(selected));
  button.setAttribute("aria-controls", "plots");
  button.tabIndex = selected ? 0 : -1;
  button.addEventListener("click", (event) => choose(axis, name, event.timeStamp));
  return button;
}

function move(event, tabs) {
  const at = tabs.indexOf(document.activeElement);
  const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: tabs.length - 1 }[event.key];
  if (to === undefined || at < 0) return;
  event.preventDefault();
  const next = tabs[(to + tabs.length) % tabs.length];
  next.focus();
  next.click();
}
