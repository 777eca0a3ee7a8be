"""Writing of a report as Markdown with formulas between dollar signs, and its figures as SVG beside it."""

from __future__ import annotations

import re
from pathlib import Path

from torsionnet.report.document_tree import (
    BreakableMath,
    Cell,
    Code,
    Heading,
    Inline,
    Math,
    NumberText,
    Report,
    Strong,
    TableBlock,
    inlines,
)
from torsionnet.report.writers.templating import TextFormat, figure_folder, figures_beside, render, write_beside

_MARKS = re.compile(r"([\\`*_{}\[\]<>#|$~&])")


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as Markdown with its figures, and return the paths."""
    return write_beside(report, path, "svg", markdown_text(report, figure_folder(path).name))


def markdown_text(report: Report, folder: str) -> str:
    """Text of the Markdown file of a report; ``folder`` holds the figures."""
    return render(report, FORMAT, figures_beside(folder, "svg"))


def escaped(text: str) -> str:
    r"""Text with all marks of Markdown in it escaped.

    >>> print(escaped("<b>A</b> $x_1$"))
    \<b\>A\</b\> \$x\_1\$
    """
    return _MARKS.sub(r"\\\1", " ".join(text.split("\n")))


def inline(cell: Cell) -> str:
    """Markdown of a cell, caption or paragraph of a report."""
    return "".join(map(_part, inlines(cell)))


def _part(part: Inline) -> str:
    match part:
        case Math(latex):
            return f"${_safe(latex)}$"
        case BreakableMath(parts):
            return f"${_safe(' '.join(parts))}$"
        case Strong(text):
            return f"**{escaped(text.strip())}**{' ' * (text != text.rstrip())}"
        case Code(text):
            return f"`{text}`"
        case NumberText():
            return str(part)
    return escaped(part)


def _safe(latex: str) -> str:
    r"""LaTeX without double backslashes, thin spaces and bars, which Markdown takes for escapes or ends of cells."""
    text = latex.replace(r" \\ ", r" \cr ").replace(r"\\", r"\cr ").replace(r"\,", r"\thinspace ")
    return text.replace(r"\left|", r"\left\vert ").replace(r"\right|", r"\right\vert ").replace("|", r"\vert ")


def _display(latex: str) -> str:
    return f"$$\n{_safe(latex)}\n$$"


def _table(block: TableBlock) -> str:
    head = " | ".join(_heading(column) for column in block.columns)
    rule = "|".join("---:" if column.numeric else "---" for column in block.columns)
    lines = [f"| {head} |", f"|{rule}|"]
    for group in block.groups:
        if group.title:
            lines.append(f"| **{inline(group.title)}** |" + " |" * (len(block.columns) - 1))
        lines += [f"| {' | '.join(map(inline, row))} |" for row in group.rows]
    return "\n".join(lines) + "".join(f"\n\n{inline(note)}" for note in block.foot_notes)


def _heading(column: Heading) -> str:
    return inline(column.text) + escaped(f" {column.bracket}" if column.bracket else "")


FORMAT = TextFormat(
    ".md",
    inline,
    {"display": _display, "equation": lambda row: _display(" ".join(row.parts)), "table": _table},
    (".svg", ".png", ".jpg", ".jpeg"),
)
"""File format Markdown with the functions that turn the parts of a report into it."""
