r"""A report as a LaTeX document with its figures as PDF in a folder beside it; one run of pdfTeX makes the PDF.

Nothing refers to pages, and tables find their widths at once, so that a second run would change nothing.
"""

from __future__ import annotations

from pathlib import Path

from torsionnet.report.document_tree import DefinitionList, Report, Section, Text
from torsionnet.report.writers.figure_files import beside, figure_folder, write_beside
from torsionnet.report.writers.latex_room import room
from torsionnet.report.writers.latex_table import table_latex
from torsionnet.report.writers.latex_text import displayed, escaped, inline
from torsionnet.report.writers.templating import TextFormat, written

LONG = 60
"""Letters of a word that is set smaller, such as a check sum."""


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the document and its figures."""
    return write_beside(report, path, "pdf", latex_document(report, figure_folder(path).name))


def latex_document(report: Report, folder: str) -> str:
    """The text of the document; ``folder`` holds the figures."""
    return written(report, FORMAT, beside(folder, "pdf"))


def _heading(section: Section) -> str:
    title = inline(section.title)
    return rf"\texorpdfstring{{{title}}}{{{escaped(section.name)}}}" if "$" in title else title


def _equation(row: DefinitionList) -> str:
    return displayed(inline(row))


def _breakable(text: Text) -> str:
    """Long words in a smaller size."""
    return " ".join(
        rf"{{\footnotesize\texttt{{{word}}}}}" if len(word) > LONG and word.isalnum() else word
        for word in inline(text).split(" ")
    )


FORMAT = TextFormat(
    ".tex",
    inline,
    {
        "display": displayed,
        "equation": _equation,
        "breakable": _breakable,
        "heading": _heading,
        "room": room,
        "table": table_latex,
    },
    (".pdf", ".png", ".jpg", ".jpeg"),
)
