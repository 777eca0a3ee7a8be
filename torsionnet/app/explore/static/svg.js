// Shapes and words of SVG.

const SVG = "http://www.w3.org/2000/svg";

export function shape(tag, attributes) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

export function word(text, x, y, kind) {
  return Object.assign(shape("text", { x, y, class: kind }), { textContent: text });
}
