// The panes of results and values: state in, question to the server, answer onto the screen.

import { ask, newestOnly, underWay } from "./api.js";
import { makeChooser, segments } from "./chooser.js";
import { byKeys, valuesAt, valuesNear } from "./cursor.js";
import { overFrequency } from "./frequency.js";
import { drawInterference } from "./interference.js";
import { drawModes } from "./modes.js";
import { makePins, pinned } from "./pins.js";
import { makePlots } from "./plots.js";
import { drawPoles } from "./poles.js";
import { makeReadout, title } from "./readout.js";
import { makeSliders } from "./sliders.js";
import { overSpeed } from "./speed.js";
import { canPin, fresh, question, read, write } from "./state.js";
import { drawTabs } from "./tabs.js";
import { apply, curveColour, isDark, whenSystemChanges } from "./theme.js";
import { makeViews } from "./views.js";

const QUIET = 500; // ms without change until the summary is read aloud and the address written
const at = (id) => document.getElementById(id);

let model = null;
let state = { theme: "auto" };
let last = null; // the last answer that was no refusal, and the state it belongs to
let test = null;
let edited = "";
let quiet = 0;
let seen = [];
let stale = false;
let sliders = null;
let fillChooser = null;
let makeParameter = () => {}; // of a number of an element
let asked = () => {}; // whatever else is drawn of the state

const pins = makePins(() => state, () => last && redraw());
const plots = makePlots([at("magnitude"), at("phase")], {
  cursor: () => readValues(),
  zoom: (ends) => zoom(ends),
  widen: () => zoom(null),
});
const readout = makeReadout(at("curves").tBodies[0], at("at"), {
  remove: (pin) => change({ pins: state.pins.filter((one) => one !== pin) }, { ask: false }),
  rename: (pin, name) => {
    pin.name = name.trim() || pin.name;
    change({}, { ask: false });
  },
  toggleTest: () => change({ overlaid: !state.overlaid }, { ask: false }),
});
const views = makeViews(() => last && drawModal(last.answer));
const which = segments("Modes of", [["drivetrain", "drivetrain"], ["cut", "cut"]], (of) => change({ of }, { ask: false }));
const request = newestOnly("answer", show, (error) => refuse([error.message]));

export const results = {
  // Begins, with what is told of every state that the server is asked about.
  begin(tell) {
    asked = tell;
    globalThis.torsionnet = { lastUpdate: null, updates: 0, drawn: () => seen, underWay };
    at("which").append(which.node);
    byKeys(at("magnitude"), plots.plots, () => plots.plots().forEach((plot) => plot.setCursor({ left: -10, top: -10 })));
    at("reset").addEventListener("click", () => change({ values: {} }));
    at("pin").addEventListener("click", pin);
    new ResizeObserver(() => last && drawInterference(at("meetings"), last.answer)).observe(at("meetings"));
    at("theme").addEventListener("click", () => change({ theme: isDark(state.theme) ? "light" : "dark" }, { ask: false }));
    whenSystemChanges(() => change({}, { ask: false }));
    addEventListener("hashchange", () => {
      if (!model) return;
      state = read(model);
      test = null;
      change({});
    });
    apply(state.theme);
  },
  show: showModel,
  makesParameters: (make) => (makeParameter = make),
  state: () => question(state),
  changed: () => Object.keys(state.values ?? {}),
  // The text holds the values now, and another answer follows it.
  forget: () => (state.values = {}),
  refuse,
  // While no text was sound yet, what is wrong with the one that stands there now.
  explain(faults) {
    const errors = faults.filter(({ severity }) => severity === "error");
    if (!last && errors.length) refuse(errors.map(({ line, message }) => `line ${line}: ${message}`));
  },
  // Whether what is shown is of an older text than the one that stands there.
  stale(is) {
    if (is === stale) return;
    stale = is;
    at("stale").hidden = !is;
    at("stale").textContent = last ? "The text is faulty: results of the last sound one" : "The text is faulty: no results yet";
    document.body.classList.toggle("is-stale", is);
    if (last) redraw();
  },
};

// A model, also one that takes the place of another: what of the state fits it stays.
function showModel(next, time = performance.now()) {
  const same = model && JSON.stringify({ ...next, revision: 0 }) === JSON.stringify({ ...model, revision: 0 });
  const before = model;
  model = next;
  if (!same) fit(before);
  change({}, { time, isNew: true });
}

