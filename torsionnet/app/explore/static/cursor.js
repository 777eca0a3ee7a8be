// One cursor for all plots: by mouse through uPlot, by arrow keys here, and values of all curves where it stands.

const STEP = 4;
const FAST = 10;

export function byKeys(place, plots, clear) {
  place.addEventListener("keydown", (event) => {
    const plot = plots()[0];
    if (!plot) return;
    const width = plot.over.clientWidth;
    const at = plot.cursor.left >= 0 ? plot.cursor.left : width / 2;
    const step = STEP * (event.shiftKey ? FAST : 1);
    const to = {
      ArrowRight: at + step, ArrowUp: at + step, ArrowLeft: at - step, ArrowDown: at - step,
      PageUp: at + FAST * STEP, PageDown: at - FAST * STEP, Home: 1, End: width - 1,
    }[event.key];
    if (event.key === "Escape") clear();
    if (to === undefined) return;
    event.preventDefault();
    const left = Math.min(width - 1, Math.max(1, to));
    for (const one of plots()) one.setCursor({ left, top: 10 }, true);
  });
}

// [x, [[magnitude, phase], ...]] at the cursor, null where there is none; over speed there is no plot of a phase.
export function valuesAt(plots) {
  const [magnitude] = plots;
  if (!magnitude || magnitude.cursor.left == null || magnitude.cursor.left < 0) return null;
  const x = magnitude.posToVal(magnitude.cursor.left, "x");
  return [x, valuesNear(plots, magnitude.posToIdx(magnitude.cursor.left))];
}

export function valuesNear([magnitude, phase], index) {
  return magnitude.series.slice(1).map((_, k) => {
    const near = magnitude.cursor.dataIdx(magnitude, k + 1, index);
    return [magnitude.data[k + 1][near], phase?.data[k + 1][near]];
  });
}
