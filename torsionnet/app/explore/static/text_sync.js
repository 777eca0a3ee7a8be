// Each change of the text goes to the server, the newest only; its faults, model and outline come back.

import { newestOnly } from "./api.js";
import { say } from "./saying.js";
import { flat } from "./text_services.js";

const PAUSE = 30; // ms after a keystroke

// `shown`: faults(list), model(model, since), stale(bool), outline()
export function makeSync(view, first, shown) {
  let revision = first;
  let since = 0;
  let waiting = 0;
  let sound = false;
  let answered = -1;
  let items = [];
  const failed = (error) => say(error.message);
  const outline = newestOnly("outline", (found) => {
    items = flat(found.items ?? [], 0);
    shown.outline();
  }, failed);
  const send = newestOnly("text", (answer, sent, begun) => {
    if (answer.revision !== revision) return; // a newer text is on its way
    answered = revision;
    sound = answer.sound;
    shown.faults(answer.faults);
    globalThis.torsionnet.lastFaults = performance.now() - begun;
    shown.stale(!sound);
    if (answer.model && revision !== first) shown.model(answer.model, begun); // the first one is there already
    outline({ text: sent.text }, begun);
  }, failed);

  // For tests: the text, and whether its faults are shown.
  Object.assign(globalThis.torsionnet, { text: () => view.state.doc.toString(), isChecked: () => answered === revision });

  function now() {
    send({ revision, text: view.state.doc.toString() }, since);
  }
  return {
    now,
    changed() {
      revision += 1;
      since = performance.now();
      clearTimeout(waiting);
      waiting = setTimeout(now, PAUSE);
    },
    isSound: () => sound,
    revision: () => revision,
    outline: () => items,
  };
}
