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
    draw: [
      (plot) => mark(plot, form.rated),
      (plot) => uprights(plot, form.whiskers),
      (plot) => bandWords(plot, form.barred),
      (plot) => limitWords(plot, form.limits),
    ],
  };
  return [{ side: "magnitude", options: { axes: [x, y], scales, hooks } }];
}

function mark(plot, rated) {
  if (rated === null || rated < plot.scales.x.min || rated > plot.scales.x.max) return;
  const { ctx, bbox } = plot;
  const x = plot.valToPos(rated, "x", true);
  ctx.save();
  ctx.strokeStyle = ctx.fillStyle = colour("muted");
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash(DASH.map((length) => length * devicePixelRatio));
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.font = `${TEXT * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = x > bbox.left + bbox.width / 2 ? "right" : "left";
  ctx.textBaseline = "top";
  ctx.fillText("rated", x + (ctx.textAlign === "right" ? -5 : 5) * devicePixelRatio, bbox.top + 4 * devicePixelRatio);
  ctx.restore();
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

// Below the top of the band, where it is wide enough, else beside it.
function bandWords(plot, barred) {
  const { bbox } = plot;
  for (const one of barred) {
    const [low, high] = ends(plot, one);
    if (low === undefined) continue;
    const onRight = low < bbox.left + 0.7 * bbox.width;
    words(plot, "barred", onRight ? low : high, bbox.top + GAP * devicePixelRatio, onRight ? "left" : "right", "top");
  }
}

// On the line at its left end, at the right one where it comes in through the top of the plot; at the top with an arrow
// where the line is above what is shown.
function limitWords(plot, limits) {
  const { x, y } = plot.scales;
  const above = [];
  for (const one of limits) {
    const inside = one.points.filter(([rpm]) => rpm >= x.min && rpm <= x.max);
    const seen = inside.filter(([, size]) => size <= y.max);
    if (!seen.length) above.push(one);
    else limitWord(plot, one.words, seen, seen[0] === inside[0]);
  }
  const off = above.flatMap(({ words: said, points }) => {
    const sizes = points.filter(([rpm]) => rpm >= x.min && rpm <= x.max).map(([, size]) => size);
    return sizes.length ? [`${said} above, from ${short(Math.min(...sizes))}`] : [];
  });
  off.forEach((said, k) => {
    const down = plot.bbox.top + (2 * GAP + (k + 1) * (TEXT + GAP)) * devicePixelRatio;
    words(plot, `↑ ${said}`, plot.bbox.left, down, "left", "top");
  });
}

function limitWord(plot, said, seen, isWhole) {
  const [rpm, size] = isWhole ? seen[0] : seen.at(-1);
  const [at, line] = [plot.valToPos(rpm, "x", true), plot.valToPos(size, "y", true)];
  if (!isWhole) return words(plot, said, at, line, at > plot.bbox.left + 0.7 * plot.bbox.width ? "right" : "left", "middle");
  const below = line - plot.bbox.top < (TEXT + GAP) * devicePixelRatio;
  words(plot, said, at, line + (below ? GAP : -GAP) * devicePixelRatio, "left", below ? "top" : "bottom");
}

// With the ground of the page behind, so that curves do not cross them.
function words(plot, said, x, y, align, baseline) {
  const { ctx } = plot;
  const inset = (align === "right" ? -GAP : GAP) * devicePixelRatio;
  ctx.save();
  ctx.font = `${TEXT * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = align;
  ctx.textBaseline = baseline;
  ctx.lineWidth = 3 * devicePixelRatio;
  ctx.lineJoin = "round";
  ctx.strokeStyle = colour("paper");
  ctx.fillStyle = colour("alarm");
  ctx.strokeText(said, x + inset, y);
  ctx.fillText(said, x + inset, y);
  ctx.restore();
}
