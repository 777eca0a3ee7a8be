// Pinned curves: states of the drivetrain that are calculated again for whatever response and band is shown.

import { ask } from "./api.js";
import { unit } from "./numbers.js";
import { question } from "./state.js";

export function pinned(state, title, labels) {
  const changes = Object.entries(state.values).map(([name, value]) => `${labels.get(name) ?? name} = ${unit(String(value))}`);
  const configuration = Object.values(state.choice).join(", ");
  const name = [configuration, ...changes].filter(Boolean).join(", ") || title;
  return { name: name.slice(0, 80), choice: { ...state.choice }, values: { ...state.values } };
}

export function makePins(current, changed) {
  const answers = new Map();
  let running = false;

  function keyOf(pin, state) {
    const { axis, output, input, excitation, quantity, band } = state;
    const asked = axis === "speed" ? [] : [input, excitation, quantity, band];
    return JSON.stringify([pin.choice, pin.values, axis, output, ...asked]);
  }

  // An answer that is out of date is still better than none until the new one is there.
  async function refresh() {
    if (running) return;
    running = true;
    try {
      for (let pin = outdated(); pin; pin = outdated()) {
        const state = current();
        const answer = await ask("answer", { kind: "pins", ...question(state), choice: pin.choice, values: pin.values });
        answers.set(pin, { key: keyOf(pin, state), answer });
        changed();
      }
    } catch {
      // The question about the sliders fails in the same way and says so.
    }
    running = false;
  }

  function outdated() {
    const state = current();
    return state.pins.find((pin) => answers.get(pin)?.key !== keyOf(pin, state));
  }

  function of(pin, state) {
    const found = answers.get(pin);
    const fits = found && !found.answer.refused && found.key === keyOf(pin, state);
    return fits ? found.answer : null;
  }
  return { refresh, of, keep: (pin, state, answer) => answers.set(pin, { key: keyOf(pin, state), answer }) };
}
