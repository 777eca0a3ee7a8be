"""Notes on laws over frequency that are read beyond the rows of their tables, for every result that reads them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.system import Assembly

ROUNDED_FREQUENCY = 1e-9
"""Relative distance from the first or last row up to which a frequency is at the row."""


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
    at = np.asarray(frequencies, dtype=float)
    at = at[np.isfinite(at)]
    found: dict[str, str] = {}
    for law, table in assembly.system.dynamic:
        rows, owner = table.rows, assembly.owners[law]
        if len(rows) < 2 or not at.size:
            continue
        beyond = []
        if at.min() < rows[0] * (1 - ROUNDED_FREQUENCY):
            beyond.append(f"from {at.min():.6g} Hz, where the first row is kept")
        if at.max() > rows[-1] * (1 + ROUNDED_FREQUENCY):
            beyond.append(f"at up to {at.max():.6g} Hz, where the last row is kept")
        if beyond:
            text = f"{owner}: the rows of its table go from {rows[0]:.6g} to {rows[-1]:.6g} Hz"
            found[owner] = f"{text}, and it is read {', and '.join(beyond)}"
    return tuple(found.values())
