"""Tables wider than the screen, split into several below each other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.app.cli.terminal import SCREEN_WIDTH, table_width

if TYPE_CHECKING:
    from torsionnet.base.table import Table


def split_table(table: Table, group: int) -> Iterator[Table]:
    """Parts of a table that each fit the screen: the first column, and whole groups of ``group`` columns.

    The title stands over the first block, the notes below the last one.
    """
    start, count = 1, len(table.columns)
    while start < count:
        end = start + group
        while end < count and table_width(_columns(table, start, end + group)) <= SCREEN_WIDTH:
            end += group
        block = _columns(table, start, end)
        yield replace(block, title=table.title if start == 1 else "", notes=table.notes if end >= count else ())
        start = end


def _columns(table: Table, start: int, end: int) -> Table:
    return replace(table.chosen([0, *range(start, end)]), title="")


def blank_zero_shares(table: Table) -> Table:
    """Copy of a table of energy shares with two decimals and empty cells for zeros."""
    rows = tuple((row[0], *(share or None for share in row[1:])) for row in table.rows)
    return replace(table, columns=tuple(replace(one, decimals=2) for one in table.columns), rows=rows)
