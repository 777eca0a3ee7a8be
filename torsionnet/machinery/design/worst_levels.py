"""Vibration levels over several conditions of one drivetrain, of which the largest counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import Channel, FloatArray
from torsionnet.machinery.design.levels import Levels

CONDITION_OFFSET = 2.0
"""Offset between equal points of two conditions, in multiples of the highest point, so that conditions never
overlap."""


@dataclass(frozen=True, eq=False)
class WorstLevels:
    """Vibration levels of all conditions of a drivetrain at one set of values, one condition behind the other.

    Attributes
    ----------
    parts : tuple of Levels
        Of every condition, for the same values.
    highest : float
        No point is higher, of any condition.
    """

    parts: tuple[Levels, ...]
    highest: float

    @property
    def precision(self) -> float:
        """Relative precision of the levels in the least precise condition."""
        return max(one.precision for one in self.parts)

    @property
    def frequencies(self) -> FloatArray:
        return np.concatenate([one.frequencies.ravel() for one in self.parts])

    @property
    def of(self) -> tuple[str, str]:
        return self.parts[0].of

    @property
    def channel(self) -> Channel:
        return self.parts[0].channel

    @property
    def _room(self) -> float:
        return CONDITION_OFFSET * self.highest

    def condition(self, points: FloatArray) -> NDArray[np.intp]:
        """Index (n,) of the condition to which each point belongs."""
        return np.asarray(np.floor_divide(points, self._room), dtype=np.intp)

    def grid(self, values: FloatArray) -> FloatArray:
        return np.concatenate([one.grid(values) + at * self._room for at, one in enumerate(self.parts)])

    def at(self, values: FloatArray, points: FloatArray) -> FloatArray:
        found = np.empty(len(points))
        for part, chosen, own in self._split(points):
            found[chosen] = part.at(values, own)
        return found

    def slopes(self, values: FloatArray, points: FloatArray) -> FloatArray:
        found = np.empty((len(points), len(values)))
        for part, chosen, own in self._split(points):
            found[chosen] = part.slopes(values, own)
        return found

    def maxima(self, values: FloatArray) -> FloatArray:
        points = np.concatenate([one.maxima(values) + at * self._room for at, one in enumerate(self.parts)])
        return points[np.argsort(-self.at(values, points), kind="stable")]

    def shown(self, points: FloatArray) -> FloatArray:
        return self.parts[0].shown(points - self._room * self.condition(points))

    def _split(self, points: FloatArray) -> list[tuple[Levels, NDArray[np.bool_], FloatArray]]:
        """Levels of each condition that has some of the points, mask (n,) of these, and the points within it."""
        places = self.condition(points)
        return [
            (part, places == at, points[places == at] - at * self._room)
            for at, part in enumerate(self.parts)
            if (places == at).any()
        ]
