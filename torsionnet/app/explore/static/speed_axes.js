// The plot over speed: linear, from 0, with a mark at the rated speed, bands of barred ranges and words on the limits.

import { linearTicks, roundUp } from "./axes.js";
import { short } from "./numbers.js";
import { AXIS_WIDTH, axis, labelled } from "./plots.js";
import { colour } from "./theme.js";

const TEXT = 12; // pixels
const DASH = [6, 4];
const BAND = 0.16; // opacity of a barred range, on which curves and words stay readable
const GAP = 4; // pixels between words and lines
const FAINT = 0.6; // of intervals, behind which the curves stay visible

export function speedPanels(form) {
  const x = axis((plot, __, low, high) => linearTicks(low, high, plot.width / 60), labelled(`Speed of ${form.reference} [r/min]`));
  const y = axis((_, __, low, high) => linearTicks(low, high), { size: AXIS_WIDTH });
  const scales = {
    x: { time: false, range: () => form.range },
    y: { range: (_, __, high) => [0, high > 0 ? roundUp(high) : 1] },
  };
  const hooks = {
    drawClear: [(plot) => bands(plot, form.barred)],
    draw: [(plot) => {
      uprights(plot, form.whiskers);
      const free = room(plot);
      mark(plot, form.rated, free);
      bandWords(plot, form.barred, free);
      limitWords(plot, form.limits, free);
    }],
  };
  return [{ side: "magnitude", options: { axes: [x, y], scales, hooks } }];
}

// Where words may stand: `take` has the first of some places on which neither a curve nor other words lie, or none. What
// finds no room is named in the list of curves.
function room(plot) {
  const { ctx, bbox, data, series, scales } = plot;
  const font = `${TEXT * devicePixelRatio}px system-ui, sans-serif`;
  const taken = [];
  const curves = series.slice(1).flatMap((one, k) => (one.show ? [data[0].flatMap((x, at) => {
    const y = data[k + 1][at];
    return y == null || x < scales.x.min || x > scales.x.max ? [] : [[plot.valToPos(x, "x", true), plot.valToPos(y, "y", true)]];
  })] : []));
  const crosses = ([left, top, right, bottom]) => curves.some((points) => points.some(([x, y], k) => {
    const [from, to] = [points[k - 1] ?? [x, y], [x, y]];
    if (from[0] > right || to[0] < left) return false;
    const at = (edge) => (to[0] > from[0] ? from[1] + ((Math.min(to[0], Math.max(from[0], edge)) - from[0]) / (to[0] - from[0])) * (to[1] - from[1]) : y);
    const ends = [at(left), at(right), ...(to[0] > from[0] ? [] : [from[1], y])];
    return Math.min(...ends) < bottom && Math.max(...ends) > top;
  }));
  // Places: [x, y, align, baseline]
  return function take(said, places, ink = colour("alarm")) {
    ctx.save();
    ctx.font = font;
    const wide = ctx.measureText(said).width;
    const high = TEXT * devicePixelRatio;
    for (const [x, y, align, baseline] of places) {
      const left = align === "right" ? x - wide : x;
      const top = { top: y, middle: y - high / 2, bottom: y - high }[baseline];
      const box = [left, top, left + wide, top + high];
      const isInside = left >= bbox.left && left + wide <= bbox.left + bbox.width && top >= bbox.top && top + high <= bbox.top + bbox.height;
      if (!isInside || crosses(box) || taken.some((one) => one[0] < box[2] && box[0] < one[2] && one[1] < box[3] && box[1] < one[3])) continue;
      taken.push(box);
      ctx.textAlign = align;
      ctx.textBaseline = baseline;
      ctx.fillStyle = ink;
      ctx.fillText(said, x, y);
      break;
    }
    ctx.restore();
  };
}

// Lines below one another from the top of the plot, of which the first free one is taken.
function rows(plot) {
  const { top, height } = plot.bbox;
  const step = (TEXT + GAP) * devicePixelRatio;
  return Array.from({ length: Math.floor(height / step) }, (_, k) => top + GAP * devicePixelRatio + k * step);
}

function mark(plot, rated, take) {
  if (rated === null || rated < plot.scales.x.min || rated > plot.scales.x.max) return;
  const { ctx, bbox } = plot;
  const x = plot.valToPos(rated, "x", true);
  ctx.save();
  ctx.strokeStyle = colour("muted");
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash(DASH.map((length) => length * devicePixelRatio));
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
  const inset = GAP * devicePixelRatio;
  take("rated", rows(plot).flatMap((y) => [[x - inset, y, "right", "top"], [x + inset, y, "left", "top"]]), colour("muted"));
}

function uprights(plot, whiskers) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.lineWidth = devicePixelRatio;
  ctx.globalAlpha = FAINT;
  for (const [x, low, high, ink] of whiskers) {
    const at = plot.valToPos(x, "x", true);
    ctx.strokeStyle = ink;
    ctx.beginPath();
    ctx.moveTo(at, plot.valToPos(low, "y", true));
    ctx.lineTo(at, plot.valToPos(high, "y", true));
    ctx.stroke();
  }
  ctx.restore();
}

// Ends of a barred range on the canvas, [] where it is outside of what is shown.
function ends(plot, [from, to]) {
  const { left, width } = plot.bbox;
  const [low, high] = [from, to].map((rpm) => Math.min(left + width, Math.max(left, plot.valToPos(rpm, "x", true))));
  return high > low ? [low, high] : [];
}

function bands(plot, barred) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.fillStyle = colour("alarm");
  ctx.globalAlpha = BAND;
  for (const one of barred) {
    const [low, high] = ends(plot, one);
    if (low !== undefined) ctx.fillRect(low, bbox.top, high - low, bbox.height);
  }
  ctx.restore();
}

// In the band or beside it.
function bandWords(plot, barred, take) {
  const inset = GAP * devicePixelRatio;
  for (const one of barred) {
    const [low, high] = ends(plot, one);
    if (low === undefined) continue;
    take("barred", rows(plot).flatMap((y) => [[low + inset, y, "left", "top"], [high - inset, y, "right", "top"], [low - inset, y, "right", "top"]]));
  }
}

// Above or below the line, from its left end on; at the top with an arrow where the line is above what is shown.
function limitWords(plot, limits, take) {
  const { x, y } = plot.scales;
  const inset = GAP * devicePixelRatio;
  for (const { words: said, points } of limits) {
    const inside = points.filter(([rpm]) => rpm >= x.min && rpm <= x.max);
    const seen = inside.filter(([, size]) => size <= y.max);
    if (seen.length) {
      const some = seen.filter((_, k) => k % Math.ceil(seen.length / 20) === 0);
      take(said, some.flatMap(([rpm, size]) => {
        const [at, line] = [plot.valToPos(rpm, "x", true) + inset, plot.valToPos(size, "y", true)];
        return [[at, line - inset, "left", "bottom"], [at, line + inset, "left", "top"]];
      }));
    } else if (inside.length) {
      const words = `↑ ${said} above, from ${short(Math.min(...inside.map(([, size]) => size)))}`;
      take(words, rows(plot).map((down) => [plot.bbox.left + inset, down, "left", "top"]));
    }
  }
}
