// Light and dark, as the system says or as chosen; canvases cannot inherit colours, so the plots ask here.

// Okabe and Ito's colours; on dark ground the ones that are bright enough.
const CURVES = {
  light: ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#444444", "#56B4E9", "#E69F00"],
  dark: ["#56B4E9", "#E69F00", "#2CC39A", "#E29BC4", "#C8C8C8", "#F0E442", "#FF8A3D"],
};
export const DASHES = [[], [8, 4], [3, 3], [10, 3, 3, 3], [6, 2], [2, 4], [12, 4, 2, 4]];

const system = matchMedia("(prefers-color-scheme: dark)");

export function isDark(theme) {
  return theme === "dark" || (theme === "auto" && system.matches);
}

export function apply(theme) {
  document.documentElement.dataset.theme = isDark(theme) ? "dark" : "light";
}

export function whenSystemChanges(act) {
  system.addEventListener("change", act);
}

export function curveColour(index) {
  const palette = CURVES[document.documentElement.dataset.theme];
  return palette[index % palette.length];
}

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
