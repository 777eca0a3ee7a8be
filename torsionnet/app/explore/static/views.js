// Views of the results as tabs, and the choosers above them, which collapse to a line that says what is chosen.

const VIEWS = [["response", "Response"], ["interference", "Interference"], ["stations", "Masses and shafts"], ["map", "Poles"]];
const KEPT = "torsionnet choosers";
const at = (id) => document.getElementById(id);

// `changed` is told when another view is shown.
export function makeViews(changed) {
  let shown = "response";
  let runs = false;
  const tabs = VIEWS.map(([id, words]) => {
    const tab = Object.assign(document.createElement("button"), { type: "button", textContent: words });
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-controls", id === "response" ? "view" : id);
    tab.addEventListener("click", () => show(id));
    tab.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      const seen = VIEWS.filter(([one], k) => !tabs[k].hidden).map(([one]) => one);
      show(seen[(seen.indexOf(shown) + step + seen.length) % seen.length]);
      tabs.find((one) => one.getAttribute("aria-selected") === "true").focus();
    });
    return tab;
  });
  at("views").append(...tabs);
  at("choosing").addEventListener("click", () => choosers(at("choosers").hidden));
  choosers(recalled() === "open");

  function show(id) {
    shown = id;
    fill(runs);
    changed();
  }

  // Over speed there are orders, and where they meet modes.
  function fill(isRunning) {
    runs = isRunning;
    if (shown === "interference" && !runs) shown = "response";
    at("sheet").dataset.view = shown;
    VIEWS.forEach(([id], k) => {
      tabs[k].hidden = id === "interference" && !runs;
      tabs[k].setAttribute("aria-selected", String(id === shown));
      tabs[k].tabIndex = id === shown ? 0 : -1;
    });
  }

  function choosers(are) {
    at("choosers").hidden = !are;
    at("choosing").setAttribute("aria-expanded", String(are));
    try {
      localStorage.setItem(KEPT, are ? "open" : "");
    } catch {
      // a browser that keeps nothing begins with them collapsed
    }
  }
  return {
    fill,
    shown: () => shown,
    say: (words) => (at("choosing").textContent = words),
  };
}

function recalled() {
  try {
    return localStorage.getItem(KEPT);
  } catch {
    return "";
  }
}
