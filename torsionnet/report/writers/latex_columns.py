r"""Layout of tables in LaTeX and Word: which columns stand side by side, and how wide each is, within the margin.

Widths are counted in letters of the size of tables. A table that is too wide first breaks its headings and its texts;
if that is not enough it goes on below, its first column repeated.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.report.document_tree import (
    BreakableMath,
    Cell,
    Code,
    Heading,
    Inline,
    Math,
    NumberText,
    Strong,
    TableBlock,
    inlines,
)

PAGE_LETTERS, GAP_LETTERS, FEWEST_LETTERS = 98, 2, 10
"""Width in letters of the page, of the gap between two columns, and of the narrowest column of text."""
MATRIX_LETTERS = 48
"""Width in letters of a matrix in a LaTeX table above which the matrix is made smaller."""
LONGEST_WORD = 20
"""Largest number of letters of a word in a LaTeX table that stays in one piece."""

_MARKUP = re.compile(r"(begin|end)\{bmatrix\}|\\[a-zA-Z]+|[{}_^~\\ &]")
_BREAKS = re.compile(r"(?<=[=,/_+])|(?<=\S)[ \n\t]+")


@dataclass(frozen=True)
class Columns:
    """Numbers, widths and headings of the columns in one piece of a LaTeX table."""

    indices: tuple[int, ...]
    widths: tuple[float | None, ...]
    headings: tuple[tuple[Cell, ...], ...]

    def spec(self, block: TableBlock) -> str:
        """Text of the columns' specification for a ``longtable``.

        Each width as measured before in its length, or as a share of the room that those leave.
        """
        broken = sum(width for width in self.widths if width is not None)
        parts = []
        for place, (index, width) in enumerate(zip(self.indices, self.widths, strict=True)):
            side = "left" if block.columns[index].numeric else "right"
            wide = length_name(place) if width is None else rf"{width / broken:.3f}\textroom"
            parts.append(rf">{{\ragged{side}\arraybackslash}}p{{{wide}}}")
        return "@{}" + "".join(parts) + "@{}"


def length_name(place: int) -> str:
    r"""Name of the LaTeX length that holds the width of a column.

    >>> length_name(0), length_name(27)
    ('\\widthA', '\\widthAB')
    """
    letters = chr(ord("A") + place % 26)
    return rf"\width{'A' * (place // 26)}{letters}"


def table_pieces(block: TableBlock) -> list[Columns]:
    """Pieces into which a LaTeX table is split, one below the other.

    The whole table if it fits, if need be with broken texts.
    """
    everything = tuple(range(len(block.columns)))
    loose = [natural_width(block, index) for index in everything]
    if sum(loose) + GAP_LETTERS * len(loose) <= PAGE_LETTERS:
        return [Columns(everything, (None,) * len(loose), tuple((_title(column),) for column in block.columns))]
    least = [_least(block, index) for index in everything]
    groups: list[list[int]] = [[0]]
    for index in everything[1:]:
        if len(groups[-1]) > 1 and sum(least[i] + GAP_LETTERS for i in (*groups[-1], index)) > PAGE_LETTERS:
            groups.append([0])
        groups[-1].append(index)
    return [_fitted(block, tuple(group), least) for group in groups]


def _fitted(block: TableBlock, indices: tuple[int, ...], least: Sequence[float]) -> Columns:
    """Widths and headings of the columns in one piece of a LaTeX table.

    Those with text share the room that is left, by how much text they have.
    """
    room = PAGE_LETTERS - GAP_LETTERS * len(indices) - sum(least[index] for index in indices)
    wanted = {index: max(natural_width(block, index) - least[index], 0) for index in indices}
    total = sum(wanted.values())
    share = min(1.0, max(room, 0) / total) if total else 0.0
    wide = {index: least[index] + share * wanted[index] for index in indices}
    widths = tuple(wide[index] if wanted[index] and can_break(block, index) else None for index in indices)
    headings = tuple(
        (_title(block.columns[index]),) if width is not None else heading_lines(block.columns[index], wide[index])
        for index, width in zip(indices, widths, strict=True)
    )
    return Columns(indices, widths, headings)


def is_matrix(cell: Cell) -> bool:
    """Whether a cell of a table is a matrix."""
    return isinstance(cell, Math) and "matrix" in cell.latex


def can_break(block: TableBlock, index: int) -> bool:
    """Whether lines may break in a column of a LaTeX table: in texts, not in numbers and matrices."""
    return not block.columns[index].numeric and not any(map(is_matrix, block.column(index)))


def _title(column: Heading) -> Cell:
    return (*inlines(column.text), f" {column.bracket}") if column.bracket else column.text


def heading_lines(column: Heading, width: float) -> tuple[Cell, ...]:
    """Lines of a column's heading no wider than its column, as far as the heading has spaces.

    The unit has a line of its own.
    """
    unit = [column.bracket] if column.bracket else []
    if not isinstance(column.text, str):
        whole = _title(column)
        return (whole,) if len(visible_text(whole)) <= width else (column.text, *unit)
    lines: list[str] = []
    for word in [*column.text.split(), *unit]:
        if lines and len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return tuple(lines)


def natural_width(block: TableBlock, index: int) -> float:
    """Width in letters of the widest cell of a column, or of its heading."""
    return max(len(visible_text(_title(block.columns[index]))), content_width(block, index))


def content_width(block: TableBlock, index: int) -> int:
    """Width in letters of the widest cell of a column, its heading left out."""
    cells, decimals = block.column(index), block.decimals(index)
    whole = max((len(number.mantissa.partition(".")[0]) for number in block.numbers(index)), default=0)
    aligned = whole + decimals + (decimals > 0)
    return max(
        [
            aligned,
            *(min(len(visible_text(c)), MATRIX_LETTERS) if is_matrix(c) else len(visible_text(c)) for c in cells),
        ],
        default=0,
    )


def _least(block: TableBlock, index: int) -> float:
    """Least width in letters that a column of a LaTeX table needs."""
    column = block.columns[index]
    words = [len(word) for word in visible_text(column.text).split()] + [len(column.unit) + 2 if column.unit else 0]
    if any(is_matrix(cell) for cell in block.column(index)):
        return min(content_width(block, index), MATRIX_LETTERS)
    if not can_break(block, index):
        return min(max([content_width(block, index), *words]), PAGE_LETTERS - 2 * GAP_LETTERS)
    longest = max((_longest(cell) for cell in block.column(index)), default=0)
    return min(natural_width(block, index), max(FEWEST_LETTERS, longest, *words))


def _longest(cell: Cell) -> int:
    """Number of letters in the longest part of a cell that cannot be broken over lines."""
    found = [0]
    for part in inlines(cell):
        if isinstance(part, str):
            found += [min(len(word), LONGEST_WORD) for word in _BREAKS.split(part)]
        elif isinstance(part, BreakableMath):
            found += [len(visible_text(Math(latex))) + 2 for latex in part.parts]
        else:
            found.append(len(visible_text(part)))
    return max(found)


def visible_text(cell: Cell) -> str:
    """Text of a cell roughly as it is printed, for counting letters."""
    return "".join(map(_letters, inlines(cell)))


def _letters(part: Inline) -> str:
    match part:
        case Math(latex):
            rows = (_rowed(row) for row in latex.split(r"\\"))
            return max(rows, key=len)
        case BreakableMath(parts):
            return "   ".join(_letters(Math(latex)) for latex in parts)
        case Strong(text) | Code(text):
            return text
        case NumberText():
            return part.mantissa + ("·10^-9" if part.exponent is not None else "")
    return part


def _rowed(latex: str) -> str:
    """Text of one row of a LaTeX formula for counting letters, with gaps between columns and around operators."""
    bare = re.sub(_MARKUP, "", latex.replace("&", "ooo").replace(r"\cdot", "o"))
    return re.sub(r"(?<=[^ ])[-+=](?=[^ ])", "- ", bare)
