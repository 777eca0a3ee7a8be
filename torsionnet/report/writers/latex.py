r"""A report as a LaTeX document with its figures as PDF in a folder beside it; one run of pdfTeX makes the PDF.

Nothing refers to pages, and tables find their widths at once, so that a second run would change nothing.
"""

from __future__ import annotations

from pathlib import Path

from torsionnet.core.atomic import write_text
from torsionnet.report.document_tree import DefinitionList, Report, Section, Text
from torsionnet.report.writers.figure_files import figure_folder, write_figures
from torsionnet.report.writers.latex_room import room
from torsionnet.report.writers.latex_table import table_latex
from torsionnet.report.writers.latex_text import displayed, escaped, inline
from torsionnet.report.writers.templating import TextFormat, written

LONG = 60
"""Letters of a word that is set smaller, such as a check sum."""


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the document and its figures."""
    text = latex_document(report, figure_folder(path).name)
    figures = write_figures(report, path, "pdf")
    write_text(path, text)
    return (path, *figures)


def latex_document(report: Report, folder: str) -> str:
    """The text of the document; ``folder`` holds the figures."""
    return written(report, FORMAT, lambda picture, _: f"{folder}/{picture.name}.pdf")


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
    {
        "block_start_string": "<%", "block_end_string": "%>",
        "variable_start_string": "<<", "variable_end_string": ">>",
        "comment_start_string": "<!--", "comment_end_string": "-->",
    },
)  # fmt: skip
