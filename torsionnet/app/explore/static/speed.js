// Over speed: the half range of all orders, thick, the largest orders below it, and the limits of the model.

import { short, symbol, unit } from "./numbers.js";
import { speedPanels } from "./speed_axes.js";
import { colour, curveColour, DASHES, isDark } from "./theme.js";

const THICK = 3.2;
const THIN = 1.5;
const COLOURS = [4, 3, 2, 6, 5]; // of the orders; pins take theirs from the other end
const SINGLE = 0.05; // share of a single speed that is shown to either side of it
const LIMIT_DASHES = [1, 4]; // of what is allowed for long, and in passing
const FAR = 2.5; // times the largest half range: a limit above that does not flatten the curves

let places = []; // which order has which colour, so that none changes it while a slider moves
let bars = []; // ranges to be barred of the last answer, for the words at the cursor

export const overSpeed = {
  cursor: "Speed cursor",
  peak: "largest",
  text: (rpm) => `${short(rpm)} r/min${bars.some((one) => one.from <= rpm && rpm <= one.to) ? ", barred range" : ""}`,
  unit: unitOf,
  summary,
  range,
  curves,
  draw(plots, seen, answer, state) {
    const { reference, rated, barred } = answer.orders;
    const form = {
      range: range(answer, state), reference, rated, theme: isDark(state.theme), whiskers: whiskers(answer, state),
      barred: joined(barred), limits: limitLabels(answer, state),
    };
    plots.draw(seen, speedPanels(form), form);
  },
  title: ({ orders }) => [symbol(orders.output), orders.count > orders.orders.length ? ": all orders and the largest" : ": all orders"],
  notes: ({ orders }) => [...(orders.tested ?? []).map(({ name, verdict }) => `${name} ${verdict}`), ...orders.notes, ...orders.limit_notes],
  start: (answer, state) => largest(answer.orders.rpm, answer.orders.half_range, range(answer, state))[0],
  said: (all, inUnit, names) => all.map(([size], k) => `${names[k]} ${short(size)} ${inUnit}`).join(", "),
};

function unitOf({ orders }, state) {
  return unit(orders.units[state.angle]);
}

function range({ orders }, state) {
  const [low, high] = state.rpm ?? orders.range;
  return low < high ? [low, high] : [low * (1 - SINGLE), high * (1 + SINGLE)];
}

function curves(answer, state, now, pinned) {
  const { orders } = answer;
  bars = orders.barred;
  const found = [{ ...half(answer, state, 0), ...now, name: orders.total }];
  for (const { name, magnitude } of placed(orders.orders)) {
    const look = { colour: colourOf(name), dash: 0, width: THIN, faint: now.faint };
    found.push({ ...line(orders, magnitude, state), ...look, key: `order ${name}`, name });
  }
  for (const one of orders.tested ?? []) {
    const look = { kind: "dots", colour: colourOf(one.name), dash: 0, faint: now.faint, hidden: !state.overlaid };
    found.push({ ...line(orders, one.magnitude, state), ...look, x: one.rpm, key: `test ${one.name} ${state.overlaid}`, name: `${one.name}, test` });
  }
  for (const { name, allowed, in_passing: passing } of orders.limits) {
    const dash = LIMIT_DASHES[Number(passing)];
    const look = { colour: colour("alarm"), dash, dashes: DASHES[dash], width: THIN, faint: now.faint, isLimit: true, isFar: isFar(orders, allowed, passing) };
    found.push({ ...line(orders, allowed, state), ...look, key: `limit ${name}`, name: limitName(name), note: passing ? "in passing" : "" });
  }
  pinned.forEach(({ answer: other, k, ...look }) => found.push({ ...half(other, state, k), ...look, dashes: DASHES[k % 7] }));
  return found;
}

function colourOf(name) {
  return curveColour(COLOURS[places.indexOf(name)]);
}

function limitName(name) {
  return `limit ${name.replace("tau_", "τ_")}`;
}

// What may be reached in passing never sets the scale.
function isFar({ half_range: values }, allowed, passing) {
  return passing || Math.min(...known(allowed)) > FAR * Math.max(...known(values));
}

function known(values) {
  return values.filter((value) => value !== null);
}

