// Unsaved text in the browser, second to the server's own draft: it is there should the server have been ended.

const KEPT = "torsionnet draft ";
const QUIET = 400; // ms

let later = 0;

export function keepDraft(file, text, unsaved) {
  clearTimeout(later);
  later = setTimeout(() => {
    try {
      if (unsaved) localStorage.setItem(KEPT + file, text);
      else localStorage.removeItem(KEPT + file);
    } catch {
      // the server has it
    }
  }, QUIET);
}

export function keptDraft(file) {
  try {
    return localStorage.getItem(KEPT + file);
  } catch {
    return null;
  }
}
