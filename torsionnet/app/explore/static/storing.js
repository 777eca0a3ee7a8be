// The file: saving the text by an explicit act, and following what other programs write into it.

import { ask, quietly } from "./api.js";
import { decide, paragraph } from "./dialogs.js";
import { replaceText } from "./edits.js";
import { download } from "./files.js";
import { results } from "./results.js";
import { say } from "./saying.js";

const PATIENCE = 3000; // ms until the next try where the server gave no answer
const SOON = 400; // ms between questions, should answers come at once

const at = (id) => document.getElementById(id);

// `opened` is what api/open answered.
export function makeFile(view, opened, changed) {
  let disk = opened.disk;
  let stored = opened.draft ? null : view.state.doc.toString(); // what the file holds, as far as this page knows
  let bar = null;
  let turn = Promise.resolve();

  const name = opened.is_template ? "template" : opened.path_shown.replace(/^.*[\\/]/, "");
  const text = () => view.state.doc.toString();
  const unsaved = () => stored !== text();

  function mark() {
    const is = unsaved();
    at("stored").textContent = `${name}${is ? " – not saved" : ""}`;
    at("stored").title = opened.save_hint || opened.path_shown;
    document.title = document.title.replace(/^● /, "").replace(/^/, is ? "● " : "");
    changed(is);
  }

  function took(now, on) {
    stored = now.replaceAll("\r\n", "\n");
    disk = on;
    bar?.remove();
    bar = null;
    mark();
  }

  // What stands in the editor, faulty or not, goes into the file it came from; where that cannot be, into a download.
  async function write(force = false) {
    const sent = text();
    const from = disk;
    const found = await ask("store", { text: sent, disk, force }).catch(({ message }) => ({ reason: message, disk }));
    if (found.stored) {
      took(sent, found.disk);
      return saved(`Saved ${opened.path_shown}.`);
    }
    if (found.disk === from) return asDownload(sent, found.reason);
    const acts = [["mine", "Keep mine"], ["theirs", "Take theirs"], ["download", "Download mine"], ["", "Cancel"]];
    const possible = acts.filter(([value]) => value !== "theirs" || found.text !== null);
    const act = await decide("The file has been changed by another program", [paragraph(found.reason), difference(found.difference)], possible);
    if (act === "mine") {
      disk = found.disk;
      await write(true);
    }
    if (act === "theirs") take(found.text, found.disk);
    if (act === "download") asDownload(sent, found.reason);
    view.focus();
  }

  // One after the other: the second begins from the version that the first has written.
  function save() {
    turn = turn.catch(() => {}).then(() => write());
    return turn;
  }

  function asDownload(sent, reason) {
    download(opened.file, sent);
    if (!disk) took(sent, disk); // no file waits for it
    saved(`Saved as a download, ${opened.file}: ${reason.replace(/\.?$/, ".")}`);
  }

  function saved(words) {
    say(results.changed().length ? `${words} Values of sliders are not in the text; "Write values into text" puts them there.` : words);
  }

  function take(theirs, on) {
    replaceText(view, theirs, "theirs");
    took(theirs, on);
    say("The text is that of the file now. Ctrl-Z brings the other one back.");
  }

  async function follow() {
    let known = disk;
    for (;;) {
      const begun = performance.now();
      const found = await quietly("changes", { disk: known }).catch(() => null);
      if (!found || found.superseded) await pause(PATIENCE);
      else if (found.refused) say(found.refused.join(" "));
      else if (found.text !== undefined) {
        await turn.catch(() => {}); // a version of this page's own comes by this way too
        if (found.disk !== disk) heard(found);
      }
      if (found?.wait_s) await pause(1000 * found.wait_s);
      known = found?.disk ?? known;
      if (found && performance.now() - begun < SOON) await pause(SOON);
    }
  }

  function heard({ text: theirs, disk: on }) {
    const now = theirs.replaceAll("\r\n", "\n");
    if (now === text()) return took(theirs, on);
    if (!unsaved()) {
      replaceText(view, theirs, "follow");
      took(theirs, on);
      return say(`${opened.path_shown} was changed by another program; the page follows.`);
    }
    bar?.remove();
    bar = notice("Another program has changed the file; your text is not saved.", [
      ["Compare", () => save()],
      ["Take theirs", () => take(theirs, on)],
      ["Keep mine", () => {
        disk = on;
        bar.remove();
      }],
    ]);
  }

  addEventListener("beforeunload", (event) => unsaved() && event.preventDefault());
  if (opened.can_save) follow();
  mark();
  return { save, mark, unsaved, tookFile: take, download: () => asDownload(text(), "as asked for") };
}

function pause(ms) {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

// A bar above the panes with what can be done about it.
export function notice(words, acts) {
  const bar = Object.assign(document.createElement("div"), { className: "bar", role: "status" });
  const buttons = [...acts, ["×", () => {}, "Close"]].map(([name, act, label]) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    if (label) button.setAttribute("aria-label", label);
    button.addEventListener("click", () => {
      if (label || name !== "Compare") bar.remove();
      act();
    });
    return button;
  });
  bar.append(paragraph(words), ...buttons);
  at("bars").append(bar);
  return bar;
}

function difference(text) {
  const box = Object.assign(document.createElement("pre"), { className: "difference", tabIndex: 0 });
  box.setAttribute("aria-label", "Difference: minus is the file, plus is your text");
  box.append(...text.split("\n").map((line) => {
    const kind = line.startsWith("+") ? "plus" : line.startsWith("-") ? "minus" : "";
    return Object.assign(document.createElement("span"), { className: kind, textContent: `${line}\n` });
  }));
  return box;
}
