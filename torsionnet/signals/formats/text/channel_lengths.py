"""Checks of the lengths of channels in a text file, and notes on empty cells."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.base.delimited.number_rows import NumberRows
from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.records.source import FileChannel


def check_lengths(rows: NumberRows, channels: Sequence[FileChannel], file: str) -> None:
    """Refuse rows of a text file of which the last are empty in some of the channels, after all were read."""
    lengths = {channel.name: int(rows.filled[channel.column]) for channel in channels}
    if len(set(lengths.values())) > 1:
        sizes = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ModelError([Fault(f"channels of different lengths: {sizes} values")], file)


class EmptyCells:
    """Note on how many cells of a text file were empty so far, among the other notes on the file."""

    def __init__(self, discovered: list[NoteOrText]) -> None:
        self.discovered = discovered
        self.said = ""

    def count(self, rows: NumberRows, columns: Sequence[int]) -> None:
        """Put the number of cells that are empty by now in place of the one before."""
        empty = int(rows.empty[list(columns)].sum())
        if empty:
            kept = [note for note in self.discovered if note != self.said]
            self.said = f"{empty} empty cells are NaN"
            self.discovered[:] = [*kept, self.said]
