"""Texts inside a line and tables of a report, laid out once, before any format writes them.

Widths are counted in letters of the size of tables. A table that is too wide for a page of paper first breaks its
headings and its texts; if that is not enough it has smaller letters, and if that is not enough it goes on below, where
the columns that tell its rows apart are repeated.

Texts, formulas and numbers inside a line of a report, told apart once; a format only says how each of them looks.

Which digits a number has and how many places are missing to those of its column is decided here too, and where a long
word may be broken.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

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
    TableGroup,
    Text,
    inlines,
)

# Texts, formulas and numbers inside a line of a report, told apart once; a format only says how each of them looks.

LONGEST_WORD = 20
"""Largest number of letters of a word that stays in one piece; a longer one may break after its signs."""
_MARKUP = re.compile(r"(begin|end)\{bmatrix\}|\\[a-zA-Z]+|[{}_^~\\ &]")


def signed_pieces(word: str) -> list[str]:
    """Pieces of a word behind whose signs a line may end.

    >>> signed_pieces("water=dry,coupling=warm")
    ['water=', 'dry,', 'coupling=', 'warm']
    """
    return re.split(r"(?<=[=,/_+])(?=.)", word)


class InlineWriter(ABC):
    """Writer of the texts, formulas and numbers inside a line of a report, in one format."""

    def __call__(self, cell: Cell) -> str:
        """Cell, caption or paragraph of a report in the format."""
        return "".join(map(self._part, inlines(cell)))

    def _part(self, part: Inline) -> str:
        match part:
            case Math(latex):
                return self.math(latex)
            case BreakableMath(terms):
                return self.terms(terms)
            case Strong(text):
                return self.strong(text)
            case Code(text):
                return self.code(text)
            case NumberText():
                return self.number(part)
        return self.text(part)

    def cell(self, cell: Cell, decimals: int) -> str:
        """Cell of a table in the format, a number with room for as many decimals as others in its column have."""
        return self.number(cell, decimals) if isinstance(cell, NumberText) else self(cell)

    def number(self, value: NumberText, decimals: int = 0) -> str:
        """Number in the format, with room for as many decimals as others in its column have."""
        if value.exponent is not None:
            return self.power(value.mantissa, str(value.exponent))
        missing = decimals - value.decimals_shown
        if missing <= 0 or not value.mantissa[-1:].isdigit():
            return self.digits(value.mantissa, "")
        return self.digits(value.mantissa, ("" if value.decimals_shown else ".") + "0" * missing)

    @abstractmethod
    def text(self, text: str) -> str:
        """Text of the report or of a model, in which nothing may act as markup."""

    @abstractmethod
    def math(self, latex: str) -> str:
        """Formula inside a line, which is given as LaTeX."""

    @abstractmethod
    def terms(self, terms: tuple[str, ...]) -> str:
        """Long formula inside a line, which may break between its terms."""

    @abstractmethod
    def strong(self, text: str) -> str:
        """Text in bold."""

    @abstractmethod
    def code(self, text: str) -> str:
        """Text to be typed as it stands."""

    @abstractmethod
    def digits(self, digits: str, gap: str, /) -> str:
        """Number without a power of ten; ``gap`` is what it lacks of the point and the decimals of its column."""

    @abstractmethod
    def power(self, digits: str, exponent: str, /) -> str:
        """Number with a power of ten."""


class CountedLetters(InlineWriter):
    """Text of a cell roughly as it is printed, for counting letters.

    Examples
    --------
    >>> CountedLetters()(("at ", Math(r"\\theta_{1}"), " ", NumberText(2.5e-7)))
    'at 1 2.5·10^-9'
    """

    def text(self, text: str) -> str:
        return text

    strong = code = text

    def math(self, latex: str) -> str:
        return max(map(_row_of_formula, latex.split(r"\\")), key=len)

    def terms(self, terms: tuple[str, ...]) -> str:
        return "   ".join(map(self.math, terms))

    def digits(self, digits: str, _gap: str) -> str:
        return digits

    def power(self, digits: str, _exponent: str) -> str:
        return f"{digits}·10^-9"


def _row_of_formula(latex: str) -> str:
    """Text of one row of a LaTeX formula for counting letters, with gaps between columns and around operators."""
    bare = re.sub(_MARKUP, "", latex.replace("&", "ooo").replace(r"\cdot", "o"))
    return re.sub(r"(?<=[^ ])[-+=](?=[^ ])", "- ", bare)


visible_text = CountedLetters()
"""Text of a cell roughly as it is printed, for counting letters."""


# Layout of the tables of a report, decided before any format writes them: decimals, pieces, widths, breaks of pages.

PAGE_LETTERS, GAP_LETTERS, FEWEST_LETTERS = 98, 1.5, 10
"""Width in letters of the page, of the gap between two columns, and of the narrowest column of text."""
SIZES = (1.0, 0.9, 0.86)
"""Sizes of the letters of tables as shares of the usual one, of which the first that fits is taken: the least is 7
points on paper."""
WIDE_LETTERS = 18
"""Width in letters that a column of long texts has where smaller letters make room for it: two or three words."""
MOST_KEY_SHARE = 0.5
"""Largest share of the page's width that columns repeated below may take."""
MATRIX_LETTERS = 48
"""Width in letters of a matrix in a table above which the matrix is made smaller."""
BOLD_WIDTH = 1.15
"""Width of a bold letter of a heading as a multiple of that of a plain one, so that no word is broken."""
MOST_UNBROKEN_ROWS = 6
"""Number of rows of a table, titles of groups too, up to which it is not split between two printed pages: with head and
notes a fifth of a page, which may stay empty. Of longer ones two rows stay together at either end."""
_WIDE = re.compile("[MW]")
_BREAKS = re.compile(r"(?<=[=,/_+])|[ \n\t]+")


