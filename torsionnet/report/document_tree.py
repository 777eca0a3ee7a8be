"""Content of a report as a tree of sections, texts, tables and figures, from which all file formats are written."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from torsionnet.base import number_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.report.wording import TemplateFolder


@dataclass(frozen=True)
class Math:
    """Formula inside a line of a report, written in LaTeX code."""

    latex: str


@dataclass(frozen=True)
class BreakableMath:
    """Long formula inside a line of a report, which may break between its terms."""

    parts: tuple[str, ...]


@dataclass(frozen=True)
class Strong:
    """Text in bold inside a line of a report."""

    text: str


@dataclass(frozen=True)
class Code:
    """Text to be typed as it stands, such as a command, inside a line of a report."""

    text: str


NumberText = number_text.NumberText
Inline: TypeAlias = str | Math | BreakableMath | Strong | Code | NumberText
Text: TypeAlias = tuple[Inline, ...]
Cell: TypeAlias = Inline | Text


def inlines(cell: Cell) -> Text:
    """Texts and formulas that a cell of a table consists of, as a tuple."""
    return cell if isinstance(cell, tuple) else (cell,)


@dataclass(frozen=True)
class Paragraph:
    """Paragraph of text in a report."""

    text: Text


@dataclass(frozen=True)
class Listing:
    """List of points in a report, one below the other."""

    items: tuple[Text, ...]


@dataclass(frozen=True)
class Facts:
    """List of terms in a report with what is to be said on each, such as author and date."""

    rows: tuple[tuple[str, Text], ...]


@dataclass(frozen=True)
class TitleTable:
    """Title block of a report: rows of one or two labelled fields, revisions, and lines to sign.

    Attributes
    ----------
    rows : tuple of tuple of (str, str)
        Label and text of each field; an empty text is left blank to be filled in.
    revision_heads, revisions : tuple
        Headings of the table of revisions, and its rows.
    signature_heads, signatures : tuple
        Headings of the table to sign, and for each line what is done by whom.
    """

    rows: tuple[tuple[tuple[str, str], ...], ...]
    revision_heads: tuple[str, ...]
    revisions: tuple[tuple[str, ...], ...]
    signature_heads: tuple[str, ...]
    signatures: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Remark:
    """Remark in a report that the reader must not miss: ``kind`` is error, warning or note."""

    kind: str
    text: Text


@dataclass(frozen=True)
class Formula:
    """Numbered formula of a report on a line of its own."""

    latex: str


@dataclass(frozen=True)
class Equations:
    """Long equations of a report one below the other, which may break between terms."""

    rows: tuple[BreakableMath, ...]


@dataclass(frozen=True)
class Heading:
    """Heading of a table column in a report.

    Text, unit, whether its cells are numbers, whether it takes the room that is left.
    """

    text: Cell
    unit: str = ""
    numeric: bool = False
    wide: bool = False

    @property
    def bracket(self) -> str:
        """Unit of the column in brackets as it stands behind the heading's text, empty if there is none."""
        return number_text.unit_in_brackets(self.unit)


@dataclass(frozen=True)
class TableGroup:
    """Rows of a report's table under a heading of their own, which may be empty."""

    rows: tuple[tuple[Cell, ...], ...]
    title: Cell = ""


@dataclass(frozen=True)
class TableBlock:
    """Table of a report with its caption, headings and groups of rows; ``more`` counts the rows left out."""

    caption: Text
    columns: tuple[Heading, ...]
    groups: tuple[TableGroup, ...]
    notes: tuple[Text, ...] = ()
    more: int = 0

    @property
    def foot_notes(self) -> tuple[Text, ...]:
        """Texts of the notes below the table: its notes, and how many rows are left out."""
        return (*self.notes, *([(f"… and {self.more} more",)] if self.more else []))


@dataclass(frozen=True, eq=False)
class Picture:
    """Figure of a report with file name, drawing, caption and a text that describes it."""

    name: str
    figure: Figure
    caption: Text
    alt: str


@dataclass(frozen=True)
class Details:
    """Long part of a report that a page folds away behind its title.

    On paper the sentence ``instead`` takes its place.
    """

    title: Text
    blocks: tuple[Block, ...]
    instead: Text


@dataclass(frozen=True)
class Section:
    """Section of a report with its heading and the blocks below it."""

    name: str
    title: Text
    blocks: tuple[Block, ...]


Block: TypeAlias = Paragraph | Listing | Facts | Remark | Formula | Equations | TableBlock | Picture | Details | Section


@dataclass(frozen=True)
class Report:
    """Whole report as a tree with its title, facts and sections.

    ``template`` is the folder with a company's page and style.
    """

    title: str
    subtitle: str
    facts: Facts
    notes: Text
    sections: tuple[Section, ...]
    author: str = ""
    date: str = ""
    template: TemplateFolder | None = None
    title_block: TitleTable | None = None

    @property
    def pictures(self) -> Iterator[Picture]:
        """Figures of a report in the order of the text."""
        stack: list[Block] = list(reversed(self.sections))
        while stack:
            block = stack.pop()
            if isinstance(block, Picture):
                yield block
            elif isinstance(block, (Section, Details)):
                stack += reversed(block.blocks)
