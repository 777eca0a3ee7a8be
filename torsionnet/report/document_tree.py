"""What a report says, without a word about how it is written: the tree that HTML, LaTeX and Markdown are made of."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.report.template_folder import TemplateFolder

SMALLEST, LARGEST = 1e-4, 1e6
"""Sizes between which a number is written without a power of ten."""


@dataclass(frozen=True)
class Math:
    """A formula inside a line, in LaTeX."""

    latex: str


@dataclass(frozen=True)
class DefinitionList:
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


@dataclass(frozen=True)
class NumberText:
    """A number with so many significant digits, or with so many decimals.

    Examples
    --------
    >>> [(number.mantissa, number.exponent) for number in map(NumberText, (0.46, 13300.0, 1.106e6))]
    [('0.46', None), ('13300', None), ('1.106', 6)]
    """

    value: float | None
    digits: int = 4
    decimals: int | None = None

    @property
    def exponent(self) -> int | None:
        """Power of ten, None where the number is written without."""
        if self.value is None or not math.isfinite(self.value) or self.value == 0:
            return None
        if SMALLEST <= abs(self.value) < LARGEST or self.decimals is not None:
            return None
        return math.floor(math.log10(float(f"{abs(self.value):.{self.digits - 1}e}")))

    @property
    def mantissa(self) -> str:
        """The digits, with an ASCII minus; a dash where there is no number."""
        if self.value is None or math.isnan(self.value):
            return "–"
        if math.isinf(self.value):
            return "-∞" if self.value < 0 else "∞"
        if self.decimals is not None:
            return _positive_zero(f"{self.value:.{self.decimals}f}")
        if self.exponent is not None:
            return _trimmed(f"{self.value / 10.0**self.exponent:.{self.digits - 1}f}")
        if self.value == 0:
            return "0"
        places = self.digits - 1 - math.floor(math.log10(abs(self.value)))
        return _trimmed(f"{round(self.value, places):.{max(0, places)}f}")

    @property
    def decimals_shown(self) -> int:
        """Digits behind the point, for setting columns."""
        return len(self.mantissa.partition(".")[2]) if self.exponent is None else 0


def _trimmed(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text


def _positive_zero(text: str) -> str:
    return text.removeprefix("-") if not text.strip("-0.") else text


Inline: TypeAlias = str | Math | DefinitionList | Strong | Code | NumberText
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

    rows: tuple[DefinitionList, ...]


@dataclass(frozen=True)
class Heading:
    """Head of a column: its text, its unit, whether numbers stand under it, whether it takes what room is left."""

    text: Cell
    unit: str = ""
    numeric: bool = False
    wide: bool = False


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


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure: name of its file, the drawing, the caption, and the caption for those who cannot see it."""

    name: str
    drawn: Figure
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
