// Over frequency: magnitude and phase of a response, and a test laid over it.

import { bodePanels } from "./bode.js";
import { curve, dots, shownUnit, summary } from "./curves.js";
import { short, symbol } from "./numbers.js";
import { DASHES, isDark } from "./theme.js";

export const overFrequency = {
  cursor: "Frequency cursor",
  peak: "peak",
  text: (frequency) => `${short(frequency)} Hz`,
  unit: ({ response }, state) => shownUnit(response, state),
  summary,
  range: (answer) => answer.band,
  curves,
  draw(plots, seen, answer, state) {
    const { band } = answer;
    const form = { band, decibels: state.decibels, logFrequency: band[1] / band[0] >= 10, theme: isDark(state.theme) };
    plots.draw(seen, bodePanels(form), form);
  },
  title: ({ response }, state) => [`${response.kind} `, symbol(state.output), " / ", symbol(state.input)],
  notes: (answer) => answer.response.notes,

  // The largest peak: what is read where no cursor stands.
  start(answer) {
    const larger = (best, one) => (best && (best[1] ?? Infinity) >= (one[1] ?? Infinity) ? best : one);
    return answer.response.peaks.reduce(larger, null)?.[0];
  },
  said: (all, unit) => `${short(all[0]?.[0])} ${unit}, ${short(all[0]?.[1], 3)} degrees`,
};

function curves(answer, state, now, pinned, test) {
  const found = [{ ...curve(answer, state, 0), ...now, name: "now" }];
  pinned.forEach(({ answer: other, k, ...look }) => found.push({ ...curve(other, state, k), ...look, dashes: DASHES[k % 7] }));
  if (!test) return found;
  const apart = answer.misfit;
  const note = apart ? `apart by ${short(apart.decibels, 3)} dB, ${short(apart.degrees, 3)}° RMS; FRAC ${apart.frac.toFixed(4)}` : "";
  const kind = { key: `test ${state.overlaid}`, name: test.name, note, hidden: !state.overlaid };
  const rest = dots(test, answer, state, true);
  found.push({ ...dots(test, answer, state, false), ...kind });
  if (rest.x.length) found.push({ ...rest, ...kind, key: `doubtful ${state.overlaid}`, name: "", unlisted: true });
  return found;
}
