// What is shown, in which form, over which frequencies or speeds.

import { plain } from "./numbers.js";

const FORMS = [["", "as measured"], ["receptance", "angle"], ["mobility", "velocity"], ["accelerance", "acceleration"]];

export function makeChooser(form, model, change) {
  const output = select("Output", groups(model.choices.outputs), (value) => change({ output: value }));
  const input = select("Input", groups(model.choices.inputs), (value) => change({ input: value }));
  const excitation = select("Driven by", model.choices.excitations.map(option), (value) => change({ excitation: value }));
  const quantity = select("Motion as", FORMS.map(([value, text]) => new Option(text, value)), (value) =>
    change({ quantity: value }),
  );
  const angle = segments("Angle", [["deg", "deg"], ["rad", "rad"]], (value) => change({ angle: value }));
  const scale = segments("Magnitude", [["", "log"], ["db", "dB"]], (value) => change({ decibels: value === "db" }));
  const axis = segments("Over", [["frequency", "frequency"], ["speed", "speed"]], (value) => change({ axis: value }));
  const band = makeEnds("Band", "frequency", "Hz", (ends) => change({ band: ends }));
  const rpm = makeEnds("Speed", "speed", "r/min", (ends) => change({ rpm: ends }, { ask: false }));
  const over = document.createElement("span");
  over.className = "over";
  over.textContent = "over";
  over.setAttribute("aria-hidden", "true");
  if (model.runs) form.append(axis.node);
  form.append(output.node, over, input.node, excitation.node, quantity.node, angle.node, scale.node, band.node, rpm.node);
  form.addEventListener("submit", (event) => event.preventDefault());
  return (state, answer) => {
    const speed = state.axis === "speed";
    for (const node of [over, input.node, scale.node, band.node]) node.hidden = speed;
    rpm.node.hidden = !speed;
    axis.fill(state.axis);
    output.control.value = state.output;
    input.control.value = state.input;
    const measured = model.choices.measured.includes(state.input);
    excitation.node.hidden = speed || !measured || model.choices.excitations.length < 2;
    if (answer) excitation.control.value = answer.excitation;
    if (speed || answer?.response) quantity.node.hidden = speed || !answer.response.is_motion;
    quantity.control.value = state.quantity;
    angle.fill(state.angle);
    scale.fill(state.decibels ? "db" : "");
    band.fill(state.band[1] ? state.band : (answer?.band ?? state.band));
    if (answer?.orders) rpm.fill(state.rpm ?? answer.orders.range);
  };
}

function option(name) {
  return new Option(name, name);
}

function groups(all) {
  return all.map((group) => {
    const node = document.createElement("optgroup");
    node.label = group.label;
    node.append(...group.entries.map((entry) => Object.assign(option(entry.name), { title: entry.what })));
    return node;
  });
}

function labelled(text, ...controls) {
  const node = document.createElement("label");
  const name = document.createElement("span");
  name.textContent = text;
  node.append(name, ...controls);
  return node;
}

function select(text, options, choose) {
  const control = Object.assign(document.createElement("select"), { name: text.toLowerCase().replace(" ", "-") });
  control.append(...options);
  control.addEventListener("change", () => choose(control.value));
  return { node: labelled(text, control), control };
}

export function segments(text, entries, choose) {
  const node = document.createElement("fieldset");
  const legend = document.createElement("legend");
  legend.textContent = text;
  const radios = entries.map(([value, shown]) => {
    const radio = Object.assign(document.createElement("input"), { type: "radio", name: text, value });
    radio.addEventListener("change", () => choose(value));
    const label = document.createElement("label");
    const face = document.createElement("span");
    face.textContent = shown;
    label.append(radio, face);
    return { radio, label };
  });
  const box = document.createElement("div");
  box.className = "segments";
  box.append(...radios.map((one) => one.label));
  node.append(legend, box);
  return {
    node,
    fill: (value) => radios.forEach(({ radio }) => (radio.checked = radio.value === value)),
    rename: (value, text_) => (radios.find(({ radio }) => radio.value === value).label.lastChild.textContent = text_),
  };
}

function makeEnds(title, what, unit, change) {
  const ends = ["Lowest", "Highest"].map((text) => {
    const field = Object.assign(document.createElement("input"), { type: "text", inputMode: "decimal", className: "end" });
    field.setAttribute("aria-label", `${text} ${what} in ${unit}`);
    return field;
  });
  const take = () => {
    const values = ends.map((field) => Number(field.value));
    const good = values[0] > 0 && values[1] > values[0] && Number.isFinite(values[1]);
    ends.forEach((field) => field.toggleAttribute("aria-invalid", !good));
    if (good) change(values);
  };
  ends.forEach((field) => field.addEventListener("change", take));
  const all = Object.assign(document.createElement("button"), { type: "button", className: "small", textContent: "all" });
  all.title = `${what === "speed" ? "All speeds of the model" : "The band of all modes"}; a double-click on a plot does the same, dragging in it zooms`;
  all.addEventListener("click", () => change(null));
  const node = document.createElement("fieldset");
  node.className = "band";
  const legend = document.createElement("legend");
  legend.textContent = `${title} [${unit}]`;
  const box = document.createElement("div");
  box.append(ends[0], "to", ends[1], all);
  node.append(legend, box);
  const fill = (values) => ends.forEach((field, k) => {
    if (document.activeElement !== field) field.value = plain(values[k], 4);
  });
  return { node, fill };
}
