// uPlot stops where the language of the browser is no tag of one, as en-US@posix on Linux without a locale.

try {
  new Intl.NumberFormat(navigator.language);
} catch {
  Object.defineProperty(navigator, "language", { value: "en-US" });
}
