// A mode on the schematic: at each node a disc swings as far as the mode moves it there.

import { short } from "./numbers.js";

const SVG = "http://www.w3.org/2000/svg";
const SECONDS = 2.4; // of one swing, whatever the frequency of the mode
const SWING = 70; // degrees, of the node that moves most
const RADIUS = 7.5;
const SMALL = 0.02; // of the largest amplitude; what moves less is said to stand still

const at = (id) => document.getElementById(id);
const calm = matchMedia("(prefers-reduced-motion: reduce)");

// `changed` is told which mode is shown.
export function makeMotion(changed) {
  let modes = [];
  let discs = new Map(); // node -> {needle, disc}
  let drawn = null;
  let runs = !calm.matches;
  let since = 0;
  let frame = 0;

  at("mode").addEventListener("change", () => choose(at("mode").value));
  at("play").addEventListener("click", () => {
    runs = !runs;
    begin();
  });
  calm.addEventListener("change", () => {
    runs = !calm.matches;
    begin();
  });
  document.addEventListener("visibilitychange", begin);

  function show(found) {
    const before = at("mode").value;
    modes = found;
    at("mode").replaceChildren(new Option("none", ""), ...modes.map(option));
    choose(before !== "" && Number(before) < modes.length ? before : null);
  }

  function on(schematic) {
    drawn = schematic;
    layer();
    begin();
  }

  function layer() {
    discs = new Map();
    const { svg, nodes } = drawn;
    if (!svg.clientWidth) return;
    const group = shape("g", { class: "swinging", "aria-hidden": "true" });
    for (const [name, id] of Object.entries(nodes)) {
      const node = svg.getElementById(id);
      if (!node) continue;
      const [x, y] = middle(node);
      const spot = shape("g", { transform: `translate(${x} ${y})` });
      const disc = shape("circle", { r: RADIUS });
      const needle = shape("line", { x1: 0, y1: 0, x2: 0, y2: -RADIUS - 3 });
      spot.append(disc, needle);
      group.append(spot);
      discs.set(name, { spot, disc, needle });
    }
    svg.append(group);
  }

  function chosen() {
    return at("mode").value === "" ? null : modes[Number(at("mode").value)];
  }

  function begin() {
    cancelAnimationFrame(frame);
    const mode = chosen();
    at("mode").disabled = at("play").disabled = !modes.length;
    at("play").textContent = runs ? "Pause" : "Play";
    at("play").hidden = !mode;
    drawn?.svg.classList.toggle("is-moving", Boolean(mode));
    at("moving").textContent = mode ? words(mode) : "";
    if (drawn) strain(mode);
    if (!mode || !drawn) return;
    if (!discs.size) layer();
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
    const mode = chosen();
    if (!mode) return;
    draw(mode, (2 * Math.PI * (now - since)) / 1000 / SECONDS);
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
  }

  function choose(k) {
    at("mode").value = k === null ? "" : String(k);
    changed(at("mode").value === "" ? null : Number(at("mode").value));
    begin();
  }
  return { show, on, choose };
}

// On the shaft of a node, below its name; where a node has no shaft, in the middle of what is drawn of it.
function middle(node) {
  const { x, y, width, height } = node.getBBox();
  const name = node.querySelector(":scope > .text-node");
  const at = name ? Number(name.getAttribute("x")) : x + width / 2;
  const below = name ? Number(name.getAttribute("y")) : y;
  const found = [...node.querySelectorAll(":scope > .pen-shaft")].flatMap(levels).filter(([left, right]) => left <= at && at <= right);
  const [nearest] = found.map(([, , level]) => level).sort((a, b) => Math.abs(a - below) - Math.abs(b - below));
  return [at, nearest ?? y + height / 2];
}

// Level stretches of a path of straight lines: [left, right, y].
function levels(path) {
  return path.getAttribute("d").split("M").flatMap((line) => {
    const points = line.replace("Z", "").trim().split(/\s+/).map((point) => point.split(",").map(Number));
    return points.slice(1).flatMap(([x, y], k) => (y === points[k][1] ? [[Math.min(x, points[k][0]), Math.max(x, points[k][0]), y]] : []));
  });
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

function shape(tag, attributes) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}
