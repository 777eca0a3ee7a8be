"""Print the theory manual and the verification manual as PDF, with version and date on the first page.

``python docs/manuals/print_manuals.py [FOLDER]`` runs Sphinx and pdflatex. Exit code 0: both are written; 1: Sphinx or
LaTeX has a complaint, which is printed; 3: pdflatex is not installed.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

MANUALS = Path(__file__).resolve().parent
DOCS = MANUALS.parent
BUILT = DOCS / "_build" / "manuals"
NAMES = ("torsionnet-theory", "torsionnet-verification")
RUNS = 3
"""Runs of LaTeX: contents and references settle in the third."""
MISSING_LATEX = """\
pdflatex was not found, so that no PDF was written. Install TeX Live (Debian and Ubuntu: texlive-latex-recommended,
texlive-latex-extra, lmodern), or read the same text as HTML: make docs, then docs/_build/html/theory/index.html and
verification.html.
"""
COMPLAINTS = re.compile(
    r"^(?:!|LaTeX Warning: (?:Reference|Citation|There were undefined|Label)|Missing character).*$", re.MULTILINE
)
"""Lines of LaTeX's log that count: errors, references that lead nowhere, characters that the font lacks."""
OVERFULL = re.compile(r"^Overfull \\hbox \((\d+)\.\d+pt too wide\).*$", re.MULTILINE)
WIDEST_OVERRUN = 30
"""Points by which a line may stand out of its column: the margin is 25 mm, 71 points wide."""


def main(folder: Path = BUILT) -> int:
    """Exit code after printing both manuals into a folder."""
    latex = shutil.which("pdflatex")
    if latex is None:
        sys.stderr.write(MISSING_LATEX)
        return 3
    sources = folder / "latex"
    shutil.rmtree(sources, ignore_errors=True)
    sphinx = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-c", str(MANUALS), "-b", "latex"]
    if subprocess.run([*sphinx, "-d", str(folder / "doctrees"), str(DOCS), str(sources)], check=False).returncode:
        return 1
    faults = [fault for name in NAMES for fault in typeset(latex, sources, name, folder)]
    sys.stdout.write("".join(f"{fault}\n" for fault in faults))
    return 1 if faults else 0


def typeset(latex: str, sources: Path, name: str, folder: Path) -> list[str]:
    """Complaints of LaTeX about one manual, whose PDF is written into a folder."""
    command = [latex, "-interaction=nonstopmode", "-halt-on-error", f"{name}.tex"]
    for _ in range(RUNS):
        done = subprocess.run(command, cwd=sources, check=False, capture_output=True)
        if done.returncode:
            break
    log = (sources / f"{name}.log").read_text(encoding="utf-8", errors="replace")
    found = [*COMPLAINTS.findall(log), *(one[0] for one in OVERFULL.finditer(log) if int(one[1]) > WIDEST_OVERRUN)]
    if done.returncode == 0:
        shutil.copy(sources / f"{name}.pdf", folder / f"{name}.pdf")
        sys.stdout.write(f"{folder / name}.pdf\n")
    elif not found:
        found = ["LaTeX failed; see its log"]
    return [f"{name}.tex: {fault}" for fault in found]


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else BUILT))
