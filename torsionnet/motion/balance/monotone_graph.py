"""Torque over twist of one law as numbers that a search can follow, with steps made steep ramps."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.model.element_base.laws import MotionState
from torsionnet.model.elements import MotionLaw
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope


@dataclass(frozen=True)
class MonotoneGraph:
    """Torque in N m over the twist in rad of a law of straight pieces, or of one with a smooth curve.

    ``places`` are corners, ``torques`` the torques there, ``slopes`` those below, between and above the corners; they
    are empty for a smooth curve.
    """

    law: MotionLaw
    places: tuple[float, ...] = ()
    torques: tuple[float, ...] = ()
    slopes: tuple[float, ...] = ()

    def at(self, twist: float) -> tuple[float, float]:
        """Torque in N m and slope in N m/rad at a twist in rad."""
        if not self.slopes:
            stiffness = self.law.scale * self.law.curve.slopes(MotionState(twist))[0]
            return float(self.law.torque(twist, 0.0)), float(stiffness)
        if not self.places:
            return self.torques[0] + self.slopes[0] * twist, self.slopes[0]
        place = bisect_right(self.places, twist)
        slope, corner = self.slopes[place], max(place - 1, 0)
        return self.torques[corner] + slope * (twist - self.places[corner]), slope

    def number_at(self, twist: float) -> int | None:
        """Number of the piece of the curve in force at a twist in rad, None for a smooth curve."""
        return bisect_right(self.places, twist) if self.slopes else None

    @property
    def stiffest(self) -> float:
        """Largest stiffness in N m/rad of the pieces, that of a smooth curve at rest."""
        return max(self.slopes) if self.slopes else abs(self.at(0.0)[1])


def monotone_graph(law: MotionLaw, ramp: float) -> MonotoneGraph:
    """Graph of a law of motion over the twist at rest, with ramps of ``ramp`` times its largest stiffness."""
    curve, scale = law.curve, float(law.scale)
    if not isinstance(curve, PieceCurve):
        return MonotoneGraph(law)
    stiffest = max((float(one.stiffness) for one in curve.pieces if isinstance(one, Slope)), default=0.0) or 1.0
    places: list[float] = []
    slopes: list[float] = []
    torques: list[float] = []
    halves = [
        min(
            (float(one.high) - float(one.low)) / (2 * ramp * stiffest), _quarter(curve.pieces[max(0, number - 1) :][:3])
        )
        if isinstance(one, Hold)
        else 0.0
        for number, one in enumerate(curve.pieces)
    ]
    for number, piece in enumerate(curve.pieces):
        slopes.append(scale * float(piece.stiffness) if isinstance(piece, Slope) else scale * ramp * stiffest)
        if number + 1 == len(curve.pieces):
            break
        after = curve.pieces[number + 1]
        line = piece if isinstance(piece, Slope) else after
        assert isinstance(line, Slope)  # two steps do not follow each other
        corner = float(piece.at) if isinstance(piece, Hold) else float(piece.upper)
        places.append(corner + halves[number] - halves[number + 1])
        torques.append(scale * float(line.at(places[-1], 0.0)))
    for number, piece in enumerate(curve.pieces):  # a ramp joins the lines beside it
        if isinstance(piece, Hold) and 0 < number < len(places):
            rise, width = (found[number] - found[number - 1] for found in (torques, places))
            slopes[number] = rise / width
    if not places:
        torques = [scale * float(one.torque) for one in curve.pieces if isinstance(one, Slope)]
    return MonotoneGraph(law, tuple(places), tuple(torques), tuple(slopes))


def _quarter(around: Sequence[Slope | Hold]) -> float:
    """Quarter of the shortest of some pieces in rad, more than which no ramp takes from them."""
    ends = [(one.lower, one.upper) for one in around if isinstance(one, Slope)]
    return min((float(upper - lower) / 4 for lower, upper in ends if None not in (lower, upper)), default=math.inf)
