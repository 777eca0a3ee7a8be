"""What a report says, without a word about how it is written: the tree that HTML, LaTeX and Markdown are made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from torsionnet.core import number_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.report.template_folder import TemplateFolder


@dataclass(frozen=True)
class Math:
    """A formula inside a line, in LaTeX."""

    latex: str


@dataclass(frozen=True)
class BreakableMath:
    """A long formula inside a line; the line may break between its terms."""

    parts: tuple[str, ...]


@dataclass(frozen=True)
class Strong:
    """Text that stands out."""

    text: str


@dataclass(frozen=True)
class Code:
    """Text to be typed as it is."""

    text: str


NumberText = number_text.NumberText
Inline: TypeAlias = str | Math | BreakableMath | Strong | Code | NumberText
Text: TypeAlias = tuple[Inline, ...]
Cell: TypeAlias = Inline | Text


def inlines(cell: Cell) -> Text:
    """A cell as a sequence of inline parts."""
    return cell if isinstance(cell, tuple) else (cell,)


@dataclass(frozen=True)
class Paragraph:
    text: Text


@dataclass(frozen=True)
class Listing:
    """Points one below the other."""

    items: tuple[Text, ...]


@dataclass(frozen=True)
class Facts:
    """A word and what is to be said to it."""

    rows: tuple[tuple[str, Text], ...]


@dataclass(frozen=True)
class Remark:
    """Something the reader must not miss: ``kind`` is error, warning or note."""

    kind: str
    text: Text


@dataclass(frozen=True)
class Formula:
    """A formula on a line of its own, numbered."""

    latex: str


@dataclass(frozen=True)
class Equations:
    """Long equations, one below the other, that may break between terms."""

    rows: tuple[BreakableMath, ...]


@dataclass(frozen=True)
class Heading:
    """Head of a column: its text, its unit, whether numbers stand under it, whether it takes what room is left."""

    text: Cell
    unit: str = ""
    numeric: bool = False
    wide: bool = False

    @property
    def bracket(self) -> str:
        """The unit as it stands behind the text, empty if there is none."""
        return number_text.unit_in_brackets(self.unit)


@dataclass(frozen=True)
class TableGroup:
    """Rows under a heading of their own, which may be empty."""

    rows: tuple[tuple[Cell, ...], ...]
    title: Cell = ""


@dataclass(frozen=True)
class TableBlock:
    """A table with its caption; ``more`` counts the rows left out."""

    caption: Text
    columns: tuple[Heading, ...]
    groups: tuple[TableGroup, ...]
    notes: tuple[Text, ...] = ()
    more: int = 0

    def column(self, index: int) -> list[Cell]:
        """The cells below a heading, of all groups."""
        return [row[index] for group in self.groups for row in group.rows]

    def numbers(self, index: int) -> list[NumberText]:
        """The numbers among them."""
        return [cell for cell in self.column(index) if isinstance(cell, NumberText)]

    def decimals(self, index: int) -> int:
        """Digits behind the point that the numbers of a column need to stand below each other."""
        return max((number.decimals_shown for number in self.numbers(index)), default=0)

    @property
    def foot_notes(self) -> tuple[Text, ...]:
        """What stands below the table: its notes, and how many rows are left out."""
        return (*self.notes, *([(f"… and {self.more} more",)] if self.more else []))


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure: name of its file, the drawing, the caption, and the caption for those who cannot see it."""

    name: str
    figure: Figure
    caption: Text
    alt: str


@dataclass(frozen=True)
class Details:
    """Something long that a page folds away behind its title; paper has a sentence ``instead``."""

    title: Text
    blocks: tuple[Block, ...]
    instead: Text


@dataclass(frozen=True)
class Section:
    """A heading and what stands below it, further sections included."""

    name: str
    title: Text
    blocks: tuple[Block, ...]


Block: TypeAlias = Paragraph | Listing | Facts | Remark | Formula | Equations | TableBlock | Picture | Details | Section


@dataclass(frozen=True)
class Report:
    """A whole report; ``template`` is the folder that says how it looks."""

    title: str
    subtitle: str
    facts: Facts
    notes: Text
    sections: tuple[Section, ...]
    author: str = ""
    date: str = ""
    template: TemplateFolder | None = None

    @property
    def pictures(self) -> Iterator[Picture]:
        """Every figure in the order of the text."""
        stack: list[Block] = list(reversed(self.sections))
        while stack:
            block = stack.pop()
            if isinstance(block, Picture):
                yield block
            elif isinstance(block, (Section, Details)):
                stack += reversed(block.blocks)
