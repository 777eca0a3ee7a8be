"""Notes on laws over frequency that are read beyond the rows of their tables, for every result that reads them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.linear.assembly.rows import Assembly, FloatArray

ROUNDED_FREQUENCY = 1e-9
"""Relative distance from the first or last row up to which a frequency is at the row."""
Told = Callable[[Assembly, FloatArray], None]
"""Function that is told of drivetrains and of the frequencies in Hz at which results read their tables."""
_TOLD: ContextVar[Told | None] = ContextVar("told", default=None)
"""Function that is told of frequencies in the current context, None for nobody."""


@contextmanager
def told_of_reads(told: Told | None) -> Iterator[None]:
    """Context manager in which ``told`` is called for every result that reads tables over frequency.

    What makes many results, such as a report or a function of a user, so notes all of them at once. None for what is
    calculated on the way and not shown.
    """
    token = _TOLD.set(told)
    try:
        yield
    finally:
        _TOLD.reset(token)


@dataclass(frozen=True)
class TableReads:
    """Frequencies at which tables over frequency are read, as far as they lie beyond the rows.

    Attributes
    ----------
    spans : dict
        (element, first row, last row) -> lowest and highest frequency read, all in Hz.
    """

    spans: dict[tuple[str, float, float], tuple[float, float]] = field(default_factory=dict)

    def add(self, assembly: Assembly, frequencies: FloatArray) -> None:
        """Count frequencies (n,) in Hz at which the tables of a drivetrain are read."""
        if not frequencies.size:
            return
        low, high = float(frequencies.min()), float(frequencies.max())
        for law, table in assembly.system.dynamic:
            if len(table.rows) > 1:
                key = assembly.owners[law], float(table.rows[0]), float(table.rows[-1])
                known = self.spans.get(key, (low, high))
                self.spans[key] = min(low, known[0]), max(high, known[1])

    def notes(self) -> tuple[str, ...]:
        """Note on each element whose table ends before some of the frequencies."""
        notes: dict[str, str] = {}
        for (owner, first, last), (low, high) in self.spans.items():
            beyond = []
            if low < first * (1 - ROUNDED_FREQUENCY):
                beyond.append(f"from {low:.6g} Hz, where the first row is kept")
            if high > last * (1 + ROUNDED_FREQUENCY):
                beyond.append(f"at up to {high:.6g} Hz, where the last row is kept")
            if beyond:
                text = f"{owner}: the rows of its table go from {first:.6g} to {last:.6g} Hz"
                notes[owner] = f"{text}, and it is read {', and '.join(beyond)}"
        return tuple(notes.values())


def range_notes(assembly: Assembly, frequencies: ArrayLike) -> tuple[str, ...]:
    """Notes on elements whose tables over frequency end before some of the frequencies in Hz at which they are read.

    A table of one row holds everywhere.

    Examples
    --------
    >>> import torsionnet as tn
    >>> bush = tn.TabulatedSpring("bush", nodes=("a", "ground"), table=[[1, 400, 2], [20, 800, 1]])
    >>> rig = tn.Drivetrain("rig", [tn.Inertia("disc", node="a", inertia=1e-3), bush])
    >>> print(*range_notes(rig.assembly, [5, 163.0]))
    bush: the rows of its table go from 1 to 20 Hz, and it is read at up to 163 Hz, where the last row is kept
    """
    if not assembly.system.dynamic:
        return ()
    at = np.asarray(frequencies, dtype=float).ravel()
    at = at[np.isfinite(at)]
    told = _TOLD.get()
    if told is not None:
        told(assembly, at)
    reads = TableReads()
    reads.add(assembly, at)
    return reads.notes()