def is_matrix(cell: Cell) -> bool:
    """Whether a cell of a table is a matrix."""
    return isinstance(cell, Math) and "matrix" in cell.latex


def longest_word(cells: Sequence[Cell]) -> int:
    """Number of letters in the longest word of the lines of a column's heading, or of cells."""
    texts = [part for cell in cells for part in inlines(cell) if isinstance(part, str)]
    return max((len(word) for text in texts for word in text.split()), default=0)


@dataclass(frozen=True)
class TableColumn:
    """Column of a report's table with its heading and the cells of all rows, and how wide they are."""

    heading: Heading
    cells: tuple[Cell, ...]

    @cached_property
    def decimals(self) -> int:
        """Number of decimals that the column needs for its points to stand below each other."""
        return max((cell.decimals_shown for cell in self.cells if isinstance(cell, NumberText)), default=0)

    @cached_property
    def content_letters(self) -> int:
        """Width in letters of the widest cell, the heading left out."""
        numbers = (cell.mantissa.partition(".")[0] for cell in self.cells if isinstance(cell, NumberText))
        # Numbers stand with their points below each other: the longest whole part, and all decimals.
        aligned = max(map(len, numbers), default=0) + self.decimals + (self.decimals > 0)
        widths = ((len(visible_text(cell)), is_matrix(cell)) for cell in self.cells)
        return max([aligned, *(min(width, MATRIX_LETTERS) if matrix else width for width, matrix in widths)])

    @cached_property
    def natural_letters(self) -> int:
        """Width in letters of the widest cell, or of the heading."""
        return max(len(visible_text(self.title)), self.content_letters)

    @cached_property
    def least_letters(self) -> float:
        """Least width in letters that the column needs."""
        heading = self.heading
        words = [len(word) for word in visible_text(heading.text).split()]
        # A bold M or W is twice as wide as a digit: units such as MN·m/rad, in brackets, would stand over the edge.
        words += [len(heading.unit) + 2 + len(_WIDE.findall(heading.unit))] if heading.unit else []
        word = BOLD_WIDTH * max(words, default=0)
        if any(map(is_matrix, self.cells)):
            return min(self.content_letters, MATRIX_LETTERS)
        if not self.can_break:
            return min(max(self.content_letters, word), PAGE_LETTERS - 2 * GAP_LETTERS)
        longest = max(map(_longest, self.cells), default=0)
        return max(word, min(self.natural_letters, max(FEWEST_LETTERS, longest)))

    @property
    def can_break(self) -> bool:
        """Whether lines may break in the column: in texts, not in numbers and matrices."""
        return not self.heading.numeric and not any(map(is_matrix, self.cells))

    @property
    def title(self) -> Cell:
        """Heading of the column in one line, its unit in brackets behind it."""
        text, bracket = self.heading.text, self.heading.bracket
        return (*inlines(text), f" {bracket}") if bracket else text

    def heading_lines(self, width: float) -> tuple[Cell, ...]:
        """Lines of the column's heading no wider than ``width``, as far as the heading has spaces.

        The unit has a line of its own.
        """
        lines: list[Cell] = []
        for word in [*_words(self.heading.text), *filter(None, [self.heading.bracket])]:
            longer: Text = (*inlines(lines[-1]), " ", *inlines(word)) if lines else inlines(word)
            if lines and len(visible_text(longer)) <= width:
                lines[-1] = visible_text(longer) if all(isinstance(part, str) for part in longer) else longer
            else:
                lines.append(word)
        return tuple(lines)


