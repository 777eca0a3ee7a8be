// Which response, in which form, over which frequencies.

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
  const band = makeBand(change);
  const over = document.createElement("span");
  over.className = "over";
  over.textContent = "over";
  over.setAttribute("aria-hidden", "true");
  form.append(output.node, over, input.node, excitation.node, quantity.node, angle.node, scale.node, band.node);
  form.addEventListener("submit", (event) => event.preventDefault());
  return (state, answer) => {
    output.control.value = state.output;
    input.control.value = state.input;
    const measured = model.choices.measured.includes(state.input);
    excitation.node.hidden = !measured || model.choices.excitations.length < 2;
    if (answer) excitation.control.value = answer.excitation;
    if (answer) quantity.node.hidden = !answer.response.is_motion;
    quantity.control.value = state.quantity;
    angle.fill(state.angle);
    scale.fill(state.decibels ? "db" : "");
    band.fill(state.band);
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

function makeBand(change) {
  const ends = ["Lowest frequency", "Highest frequency"].map((text) => {
    const field = Object.assign(document.createElement("input"), { type: "text", inputMode: "decimal", className: "end" });
    field.setAttribute("aria-label", `${text} in Hz`);
    return field;
  });
  const take = () => {
    const band = ends.map((field) => Number(field.value));
    const good = band[0] > 0 && band[1] > band[0] && Number.isFinite(band[1]);
    ends.forEach((field) => field.toggleAttribute("aria-invalid", !good));
    if (good) change({ band });
  };
  ends.forEach((field) => field.addEventListener("change", take));
  const all = Object.assign(document.createElement("button"), { type: "button", className: "small", textContent: "fit" });
  all.title = "The band of all modes; a double-click on a plot does the same, dragging in it zooms";
  all.addEventListener("click", () => change({ band: null }));
  const node = document.createElement("fieldset");
  node.className = "band";
  const legend = document.createElement("legend");
  legend.textContent = "Band [Hz]";
  const box = document.createElement("div");
  box.append(ends[0], "to", ends[1], all);
  node.append(legend, box);
  const fill = (band) => ends.forEach((field, k) => {
    if (document.activeElement !== field) field.value = plain(band[k], 4);
  });
  return { node, fill };
}
