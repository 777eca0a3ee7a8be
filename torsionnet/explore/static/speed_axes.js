// The plot over speed: linear, from 0, with a mark at the rated speed.

import { linearTicks, roundUp } from "./axes.js";
import { AXIS_WIDTH, axis, labelled } from "./plots.js";
import { colour } from "./theme.js";

const TEXT = 12; // pixels
const DASH = [6, 4];
const FAINT = 0.6; // of intervals, behind which the curves stay visible

export function speedPanels(form) {
  const x = axis((plot, __, low, high) => linearTicks(low, high, plot.width / 60), labelled(`Speed of ${form.reference} [r/min]`));
  const y = axis((_, __, low, high) => linearTicks(low, high), { size: AXIS_WIDTH });
  const scales = {
    x: { time: false, range: () => form.range },
    y: { range: (_, __, high) => [0, high > 0 ? roundUp(high) : 1] },
  };
  return [{ side: "magnitude", options: { axes: [x, y], scales, hooks: { draw: [(plot) => mark(plot, form.rated), (plot) => uprights(plot, form.whiskers)] } } }];
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
