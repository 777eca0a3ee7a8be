"""Motions of coordinates in which rows are held still, as by friction that sticks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray

DEPENDENT = 1e-9
"""Size of a pivot, over the entries of its row, below which held rows depend on each other: ratios of real machinery
meet to 1e-11 or differ by more than 1e-6."""


@dataclass(frozen=True, eq=False)
class Held:
    """Motions q = Z y + Y c of coordinates in which rows are held at c, with y = q[free]."""

    Z: FloatArray
    Y: FloatArray
    free: tuple[int, ...]


def held_motions(rows: FloatArray, owners: Sequence[str]) -> Held:
    """Motions of coordinates in which rows (n_rows, n_q) are held, by elimination of one coordinate for each row.

    Raises
    ------
    UsageError
        Rows depend on each other: the parts stick in a loop.
    """
    left, made = rows.copy(), np.eye(len(rows))
    pivots: list[int] = []
    for number in range(len(rows)):
        for other, pivot in enumerate(pivots):
            factor = left[number, pivot]
            left[number] -= factor * left[other]
            made[number] -= factor * made[other]
        left[number, pivots] = 0.0
        pivot = int(np.abs(left[number]).argmax())
        if np.abs(left[number, pivot]) <= DEPENDENT * np.abs(rows[number]).max():
            names = [owners[one] for one in np.flatnonzero(np.abs(made[number]) > DEPENDENT).tolist()]
            text = "stick in a loop, so that their torques do not follow from equilibrium"
            raise UsageError(f"{' and '.join(dict.fromkeys(names))} {text}; give one of them a stiffness")
        made[number] /= left[number, pivot]
        left[number] /= left[number, pivot]
        for other in range(number):
            factor = left[other, pivot]
            left[other] -= factor * left[number]
            made[other] -= factor * made[number]
        pivots.append(pivot)
    n = rows.shape[1]
    free = tuple(column for column in range(n) if column not in pivots)
    Z, Y = np.zeros((n, len(free))), np.zeros((n, len(rows)))
    Z[list(free), range(len(free))] = 1.0
    Z[pivots], Y[pivots] = -left[:, list(free)], made
    return Held(Z, Y, free)