// What is written on the lines of the limits, and their points in r/min and the unit shown.
function limitLabels({ orders }, state) {
  const scale = orders.scales[state.angle];
  return orders.limits.map(({ name, allowed }) => ({
    words: limitName(name),
    points: orders.rpm.flatMap((rpm, k) => (allowed[k] === null ? [] : [[rpm, allowed[k] * scale]])),
  }));
}

// Ranges of several limits that overlap are one band.
function joined(barred) {
  const found = [];
  for (const { from, to } of [...barred].sort((one, other) => one.from - other.from)) {
    const before = found.at(-1);
    if (before && from <= before[1]) before[1] = Math.max(before[1], to);
    else found.push([from, to]);
  }
  return found;
}

// Intervals of measured orders: [r/min, lowest, highest, colour]. They stay where they are while a slider moves.
function whiskers({ orders }, state) {
  const scale = orders.scales[state.angle];
  const shown = state.overlaid ? (orders.tested ?? []).filter((one) => one.half_widths) : [];
  return shown.flatMap(({ name, rpm, magnitude, half_widths: widths }) =>
    rpm.flatMap((x, k) => (widths[k] === null ? [] : [[x, scale * Math.max(0, magnitude[k] - widths[k]), scale * (magnitude[k] + widths[k]), colourOf(name)]])),
  );
}

function half({ orders }, state, index) {
  const look = { colour: curveColour(index), dash: index % 7, width: index ? THICK * 0.7 : THICK };
  return { ...line(orders, orders.half_range, state), ...look };
}

function line(orders, values, state) {
  const scale = orders.scales[state.angle];
  return { kind: "line", x: orders.rpm, magnitude: values.map((value) => (value === null ? null : value * scale)) };
}

// In the order of their colours; an order that comes in takes the place of one that has gone.
function placed(orders) {
  const names = orders.map(({ name }) => name);
  places = COLOURS.map((_, k) => (names.includes(places[k]) ? places[k] : ""));
  for (const name of names) if (!places.includes(name)) places[places.indexOf("")] = name;
  return places.filter(Boolean).map((name) => orders.find((one) => one.name === name));
}

// [r/min, size] where a curve is largest, among the speeds in a range.
function largest(rpm, values, [low, high] = [0, Infinity]) {
  const inside = rpm.flatMap((one, k) => (one >= low && one <= high && values[k] !== null ? [k] : []));
  const at = inside.reduce((best, k) => (values[k] > (values[best] ?? -1) ? k : best), -1);
  return [rpm[at], values[at]];
}

function summary({ orders }, state) {
  const words = unitOf({ orders }, state);
  const said = ([rpm, value]) => `${short(value * orders.scales[state.angle])} ${words} at ${short(rpm)} r/min`;
  const parts = [`${orders.total}, at most ${said(largest(orders.rpm, orders.half_range))}`, ...atRated(orders, said)];
  for (const { name, magnitude } of orders.orders) parts.push(`${name}, at most ${said(largest(orders.rpm, magnitude))}`);
  for (const { name, allowed } of orders.limits) if (known(allowed).length) parts.push(`${limitName(name)} ${between(orders, allowed, state)} ${words}`);
  for (const [from, to] of joined(orders.barred)) {
    const by = orders.barred.filter((one) => from <= one.from && one.to <= to).map(({ name, case: worst }) => limitName(name) + (worst && `, ${worst}`));
    parts.push(`barred from ${short(from)} to ${short(to)} r/min (${[...new Set(by)].join(", ")})`);
  }
  return `${orders.output}: ${parts.join("; ")}.`;
}

// The lowest to the highest value allowed, or the only one.
function between(orders, allowed, state) {
  const scale = orders.scales[state.angle];
  const [low, high] = [Math.min, Math.max].map((end) => short(end(...known(allowed)) * scale));
  return low === high ? low : `${low} to ${high}`;
}

// At the calculated speed next to the rated one, if that is among them.
function atRated({ rpm, range: [low, high], rated, half_range: values }, said) {
  if (rated === null || rated < low || rated > high) return [];
  const at = rpm.reduce((best, one, k) => (Math.abs(one - rated) < Math.abs(rpm[best] - rated) ? k : best), 0);
  return [`${said([rpm[at], values[at]])}, rated speed`];
}
