"""Tables that are wider than a screen, as several below each other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.cli.terminal import WIDTH, width_of

if TYPE_CHECKING:
    from torsionnet.response.table import Table


def in_blocks(table: Table, group: int) -> Iterator[Table]:
    """The first column with as many groups of ``group`` columns as fit; the title stands over the first block alone."""
    start, count = 1, len(table.columns)
    while start < count:
        end = start + group
        while end < count and width_of(_columns(table, start, end + group)) <= WIDTH:
            end += group
        block = _columns(table, start, end)
        yield replace(block, title=table.title if start == 1 else "", notes=table.notes if end >= count else ())
        start = end


def _columns(table: Table, start: int, end: int) -> Table:
    return replace(table.chosen([0, *range(start, end)]), title="")


def shares_on_screen(table: Table) -> Table:
    """Percentages to two decimals, and nothing where there is none."""
    rows = tuple((row[0], *(share or None for share in row[1:])) for row in table.rows)
    return replace(table, columns=tuple(replace(one, decimals=2) for one in table.columns), rows=rows)
