// Poles in the upper half plane, both axes in Hz, with rays of equal damping ratio. Real poles far to the left would
// flatten everything: the map shows where vibrations are, and an arrow for what lies beyond.

import { linearTicks, roundUp } from "./axes.js";
import { short } from "./numbers.js";
import { shape, word } from "./svg.js";

const WIDTH = 380;
const HEIGHT = 280;
const EDGE = { left: 12, right: 46, top: 14, bottom: 34 };
const RATIOS = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7];
const TURN = 2 * Math.PI;

export function drawPoles(svg, sets) {
  svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  const poles = sets.flatMap((set) => set.modes.real.map((_, k) => pole(set, k)));
  const view = window_(poles);
  const place = {
    x: (real) => EDGE.left + (WIDTH - EDGE.left - EDGE.right) * (1 - real / view.real),
    y: (imag) => HEIGHT - EDGE.bottom - (HEIGHT - EDGE.top - EDGE.bottom) * (imag / view.imag),
  };
  svg.replaceChildren(...grid(view, place), ...rays(view, place), ...poles.map((one) => cross(one, view, place)));
  svg.setAttribute("aria-label", `Pole map: ${sets[0].modes.damped.map((f, k) => said(sets[0].modes, k)).join("; ")}`);
}

function pole({ modes, colour, pinned }, k) {
  return { real: modes.real[k] / TURN, imag: modes.imag[k] / TURN, title: said(modes, k), colour, pinned };
}

function said(modes, k) {
  return `mode ${k + 1}: ${short(modes.natural[k])} Hz, ${modes.kinds[k] === "rigid body" ? "rigid body" : `${short(100 * modes.ratio[k], 3)} %`}`;
}

// Seen: every vibration, and real poles as far as these reach.
function window_(poles) {
  const vibrating = poles.filter((one) => one.imag > 0);
  const shown = vibrating.length ? vibrating : poles;
  const imag = Math.max(...shown.map((one) => one.imag), 0);
  const real = Math.min(...shown.map((one) => one.real), 0);
  const high = roundUp(1.12 * imag || 1);
  return { imag: high, real: -roundUp(1.2 * -real || 0.02 * high) };
}

function grid(view, place) {
  const lines = [];
  for (const tick of linearTicks(0, view.imag, 5)) {
    lines.push(line("grid", place.x(view.real), place.y(tick), place.x(0), place.y(tick)));
    lines.push(word(short(tick, 3), place.x(0) + 6, place.y(tick) + 4, "tick"));
  }
  for (const tick of linearTicks(view.real, 0, 4)) {
    lines.push(line("grid", place.x(tick), place.y(0), place.x(tick), place.y(view.imag)));
    lines.push(word(short(tick, 3), place.x(tick), place.y(0) + 15, "tick middle"));
  }
  lines.push(line("axis", place.x(view.real), place.y(0), place.x(0), place.y(0)));
  lines.push(line("axis", place.x(0), place.y(0), place.x(0), place.y(view.imag)));
  lines.push(word("Im", place.x(0) - 6, EDGE.top + 2, "tick end"), word("Re", place.x(view.real / 2), HEIGHT - 4, "tick middle"));
  return lines;
}

// zeta = -Re / |lambda|: a straight line through the origin, whatever the scales of the axes.
function rays(view, place) {
  let last = -Infinity; // names side by side keep their distance
  return RATIOS.toReversed().flatMap((ratio) => {
    const slope = ratio / Math.sqrt(1 - ratio ** 2);
    const imag = Math.min(view.imag, -view.real / slope);
    const [x, y] = [place.x(-slope * imag), place.y(imag)];
    const way = x - (y - place.y(view.imag)); // along the left edge upwards, then along the upper one
    if (way - last < 30 || place.x(0) - x < 26 || place.y(0) - y < 22) return [];
    last = way;
    const label = `${short(100 * ratio)} %`;
    const shown = imag === view.imag ? word(label, x, y - 3, "ray-name middle") : word(label, x + 3, y - 3, "ray-name");
    return [line("ray", place.x(0), place.y(0), x, y), shown];
  });
}

function cross(one, view, place) {
  const group = shape("g", { class: one.pinned ? "pole pinned" : "pole", stroke: one.colour });
  const beyond = one.real < view.real || one.real > 0;
  const [x, y] = [place.x(Math.max(view.real, Math.min(one.real, 0))), place.y(Math.min(one.imag, view.imag))];
  const size = one.pinned ? 3.5 : 5;
  const path = beyond
    ? `M${x + 9} ${y - 4}L${x + 2} ${y}L${x + 9} ${y + 4}`
    : `M${x - size} ${y - size}L${x + size} ${y + size}M${x - size} ${y + size}L${x + size} ${y - size}`;
  group.append(Object.assign(shape("title", {}), { textContent: one.title }), shape("path", { d: path }));
  return group;
}

function line(kind, x1, y1, x2, y2) {
  return shape("line", { class: kind, x1, y1, x2, y2 });
}