function fit(before) {
  if (before) {
    const untouched = String(state.band) === String(before.start.band);
    write(state);
    state = read(model);
    if (untouched) state.band = [...model.start.band];
  } else state = read(model);
  test = null;
  at("name").textContent = model.name;
  at("source").textContent = [model.source, model.file].filter(Boolean).join(" · ");
  at("source").title = model.description;
  document.title = `${model.name} – torsionnet explore`;
  at("chooser").replaceChildren();
  fillChooser = makeChooser(at("chooser"), model, change);
  sliders = makeSliders(at("sliders"), model.parameters, model.operating_point.rows, model.numbers, changeValue, (one) => makeParameter(one));
  at("point-hint").textContent = model.operating_point.hint;
  if (Object.keys(model.axes).length) at("plots").setAttribute("role", "tabpanel");
  else at("plots").removeAttribute("role");
}

function changeValue(name, value, time) {
  const values = { ...state.values };
  if (value === null) delete values[name];
  else values[name] = value;
  edited = name;
  change({ values }, { time });
}

// All speeds have been calculated already, frequencies have not.
function zoom(ends) {
  if (state.axis === "speed") change({ rpm: ends }, { ask: false });
  else change({ band: ends });
}

// Everything that happens comes through here. Without `ask` only the look changes.
function change(part, { ask: asks = true, time = performance.now(), isNew = false } = {}) {
  const before = state.output + state.input + state.quantity;
  state = { ...state, ...part };
  if (model) state.band = part.band === null ? fresh(model).band : state.band;
  apply(state.theme);
  at("theme").setAttribute("aria-label", isDark(state.theme) ? "Light colours" : "Dark colours");
  at("theme").title = at("theme").getAttribute("aria-label");
  if (!model) return;
  drawTabs(at("tabs"), model.axes, state.choice, chooseTab);
  fillChooser(state, last?.answer);
  const chosen = Object.entries(state.choice).map((pair) => pair.join(" ")).join(", ") || (Object.keys(model.axes).length ? "as written" : "");
  views.say([chosen, `${state.output} over ${state.axis === "speed" ? "speed" : state.input}`].filter(Boolean).join(" · "));
  if (before !== state.output + state.input + state.quantity) test = null;
  if (last && (!asks || "angle" in part || "decibels" in part)) redraw(); // the numbers are here already
  if (asks) {
    request({ ...question(state), rough: true }, time);
    asked(question(state), isNew);
  }
  later();
}

function chooseTab(axis, name, time) {
  const choice = { ...state.choice };
  if (name) choice[axis] = name;
  else delete choice[axis];
  change({ choice }, { time });
}

function show(answer, asked, time) {
  if (answer.refused) return refuse(answer.refused, answer);
  at("refused").hidden = true;
  sliders.fault("");
  last = { answer, asked };
  fillSliders(answer);
  fillChooser(state, answer);
  redraw();
  finish(time);
  if (!asked.rough || answer.orders?.thinned) later(); // also where the answer took longer than the quiet time
  if (model.overlay && answer.response && !test) fetchTest();
  pins.refresh();
}

function fillSliders({ parameters, operating_point: point }) {
  sliders.fill([...parameters, ...point]);
}

function refuse(reasons, answer = null) {
  if (answer?.parameters) fillSliders(answer);
  at("refused").replaceChildren(...reasons.map((reason) => Object.assign(document.createElement("p"), { textContent: reason })));
  at("refused").hidden = false;
  sliders?.fault(edited);
  at("reset").disabled = !Object.keys(state.values ?? {}).length;
  if (last) redraw(true);
}

async function fetchTest() {
  const { output, input, quantity } = state;
  const found = (await ask("overlay", question(state)).catch(() => ({}))).overlay ?? "none";
  if (output !== state.output || input !== state.input || quantity !== state.quantity) return; // the next answer asks again
  test = found;
  redraw();
}

function redraw(faint = false) {
  const { answer } = last;
  const all = allCurves(answer, faint || stale || !at("refused").hidden);
  const alone = Boolean(answer.orders);
  seen = all.filter((one) => !one.hidden);
  at("phase").hidden = at("phase-title").hidden = alone;
  at("plots").classList.toggle("alone", alone);
  at("curves").classList.toggle("no-phase", alone);
  at("magnitude").setAttribute("aria-label", over(answer).cursor);
  over(answer).draw(plots, seen, answer, state);
  readout.list([...seen, ...all.filter((one) => one.hidden)].filter((one) => !one.unlisted));
  readValues();
  words(answer);
  drawModal(answer);
  at("reset").disabled = !Object.keys(state.values).length;
  at("pin").disabled = !canPin(state);
}

