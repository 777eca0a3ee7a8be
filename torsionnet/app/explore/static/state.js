// What the page shows, as one object; the address carries it, so that reloading or sending it keeps everything.

const TEXTS = { axis: "over", output: "out", input: "in", excitation: "by", quantity: "as", angle: "angle" };
const AXES = ["frequency", "speed"];
export const LOOKS = ["auto", "dark", "light"];
const MOST_PINS = 6;

export function fresh(model) {
  return { ...structuredClone(model.start), rpm: null, pins: [], theme: "auto", overlaid: true, of: "drivetrain" };
}

// The part that the server is asked about.
export function question(state) {
  const { choice, values, axis, output, input, excitation, quantity, band, angle, decibels } = state;
  return { choice, values, axis, output, input, excitation, quantity, band, angle, decibels };
}

export function write(state) {
  const words = new URLSearchParams();
  for (const [axis, name] of Object.entries(state.choice)) words.append("c", `${axis}=${name}`);
  for (const [name, value] of Object.entries(state.values)) words.append("set", `${name}=${value}`);
  for (const [key, word] of Object.entries(TEXTS)) if (state[key]) words.set(word, state[key]);
  words.set("band", state.band.join(" "));
  if (state.rpm) words.set("rpm", state.rpm.join(" "));
  if (state.decibels) words.set("db", "1");
  if (state.theme !== "auto") words.set("theme", state.theme);
  if (!state.overlaid) words.set("test", "0");
  if (state.of !== "drivetrain") words.set("modes", state.of);
  for (const { name, choice, values } of state.pins) words.append("pin", JSON.stringify({ name, choice, values }));
  history.replaceState(null, "", `#${words}`);
}

// Names that this model does not have are left out: an address may come from another version of the file.
export function read(model) {
  const state = fresh(model);
  const words = new URLSearchParams(location.hash.slice(1));
  if (![...words.keys()].length) return state;
  const chosen = pairs(words.getAll("c"));
  state.choice = known(chosen, (axis, name) => model.axes[axis]?.includes(name));
  state.values = known(pairs(words.getAll("set")), (name) => hasParameter(model, name));
  if (model.runs && AXES.includes(words.get("over"))) state.axis = words.get("over");
  const outputs = names(model.choices.outputs);
  const inputs = names(model.choices.inputs);
  if (outputs.includes(words.get("out"))) state.output = words.get("out");
  if (inputs.includes(words.get("in"))) state.input = words.get("in");
  if (model.choices.excitations.includes(words.get("by"))) state.excitation = words.get("by");
  if (["receptance", "mobility", "accelerance"].includes(words.get("as"))) state.quantity = words.get("as");
  if (words.get("angle") === "deg") state.angle = "deg";
  if (words.get("angle") === "rad") state.angle = "rad";
  state.band = ends(words.get("band")) ?? state.band;
  state.rpm = ends(words.get("rpm"));
  state.decibels = words.get("db") === "1";
  if (LOOKS.includes(words.get("theme"))) state.theme = words.get("theme");
  state.overlaid = words.get("test") !== "0";
  if (words.get("modes") === "cut") state.of = "cut";
  state.pins = words.getAll("pin").slice(0, MOST_PINS).map((text) => readPin(text, model)).filter(Boolean);
  return state;
}

export function canPin(state) {
  return state.pins.length < MOST_PINS;
}

function readPin(text, model) {
  try {
    const { name, choice, values } = JSON.parse(text);
    return {
      name: String(name).slice(0, 80),
      choice: known(choice, (axis, one) => model.axes[axis]?.includes(one)),
      values: known(values, (one) => hasParameter(model, one)),
    };
  } catch {
    return null;
  }
}

function hasParameter(model, name) {
  return [...model.parameters, ...model.operating_point.rows].some((one) => one.name === name);
}

function pairs(texts) {
  return Object.fromEntries(texts.map((text) => [text.slice(0, text.indexOf("=")), text.slice(text.indexOf("=") + 1)]));
}

function known(table, test) {
  return Object.fromEntries(Object.entries(table).filter(([name, value]) => test(name, value)));
}

// Two numbers above 0, the lower one first, or null.
function ends(text) {
  const found = (text ?? "").split(" ").map(Number);
  return found.length === 2 && found[0] > 0 && found[1] > found[0] && Number.isFinite(found[1]) ? found : null;
}

function names(groups) {
  return groups.flatMap((group) => group.entries.map((entry) => entry.name));
}
