// A table out of a spreadsheet, pasted into the text, becomes a model if one wants it to.

import { ask } from "./api.js";
import { decide, paragraph } from "./dialogs.js";
import { replaceText } from "./edits.js";
import { say } from "./saying.js";

const LEAST_ROWS = 2;
const SHOWN_ROWS = 6;

// True where the paste is dealt with here.
export function pasteTable(event, view) {
  const text = event.clipboardData?.getData("text/plain") ?? "";
  if (!looksLikeTable(text)) return false;
  event.preventDefault();
  offer(text, view).catch((error) => say(error.message));
  return true;
}

// Several lines that tabs, or semicolons, divide into columns; a YAML text has neither.
export function looksLikeTable(text) {
  const lines = text.split(/\r?\n/).filter((line) => line.trim());
  const divided = (mark) => lines.filter((line) => line.includes(mark)).length;
  return lines.length >= LEAST_ROWS && Math.max(divided("\t"), divided(";")) > lines.length / 2;
}

async function offer(table, view) {
  const found = await ask("paste", { table });
  if (found.no_table) return raw(table, view);
  const rows = table.split(/\r?\n/).filter((line) => line.trim());
  const seen = Object.assign(document.createElement("pre"), { textContent: rows.slice(0, SHOWN_ROWS).join("\n") + (rows.length > SHOWN_ROWS ? "\n…" : "") });
  if (found.asked) return withUnits(table, view, found, seen);
  if (found.refused) {
    const reasons = found.refused.map((one) => paragraph(one, "reason"));
    const act = await decide("This table makes no model yet", [...reasons, seen], [["", "Cancel"], ["raw", "Paste as it is"]]);
    if (act === "raw") raw(table, view);
    return view.focus();
  }
  const words = view.state.doc.length ? "The model takes the place of the whole text; Ctrl-Z brings it back." : "";
  const act = await decide(`Make a model of this table of ${rows.length} lines?`, [seen, ...(found.notes ?? []).map((note) => paragraph(note, "reason")), paragraph(words)], [["model", "Make a model"], ["raw", "Paste as it is"], ["", "Cancel"]]);
  if (act === "model") {
    replaceText(view, found.text, "paste");
    say("The table is a model now.");
  } else if (act === "raw") raw(table, view);
  view.focus();
}

// Columns without a unit: each is asked for, and written into its heading.
async function withUnits(table, view, { asked }, seen) {
  const fields = asked.map(({ heading, units }) => {
    const label = paragraph(`Unit of ${heading} `);
    const field = document.createElement("select");
    field.setAttribute("aria-label", `Unit of ${heading}`);
    field.append(...units.map((unit) => new Option(unit, unit)));
    label.append(field);
    return { label, field };
  });
  const act = await decide("In which units is this table?", [seen, ...fields.map(({ label }) => label)], [["go", "Go on"], ["raw", "Paste as it is"], ["", "Cancel"]]);
  if (act === "raw") raw(table, view);
  if (act !== "go") return view.focus();
  const lines = table.split(/\r?\n/);
  asked.forEach(({ line, heading }, k) => {
    const cells = lines[line - 1].split(/([\t;])/);
    cells[cells.findIndex((cell) => cell.trim() === heading)] = `${heading} [${fields[k].field.value}]`;
    lines[line - 1] = cells.join("");
  });
  return offer(lines.join("\n"), view);
}

function raw(text, view) {
  view.dispatch(view.state.replaceSelection(text), { userEvent: "input.paste", scrollIntoView: true });
}
