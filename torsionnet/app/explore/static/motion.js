// Modes on the schematic: at each node a disc swings as far as the mode moves it there, over the curve of the shape.

import { short } from "./numbers.js";
import { makeShape } from "./shape.js";
import { shape as form } from "./svg.js";

const SECONDS = 2.4; // of one swing, whatever the frequency of the mode
const SWING = 70; // degrees, of the node that moves most
const RADIUS = 7.5;
const LEAST = 0.6; // pixels for a point, of the discs
const SMALL = 0.02; // of the largest amplitude; what moves less is said to stand still

const at = (id) => document.getElementById(id);
const calm = matchMedia("(prefers-reduced-motion: reduce)");

// `changed` is told which modes are shown; the first of them swings on the schematic, all of them in the curve below it.
export function makeMotion(changed) {
  let modes = [];
  let elements = {};
  let shown = []; // places of modes
  let isAsked = false; // whether someone has chosen a mode; until then none is chosen but the first vibration
  let discs = new Map(); // node -> {needle, disc}
  let drawn = null;
  let runs = false;
  let since = 0;
  let frame = 0;
  const shape = makeShape(at("shape"));

  at("mode").addEventListener("change", () => choose(at("mode").value === "" ? null : Number(at("mode").value)));
  at("play").addEventListener("click", () => {
    runs = !runs;
    begin();
  });
  document.addEventListener("visibilitychange", begin);

  function show(found) {
    ({ modes, elements } = found);
    at("mode").replaceChildren(new Option("none", ""), ...modes.map(option));
    const first = Math.max(0, modes.findIndex((mode) => mode.damped_hz > 0));
    settle(isAsked ? shown.filter((k) => k < modes.length) : modes.length ? [first] : []);
  }

  function on(schematic) {
    drawn = schematic;
    layer();
    begin();
  }

  // The schematic was zoomed or moved: discs stay large enough to be seen, and the curve below its nodes.
  function look(view) {
    const size = Math.max(1, LEAST / view.scale);
    for (const { spot, x, y } of discs.values()) spot.setAttribute("transform", `translate(${x} ${y}) scale(${size})`);
    shape.look(view);
  }

  function layer() {
    discs = new Map();
    const group = form("g", { class: "swinging", "aria-hidden": "true" });
    for (const [name, [x, y]] of drawn.at) {
      const spot = form("g", { transform: `translate(${x} ${y})` });
      const disc = form("circle", { r: RADIUS });
      const needle = form("line", { x1: 0, y1: 0, x2: 0, y2: -RADIUS - 3 });
      spot.append(disc, needle);
      group.append(spot);
      discs.set(name, { spot, disc, needle, x, y });
    }
    drawn.svg.append(group);
  }

  function begin() {
    cancelAnimationFrame(frame);
    const mode = modes[shown[0]];
    at("mode").disabled = at("play").disabled = !modes.length;
    at("play").textContent = runs ? "Pause" : "Play";
    at("play").hidden = !mode;
    drawn?.svg.classList.toggle("is-moving", Boolean(mode));
    at("moving").textContent = mode ? words(mode) : "";
    if (drawn) {
      strain(mode);
      shape.draw(drawn.at, elements, shown.map((k) => modes[k]));
    }
    if (!mode || !drawn) return;
    since = performance.now();
    if (runs && !document.hidden) frame = requestAnimationFrame(step);
    else draw(mode, 0);
  }

  // Elements that are twisted in the mode, by their share of its energy.
  function strain(mode) {
    for (const [name, id] of Object.entries(drawn.elements)) {
      drawn.svg.getElementById(id)?.style.setProperty("--strain", `${100 * Math.min(1, mode?.strain?.[name] ?? 0)}%`);
    }
  }

  function step(now) {
    draw(modes[shown[0]], (2 * Math.PI * (now - since)) / 1000 / SECONDS);
    frame = requestAnimationFrame(step);
  }

  function draw(mode, angle) {
    for (const [name, { spot, needle, disc }] of discs) {
      const [size, phase] = mode.nodes[name] ?? [0, 0];
      const now = size * Math.cos(angle + phase);
      spot.classList.toggle("is-still", size < SMALL);
      needle.setAttribute("transform", `rotate(${(SWING * now).toFixed(2)})`);
      disc.setAttribute("fill-opacity", Math.abs(now).toFixed(3));
      disc.classList.toggle("is-back", now < 0);
    }
    shape.move(angle);
  }

  // A mode alone, or beside those that are shown; null for none.
  function choose(k, isBeside = false) {
    isAsked = true;
    const rest = isBeside ? shown.filter((one) => one !== k) : [];
    const takesAway = k === null || (shown.includes(k) && (isBeside || shown.length === 1));
    runs = !calm.matches && (!takesAway || runs);
    settle(takesAway ? rest : [...rest, k]);
  }

  function settle(now) {
    shown = now;
    at("mode").value = shown.length ? String(shown[0]) : "";
    changed(shown);
    begin();
  }
  return { show, on, look, choose };
}

function option({ name, kind, frequency_hz: frequency, damping_ratio: ratio }, k) {
  const size = ratio === null ? "" : ` ${short(frequency)} Hz, ${short(100 * ratio, 3)} %`;
  return new Option(/^\d/.test(name) ? `${name}:${size}` : `${kind}${kind === "rigid body" ? "" : size}`, String(k));
}

// For those who do not see it: who moves most, and who moves against it.
function words({ frequency_hz: frequency, description, nodes }) {
  const all = Object.entries(nodes).filter(([, [size]]) => size >= SMALL).sort(([, a], [, b]) => b[0] - a[0]);
  if (!all.length) return "";
  const lead = all[0][1][1];
  const parts = all.map(([name, [size, phase]]) => `${name} ${short(size, 2)}${Math.cos(phase - lead) < 0 ? " against it" : ""}`);
  return `${short(frequency)} Hz: ${description}. Amplitudes: ${parts.slice(0, 12).join(", ")}`;
}
