// Words of the schematic at any zoom: never smaller than can be read, and only as many as have room, names first.

const LEAST = 11.1; // pixels
const CELL = 60; // pixels of the grid in which neighbours are looked for
const MOST = 1.8; // factor by which words are enlarged before those on values are left out
const TOUCH = 1; // pixels by which a word may reach over a symbol
const FIRST = ["text-node", "text-name", "text-input", "text-sensor", "text-value"];

export function makeLabels(svg) {
  const all = [...svg.querySelectorAll("text")].map((node) => {
    const size = Number(node.getAttribute("font-size"));
    const parts = [...node.querySelectorAll("[font-size]")].map((part) => [part, Number(part.getAttribute("font-size"))]);
    const rank = FIRST.indexOf(node.classList[0]);
    const [x, y] = ["x", "y"].map((name) => Number(node.getAttribute(name)));
    return { node, group: node.closest("[id]"), size, parts, x, y, rank: rank < 0 ? FIRST.length : rank, isLeft: node.getAttribute("text-anchor") === "start", wide: 0 };
  }).sort((one, other) => one.rank - other.rank);
  let symbols = []; // of elements, which larger words of others would cover
  return {
    // `scale`: pixels for a point
    fit(scale) {
      if (!all[0]?.wide) for (const one of all) one.wide = one.node.getComputedTextLength() / one.size; // 0 in a hidden pane
      if (!symbols.length) symbols = [...svg.querySelectorAll(".pen-part")].map((part) => ({ group: part.closest("[id]"), box: part.getBBox() }));
      const taken = new Map();
      for (const one of all) {
        const size = Math.max(one.size, LEAST / scale);
        const isSmall = one.rank >= FIRST.indexOf("text-value") && size > MOST * one.size;
        const [wide, high] = [one.wide * size * scale, size * scale];
        const left = one.x * scale - (one.isLeft ? 0 : wide / 2);
        const place = { left, right: left + wide, top: one.y * scale - high, bottom: one.y * scale };
        const covers = ({ group, box }) => group !== one.group && meets(place, scaled(box, scale), TOUCH);
        const isFree = !isSmall && !(size > one.size && symbols.some(covers)) && claim(taken, place);
        one.node.toggleAttribute("data-crowded", !isFree);
        if (!isFree) continue;
        one.node.setAttribute("font-size", size);
        for (const [part, own] of one.parts) part.setAttribute("font-size", Math.max(own, LEAST / scale));
      }
    },
  };
}

// Whether a box is free, which it no longer is then.
function claim(taken, box) {
  const cells = [];
  for (let x = Math.floor(box.left / CELL); x <= box.right / CELL; x += 1) {
    for (let y = Math.floor(box.top / CELL); y <= box.bottom / CELL; y += 1) cells.push(`${x} ${y}`);
  }
  if (cells.some((cell) => taken.get(cell)?.some((other) => meets(box, other)))) return false;
  for (const cell of cells) taken.set(cell, [...(taken.get(cell) ?? []), box]);
  return true;
}

// Whether two boxes share more than a margin of so many pixels.
function meets(one, other, margin = 0) {
  const apart = (low, high) => Math.min(one[high], other[high]) - Math.max(one[low], other[low]) <= margin;
  return !apart("left", "right") && !apart("top", "bottom");
}

function scaled({ x, y, width, height }, scale) {
  return { left: x * scale, right: (x + width) * scale, top: y * scale, bottom: (y + height) * scale };
}
