// Interference diagram: natural frequencies as level lines, orders of the excitations as rays over speed, dots where they
// meet at a critical speed in the range.

import { linearTicks, roundUp } from "./axes.js";
import { short } from "./numbers.js";
import { shape, word } from "./svg.js";
import { curveColour } from "./theme.js";

const EDGE = { left: 46, right: 92, top: 16, bottom: 36 };
const ROOM = 13; // pixels for a word
const HEADROOM = 1.15;

export function drawInterference(svg, { orders, modes }) {
  const { clientWidth: width, clientHeight: height } = svg;
  if (!width || !orders) return;
  const [low, high] = orders.range;
  const end = 1.06 * high;
  const waves = modes.natural.flatMap((hz, k) => (hz > 0 && modes.damped[k] > 0 ? [{ hz, name: modes.numbers[k] }] : []));
  const met = waves.flatMap(({ hz, name }) => orders.lines.flatMap((line) => {
    const rpm = (hz - line.fixed) / line.slope;
    return rpm >= low && rpm <= high ? [{ hz, rpm, said: `mode ${name}, ${line.name}: ${short(hz)} Hz at ${short(rpm)} r/min` }] : [];
  }));
  const top = roundUp(HEADROOM * Math.max(...met.map(({ hz }) => hz), waves[0]?.hz ?? 1));
  const x = (rpm) => EDGE.left + ((width - EDGE.left - EDGE.right) * rpm) / end;
  const y = (hz) => height - EDGE.bottom - ((height - EDGE.top - EDGE.bottom) * hz) / top;
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("aria-label", `Interference diagram: ${met.map(({ said }) => said).join("; ") || "no critical speed in the range"}`);
  const parts = [shape("rect", { x: x(low), width: Math.max(1, x(high) - x(low)), y: EDGE.top, height: y(0) - EDGE.top, class: "range" })];
  for (const tick of linearTicks(0, end, width / 90)) parts.push(word(short(tick, 3), x(tick), y(0) + 16, "middle"));
  for (const tick of linearTicks(0, top, height / 40)) {
    parts.push(shape("line", { x1: x(0), x2: x(end), y1: y(tick), y2: y(tick), class: "grid" }), word(short(tick, 3), x(0) - 6, y(tick) + 4, "end"));
  }
  parts.push(word(`Speed of ${orders.reference} [r/min]`, x(end / 2), height - 4, "middle"), word("[Hz]", 4, 11, ""));
  const names = []; // places of words at the ends of lines
  const source = ({ name }) => name.split(" ")[0];
  const sources = [...new Set(orders.lines.map(source))];
  for (const { hz, name } of waves.filter((one) => one.hz <= top)) {
    parts.push(shape("line", { x1: x(0), x2: x(end), y1: y(hz), y2: y(hz), class: "natural" }));
    const place = [x(end) + 4, y(hz) + 4, ""];
    if (names.some(([left, down]) => left >= place[0] && Math.abs(down - place[1]) < ROOM)) continue;
    names.push(place);
    parts.push(word(`${name}: ${short(hz)} Hz`, ...place));
  }
  for (const line of orders.lines) {
    const last = line.slope > 0 ? Math.min(end, (top - line.fixed) / line.slope) : end;
    const stop = { x: x(last), y: y(line.fixed + line.slope * last) };
    parts.push(shape("line", { x1: x(0), y1: y(line.fixed), x2: stop.x, y2: stop.y, stroke: curveColour(sources.indexOf(source(line))), class: "order" }));
    const said = line.name.slice(line.name.indexOf(" ") + 1);
    const place = last < end ? [stop.x, stop.y - 4, "middle"] : [stop.x + 4, stop.y + 4, ""];
    if (names.some(([left, down]) => Math.abs(left - place[0]) < 2 * ROOM && Math.abs(down - place[1]) < ROOM)) continue;
    names.push(place);
    parts.push(word(said, ...place));
  }
  parts.push(...met.map((one) => {
    const dot = shape("circle", { cx: x(one.rpm), cy: y(one.hz), r: 4 });
    dot.append(Object.assign(shape("title", {}), { textContent: one.said }));
    return dot;
  }));
  svg.replaceChildren(...parts);
}
