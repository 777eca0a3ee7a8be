// The schematic: the server's SVG, whose groups are elements and nodes that can be chosen by mouse and keys.

const SVG = "http://www.w3.org/2000/svg";
const LEAST = 1.15; // pixels for a point; a longer drivetrain is scrolled rather than made smaller
const MOST = 1.7;
const FORBIDDEN = "script, foreignObject, style, a, image, iframe, animate, set";

export function makeSchematic(place, actions) {
  let drawn = null; // {svg, elements, nodes, groups: Map(group -> {kind, name})}
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
    drawn = { svg, groups, nodes: found.nodes, elements: found.elements };
    groups.forEach((one, group) => prepare(group, one));
    svg.setAttribute("role", "graphics-document");
    svg.setAttribute("aria-label", "Schematic: arrow keys move along, Enter goes to the text");
    place.replaceChildren(svg);
    fit();
    roving(groupOf(chosen[0]) ?? inOrder()[0]);
    mark();
    if (kept) groupOf(kept)?.focus();
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

  function fit() {
    if (!drawn) return;
    const { width, height } = drawn.svg.viewBox.baseVal;
    if (!width || !place.clientWidth) return;
    const scale = Math.max(LEAST, Math.min(MOST, place.clientWidth / width, place.clientHeight / height));
    drawn.svg.style.width = `${width * scale}px`;
    drawn.svg.style.height = `${height * scale}px`;
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

  place.addEventListener("click", (event) => {
    const one = drawn?.groups.get(event.target.closest(".choosable"));
    if (one) actions.choose(one.kind, one.name);
  });
  place.addEventListener("keydown", (event) => {
    const group = event.target.closest(".choosable");
    if (!group) return;
    if (event.key === "Enter" || event.key === " ") {
      const { kind, name } = drawn.groups.get(group);
      actions.choose(kind, name);
    } else {
      const all = inOrder();
      const k = all.indexOf(group);
      const to = { ArrowRight: k + 1, ArrowDown: k + 1, ArrowLeft: k - 1, ArrowUp: k - 1, Home: 0, End: all.length - 1 }[event.key];
      if (to === undefined) return;
      const next = all[Math.max(0, Math.min(all.length - 1, to))];
      roving(next);
      next.focus();
      next.scrollIntoView({ block: "nearest", inline: "nearest" });
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
      group.scrollIntoView({ block: "nearest", inline: "nearest" });
    },
    has: (key) => Boolean(groupOf(key)),
  };
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
