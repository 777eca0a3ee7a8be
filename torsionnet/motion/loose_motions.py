"""Motions without inertia that nothing but friction fixes, as those of a node between two frictions.

Such a node takes at once the rate at which its torques are in balance. Where all friction beside it slips, its torques
are constant, so that it runs on until as many of the frictions stick as it has motions; those that stick carry no
more than they hold. This is the minimum over the rates w of sum_i T_i |r_i + n_i w| - f w.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray

AT_REST = 1e-12
"""Share of the largest rate up to which a slip counts as just begun."""
BEGUN = 1e-9
"""Rate of a slip that has just begun, over the largest rate, of the first one: no two are equal and end at once."""
HOLDING = 1e-9
"""Share of what friction holds by which it may seem to carry more by rounding."""
PARALLEL = 1e-9
"""Determinant of the ways of frictions, over their sizes, from which they fix a motion."""


class LooseMotionError(UsageError):
    """Error of motions (n_q, n) without inertia that nothing fixes in a contact state."""

    def __init__(self, text: str, motions: FloatArray) -> None:
        super().__init__(text)
        self.motions = motions


@dataclass(frozen=True)
class Slip:
    """Friction that slips beside a loose motion.

    Attributes
    ----------
    way : (n,) array
        Rate of the slip per rate of each loose motion.
    rate : float
        Rate of the slip in rad/s.
    sign : int
        Direction of its torque.
    torque : float
        Size of its torque in N m while it slips.
    holds : float
        Torque in N m that it holds.
    """

    way: FloatArray
    rate: float
    sign: int
    torque: float
    holds: float


def balanced_slips(slips: Sequence[Slip], outside: FloatArray) -> FloatArray | None:
    """Rates (n_slips,) in rad/s at which loose motions are in balance, those that stick exactly 0; None without any.

    ``outside`` (n,) are the torques in N m on the loose motions from outside.
    """
    ways, rates = np.array([one.way for one in slips]), np.array([one.rate for one in slips])
    torques, holds = (np.array([getattr(one, name) for one in slips]) for name in ("torque", "holds"))
    size = np.abs(rates).max(initial=0.0) or 1.0
    begun = np.array([one.sign for one in slips]) * BEGUN * size * (1 + np.arange(len(slips)) / len(slips))
    rates = np.where(np.abs(rates) <= AT_REST * size, begun, rates)
    for chosen in combinations(range(len(slips)), ways.shape[1]):
        stick = list(chosen)
        own = ways[stick]
        if abs(np.linalg.det(own)) <= PARALLEL * np.prod(np.abs(own).max(axis=1)):
            continue
        left = rates - ways @ np.linalg.solve(own, rates[stick])
        left[stick] = 0.0
        carried = np.linalg.solve(own.T, outside - ways.T @ (torques * np.sign(left)))
        if (np.abs(carried) <= holds[stick] * (1 + HOLDING)).all():
            return np.asarray(left)
    return None
