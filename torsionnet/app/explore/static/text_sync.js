// Each change of the text goes to the server, the newest only; its faults, model and outline come back. While digits
// alone change in a number, the outline stays and its places move along.

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
  let outlined = -1; // the revision that the items belong to
  const failed = (error) => say(error.message);
  const outline = newestOnly("outline", (found, sent, of) => {
    items = flat(found.items ?? [], 0);
    outlined = of;
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
    if (outlined !== revision) outline({ text: sent.text }, revision);
  }, failed);

  // For tests: the text, and whether its faults are shown.
  Object.assign(globalThis.torsionnet, { text: () => view.state.doc.toString(), isChecked: () => answered === revision });

  function now() {
    send({ revision, text: view.state.doc.toString() }, since);
  }
  return {
    now,
    changed(step) {
      if (outlined === revision && isOfDigits(step, items)) {
        items = items.map((item) => moved(item, step.changes));
        outlined += 1;
      }
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

// Whether every change leaves a number a number, one that is no name.
function isOfDigits({ changes, startState: { doc } }, items) {
  let found = true;
  changes.iterChanges((from, to, _, __, added) => {
    const line = doc.lineAt(from);
    const before = /[\d.]*$/.exec(line.text.slice(0, from - line.from))[0];
    const after = /^[\d.]*/.exec(line.text.slice(to - line.from))[0];
    const [start, end] = [from - before.length, to + after.length];
    const numbers = [doc.sliceString(start, end), before + added.toString() + after];
    found &&= to <= line.to && numbers.every((number) => /^\d[\d.]*$/.test(number));
    found &&= /[\s,[]/.test(doc.sliceString(start - 1, start)) && !items.some((item) => item.name_from <= end && start <= item.name_to);
  });
  return found;
}

function moved({ from, to, name_from: begin, name_to: end, ...item }, changes) {
  const [first, last, left, right] = [changes.mapPos(from, -1), changes.mapPos(to, 1), changes.mapPos(begin, 1), changes.mapPos(end, -1)];
  return { ...item, from: first, to: last, name_from: left, name_to: right };
}
