// A row for each parameter: name, value with unit, slider, reset. Rows are made once and only filled afterwards, since
// replacing a slider under the finger that drags it would end the drag.

import { plain, short, symbol, unit } from "./numbers.js";
import { STEPS, toPosition, toValue } from "./scale.js";

// `make` makes a parameter of one of the numbers that elements are written with.
export function makeSliders(place, parameters, point, numbers, change, make) {
  const rows = new Map([...point, ...parameters].map((one) => [one.name, makeRow(bare(one), change)]));
  place.replaceChildren(...[...rows.values()].map((row) => row.node));
  if (point.length && parameters.length) rows.get(parameters[0].name).node.classList.add("first");
  if (numbers.length) place.append(numberList(numbers, !rows.size, make));
  else if (!rows.size) place.textContent = "The model has no numbers to move.";
  return {
    fill: (now) => {
      const given = new Map(now.map((one) => [one.name, one]));
      rows.forEach((row, name) => (given.has(name) ? fill(row, given.get(name)) : (row.node.hidden = true)));
    },
    fault: (name) => rows.forEach((row, own) => row.field.toggleAttribute("aria-invalid", own === name || !row.gap.hidden)),
  };
}

// Numbers in elements, each with a button that gives it a slider.
function numberList(numbers, isOpen, make) {
  const box = Object.assign(element("details", "numbers"), { open: isOpen });
  const rows = numbers.map((one) => {
    const button = Object.assign(element("button", "small", "slider"), { type: "button", title: "Make it a parameter, in the text" });
    button.setAttribute("aria-label", `Slider for ${one.entry} of ${one.element}`);
    button.addEventListener("click", () => make(one));
    const row = element("p", "number");
    row.append(element("span", "name", `${one.element}, ${one.entry}`), element("span", "unit", unit(one.written)), button);
    return row;
  });
  box.append(element("summary", "", "Numbers without a slider"), ...rows);
  return box;
}

function bare(parameter) {
  return { ...parameter, value: 1, default: 1, low: 0.1, high: 10, shown_unit: "", expression: "", remark: "" };
}

function makeRow(parameter, change) {
  const id = `parameter-${parameter.name}`;
  const words = parameter.label ?? parameter.name;
  const node = element("div", "parameter");
  const label = element("label", "name");
  label.htmlFor = id;
  label.append(parameter.label ?? symbol(parameter.name));
  label.title = [words, parameter.description].filter(Boolean).join(": ");
  node.classList.toggle("is-point", Boolean(parameter.label));
  const description = element("span", "description", parameter.description ?? "");
  const field = element("input", "value");
  Object.assign(field, { id, type: "text", inputMode: "decimal", autocomplete: "off", spellcheck: false });
  const units = element("span", "unit");
  const slider = element("input", "slider");
  Object.assign(slider, { type: "range", min: 0, max: STEPS, step: 1, title: "Double-click: back to the file's value" });
  slider.setAttribute("aria-label", `${words} ${parameter.description ?? ""}`.trim());
  const mark = element("span", "mark");
  const reset = element("button", "reset", "↺");
  Object.assign(reset, { type: "button", title: "Back to the file's value" });
  reset.setAttribute("aria-label", `Reset ${words}`);
  const track = element("div", "track");
  track.append(mark, slider);
  const derived = element("span", "derived");
  const gap = element("p", "gap");
  Object.assign(gap, { id: `${id}-gap`, hidden: true, role: "alert" });
  node.append(label, description, field, units, track, derived, gap, reset);
  const row = { node, field, units, slider, mark, reset, derived, gap, now: parameter };
  slider.addEventListener("input", (event) => drag(row, change, event));
  field.addEventListener("change", (event) => type(row, change, event));
  const back = (event) => {
    missing(row, false);
    row.field.value = plain(row.now.value);
    change(row.now.name, null, event.timeStamp);
  };
  slider.addEventListener("dblclick", back);
  reset.addEventListener("click", back);
  return row;
}

function drag(row, change, event) {
  const value = toValue(Number(row.slider.value), row.now);
  missing(row, false);
  row.field.value = plain(value);
  row.slider.setAttribute("aria-valuetext", `${plain(value)} ${row.now.shown_unit}`);
  change(row.now.name, value === row.now.default ? null : withUnit(plain(value), row.now), event.timeStamp);
}

// A bare number is meant in the unit beside the field; any other text goes to the library, which reads units.
function type(row, change, event) {
  const text = withPoint(row.field.value.trim());
  row.field.value = text;
  const isNumber = text !== "" && Number.isFinite(Number(text));
  missing(row, text === "");
  if (text === "") return;
  const same = isNumber && Number(text) === row.now.default;
  change(row.now.name, same ? null : isNumber ? withUnit(text, row.now) : text, event.timeStamp);
}

// 0,3 is 0.3; whether 13,300 is meant so is for the one who wrote it to say.
function withPoint(text) {
  return text.replace(/^([-+]?\d*),(\d+)(?![\d,.])/, (all, whole, part) => (part.length === 3 && Number(whole) ? all : `${whole}.${part}`));
}

// An empty field is no value: it says what it waits for, and the last value stays in force.
function missing(row, is) {
  row.gap.hidden = !is;
  row.field.toggleAttribute("aria-invalid", is);
  if (!is) return row.field.removeAttribute("aria-describedby");
  const { label, name, default: own, shown_unit: inUnit } = row.now;
  row.gap.textContent = `${label ?? name} has no value: type a number, such as ${plain(own)}${inUnit ? ` ${inUnit}` : ""}, or ↺ for the file's value. Until then ${plain(row.now.value)} stays in force.`;
  row.field.setAttribute("aria-describedby", row.gap.id);
  row.reset.hidden = false;
}

function withUnit(text, parameter) {
  return parameter.unit ? `${text} ${parameter.unit}` : text;
}

function fill(row, parameter) {
  row.now = parameter;
  row.node.hidden = false;
  const derived = parameter.expression !== "";
  row.node.classList.toggle("is-derived", derived);
  row.node.classList.toggle("is-changed", parameter.changed);
  row.field.readOnly = derived;
  if (row.gap.hidden && (document.activeElement !== row.field || derived)) row.field.value = derived ? short(parameter.value, 5) : plain(parameter.value);
  row.units.textContent = unit(parameter.shown_unit);
  row.reset.hidden = !parameter.changed && row.gap.hidden;
  row.derived.textContent = derived ? `= ${unit(parameter.expression)}` : parameter.remark;
  row.node.classList.toggle("has-remark", parameter.remark !== "");
  const position = toPosition(parameter.value, parameter);
  if (Number(row.slider.value) !== position) row.slider.value = position;
  row.slider.setAttribute("aria-valuetext", `${short(parameter.value)} ${parameter.shown_unit}`);
  row.mark.style.setProperty("--at", toPosition(parameter.default, parameter) / STEPS);
}

function element(tag, kind, text = "") {
  const node = document.createElement(tag);
  node.className = kind;
  if (text) node.textContent = text;
  return node;
}