function over(answer) {
  return answer.orders ? overSpeed : overFrequency;
}

function allCurves(answer, faint) {
  const now = { key: "now", faint, dashes: [] };
  const kept = state.pins.flatMap((pin, k) => {
    const found = pins.of(pin, state);
    const look = { key: `pin ${k} ${state.pins.length} ${pin.name}`, name: pin.name, pin };
    return found && over(found) === over(answer) ? [{ answer: found, k: k + 1, ...look }] : [];
  });
  return over(answer).curves(answer, state, now, kept, test && test !== "none" ? { ...test, name: model.overlay } : null);
}

function words(answer) {
  const view = over(answer);
  title(at("magnitude-title"), view.title(answer, state), view.unit(answer, state));
  title(at("phase-title"), ["phase"], "deg");
  at("summary").textContent = view.summary(answer, state);
  const notes = [...view.notes(answer), ...answer.notes, ...answer.findings];
  if (test === "none" && answer.response) notes.push(`${model.overlay} holds no ${answer.response.label}`);
  at("notes").textContent = notes.join(" · ");
  at("command").textContent = answer.command;
}

function drawModal(answer) {
  at("which").hidden = !answer.cut;
  const cut = state.of === "cut" && answer.cut;
  which.fill(cut ? "cut" : "drivetrain");
  which.rename("cut", `cut at ${state.input}`);
  at("modes-title").textContent = cut ? `Poles of ${answer.response.label}` : "Modes";
  const side = (one) => (cut ? one.cut : one.modes);
  drawModes(at("modes"), side(answer), Boolean(cut));
  views.fill(Boolean(answer.orders));
  drawInterference(at("meetings"), answer);
  const sets = state.pins.map((pin, k) => [pins.of(pin, state), k]).filter(([found]) => found && side(found));
  drawPoles(at("poles"), [
    { modes: side(answer), colour: curveColour(0) },
    ...sets.map(([found, k]) => ({ modes: side(found), colour: curveColour(k + 1), pinned: true })),
  ]);
}

// Without a cursor, the values at the largest peak.
function readValues() {
  if (!last) return;
  const drawn = plots.plots();
  if (!drawn.length || !drawn[0].data[0]?.length) return;
  const { answer } = last;
  const view = over(answer);
  const found = valuesAt(drawn);
  const largest = view.start(answer, state);
  const range = view.range(answer, state);
  const x = found?.[0] ?? largest ?? range[0];
  const values = found?.[1] ?? valuesNear(drawn, drawn[0].valToIdx(x));
  const unit = view.unit(answer, state);
  readout.values(`at ${view.text(x)}${!found && largest ? ` (${view.peak})` : ""} [${unit}]`, values);
  const slider = at("magnitude");
  slider.setAttribute("aria-valuemin", range[0]);
  slider.setAttribute("aria-valuemax", range[1]);
  slider.setAttribute("aria-valuenow", x);
  slider.setAttribute("aria-valuetext", `${view.text(x)}: ${view.said(values, unit, seen.map(({ name }) => name))}`);
}

function pin() {
  if (!last || !canPin(state)) return;
  const made = pinned(state, "as written", new Map(model.operating_point.rows.map(({ name, label }) => [name, label])));
  pins.keep(made, state, last.answer);
  change({ pins: [...state.pins, made] });
}

// uPlot draws in a microtask: when a task of its own comes after it, everything is on the canvases.
function finish(time) {
  queueMicrotask(() => queueMicrotask(() => {
    const ms = performance.now() - time;
    globalThis.torsionnet.lastUpdate = ms;
    globalThis.torsionnet.updates += 1;
    at("time").textContent = `${ms.toFixed(0)} ms`;
  }));
}

function later() {
  clearTimeout(quiet);
  quiet = setTimeout(() => {
    write(state);
    if (last?.answer.orders?.thinned) return request(question(state), performance.now()); // comes back here
    at("live").textContent = at("refused").hidden ? at("summary").textContent : "";
  }, QUIET);
}
