// The text pane with all that goes with it: faults, file, services, and the cursor that chooses in the schematic.

import { ask, askAbout } from "./api.js";
import { keepDraft, keptDraft } from "./drafts.js";
import { applyEdits, replaceText, select } from "./edits.js";
import { makeFaults } from "./faults.js";
import { copy } from "./files.js";
import { pasteTable } from "./pasting.js";
import { results } from "./results.js";
import { say } from "./saying.js";
import { makeFile, notice } from "./storing.js";
import { makeTextPane } from "./text_pane.js";
import { complete, format, goToDefinition, hover, rename, showOutline, showReferences } from "./text_services.js";
import { makeSync } from "./text_sync.js";

const SETTLED = 40; // ms after a movement of the cursor
const at = (id) => document.getElementById(id);

// Opens the document of this tab. `panes` shows panes; `schematic` is told what the cursor stands in.
export async function openText(nonce, schematic) {
  let sync = null;
  let faults = null;
  let file = null;
  let moving = 0;
  const act = (what) => (view) => {
    Promise.resolve(what(view)).catch((error) => say(error.message));
    return true;
  };
  const keys = [
    { key: "F12", run: act(goToDefinition), shift: act(showReferences) },
    { key: "F2", run: act(rename) },
    { key: "Shift-Alt-f", run: act(format), preventDefault: true },
    { key: "Mod-.", run: act(() => faults.mend()) },
  ];
  const { view, begin, mark } = makeTextPane(at("editor"), nonce, {
    keys,
    complete,
    hover,
    paste: pasteTable,
    changed: (_, step) => {
      sync?.changed(step);
      file?.mark();
    },
    moved: () => {
      clearTimeout(moving);
      moving = setTimeout(follow, SETTLED);
    },
  });
  faults = makeFaults(view);
  askAbout(nameOfTab());
  const opened = await ask("open");
  begin(opened.text);
  sync = makeSync(view, opened.revision, {
    faults: (found) => {
      faults.show(found);
      results.explain(found);
    },
    stale: (is) => {
      results.stale(is);
      button();
    },
    model: (model, since) => {
      results.show(model, since);
      file.mark();
    },
    outline: follow,
  });
  file = makeFile(view, opened, (unsaved) => keepDraft(opened.path_shown, view.state.doc.toString(), unsaved));
  results.makesParameters(({ element, entry, symbol }) => act(async () => {
    const { edits, refused } = await ask("parameter", { text: view.state.doc.toString(), element, entry, symbol });
    say(refused ? refused.join(" ") : `${symbol} of ${element} is a parameter now. Ctrl-Z takes it back.`);
    if (edits) applyEdits(view, edits, "parameter");
  })(view));
  offerDrafts(view, opened, file);
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const found = key === "s" && !event.shiftKey ? () => file.save() : key === "o" && event.shiftKey ? () => showOutline(view) : null;
    if (!found || document.querySelector("dialog[open]")) return;
    event.preventDefault();
    act(found)(view);
  });
  at("save").addEventListener("click", () => act(() => file.save())(view));
  at("download").addEventListener("click", () => file.download());
  at("copy").addEventListener("click", act(async () => say(await copy(at("command")))));
  at("ways").addEventListener("click", () => at("ways").hidePopover());
  at("outline").addEventListener("click", () => act(showOutline)(view));
  at("format").addEventListener("click", () => act(format)(view));
  at("write").addEventListener("click", () => act(writeValues)(view));

  // What the cursor stands in is chosen in the schematic, and its lines are marked.
  function follow() {
    const { head } = view.state.selection.main;
    const around = sync.outline().filter(({ kind, name, from, to }) => from <= head && head <= to && schematic.has(`${kind} ${name}`));
    schematic.choose(around.map(({ kind, name }) => `${kind} ${name}`));
    mark(around.find(({ kind }) => kind === "element") ?? null);
  }

  async function writeValues() {
    const found = await ask("values", results.state());
    if (found.refused) return say(found.refused.join("; "));
    if (found.revision !== sync.revision()) return say("Mend the text first: values are written into a sound text.");
    results.forget();
    if (replaceText(view, found.text, "values")) say("The values stand in the text. Ctrl-Z takes them back.");
    view.focus();
  }

  function button() {
    at("write").disabled = !(sync?.isSound() && results.changed().length);
  }
  return {
    view,
    opened,
    button,
    begin: () => {
      file.mark();
      sync.now();
    },
    // The place where an element or a node is written.
    goTo(kind, name) {
      const found = sync.outline().find((item) => item.kind === kind && item.name === name);
      if (found) select(view, found.name_from, found.name_to);
    },
  };
}

// A document for each tab: it outlives a reload, and another tab has its own.
function nameOfTab() {
  const key = "torsionnet document";
  const name = sessionStorage.getItem(key) ?? crypto.randomUUID();
  sessionStorage.setItem(key, name);
  return name;
}

function offerDrafts(view, opened, file) {
  if (opened.draft) {
    const acts = opened.can_save ? [["Take the file instead", async () => {
      const { text, disk } = await ask("changes", { disk: "" });
      file.tookFile(text, disk);
    }]] : [];
    return notice("Here is text that had not been saved when its tab was closed.", acts);
  }
  const kept = keptDraft(opened.path_shown);
  if (kept === null || kept === view.state.doc.toString()) return null;
  return notice("The browser has kept a text of this file that was never saved.", [
    ["Bring it back", () => replaceText(view, kept, "draft")],
    ["Forget it", () => keepDraft(opened.path_shown, "", false)],
  ]);
}
