// Mode shapes as curves along the line, each node below itself in the schematic, all modes moving together.

import { short } from "./numbers.js";
import { shape as form, word } from "./svg.js";
import { curveColour, DASHES } from "./theme.js";

const LEAST = 44; // pixels for the name of a node
const NAMES = 16; // pixels of the row of names of nodes below, and of that of modes above
const EDGE = 6;
const APART = 126; // pixels between names of modes
const MARK = 24; // pixels of the line before a name

export function makeShape(svg) {
  let nodes = new Map(); // node -> [x, y] in points
  let lines = []; // pairs of nodes
  let modes = [];
  let curves = [];
  let view = { x: 0, scale: 1 };
  let angle = 0;

  function draw(places, elements, shown) {
    nodes = places;
    modes = shown;
    lines = Object.values(elements).map((one) => one.nodes.filter((node) => nodes.has(node))).filter((ends) => ends.length === 2);
    svg.toggleAttribute("hidden", !modes.length);
    svg.setAttribute("aria-label", `Mode shapes: ${modes.map(named).join(", ")}`);
    curves = modes.map((_, k) => form("path", { ...inks(k), class: "curve" }));
    grid();
  }

  const across = ([x]) => (x - view.x) * view.scale;

  function grid() {
    const { clientWidth: wide, clientHeight: high } = svg;
    if (!wide || !modes.length) return;
    svg.setAttribute("viewBox", `0 0 ${wide} ${high}`);
    const middle = high / 2;
    const parts = [form("line", { x1: 0, x2: wide, y1: middle, y2: middle, class: "zero" })];
    let last = -Infinity;
    for (const [name, place] of [...nodes].sort(([, a], [, b]) => a[0] - b[0])) {
      const x = across(place);
      if (x < 0 || x > wide) continue;
      parts.push(form("line", { x1: x, x2: x, y1: NAMES, y2: high - NAMES, class: "station" }));
      const half = Math.max(LEAST, 6.6 * name.length) / 2;
      if (x - half < last || x + half > wide + EDGE) continue;
      last = x + half;
      parts.push(word(name, x, high - 4, "name"));
    }
    const names = modes.flatMap((mode, k) => {
      const left = EDGE + k * APART;
      return [form("path", { ...inks(k), d: `M${left} 8h${MARK}` }), word(named(mode), left + MARK + EDGE, 12, "mode")];
    });
    svg.replaceChildren(...parts, ...curves, ...names);
    move(angle);
  }

  function move(now) {
    angle = now;
    const middle = svg.clientHeight / 2;
    const high = middle - NAMES - EDGE / 2;
    const size = (mode, node) => {
      const [most, phase] = mode.nodes[node] ?? [0, 0];
      return (middle - high * most * Math.cos(angle + phase)).toFixed(1);
    };
    modes.forEach((mode, k) => curves[k].setAttribute("d", lines.map(([a, b]) =>
      `M${across(nodes.get(a)).toFixed(1)} ${size(mode, a)}L${across(nodes.get(b)).toFixed(1)} ${size(mode, b)}`).join("")));
  }

  new ResizeObserver(grid).observe(svg);
  return {
    draw,
    move,
    look(now) {
      view = now;
      grid();
    },
  };
}

function inks(k) {
  return { stroke: curveColour(k), "stroke-dasharray": DASHES[k % DASHES.length].join(" "), "stroke-width": 2 };
}

function named({ name, kind, frequency_hz: frequency }) {
  return kind === "rigid body" ? kind : `${/^\d/.test(name) ? `${name}: ` : ""}${short(frequency)} Hz`;
}
