"""Rows of a table between which a page may end, in printed HTML and in Word."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.report.document_tree import TableBlock

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
