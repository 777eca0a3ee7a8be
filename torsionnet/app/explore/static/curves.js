// The answer of the server as curves in the units shown.

import { short, unit } from "./numbers.js";
import { colour, curveColour } from "./theme.js";

export function shownUnit(response, state) {
  const text = unit(response.units[state.angle]);
  const plain = text === "1" ? "–" : text;
  return state.decibels ? `dB re 1 ${plain === "–" ? "" : plain}`.trim() : plain;
}

export function curve(answer, state, index, more = {}) {
  const { response } = answer;
  const scale = response.scales[state.angle];
  return {
    kind: "line",
    x: response.frequencies,
    magnitude: response.magnitude.map((value) => shown(value, scale, state)),
    phase: response.phase,
    colour: curveColour(index),
    dash: index % 7,
    ...more,
  };
}

// A test has phases between -180 and 180 degrees; each dot goes to the turn in which the model is at that frequency.
// Lines that cannot be trusted (coherence, resolution) come apart, and faint.
export function dots(test, answer, state, doubtful) {
  const scale = answer.response.scales[state.angle];
  const lines = test.trusted.flatMap((good, k) => (good === doubtful ? [] : [k]));
  return {
    kind: "dots",
    x: lines.map((k) => test.frequencies[k]),
    magnitude: lines.map((k) => shown(test.magnitude[k], scale, state)),
    phase: lines.map((k) => beside(test.phase[k], at(answer.response, test.frequencies[k]))),
    colour: colour("test"),
    dash: 0,
    doubtful,
  };
}

export function shown(value, scale, state) {
  if (value === null || value <= 0) return null;
  return state.decibels ? 20 * Math.log10(value * scale) : value * scale;
}

export function summary(answer, state) {
  const { response } = answer;
  const scale = response.scales[state.angle];
  const words = shownUnit(response, state);
  const high = response.peaks.filter((peak) => peak[1] !== null);
  const said = high.map(
    ([f, magnitude, phase]) => `${short(shown(magnitude, scale, state))} ${words} at ${short(f)} Hz (${short(phase, 3)}°)`,
  );
  const endless = response.peaks.filter((peak) => peak[1] === null).map(([f]) => short(f));
  if (endless.length) said.push(`without bound at ${endless.join(", ")} Hz (no damping)`);
  if (!said.length) return `${response.label}: no peak in this band.`;
  return `${response.label}: ${response.peaks.length > 1 ? "peaks" : "peak"} ${said.join(", ")}.`;
}

function at(response, frequency) {
  const { frequencies, phase } = response;
  let [low, high] = [0, frequencies.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (frequencies[middle] <= frequency) low = middle;
    else high = middle;
  }
  return phase[low] ?? 0;
}

function beside(value, other) {
  return value + 360 * Math.round((other - value) / 360);
}
