"""Writing of a report as Markdown with formulas between dollar signs, and its figures as SVG beside it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from torsionnet.base.number_text import RAISED
from torsionnet.report.document_tree import (
    BreakableMath,
    Heading,
    Picture,
    Report,
    Section,
    Text,
    TitleTable,
)
from torsionnet.report.writers.blocks import CountedLabel
from torsionnet.report.writers.table_layout import InlineWriter, TableLayout
from torsionnet.report.writers.templating import BesideWriter

_MARKS = re.compile(r"([\\`*_{}\[\]<>#|$~&])")


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as Markdown with its figures, and return the paths."""
    return MarkdownWriter.write(report, path)


def escaped(text: str) -> str:
    r"""Text with all marks of Markdown in it escaped.

    >>> print(escaped("<b>A</b> $x_1$"))
    \<b\>A\</b\> \$x\_1\$
    """
    return _MARKS.sub(r"\\\1", " ".join(text.split("\n")))


def _safe(latex: str) -> str:
    r"""LaTeX without double backslashes, thin spaces and bars, which Markdown takes for escapes or ends of cells."""
    text = latex.replace(r" \\ ", r" \cr ").replace(r"\\", r"\cr ").replace(r"\,", r"\thinspace ")
    return text.replace(r"\left|", r"\left\vert ").replace(r"\right|", r"\right\vert ").replace("|", r"\vert ")


class MarkdownInline(InlineWriter):
    """Writer of the texts, formulas and numbers inside a line of Markdown."""

    def text(self, text: str) -> str:
        return escaped(text)

    def math(self, latex: str) -> str:
        return f"${_safe(latex)}$"

    def terms(self, terms: tuple[str, ...]) -> str:
        return self.math(" ".join(terms))

    def strong(self, text: str) -> str:
        return f"**{escaped(text.strip())}**{' ' * (text != text.rstrip())}"

    def code(self, text: str) -> str:
        return f"`{text}`"

    def digits(self, digits: str, _gap: str) -> str:
        return digits.replace("-", "−")

    def power(self, digits: str, exponent: str) -> str:
        return f"{self.digits(digits, '')}·10{exponent.translate(RAISED)}"


class MarkdownWriter(BesideWriter):
    """Writer of a report as Markdown."""

    ending = ".md"
    form = "svg"
    images = (".svg", ".png", ".jpg", ".jpeg")
    inline = MarkdownInline()

    def heading(self, block: Section, number: str, level: int) -> str:
        return f"{'#' * (min(level + 1, 5) + 1)} {number} {self.inline(block.title)}\n\n"

    def paragraph(self, text: Text) -> str:
        return self.inline(text)

    def listing(self, items: Sequence[Text]) -> str:
        return "\n".join(f"- {self.inline(item)}" for item in items)

    def facts(self, rows: Sequence[tuple[str, Text]]) -> str:
        return "| | |\n|---|---|\n" + "".join(f"| {escaped(word)} | {self.inline(text)} |\n" for word, text in rows)

    def remark(self, _kind: str, word: str, text: Text) -> str:
        return f"> **{escaped(word)}:** {self.inline(text)}"

    def formula(self, latex: str, _number: str) -> str:
        return f"$$\n{_safe(latex)}\n$$"

    def equations(self, rows: Sequence[BreakableMath]) -> str:
        return "\n\n".join(self.formula(" ".join(row.parts), "") for row in rows)

    def picture(self, block: Picture, label: CountedLabel) -> str:
        return f"![{escaped(block.alt)}]({self.drawing(block)})\n\n{self._caption(label, block.caption)}"

    def table(self, layout: TableLayout, label: CountedLabel) -> str:
        block = layout.block
        head = " | ".join(self._heading(column) for column in block.columns)
        rule = "|".join("---:" if column.numeric else "---" for column in block.columns)
        lines = [f"{self._caption(label, block.caption)}\n", f"| {head} |", f"|{rule}|"]
        for group in block.groups:
            if group.title:
                lines.append(f"| **{self.inline(group.title)}** |" + " |" * (len(block.columns) - 1))
            lines += [f"| {' | '.join(map(self.inline, row))} |" for row in group.rows]
        return "\n".join(lines) + "".join(f"\n\n{self.inline(note)}" for note in block.foot_notes)

    def _caption(self, label: CountedLabel, caption: Text) -> str:
        return f"**{escaped(label.word)} {label.number}** {self.inline(caption)}"

    def _heading(self, column: Heading) -> str:
        return self.inline(column.text) + escaped(f" {column.bracket}" if column.bracket else "")

    def title_block(self, block: TitleTable) -> str:
        # A field that is alone in its row leaves the other two cells empty, as a signature its date and name.
        rows = [_line(text for field in row for text in field) + " | |" * (len(row) == 1) for row in block.rows]
        tables = [["| | | | |", "|---|---|---|---|", *rows]]
        tables.append([*_head(block.revision_heads), *map(_line, block.revisions)])
        tables.append([*_head(block.signature_heads), *(f"{_line(signed)} | |" for signed in block.signatures)])
        return "\n\n".join(map("\n".join, tables)) + "\n"


def _line(texts: Iterable[str]) -> str:
    """Row of the title block."""
    return "|" + "".join(f" {escaped(text)} |" for text in texts)


def _head(texts: Sequence[str]) -> list[str]:
    return [_line(texts), "|" + "---|" * len(texts)]
