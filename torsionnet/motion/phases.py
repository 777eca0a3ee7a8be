"""Phases of a law of motion: straight pieces and steps of its curve, and contacts that are loose where bodies overlap.

A contact gives max(0, k d + c d') at a penetration d. Where that sum is negative the bodies are still within each
other's reach but free: the phase ``"free"`` of the piece.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from torsionnet.base.errors import UsageError
from torsionnet.model.elements import MotionLaw
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope


@dataclass(frozen=True)
class Phase:
    """Phase of a law: torque + stiffness gamma + damping gamma' in SI units between bounds, or a row held at a place.

    ``place`` is the number of the piece in its curve. Of a hold, ``lower`` and ``upper`` are both the place where the
    row is held, and ``low`` and ``high`` the torques at which it lets go.
    """

    kind: Literal["slope", "free", "hold"]
    place: int
    torque: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    lower: float = -math.inf
    upper: float = math.inf
    side: int = 0
    low: float = 0.0
    high: float = 0.0

    def at(self, twist: float, rate: float) -> float:
        """Torque in N m of the straight line of the phase at a twist in rad and a rate in rad/s."""
        return self.torque + self.stiffness * twist + self.damping * rate


@dataclass(frozen=True)
class LawPhases:
    """Phases of one law of an element, with its scale left out where that is given over time.

    ``over_rate`` says whether the bounds are rates.
    """

    owner: str
    over_rate: bool
    phases: tuple[Phase, ...]

    def of_piece(self, place: int, kind: str = "") -> int:
        """Number of the phase of a piece, of its free phase with ``kind`` "free"."""
        found = [number for number, phase in enumerate(self.phases) if phase.place == place]
        return found[-1] if kind == "free" and len(found) > 1 else found[0]

    @property
    def last_place(self) -> int:
        return self.phases[-1].place


def law_phases(owner: str, law: MotionLaw, *, scaled: bool = False) -> LawPhases:
    """Phases of a law of straight pieces, as floats; ``scaled`` leaves its scale out.

    Raises
    ------
    UsageError
        The curve is not one of straight pieces, or a law whose scale is given over time is more than a torque.
    """
    curve = law.curve
    if not isinstance(curve, PieceCurve):
        raise UsageError(f"{owner}: its torque does not follow straight pieces")
    scale = 1.0 if scaled else float(law.scale)
    phases: list[Phase] = []
    for place, piece in enumerate(curve.pieces):
        if isinstance(piece, Hold):
            at = float(piece.at)
            phases.append(
                Phase("hold", place, lower=at, upper=at, low=scale * float(piece.low), high=scale * float(piece.high))
            )
        else:
            phases += _of_slope(place, piece, scale)
    if scaled and any(one.stiffness or one.damping for one in phases):
        raise UsageError(f"{owner}: a law whose torque grows with its motion cannot be scaled over time here")
    return LawPhases(owner, curve.over == "rate", tuple(phases))


def _of_slope(place: int, piece: Slope, scale: float) -> list[Phase]:
    lower = -math.inf if piece.lower is None else float(piece.lower)
    upper = math.inf if piece.upper is None else float(piece.upper)
    torque, stiffness, damping = (scale * float(value) for value in (piece.torque, piece.stiffness, piece.damping))
    found = [Phase("slope", place, torque, stiffness, damping, lower, upper, piece.side)]
    if piece.side and damping:
        found.append(Phase("free", place, torque, stiffness, damping, lower, upper, piece.side))
    return found
