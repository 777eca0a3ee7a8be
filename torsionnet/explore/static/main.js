// The page: state in, question to the server, answer onto the screen.

import { ask, newestOnly, underWay } from "./api.js";
import { makeBode } from "./bode.js";
import { makeChooser, segments } from "./chooser.js";
import { byKeys, valuesAt, valuesNear } from "./cursor.js";
import { curve, dots, shownUnit, summary } from "./curves.js";
import { copy, save } from "./files.js";
import { drawModes } from "./modes.js";
import { short, symbol } from "./numbers.js";
import { makePins, pinned } from "./pins.js";
import { drawPoles } from "./poles.js";
import { makeReadout } from "./readout.js";
import { makeSliders } from "./sliders.js";
import { canPin, fresh, question, read, write } from "./state.js";
import { drawTabs } from "./tabs.js";
import { apply, curveColour, DASHES, isDark, whenSystemChanges } from "./theme.js";

const QUIET = 500; // ms without change until the summary is read aloud and the address written
const at = (id) => document.getElementById(id);

const model = await ask("model");
let state = read(model);
let last = null; // the last answer that was no refusal, and the state it belongs to
let test = null;
let edited = "";
let quiet = 0;
let seen = [];
globalThis.torsionnet = { lastUpdate: null, updates: 0, drawn: () => seen, underWay };

at("name").textContent = model.name;
at("source").textContent = [model.source, model.file].filter(Boolean).join(" · ");
at("source").title = model.description;
document.title = `${model.name} – torsionnet explore`;
apply(state.theme);

const pins = makePins(() => state, () => last && redraw());
const bode = makeBode([at("magnitude"), at("phase")], {
  cursor: () => readValues(),
  zoom: (band) => change({ band }),
  widen: () => change({ band: null }),
  drawn: () => {},
});
const readout = makeReadout(at("curves").tBodies[0], at("at"), {
  remove: (pin) => change({ pins: state.pins.filter((one) => one !== pin) }, { ask: false }),
  rename: (pin, name) => {
    pin.name = name.trim() || pin.name;
    change({}, { ask: false });
  },
  toggleTest: () => change({ overlaid: !state.overlaid }, { ask: false }),
});
const fillChooser = makeChooser(at("chooser"), model, (part) => change(part));
const which = segments("Modes of", [["drivetrain", "drivetrain"], ["cut", "cut"]], (of) => change({ of }, { ask: false }));
at("which").append(which.node);
const sliders = makeSliders(at("sliders"), model.parameters.map(bare), changeValue);
const request = newestOnly("answer", show, (error) => refuse([error.message]));
byKeys(at("magnitude"), bode.plots, () => bode.plots().forEach((plot) => plot.setCursor({ left: -10, top: -10 })));

at("reset").addEventListener("click", () => change({ values: {} }));
at("pin").addEventListener("click", pin);
at("save").addEventListener("click", async () => say(await save(question(state)).catch((error) => error.message)));
at("copy").addEventListener("click", async () => say(await copy(at("command"))));
at("theme").addEventListener("click", () => change({ theme: isDark(state.theme) ? "light" : "dark" }, { ask: false }));
whenSystemChanges(() => change({}, { ask: false }));
addEventListener("hashchange", () => {
  state = read(model);
  test = null;
  change({});
});
if (Object.keys(model.axes).length) at("plots").setAttribute("role", "tabpanel");
change({});

function bare(parameter) {
  return { ...parameter, value: 1, default: 1, low: 0.1, high: 10, shown_unit: "", expression: "" };
}

function changeValue(name, value, time) {
  const values = { ...state.values };
  if (value === null) delete values[name];
  else values[name] = value;
  edited = name;
  change({ values }, { time });
}

// Everything that happens comes through here. Without `ask` only the look changes.
function change(part, { ask: asks = true, time = performance.now() } = {}) {
  const before = state.output + state.input + state.quantity;
  state = { ...state, ...part, band: part.band === null ? fresh(model).band : (part.band ?? state.band) };
  apply(state.theme);
  at("theme").setAttribute("aria-label", isDark(state.theme) ? "Light colours" : "Dark colours");
  at("theme").title = at("theme").getAttribute("aria-label");
  drawTabs(at("tabs"), model.axes, state.choice, chooseTab);
  fillChooser(state, last?.answer);
  if (before !== state.output + state.input + state.quantity) test = null;
  if (last && (!asks || "angle" in part || "decibels" in part)) redraw(); // the numbers are here already
  if (asks) request(question(state), time);
  later();
}

function chooseTab(axis, name, time) {
  const choice = { ...state.choice };
  if (name) choice[axis] = name;
  else delete choice[axis];
  change({ choice }, { time });
}

function show(answer, asked, time) {
  if (answer.refused) return refuse(answer.refused);
  at("refused").hidden = true;
  sliders.fault("");
  last = { answer, asked };
  sliders.fill(answer.parameters);
  redraw();
  finish(time);
  if (model.overlay && !test) fetchTest();
  pins.refresh();
}

