// Small questions in dialogs that the browser closes with Escape; each resolves with what was decided.

function open(title, kind = "") {
  const dialog = Object.assign(document.createElement("dialog"), { className: kind });
  const heading = Object.assign(document.createElement("h2"), { textContent: title, id: "dialog-title" });
  dialog.setAttribute("aria-labelledby", heading.id);
  dialog.append(heading);
  document.body.append(dialog);
  const done = new Promise((resolve) => dialog.addEventListener("close", () => {
    dialog.remove();
    resolve(dialog.returnValue);
  }));
  return { dialog, done };
}

export function paragraph(text, kind = "") {
  return Object.assign(document.createElement("p"), { textContent: text, className: kind });
}

// One of several acts, [value, words]; "" where the dialog was left.
export async function decide(title, content, acts) {
  const { dialog, done } = open(title, "decide");
  const row = Object.assign(document.createElement("div"), { className: "acts" });
  row.append(...acts.map(([value, words]) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: words });
    button.addEventListener("click", () => dialog.close(value));
    return button;
  }));
  dialog.append(...content, row);
  dialog.showModal();
  row.querySelector("button").focus();
  return done;
}

// A name that `check` takes, or says in a sentence why not.
export async function writeOne(title, value, check) {
  const { dialog, done } = open(title, "write");
  const form = document.createElement("form");
  const field = Object.assign(document.createElement("input"), { type: "text", value, autocomplete: "off", spellcheck: false });
  field.setAttribute("aria-labelledby", "dialog-title");
  const reason = Object.assign(paragraph("", "reason"), { role: "alert" });
  const button = Object.assign(document.createElement("button"), { type: "submit", textContent: "Rename" });
  form.append(field, button, reason);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    reason.textContent = await check(field.value.trim()).catch((error) => error.message);
    if (reason.textContent) field.focus();
    else dialog.close("done");
  });
  dialog.append(form);
  dialog.showModal();
  field.select();
  return done;
}

// One of many rows {name, detail, depth}, found by typing, arrow keys and Enter, or by mouse; null where left.
export async function chooseOne(title, rows) {
  const { dialog, done } = open(title, "choose");
  const field = Object.assign(document.createElement("input"), { type: "text", autocomplete: "off", spellcheck: false });
  const list = Object.assign(document.createElement("ul"), { id: "choices", role: "listbox" });
  for (const [key, value] of Object.entries({ role: "combobox", "aria-expanded": "true", "aria-controls": "choices", "aria-label": `${title}: type to filter` })) {
    field.setAttribute(key, value);
  }
  const nodes = rows.map((row, k) => choice(row, k, () => take(k)));
  let at = -1;
  const shown = () => nodes.map((_, k) => k).filter((k) => !nodes[k].hidden);
  const take = (k) => k >= 0 && dialog.close(String(k));
  const move = (to) => {
    nodes[at]?.removeAttribute("aria-selected");
    at = to ?? -1;
    nodes[at]?.setAttribute("aria-selected", "true");
    nodes[at]?.scrollIntoView({ block: "nearest" });
    if (at >= 0) field.setAttribute("aria-activedescendant", nodes[at].id);
  };
  const filter = () => {
    const words = field.value.toLowerCase();
    rows.forEach((row, k) => (nodes[k].hidden = !`${row.name} ${row.kind ?? ""} ${row.detail ?? ""}`.toLowerCase().includes(words)));
    const all = shown();
    move(all.find((k) => rows[k].name.toLowerCase().startsWith(words)) ?? all.find((k) => rows[k].name.toLowerCase().includes(words)) ?? all[0]);
  };
  field.addEventListener("input", filter);
  field.addEventListener("keydown", (event) => {
    const all = shown();
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
    if (step) move(all[Math.max(0, Math.min(all.length - 1, all.indexOf(at) + step))]);
    else if (event.key === "Enter") take(at);
    else return;
    event.preventDefault();
  });
  list.append(...nodes);
  dialog.append(field, list);
  dialog.showModal();
  field.focus();
  filter();
  const value = await done;
  return value === "" ? null : rows[Number(value)];
}

function choice(row, k, take) {
  const node = Object.assign(document.createElement("li"), { id: `choice-${k}`, role: "option", className: `depth-${Math.min(row.depth ?? 0, 4)}` });
  const detail = Object.assign(document.createElement("span"), { className: "detail", textContent: [row.kind, row.detail].filter(Boolean).join(" · ") });
  node.append(row.name, detail);
  node.addEventListener("click", take);
  return node;
}
