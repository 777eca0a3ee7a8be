// All of a zoomed drivetrain, small, with the stretch that is seen; a click or a drag in it looks elsewhere.

import { shape } from "./svg.js";

// `go` is told the middle to be seen, in points.
export function makeMinimap(svg, go) {
  const dots = shape("path", {});
  const seen = shape("rect", {});
  svg.replaceChildren(dots, seen);
  const move = (event) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    go(at.x, at.y);
    event.preventDefault();
  };
  svg.addEventListener("pointerdown", (event) => {
    svg.setPointerCapture(event.pointerId);
    move(event);
  });
  svg.addEventListener("pointermove", (event) => event.buttons && move(event));
  return {
    draw({ x, y, width, height }, places) {
      svg.setAttribute("viewBox", `${x} ${y} ${width} ${height}`);
      dots.setAttribute("d", places.map(([left, top]) => `M${left} ${top}h0`).join(""));
    },
    // The rectangle that is seen, null for all.
    look(box) {
      svg.toggleAttribute("hidden", !box);
      for (const [name, value] of Object.entries(box ?? {})) seen.setAttribute(name, value);
    },
  };
}
