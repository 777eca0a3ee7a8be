r"""Writing of a report as a LaTeX document with its figures as PDF beside it; one run of pdfTeX makes the PDF.

Nothing refers to pages, and tables find their widths at once, so that a second run would change nothing.
"""

from __future__ import annotations

from pathlib import Path

from torsionnet.report.document_tree import Report, Text
from torsionnet.report.writers.figure_files import figure_folder, figures_beside, write_beside
from torsionnet.report.writers.latex_space import room_command
from torsionnet.report.writers.latex_table import table_latex
from torsionnet.report.writers.latex_text import display_math, inline
from torsionnet.report.writers.templating import TextFormat, render

LONG_WORD = 60
"""Number of letters of a word from which on LaTeX sets it smaller, such as a check sum."""


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as a LaTeX document with its figures, and return the paths."""
    return write_beside(report, path, "pdf", latex_document(report, figure_folder(path).name))


def latex_document(report: Report, folder: str) -> str:
    """Text of the LaTeX document of a report; ``folder`` holds the figures."""
    return render(report, FORMAT, figures_beside(folder, "pdf"))


def _breakable(text: Text) -> str:
    """LaTeX of a text with its long words in a smaller size."""
    return " ".join(
        rf"{{\footnotesize\texttt{{{word}}}}}" if len(word) > LONG_WORD and word.isalnum() else word
        for word in inline(text).split(" ")
    )


FORMAT = TextFormat(
    ".tex",
    inline,
    {
        "display": display_math,
        "equation": lambda row: display_math(inline(row)),
        "breakable": _breakable,
        "text": inline,
        "room": room_command,
        "table": table_latex,
    },
    (".pdf", ".png", ".jpg", ".jpeg"),
)
"""File format LaTeX with the functions that turn the parts of a report into it."""
