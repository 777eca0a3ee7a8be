// Numbers and names as an engineer writes them.

const GREEK = {
  alpha: "α", beta: "β", gamma: "γ", delta: "δ", epsilon: "ε", zeta: "ζ", eta: "η", theta: "θ", kappa: "κ",
  lambda: "λ", mu: "μ", nu: "ν", xi: "ξ", rho: "ρ", sigma: "σ", tau: "τ", phi: "φ", psi: "ψ", omega: "ω",
};

export function short(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e6 || size < 1e-4 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return text.replace(/\.?0+e/, "e").replace("e+", "e").replace("-", "−");
}

// For fields: no typographic minus, so that what stands there can be read back.
export function plain(value, digits = 6) {
  return String(Number(value.toPrecision(digits)));
}

export function unit(text) {
  return text.replaceAll("**", "^").replaceAll("*", "·").replaceAll("^2", "²").replaceAll("^3", "³");
}

// I_MT becomes I with a subscript, tau becomes τ; words such as generator_speed stay as they are.
export function symbol(name) {
  const parts = name.split("_");
  const [head, ...rest] = /^[A-Za-z]{1,2}$/.test(parts[0]) || GREEK[parts[0]] ? parts : [name];
  const node = document.createElement("span");
  node.className = "symbol";
  const letter = document.createElement(/^[A-Za-z]$/.test(head) || GREEK[head] ? "i" : "span");
  letter.textContent = GREEK[head] ?? head;
  node.append(letter);
  if (rest.length) {
    const sub = document.createElement("sub");
    sub.textContent = rest.join(",");
    node.append(sub);
  }
  return node;
}
