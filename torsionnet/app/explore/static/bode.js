// Magnitude and phase over frequency.

import { linearTicks, logRange, logTicks, phaseTicks, stepRange } from "./axes.js";
import { AXIS_WIDTH, axis, labelled } from "./plots.js";

const LEAST_APART = 20; // pixels between ticks of phase

export function bodePanels(form) {
  return [
    { side: "magnitude", options: { ...magnitudeAxes(form), ...scales(form, magnitudeScale(form)) } },
    { side: "phase", options: { ...phaseAxes(form), ...scales(form, { range: phaseRange }) } },
  ];
}

function frequencies(form, label) {
  const ticks = form.logFrequency ? logTicks : linearTicks;
  return axis((_, __, low, high) => ticks(low, high), labelled(label));
}

function scales(form, y) {
  const x = { time: false, distr: form.logFrequency ? 3 : 1, range: () => form.band };
  return { scales: { x, y } };
}

function magnitudeScale(form) {
  if (form.decibels) return { range: (_, low, high) => stepRange(low, high, 10, 20) };
  return { distr: 3, range: (_, low, high) => logRange(low, high) };
}

function phaseRange(_, low, high) {
  return stepRange(low, high, 45, 90);
}

function magnitudeAxes(form) {
  const ticks = form.decibels ? linearTicks : logTicks;
  return { axes: [frequencies(form, ""), axis((_, __, low, high) => ticks(low, high), { size: AXIS_WIDTH })] };
}

function phaseAxes(form) {
  return { axes: [frequencies(form, "Frequency [Hz]"), axis((plot, __, low, high) => phaseTicks(low, high, plot.height / LEAST_APART - 3), { size: AXIS_WIDTH })] };
}