def _words(text: Cell) -> list[Cell]:
    """Words of a heading, in which formulas are parts like letters.

    >>> _words(("rubber of ", Math("k"), ", N"))
    ['rubber', 'of', (Math(latex='k'), ','), 'N']
    """
    words: list[Text] = [()]
    for part in inlines(text):
        first, *others = part.split(" ") if isinstance(part, str) else [part]
        words[-1] += (first,)
        words += [(other,) for other in others]
    written = (tuple(part for part in word if part != "") for word in words)
    return [word if len(word) > 1 else word[0] for word in written if word]


def _longest(cell: Cell) -> int:
    """Number of letters in the longest part of a cell that cannot be broken over lines."""
    letters = [0]  # of each part between two breaks; a number and the unit behind it are one
    for part in inlines(cell):
        if isinstance(part, str):
            first, *others = (min(len(word), LONGEST_WORD) for word in _BREAKS.split(part))
            letters[-1] += first
            letters += others
        elif isinstance(part, BreakableMath):
            letters += [len(visible_text(Math(term))) + 2 for term in part.parts]
        else:
            letters[-1] += len(visible_text(part))
    return max(letters)


@dataclass(frozen=True)
class PlacedColumn:
    """Column at its place in a piece of a table.

    Attributes
    ----------
    index : int
        Its number in the rows of the whole table.
    column : TableColumn
    width : float or None
        Letters of a line, where its texts break; None where it is as wide as its widest cell.
    lines : tuple
        Lines of its heading.
    """

    index: int
    column: TableColumn
    width: float | None
    lines: tuple[Cell, ...]

    @property
    def numeric(self) -> bool:
        """Whether the cells of the column are numbers, which stand at its right side."""
        return self.column.heading.numeric


Piece = tuple[PlacedColumn, ...]


