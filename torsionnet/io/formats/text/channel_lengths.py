"""Checks of the lengths of channels in a text file, and notes on empty cells."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.core.delimited.number_rows import NumberRows
from torsionnet.core.errors import Fault, ModelError
from torsionnet.io.records.source import FileChannel

EMPTY_CELLS_NOTE = " empty cells are NaN"
"""End of the note on a text file's empty cells, by which an earlier note is found."""


def check_lengths(rows: NumberRows, channels: Sequence[FileChannel], file: str) -> None:
    """Refuse rows of a text file of which the last are empty in some of the channels, after all were read."""
    lengths = {channel.name: int(rows.filled[channel.column]) for channel in channels}
    if len(set(lengths.values())) > 1:
        sizes = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ModelError([Fault(f"channels of different lengths: {sizes} values")], file)


def count_empty(rows: NumberRows, columns: Sequence[int], discovered: list[str]) -> None:
    """Update the note on how many cells of a text file were empty so far."""
    empty = int(rows.empty[list(columns)].sum())
    if empty:
        discovered[:] = [
            *(note for note in discovered if not note.endswith(EMPTY_CELLS_NOTE)),
            f"{empty}{EMPTY_CELLS_NOTE}",
        ]
