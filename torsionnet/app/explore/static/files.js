// Out of the page: the text as a download, the command on the clipboard.

export function download(file, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/yaml" }));
  link.download = file;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

// Where the browser keeps the clipboard to itself, the command is selected and one key away.
export async function copy(node) {
  try {
    await navigator.clipboard.writeText(node.textContent);
    return "Copied the command.";
  } catch {
    getSelection().selectAllChildren(node);
    return "The command is selected: copy it with Ctrl-C.";
  }
}
