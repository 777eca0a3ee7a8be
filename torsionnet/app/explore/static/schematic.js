// The schematic: the server's SVG, whose groups are elements and nodes that can be chosen by mouse and keys. It fits its
// pane; the wheel and + and - zoom, dragging and Shift with arrow keys pan, 0 fits it again.

import { makeLabels } from "./labels.js";
import { makeMinimap } from "./minimap.js";

const SVG = "http://www.w3.org/2000/svg";
const LARGEST_FIT = 1.7; // pixels for a point of a short drivetrain
const LARGEST = 6;
const EDGE = 24; // pixels for words that reach beyond the first and the last symbol
const STEP = 1.25; // factor of one zoom
const PAN = 60; // pixels for an arrow key
const TALL = 0.2; // height over width from which the height of the pane makes a drawing small
const FEW = 4; // pixels that a click may move
const FORBIDDEN = "script, foreignObject, style, a, image, iframe, animate, set";

export function makeSchematic(place, actions) {
  let drawn = null; // {svg, elements, nodes, groups: Map(group -> {kind, name}), at: Map(node -> [x, y])}
  let view = null; // {x, y, scale}: the corner in points, pixels for a point
  let isFit = true;
  let labels = null;
  const map = makeMinimap(document.getElementById("minimap"), (x, y) => look({ ...view, x: x - place.clientWidth / view.scale / 2, y: y - place.clientHeight / view.scale / 2 }));
  let chosen = []; // "element shaft", "node motor"

  function show(found) {
    const svg = imported(found.svg);
    if (!svg) return;
    const kept = place.contains(document.activeElement) ? nameOf(document.activeElement) : "";
    const groups = new Map();
    for (const [kind, names] of [["node", found.nodes], ["element", found.elements]]) {
      for (const [name, id] of Object.entries(names)) {
        const group = svg.getElementById(id);
        if (group) groups.set(group, { kind, name });
      }
    }
    drawn = { svg, groups, nodes: found.nodes, elements: found.elements, at: null, box: bounds(svg) };
    place.parentElement.classList.toggle("is-tall", drawn.box.height > TALL * drawn.box.width);
    groups.forEach((one, group) => prepare(group, one));
    svg.setAttribute("role", "graphics-document");
    svg.setAttribute("aria-label", "Schematic: arrow keys move along, Enter goes to the text, + - 0 zoom, Shift with arrows pans");
    svg.style.width = svg.style.height = "100%";
    place.replaceChildren(svg);
    labels = makeLabels(svg);
    mark();
    fit();
    if (kept) groupOf(kept)?.focus();
  }

  // Only what is seen has a size.
  function measure() {
    const { svg, nodes, box } = drawn;
    drawn.at = new Map(Object.entries(nodes).flatMap(([name, id]) => (svg.getElementById(id) ? [[name, middle(svg.getElementById(id))]] : [])));
    map.draw(box, [...drawn.at.values()]);
    roving(groupOf(chosen[0]) ?? inOrder()[0]);
    actions.drawn(drawn);
  }

  function prepare(group, { kind, name }) {
    group.classList.add("choosable", `is-${kind}`);
    group.setAttribute("role", "button");
    group.setAttribute("tabindex", "-1");
    if (!group.hasAttribute("aria-label")) {
      const title = [...group.children].find((child) => child.tagName === "title")?.textContent;
      group.setAttribute("aria-label", title || `${kind} ${name}`);
    }
  }

  function fitting() {
    const { width, height } = drawn.box;
    return Math.min(LARGEST_FIT, Math.max(1, place.clientWidth - 2 * EDGE) / width, Math.max(1, place.clientHeight - EDGE) / height);
  }

  // Until it is zoomed, the whole drivetrain is seen, also after changes of the text or the pane.
  function fit() {
    if (!drawn || !drawn.box.width || !place.clientWidth || !place.clientHeight) return;
    if (!drawn.at) measure();
    look(isFit || !view ? { scale: fitting() } : view);
  }

  function look({ x = 0, y = 0, scale }) {
    const least = fitting();
    isFit = scale <= least;
    const now = Math.max(least, Math.min(LARGEST, scale));
    const { box, svg } = drawn;
    const [wide, high] = [place.clientWidth / now, place.clientHeight / now];
    view = { scale: now, x: within(x, box.x, box.width, wide), y: within(y, box.y, box.height, high) };
    svg.setAttribute("viewBox", `${view.x} ${view.y} ${wide} ${high}`);
    labels.fit(now);
    map.look(isFit ? null : { x: view.x, y: view.y, width: wide, height: high });
    actions.moved(view);
  }

  // Closer or farther, with what is at a place in the pane staying there.
  function zoom(factor, [left, top] = [place.clientWidth / 2, place.clientHeight / 2]) {
    if (!drawn || !view) return;
    const scale = Math.max(fitting(), Math.min(LARGEST, view.scale * factor));
    look({ scale, x: view.x + left / view.scale - left / scale, y: view.y + top / view.scale - top / scale });
  }

  function pan(right, down) {
    look({ ...view, x: view.x + right / view.scale, y: view.y + down / view.scale });
  }

  function reveal(group) {
    const [inner, outer] = [group.getBoundingClientRect(), place.getBoundingClientRect()];
    const off = (from, to, low, high) => (from < low || to > high ? (from + to - low - high) / 2 : 0);
    const [right, down] = [off(inner.left, inner.right, outer.left, outer.right), off(inner.top, inner.bottom, outer.top, outer.bottom)];
    if (!isFit && (right || down)) pan(right, down);
  }

  function nameOf(node) {
    const one = drawn?.groups.get(node?.closest?.(".choosable"));
    return one ? `${one.kind} ${one.name}` : "";
  }

  function groupOf(key) {
    return [...(drawn?.groups ?? [])].find(([, { kind, name }]) => `${kind} ${name}` === key)?.[0];
  }

  // From left to right, then downwards, as one reads.
  function inOrder() {
    const all = [...drawn.groups.keys()].map((group) => ({ group, box: group.getBoundingClientRect() }));
    const middle = ({ box }) => box.left + box.width / 2;
    return all.sort((a, b) => middle(a) - middle(b) || a.box.top - b.box.top).map(({ group }) => group);
  }

  function roving(group) {
    drawn.groups.forEach((_, other) => other.setAttribute("tabindex", other === group ? "0" : "-1"));
  }

  function mark() {
    drawn?.groups.forEach((_, group) => {
      const is = chosen.includes(nameOf(group));
      group.classList.toggle("is-chosen", is);
      if (is) group.setAttribute("aria-current", "true");
      else group.removeAttribute("aria-current");
    });
  }

  let moved = 0; // pixels of the last drag, which is no click
  place.addEventListener("pointerdown", (event) => {
    moved = 0;
    let last = event;
    const move = (now) => {
      if (!now.buttons) return;
      moved += Math.abs(now.x - last.x) + Math.abs(now.y - last.y);
      if (moved > FEW) pan(last.x - now.x, last.y - now.y);
      last = now;
    };
    addEventListener("pointermove", move);
    addEventListener("pointerup", () => removeEventListener("pointermove", move), { once: true });
  });
  place.addEventListener("click", (event) => {
    const one = drawn?.groups.get(event.target.closest(".choosable"));
    if (one && moved <= FEW) actions.choose(one.kind, one.name);
  });
  place.addEventListener("dblclick", (event) => event.target.closest(".choosable") || look({ scale: 0 }));
  place.addEventListener("wheel", (event) => {
    const { left, top } = place.getBoundingClientRect();
    zoom(STEP ** (-event.deltaY / 100), [event.clientX - left, event.clientY - top]);
    event.preventDefault();
  }, { passive: false });
  for (const [id, factor] of [["closer", STEP], ["farther", 1 / STEP], ["fit", 0]]) document.getElementById(id).addEventListener("click", () => zoom(factor));
  place.addEventListener("keydown", (event) => {
    const group = event.target.closest(".choosable");
    if (!group || event.ctrlKey || event.metaKey || event.altKey) return;
    const factor = { "+": STEP, "=": STEP, "-": 1 / STEP, 0: 0 }[event.key];
    const away = { ArrowRight: [PAN, 0], ArrowLeft: [-PAN, 0], ArrowDown: [0, PAN], ArrowUp: [0, -PAN] }[event.key];
    if (event.key === "Enter" || event.key === " ") {
      const { kind, name } = drawn.groups.get(group);
      actions.choose(kind, name);
    } else if (factor !== undefined) {
      zoom(factor);
      reveal(group);
    } else if (event.shiftKey && away) pan(...away);
    else {
      const all = inOrder();
      const k = all.indexOf(group);
      const to = { ArrowRight: k + 1, ArrowDown: k + 1, ArrowLeft: k - 1, ArrowUp: k - 1, Home: 0, End: all.length - 1 }[event.key];
      if (to === undefined) return;
      const next = all[Math.max(0, Math.min(all.length - 1, to))];
      roving(next);
      next.focus({ preventScroll: true });
      reveal(next);
    }
    event.preventDefault();
  });
  new ResizeObserver(fit).observe(place);
  return {
    show,
    // What the cursor stands in.
    choose: (keys) => {
      if (keys.join() === chosen.join()) return;
      chosen = keys;
      mark();
      const group = groupOf(keys[0]);
      if (!group) return;
      roving(group);
      reveal(group);
    },
    has: (key) => Boolean(groupOf(key)),
  };
}

function bounds(svg) {
  const { x, y, width, height } = svg.viewBox.baseVal;
  return { x, y, width, height };
}

// The corner of a view of a size: inside of the drivetrain, or around its middle where the view is larger.
function within(at, from, size, seen) {
  return seen >= size ? from - (seen - size) / 2 : Math.max(from, Math.min(from + size - seen, at));
}

// Only shapes and words: whatever could act or look elsewhere is taken out before the page holds it.
function imported(text) {
  const parsed = new DOMParser().parseFromString(text, "image/svg+xml");
  const root = parsed.documentElement;
  if (root.namespaceURI !== SVG || root.localName !== "svg") return null;
  root.querySelectorAll(FORBIDDEN).forEach((node) => node.remove());
  for (const node of [root, ...root.querySelectorAll("*")]) {
    for (const { name, value } of [...node.attributes]) {
      const isAway = name.endsWith("href") && !value.startsWith("#");
      if (name === "style" || name.startsWith("on") || isAway) node.removeAttribute(name);
    }
  }
  return document.importNode(root, true);
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
