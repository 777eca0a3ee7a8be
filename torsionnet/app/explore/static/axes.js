// Ticks of frequency, speed, magnitude and phase.

import { short } from "./numbers.js";

const FEW_DECADES = 2.6;

// 1, 2, 5 over few decades, powers of ten over many.
export function logTicks(low, high) {
  const decades = Math.log10(high / low);
  const factors = decades < FEW_DECADES ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / 8));
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += every) {
    for (const factor of factors) {
      const tick = Number((factor * 10 ** power).toPrecision(3));
      if (tick >= low * 0.999 && tick <= high * 1.001) ticks.push(tick);
    }
  }
  return ticks.length > 1 ? ticks : linearTicks(low, high);
}

export function linearTicks(low, high, most = 6) {
  const rough = (high - low) / most;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * decade).find((one) => one >= rough * 0.999);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) ticks.push(Number((k * step).toPrecision(12)));
  return ticks;
}

export function phaseTicks(low, high, most) {
  const step = [30, 45, 90, 180, 360, 720].find((one) => (high - low) / one <= Math.max(1, Math.min(most, 8))) ?? 1440;
  const ticks = [];
  for (let tick = Math.ceil(low / step) * step; tick <= high; tick += step) ticks.push(tick);
  return ticks;
}

export function texts(ticks) {
  return ticks.map((tick) => short(tick, 3));
}

// Limits on round numbers, so that the plot does not breathe with every step of a slider.
export function logRange(low, high) {
  if (!(low > 0) || !Number.isFinite(high)) return [0.1, 1];
  const round = (value, up) => {
    const decade = 10 ** Math.floor(Math.log10(value) + 1e-9);
    const steps = [1, 2, 5, 10].map((factor) => factor * decade);
    return up ? steps.find((one) => one >= value * 0.999999) : steps.findLast((one) => one <= value * 1.000001);
  };
  const range = [round(low, false), round(high, true)];
  return range[1] / range[0] < 10 ? [range[0] / 2, range[1] * 2] : range;
}

export function roundUp(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].map((factor) => factor * decade).find((one) => one >= value * 0.9999);
}

export function stepRange(low, high, step, least) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [-step, step];
  let [bottom, top] = [Math.floor(low / step) * step, Math.ceil(high / step) * step];
  while (top - bottom < least) [bottom, top] = [bottom - step, top + step];
  return [bottom, top];
}
