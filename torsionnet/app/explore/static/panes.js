// Panes: which are shown, how large they are, F6 from one to the next; on narrow screens one at a time, as tabs.

const NARROW = matchMedia("(max-width: 960px)");
const STEP = 24; // pixels for a press of an arrow key
const PANES = [["text", "Text"], ["drawing", "Schematic"], ["sheet", "Results"]];
const ALL = [...PANES.map(([id]) => id), "parameters"];
const KEPT = "torsionnet panes";
// Each bar between panes: the variable of the layout it sets, which way it goes, its limits in pixels, the pane it closes.
const BARS = {
  "split-text": { size: "--text", axis: "x", sign: 1, least: 240, most: 900, pane: "text", name: "Width of the text" },
  "split-drawing": { size: "--drawing", axis: "y", sign: 1, least: 120, most: 640, pane: "drawing", name: "Height of the schematic" },
  "split-values": { size: "--values", axis: "x", sign: -1, least: 240, most: 560, pane: "parameters", name: "Width of the values" },
};

const at = (id) => document.getElementById(id);

export function makePanes() {
  const kept = recalled();
  const hidden = new Set(kept.hidden ?? []);
  const sizes = kept.sizes ?? {};
  let tab = "sheet";
  let largest = ""; // the pane that has the whole page
  const toggles = [["text", "Text"], ["drawing", "Schematic"], ["parameters", "Values"]]
    .map(([id, words]) => toggle(id, words));
  at("shown").replaceChildren(...toggles.map(({ button }) => button));
  at("pane-tabs").replaceChildren(...PANES.map(tabOf));
  for (const [id, bar] of Object.entries(BARS)) prepare(at(id), bar);
  NARROW.addEventListener("change", apply);
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey) return;
    if (event.key === "F6") next(event);
    if (event.key === "F9") enlarge(event, paneOf(document.activeElement) ?? "sheet");
  });
  for (const id of ALL) at(id).querySelector(".heading, #top").addEventListener("dblclick", (event) => event.target.closest("button, select") || enlarge(event, id));
  apply();

  function toggle(id, words) {
    const button = Object.assign(document.createElement("button"), { type: "button", className: "quiet", textContent: words });
    button.addEventListener("click", () => {
      if (!hidden.delete(id)) hidden.add(id);
      apply();
    });
    return { id, button };
  }

  function tabOf([id, words]) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: words });
    button.setAttribute("role", "tab");
    button.setAttribute("aria-controls", id);
    button.addEventListener("click", () => show(id));
    button.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      const ids = PANES.map(([one]) => one);
      const to = (ids.indexOf(id) + step + ids.length) % ids.length;
      show(ids[to]);
      at("pane-tabs").children[to].focus();
    });
    return button;
  }

  // Brings a pane into sight.
  function show(id) {
    hidden.delete(id);
    if (largest && largest !== id) largest = "";
    if (PANES.some(([one]) => one === id)) tab = id;
    apply();
  }

  // One pane alone, until the key is pressed again.
  function enlarge(event, id) {
    largest = largest ? "" : id;
    apply();
    event.preventDefault();
  }

  function apply() {
    const narrow = NARROW.matches;
    at("pane-tabs").hidden = !narrow;
    at("shown").hidden = narrow;
    document.body.dataset.tab = narrow ? tab : "";
    const alone = narrow ? "" : largest;
    document.body.classList.toggle("is-alone", alone !== "");
    const seen = (id) => (narrow ? tab === id : alone ? alone === id : !hidden.has(id));
    for (const [id] of PANES) at(id).hidden = !seen(id);
    at("parameters").hidden = narrow ? tab !== "sheet" : !seen("parameters");
    at("right").hidden = at("drawing").hidden && at("sheet").hidden;
    for (const [id, { pane }] of Object.entries(BARS)) at(id).hidden = narrow || alone !== "" || at(pane).hidden;
    toggles.forEach(({ id, button }) => button.setAttribute("aria-pressed", String(!hidden.has(id))));
    PANES.forEach(([id], k) => {
      const button = at("pane-tabs").children[k];
      button.setAttribute("aria-selected", String(id === tab));
      button.tabIndex = id === tab ? 0 : -1;
    });
    for (const [id, { size }] of Object.entries(BARS)) {
      if (sizes[id]) document.documentElement.style.setProperty(size, `${sizes[id]}px`);
      else document.documentElement.style.removeProperty(size);
      describe(at(id), BARS[id]);
    }
    keep();
  }

  function prepare(node, bar) {
    node.setAttribute("role", "separator");
    node.tabIndex = 0;
    node.setAttribute("aria-label", bar.name);
    node.setAttribute("aria-orientation", bar.axis === "x" ? "vertical" : "horizontal");
    node.setAttribute("aria-controls", bar.pane);
    node.title = "Drag or arrow keys; Enter hides, double-click restores";
    node.addEventListener("pointerdown", (event) => {
      node.setPointerCapture(event.pointerId);
      const start = { at: event[bar.axis], size: measured(bar) };
      const move = (now) => set(node.id, start.size + bar.sign * (now[bar.axis] - start.at));
      node.addEventListener("pointermove", move);
      node.addEventListener("lostpointercapture", () => node.removeEventListener("pointermove", move), { once: true });
      event.preventDefault();
    });
    node.addEventListener("dblclick", () => set(node.id, 0));
    node.addEventListener("keydown", (event) => {
      const step = { ArrowRight: STEP, ArrowLeft: -STEP, ArrowDown: STEP, ArrowUp: -STEP }[event.key];
      if (step) set(node.id, measured(bar) + bar.sign * step);
      else if (event.key === "Home") set(node.id, bar.least);
      else if (event.key === "End") set(node.id, bar.most);
      else if (event.key === "Enter") {
        hidden.add(bar.pane);
        apply();
        toggles.find(({ id }) => id === bar.pane)?.button.focus();
      } else return;
      event.preventDefault();
    });
  }

  function set(id, size) {
    const { least, most } = BARS[id];
    if (size) sizes[id] = Math.round(Math.max(least, Math.min(most, size)));
    else delete sizes[id];
    apply();
  }

  function keep() {
    try {
      localStorage.setItem(KEPT, JSON.stringify({ hidden: [...hidden], sizes }));
    } catch {
      // a browser that keeps nothing begins with the usual sizes
    }
  }

  function next(event) {
    const stops = [".cm-content", "#schematic [tabindex='0']", "#magnitude", "#parameters input:not([readonly])"]
      .map((one) => document.querySelector(one)).filter((node) => node && node.getClientRects().length);
    const here = paneOf(document.activeElement);
    const k = stops.findIndex((node) => here && paneOf(node) === here);
    stops[(k + (event.shiftKey ? stops.length - 1 + (k < 0) : 1)) % stops.length]?.focus();
    event.preventDefault();
  }
  return { show };
}

function paneOf(node) {
  return ALL.find((id) => at(id).contains(node));
}

function measured({ pane, axis }) {
  const box = at(pane).getBoundingClientRect();
  return axis === "x" ? box.width : box.height;
}

function describe(node, bar) {
  node.setAttribute("aria-valuemin", bar.least);
  node.setAttribute("aria-valuemax", bar.most);
  node.setAttribute("aria-valuenow", Math.round(measured(bar)));
}

function recalled() {
  try {
    return JSON.parse(localStorage.getItem(KEPT)) ?? {};
  } catch {
    return {};
  }
}