function refuse(reasons) {
  at("refused").replaceChildren(...reasons.map((reason) => Object.assign(document.createElement("p"), { textContent: reason })));
  at("refused").hidden = false;
  sliders.fault(edited);
  at("reset").disabled = !Object.keys(state.values).length;
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
  const stale = faint || !at("refused").hidden;
  const all = allCurves(answer, stale);
  seen = all.filter((one) => !one.hidden);
  const band = answer.band;
  bode.draw(seen, { band, decibels: state.decibels, logFrequency: band[1] / band[0] >= 10, theme: isDark(state.theme) });
  readout.list([...seen, ...all.filter((one) => one.hidden)].filter((one) => !one.unlisted));
  readValues();
  words(answer);
  drawModal(answer);
  at("reset").disabled = !Object.keys(state.values).length;
  at("pin").disabled = !canPin(state);
}

function allCurves(answer, faint) {
  const now = { key: "now", name: "now", note: answer.title, faint };
  const curves = [{ ...curve(answer, state, 0), ...now, dashes: [] }];
  state.pins.forEach((one, k) => {
    const found = pins.of(one, state);
    const look = { key: `pin ${k} ${state.pins.length} ${one.name}`, name: one.name, pin: one, dashes: DASHES[(k + 1) % 7] };
    if (found) curves.push({ ...curve(found, state, k + 1), ...look });
  });
  if (test && test !== "none") {
    const apart = answer.misfit;
    const note = apart ? `apart by ${short(apart.decibels, 3)} dB, ${short(apart.degrees, 3)}° RMS; FRAC ${apart.frac.toFixed(4)}` : "";
    const kind = { key: `test ${state.overlaid}`, name: model.overlay, note, hidden: !state.overlaid };
    curves.push({ ...dots(test, answer, state, false), ...kind });
    const rest = dots(test, answer, state, true);
    if (rest.frequencies.length) curves.push({ ...rest, ...kind, key: `doubtful ${state.overlaid}`, name: "", unlisted: true });
  }
  return curves;
}

function words(answer) {
  const words_ = shownUnit(answer.response, state);
  title("magnitude-title", [`${answer.response.kind} `, symbol(state.output), " / ", symbol(state.input)], words_);
  title("phase-title", ["phase"], "deg");
  at("summary").textContent = summary(answer, state);
  const notes = [...answer.response.notes, ...answer.notes, ...answer.findings];
  if (test === "none") notes.push(`${model.overlay} holds no ${answer.response.label}`);
  at("notes").textContent = notes.join(" · ");
  at("command").textContent = answer.command;
}

function title(id, content, inUnit) {
  const small = document.createElement("small");
  small.textContent = ` [${inUnit}]`;
  at(id).replaceChildren(...content, small);
}

function drawModal(answer) {
  at("which").hidden = !answer.cut;
  const cut = state.of === "cut" && answer.cut;
  which.fill(cut ? "cut" : "drivetrain");
  which.rename("cut", `cut at ${state.input}`);
  at("modes-title").textContent = cut ? `Poles of ${answer.response.label}` : "Modes";
  const side = (one) => (cut ? one.cut : one.modes);
  drawModes(at("modes"), side(answer));
  const sets = state.pins.map((pin, k) => [pins.of(pin, state), k]).filter(([found]) => found && side(found));
  drawPoles(at("poles"), [
    { modes: side(answer), colour: curveColour(0) },
    ...sets.map(([found, k]) => ({ modes: side(found), colour: curveColour(k + 1), pinned: true })),
  ]);
}

// Without a cursor, the values at the largest peak.
function readValues() {
  if (!last) return;
  const plots = bode.plots();
  if (plots.length < 2 || !plots[0].data[0]?.length) return;
  const found = valuesAt(plots);
  const peaks = last.answer.response.peaks;
  const largest = peaks.reduce((best, one) => (best && (best[1] ?? Infinity) >= (one[1] ?? Infinity) ? best : one), null);
  const frequency = found?.[0] ?? largest?.[0] ?? last.answer.band[0];
  const values = found?.[1] ?? valuesNear(plots[0], plots[1], plots[0].valToIdx(frequency));
  const shown = shownUnit(last.answer.response, state);
  readout.values(frequency, shown, values, !found && Boolean(largest));
  const slider = at("magnitude");
  slider.setAttribute("aria-valuemin", last.answer.band[0]);
  slider.setAttribute("aria-valuemax", last.answer.band[1]);
  slider.setAttribute("aria-valuenow", frequency);
  const [size, phase] = values[0] ?? [];
  slider.setAttribute("aria-valuetext", `${short(frequency)} Hz: ${short(size)} ${shown}, ${short(phase, 3)} degrees`);
}

function pin() {
  if (!last || !canPin(state)) return;
  const made = pinned(state, "as written");
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
    at("live").textContent = at("refused").hidden ? at("summary").textContent : "";
  }, QUIET);
}

function say(text) {
  at("said").textContent = text;
  setTimeout(() => (at("said").textContent = ""), 6000);
}
