"""Numbers of sections, tables, figures and formulas, the same in every file format of a report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from torsionnet.report.document_tree import Block, Details, Formula, Picture, Section, TableBlock


@dataclass(frozen=True)
class NumberedBlock:
    """Block of a report with its number and the blocks inside it.

    Attributes
    ----------
    block : Block
    number : str
        ``2.1`` of a section, ``3`` of a table, figure or formula, else empty.
    inner : tuple of NumberedBlock
        What stands in a section, or folded away.
    """

    block: Block
    number: str = ""
    inner: tuple[NumberedBlock, ...] = ()

    @property
    def kind(self) -> str:
        """Name of the block's class, by which templates choose what to write."""
        return type(self.block).__name__

    @property
    def level(self) -> int:
        """Depth of a block's section in the report, as the number of sections around it."""
        return self.number.count(".")


def number_blocks(blocks: Sequence[Block], *, folds: bool = False) -> tuple[NumberedBlock, ...]:
    """Blocks of a report with their numbers; without ``folds`` the blocks that are folded away are left out."""
    return _Numbers(Counter(), folds).of(blocks)


@dataclass(frozen=True)
class _Numbers:
    """Counter of tables, figures and formulas in the order of the text.

    What is folded away counts for itself, after an S: paper, which leaves it out, has the same numbers without it.
    """

    counts: Counter[str]
    folds: bool
    series: str = ""

    def of(self, blocks: Sequence[Block], above: str = "") -> tuple[NumberedBlock, ...]:
        found, sections = [], 0
        for block in blocks:
            if isinstance(block, Section):
                sections += 1
                number = f"{above}{sections}"
                found.append(NumberedBlock(block, number, self.of(block.blocks, f"{number}.")))
            elif isinstance(block, Details):
                folded = _Numbers(self.counts, self.folds, "S").of(block.blocks) if self.folds else ()
                found.append(NumberedBlock(block, inner=folded))
            elif isinstance(block, TableBlock | Picture | Formula):
                what = self.series + type(block).__name__
                self.counts[what] += 1
                found.append(NumberedBlock(block, f"{self.series}{self.counts[what]}"))
            else:
                found.append(NumberedBlock(block))
        return tuple(found)


# Rows of a table between which a page may end, in printed HTML and in Word.

MOST_UNBROKEN_ROWS = 6
"""Number of rows of a table, titles of groups too, up to which it is not split between two printed pages: with head and
notes a fifth of a page, which may stay empty. Of longer ones two rows stay together at either end."""


def stays_whole(block: TableBlock) -> bool:
    """Whether a table is short enough to stay on one page: up to six rows, titles of groups counted."""
    return sum(len(group.rows) + bool(group.title) for group in block.groups) <= MOST_UNBROKEN_ROWS


def rows_kept(block: TableBlock) -> Iterator[bool]:
    """Whether each row of a table, without titles of groups, stays on the page of the row below; the last one does not.

    In a table that may be split those are its first row, the last but one, and the first below the title of a group.

    Examples
    --------
    >>> from torsionnet.report.document_tree import Heading, TableGroup
    >>> rows = tuple((str(number),) for number in range(4))
    >>> list(rows_kept(TableBlock(("Two groups",), (Heading("No."),), (TableGroup(rows), TableGroup(rows, "Below")))))
    [True, False, False, False, True, False, True, False]
    """
    whole = stays_whole(block)
    places = [(place == 0 and bool(group.title)) for group in block.groups for place in range(len(group.rows))]
    for number, titled in enumerate(places):
        last = number == len(places) - 1
        yield not last and (whole or titled or number in (0, len(places) - 2))