@dataclass(frozen=True)
class TableLayout:
    """Table of a report with all that is decided on it before it is written."""

    block: TableBlock

    @cached_property
    def columns(self) -> tuple[TableColumn, ...]:
        """Columns of the table with their cells."""
        rows = [row for group in self.block.groups for row in group.rows]
        return tuple(
            TableColumn(heading, tuple(row[index] for row in rows)) for index, heading in enumerate(self.block.columns)
        )

    @cached_property
    def decimals(self) -> tuple[int, ...]:
        """Number of decimals of each column."""
        return tuple(column.decimals for column in self.columns)

    @cached_property
    def size(self) -> float:
        """Size of the letters as a share of the usual one: smaller where the table fits the page only so.

        Smaller, too, where long texts would stand in narrow columns otherwise.
        """
        least = sum(column.least_letters + GAP_LETTERS for column in self.columns)
        long = [column for column in self.columns if column.heading.wide and column.can_break]
        more = sum(max(0, min(column.natural_letters, WIDE_LETTERS) - column.least_letters) for column in long)
        fitting = (size for letters in (least + more, least) for size in SIZES if letters * size <= PAGE_LETTERS)
        return next(fitting, SIZES[0])

    @property
    def page_letters(self) -> float:
        """Width of the page in letters of the table's size."""
        return PAGE_LETTERS / self.size

    @cached_property
    def keys(self) -> tuple[int, ...]:
        """Indices of the first columns that tell the rows of each group apart, as far as half the page holds them."""
        width, rows = 0.0, [group.rows for group in self.continued]
        for index, column in enumerate(self.columns):
            width += column.least_letters + GAP_LETTERS
            if index and width > MOST_KEY_SHARE * self.page_letters:
                return tuple(range(index))
            names = [[tuple(map(visible_text, row[: index + 1])) for row in group] for group in rows]
            if all(len(set(group)) == len(group) for group in names):
                return tuple(range(index + 1))
        return (0,)

    @cached_property
    def continued(self) -> tuple[TableGroup, ...]:
        """Groups of the table for the pieces that go on below: first cells left blank are said again.

        Blank are those of rows that go on with what the row above is about; a single row that begins so is a sum.
        """
        blank = sum(row[0] == "" for group in self.block.groups for row in group.rows)
        if blank <= 1:
            return self.block.groups
        groups = []
        for group in self.block.groups:
            rows: list[tuple[Cell, ...]] = []
            for row in group.rows:
                named = next((index for index, cell in enumerate(row) if cell != ""), 0) if rows else 0
                rows.append((*(rows[-1][:named] if named else ()), *row[named:]))
            groups.append(TableGroup(tuple(rows), group.title))
        return tuple(groups)

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Pieces into which the table is split on paper, one below the other.

        The whole table if it fits, if need be with broken texts.
        """
        columns = self.columns
        if sum(column.natural_letters + GAP_LETTERS for column in columns) <= PAGE_LETTERS:
            return (tuple(PlacedColumn(i, column, None, (column.title,)) for i, column in enumerate(columns)),)
        groups = self._pieces_of_columns(self.page_letters)
        # The least width that makes no more pieces makes equal ones: no column stands alone below.
        for letters in range(round(self.page_letters / 2), round(self.page_letters)):
            if len(groups) > 1 and len(equal := self._pieces_of_columns(letters)) == len(groups):
                return tuple(map(self._fitted, equal))
        return tuple(map(self._fitted, groups))

    def _pieces_of_columns(self, letters: float) -> list[list[int]]:
        """Indices of the columns of each piece of a table whose pieces are no wider than a number of letters."""
        groups: list[list[int]] = [[]]
        for index in range(len(self.columns)):
            width = sum(self.columns[i].least_letters + GAP_LETTERS for i in (*groups[-1], index))
            begun = len(groups[-1]) > (len(self.keys) if len(groups) > 1 else 0)
            if begun and width > letters:
                groups.append([*self.keys])
            groups[-1].append(index)
        return groups

    def _fitted(self, indices: Sequence[int]) -> Piece:
        """Columns of one piece; those with text share the room that is left, by how much text they have."""
        columns = [self.columns[index] for index in indices]
        room = self.page_letters - sum(column.least_letters + GAP_LETTERS for column in columns)
        wanted = [max(column.natural_letters - column.least_letters, 0) for column in columns]
        share = min(1.0, max(room, 0) / sum(wanted)) if any(wanted) else 0.0
        placed = []
        for index, column, more in zip(indices, columns, wanted, strict=True):
            width = column.least_letters + share * more
            if more and column.can_break:
                placed.append(PlacedColumn(index, column, width, (column.title,)))
            else:
                placed.append(PlacedColumn(index, column, None, column.heading_lines(width)))
        return tuple(placed)

    @cached_property
    def stays_whole(self) -> bool:
        """Whether the table is short enough to stay on one page: up to six rows, titles of groups counted."""
        return sum(len(group.rows) + bool(group.title) for group in self.block.groups) <= MOST_UNBROKEN_ROWS

    @property
    def rows_kept(self) -> Iterator[bool]:
        """Whether each row, without titles of groups, stays on the page of the row below; the last one does not.

        In a table that may be split those are its first row, the last but one, and the first below the title of a
        group of several.

        Examples
        --------
        >>> from torsionnet.report.document_tree import TableGroup
        >>> rows = tuple((str(number),) for number in range(4))
        >>> block = TableBlock(("Two groups",), (Heading("No."),), (TableGroup(rows), TableGroup(rows, "Below")))
        >>> list(TableLayout(block).rows_kept)
        [True, False, False, False, True, False, True, False]
        """
        # A group of one row ends there: else tables of such groups would be one piece.
        titled = [
            row == 0 and bool(group.title) and len(group.rows) > 1
            for group in self.block.groups
            for row in range(len(group.rows))
        ]
        for number, first_of_several in enumerate(titled):
            last = number == len(titled) - 1
            yield not last and (self.stays_whole or first_of_several or number in (0, len(titled) - 2))


def piece_letters(piece: Piece, page_letters: float) -> list[float]:
    """Width in letters of each column of a piece with its gap, for a format that cannot measure texts.

    Where letters are too many for the page, columns give way whose words can stand on more lines.
    """
    wanted, least = [], []
    for placed in piece:
        word = BOLD_WIDTH * longest_word(placed.lines)
        content = placed.column.content_letters
        natural = placed.width
        if natural is None:
            natural = max([content, *(len(visible_text(line)) for line in placed.lines)])
        wanted.append(max(natural, word) + GAP_LETTERS)
        unbroken = content if placed.width is None else longest_word(placed.column.cells)
        least.append(min(wanted[-1], max(unbroken, word) + GAP_LETTERS))
    spare = sum(wanted) - sum(least)
    share = min(1.0, max(sum(wanted) - page_letters, 0) / spare) if spare else 0.0
    return [most - share * (most - low) for most, low in zip(wanted, least, strict=True)]
