"""A report as Markdown with formulas between dollar signs, its figures as SVG in a folder beside it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from torsionnet.core.atomic import write_text
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Code,
    DefinitionList,
    Details,
    Equations,
    Facts,
    Formula,
    Heading,
    Inline,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Remark,
    Report,
    Section,
    Strong,
    TableBlock,
    inlines,
)
from torsionnet.report.writers.figure_files import figure_folder, write_figures

_MARKS = re.compile(r"([\\`*_{}\[\]<>#|$~&])")


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the text and its figures."""
    figures = write_figures(report, path, "svg")
    write_text(path, markdown_text(report, figure_folder(path).name))
    return (path, *figures)


def markdown_text(report: Report, folder: str) -> str:
    """The text; ``folder`` holds the figures."""
    writer = _Writer(folder)
    parts = [f"# {escaped(report.title)}", escaped(report.subtitle), writer.facts(report.facts)]
    parts += [inline(report.notes)] if any(report.notes) else []
    parts += [writer.section(section, (number,)) for number, section in enumerate(report.sections, 1)]
    return "\n\n".join(parts) + "\n"


def escaped(text: str) -> str:
    r"""Text in which no mark means anything.

    >>> print(escaped("<b>A</b> $x_1$"))
    \<b\>A\</b\> \$x\_1\$
    """
    return _MARKS.sub(r"\\\1", " ".join(text.split("\n")))


def inline(cell: Cell) -> str:
    return "".join(map(_part, inlines(cell)))


def _part(part: Inline) -> str:
    match part:
        case Math(latex):
            return f"${_safe(latex)}$"
        case DefinitionList(parts):
            return f"${_safe(' '.join(parts))}$"
        case Strong(text):
            return f"**{escaped(text.strip())}**{' ' * (text != text.rstrip())}"
        case Code(text):
            return f"`{text}`"
        case NumberText():
            return str(part)
    return escaped(part)


def _safe(latex: str) -> str:
    r"""Without ``\\`` and ``\,``, which Markdown takes for escapes, and without bars, which end a cell."""
    text = latex.replace(r" \\ ", r" \cr ").replace(r"\\", r"\cr ").replace(r"\,", r"\thinspace ")
    return text.replace(r"\left|", r"\left\vert ").replace(r"\right|", r"\right\vert ").replace("|", r"\vert ")


def _display(latex: str) -> str:
    return f"$$\n{_safe(latex)}\n$$"


@dataclass
class _Writer:
    """Counts tables and figures as it goes."""

    folder: str
    counts: Counter[str] = field(default_factory=Counter)

    def label(self, what: str) -> str:
        self.counts[what] += 1
        return f"{what} {self.counts[what]}"

    def section(self, section: Section, numbers: tuple[int, ...]) -> str:
        marks, shown = "#" * min(len(numbers) + 1, 6), ".".join(map(str, numbers))
        parts, below = [f"{marks} {shown} {inline(section.title)}"], 0
        for block in section.blocks:
            if isinstance(block, Section):
                below += 1
                parts.append(self.section(block, (*numbers, below)))
            else:
                parts.append(self.block(block))
        return "\n\n".join(parts)

    def block(self, block: Block) -> str:
        writers: dict[type, Callable[[Any], str]] = {
            Paragraph: lambda one: inline(one.text),
            Listing: lambda one: "\n".join(f"- {inline(item)}" for item in one.items),
            Remark: lambda one: f"> **{one.kind.capitalize()}:** {inline(one.text)}",
            Formula: lambda one: _display(one.latex),
            Equations: lambda one: "\n\n".join(_display(" ".join(row.parts)) for row in one.rows),
            TableBlock: self.table,
            Picture: self.picture,
            Details: lambda one: inline(one.instead),
            Facts: self.facts,
        }
        return writers[type(block)](block)

    def picture(self, block: Picture) -> str:
        caption = f"**{self.label('Figure')}** {inline(block.caption)}"
        return f"![{escaped(block.alt)}]({self.folder}/{block.name}.svg)\n\n{caption}"

    @staticmethod
    def facts(facts: Facts) -> str:
        rows = "\n".join(f"| {escaped(word)} | {inline(text)} |" for word, text in facts.rows)
        return f"| | |\n|---|---|\n{rows}"

    def table(self, block: TableBlock) -> str:
        head = " | ".join(_heading(column) for column in block.columns)
        rule = "|".join("---:" if column.numeric else "---" for column in block.columns)
        lines = [f"**{self.label('Table')}** {inline(block.caption)}", "", f"| {head} |", f"|{rule}|"]
        for group in block.groups:
            if group.title:
                lines.append(f"| **{inline(group.title)}** |" + " |" * (len(block.columns) - 1))
            lines += [f"| {' | '.join(map(inline, row))} |" for row in group.rows]
        return "\n".join(lines) + "".join(f"\n\n{inline(note)}" for note in block.ending)


def _heading(column: Heading) -> str:
    return inline(column.text) + escaped(f" {column.bracket}" if column.bracket else "")
