// Magnitude and phase over frequency: two plots of uPlot with one cursor.

import { linearTicks, logRange, logTicks, phaseTicks, stepRange, texts } from "./axes.js";
import { colour, DASHES } from "./theme.js";

const AXIS_WIDTH = 58;
const LINE = 2;
const LEAST_APART = 20; // pixels between ticks of phase

export function makeBode(places, actions) {
  let plots = [];
  let shape = "";

  // Made anew only if something changes that uPlot cannot change in place.
  function draw(curves, form) {
    const wanted = JSON.stringify([curves.map(({ kind, colour: ink, faint, dash }) => [kind, ink, faint, dash]), form]);
    const data = ["magnitude", "phase"].map((side) => joined(curves, side));
    if (wanted === shape) {
      plots.forEach((plot, k) => plot.setData(data[k]));
      return;
    }
    plots.forEach((plot) => plot.destroy());
    shape = wanted;
    plots = places.map((place, k) => {
      const options = k ? phaseOptions(form) : magnitudeOptions(form);
      return new uPlot({ ...common(place, curves, form, actions), ...options, ...scales(form, k) }, data[k], place);
    });
  }

  const resize = new ResizeObserver(() => plots.forEach((plot, k) => plot.setSize(size(places[k]))));
  places.forEach((place) => resize.observe(place));
  return { draw, plots: () => plots };
}

// Every curve has frequencies of its own; uPlot wants one list of x and gaps where a curve has no value.
function joined(curves, side) {
  if (!curves.length) return [[], []];
  return uPlot.join(curves.map((curve) => [curve.frequencies, curve[side]]));
}

function size(place) {
  return { width: Math.max(place.clientWidth, 120), height: Math.max(place.clientHeight, 80) };
}

function common(place, curves, form, actions) {
  return {
    ...size(place),
    legend: { show: false },
    padding: [8, 20, 0, 0],
    cursor: {
      sync: { key: "bode" },
      y: false,
      drag: { x: true, y: false, setScale: false },
      dataIdx: (plot, number, index) => (curves[number - 1]?.doubtful ? null : nearestValue(plot, number, index)),
      points: { size: 7, width: 2, fill: colour("paper") },
      bind: { dblclick: () => () => actions.widen() },
    },
    series: [{}, ...curves.map(series)],
    hooks: {
      setCursor: [actions.cursor],
      setSelect: [(plot) => select(plot, actions)],
      draw: [actions.drawn],
    },
  };
}

function series(curve, index) {
  const dots = curve.kind === "dots";
  return {
    stroke: curve.colour,
    width: dots ? 0 : index ? LINE * 0.8 : LINE,
    alpha: curve.faint || curve.doubtful ? 0.3 : 1,
    dash: DASHES[curve.dash],
    spanGaps: true,
    auto: !curve.doubtful, // lines of a test that nobody should trust do not set the scale
    pxAlign: 0,
    paths: dots ? () => null : undefined,
    points: { show: dots, size: 4, fill: curve.colour, width: 0 },
  };
}

function nearestValue(plot, number, index) {
  const values = plot.data[number];
  for (let away = 0; away < values.length; away += 1) {
    if (values[index + away] != null) return index + away;
    if (values[index - away] != null) return index - away;
  }
  return index;
}

function select(plot, actions) {
  const { left, width } = plot.select;
  if (width < 4) return;
  const band = [left, left + width].map((x) => Number(plot.posToVal(x, "x").toPrecision(3)));
  plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  actions.zoom(band);
}

function axis(values, more = {}) {
  const line = { stroke: colour("line"), width: 1 };
  return {
    stroke: colour("muted"),
    font: "12px system-ui, sans-serif",
    grid: line,
    ticks: { ...line, size: 4 },
    splits: values,
    values: (_, ticks) => texts(ticks),
    filter: (_, ticks) => ticks, // uPlot would label powers of ten only
    ...more,
  };
}

function frequencies(form, label) {
  const ticks = form.logFrequency ? logTicks : linearTicks;
  return axis((plot, __, low, high) => ticks(low, high), { size: 24, ...(label ? { label, labelSize: 16, labelFont: "12px system-ui, sans-serif" } : {}) });
}

function scales(form, isPhase) {
  const x = { time: false, distr: form.logFrequency ? 3 : 1, range: () => form.band };
  return { scales: { x, y: isPhase ? { range: phaseRange } : magnitudeScale(form) } };
}

function magnitudeScale(form) {
  if (form.decibels) return { range: (_, low, high) => stepRange(low, high, 10, 20) };
  return { distr: 3, range: (_, low, high) => logRange(low, high) };
}

function phaseRange(_, low, high) {
  return stepRange(low, high, 45, 90);
}

function magnitudeOptions(form) {
  const ticks = form.decibels ? linearTicks : logTicks;
  return { axes: [frequencies(form, ""), axis((_, __, low, high) => ticks(low, high), { size: AXIS_WIDTH })] };
}

function phaseOptions(form) {
  return { axes: [frequencies(form, "Frequency [Hz]"), axis((plot, __, low, high) => phaseTicks(low, high, plot.height / LEAST_APART - 3), { size: AXIS_WIDTH })] };
}
