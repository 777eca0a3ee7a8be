// Plots of uPlot below each other, with one cursor: what curves look like, how one zooms and reads them.

import { texts } from "./axes.js";
import { colour, DASHES } from "./theme.js";

export const AXIS_WIDTH = 58;
const LINE = 2;
const FONT = "12px system-ui, sans-serif";

export function makePlots(places, actions) {
  let plots = [];
  let shape = "";

  // `panels` say which side of the curves a plot shows and with which options of uPlot; `form` is what these depend on.
  // Plots are made anew only if something changes that uPlot cannot change in place.
  function draw(curves, panels, form) {
    const looks = curves.map(({ kind, colour: ink, faint, dash, width, isFar }) => [kind, ink, faint, dash, width, isFar]);
    const wanted = JSON.stringify([looks, form]);
    const data = panels.map(({ side }) => joined(curves, side));
    if (wanted === shape) {
      plots.forEach((plot, k) => plot.setData(data[k]));
      return;
    }
    plots.forEach((plot) => plot.destroy());
    shape = wanted;
    plots = panels.map(({ options }, k) => {
      const all = common(places[k], curves, actions);
      return new uPlot({ ...all, ...options, hooks: { ...all.hooks, ...options.hooks } }, data[k], places[k]);
    });
  }

  const resize = new ResizeObserver(() => plots.forEach((plot, k) => plot.setSize(size(places[k]))));
  places.forEach((place) => resize.observe(place));
  return { draw, plots: () => plots };
}

// Every curve has an x of its own; uPlot wants one list of x and gaps where a curve has no value.
function joined(curves, side) {
  if (!curves.length) return [[], []];
  return uPlot.join(curves.map((curve) => [curve.x, curve[side]]));
}

function size(place) {
  return { width: Math.max(place.clientWidth, 120), height: Math.max(place.clientHeight, 80) };
}

function common(place, curves, actions) {
  return {
    ...size(place),
    legend: { show: false },
    padding: [8, 20, 0, 0],
    cursor: {
      sync: { key: "plots" },
      y: false,
      drag: { x: true, y: false, setScale: false },
      dataIdx: (plot, number, index) => (curves[number - 1]?.doubtful ? null : curves[number - 1]?.isLimit ? index : nearestValue(plot, number, index)),
      points: { size: 7, width: 2, fill: colour("paper") },
      bind: { dblclick: () => () => actions.widen() },
    },
    series: [{}, ...curves.map(series)],
    hooks: { setCursor: [actions.cursor], setSelect: [(plot) => select(plot, actions)] },
  };
}

function series(curve, index) {
  const dots = curve.kind === "dots";
  return {
    stroke: curve.colour,
    width: dots ? 0 : (curve.width ?? (index ? LINE * 0.8 : LINE)),
    alpha: curve.faint || curve.doubtful ? 0.3 : 1,
    dash: DASHES[curve.dash],
    spanGaps: true,
    auto: !curve.doubtful && !curve.isFar, // lines of a test that nobody should trust and far limits do not set the scale
    pxAlign: 0,
    paths: dots ? () => null : undefined,
    points: { show: dots || curve.x.length === 1, size: dots ? 4 : 7, fill: curve.colour, width: 0 },
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
  const range = [left, left + width].map((x) => Number(plot.posToVal(x, "x").toPrecision(3)));
  plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  actions.zoom(range);
}

export function axis(values, more = {}) {
  const line = { stroke: colour("line"), width: 1 };
  return {
    stroke: colour("muted"),
    font: FONT,
    grid: line,
    ticks: { ...line, size: 4 },
    splits: values,
    values: (_, ticks) => texts(ticks),
    filter: (_, ticks) => ticks, // uPlot would label powers of ten only
    ...more,
  };
}

export function labelled(label) {
  return { size: 24, ...(label ? { label, labelSize: 16, labelFont: FONT } : {}) };
}
