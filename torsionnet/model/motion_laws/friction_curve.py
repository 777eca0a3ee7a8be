"""Torque curves of dry friction over the slip speed, constant or by rows, with the torque that sticks."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from torsionnet.model.element_base.spring_stages import NumberRows
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope, symmetric_curve


def friction_curve(torque: Any, stick: Any) -> PieceCurve:
    """Curve of Coulomb friction: T sgn(gamma') against the slip, and anything from -T_s to T_s while it sticks.

    >>> friction_curve(20, 30).torque(0, -1), friction_curve(20, 30).pieces[1]
    (-20, Hold(at=0, low=-30, high=30))
    """
    return symmetric_curve("rate", (Hold(0, -stick, stick), Slope(torque, lower=0)))


def slip_curve(rows: NumberRows, stick: Any = None) -> PieceCurve:
    """Curve of friction by rows [slip speed, torque] from slip zero on, the same both ways, up to the last row.

    It sticks up to ``stick``, by default the torque at slip zero.

    >>> slip_curve(((0, 20.0), (10, 15.0))).torque(0, -4)
    -18.0
    """
    above = _slopes(rows)
    held = rows[0][1] if stick is None else stick
    return symmetric_curve("rate", (Hold(0, -held, held), *above))


def clutch_curve(rows: NumberRows, stick: Any = None) -> PieceCurve:
    """Curve of the faces of a clutch by rows [slip speed, torque or friction coefficient], up to the last row.

    Rows from slip zero on hold both ways and stick up to ``stick``, by default the first of them; rows through negative
    slips hold as they are, without a step.

    >>> curve = clutch_curve(((0, 20.0), (10, 15.0)))
    >>> curve.torque(0, -4), curve.pieces[1]
    (-18.0, Hold(at=0, low=-20.0, high=20.0))
    """
    if stick is not None:
        return slip_curve(rows, stick)
    slopes = _slopes(rows)
    return symmetric_curve("rate", slopes) if rows[0][0] == 0 else PieceCurve("rate", slopes)


def _slopes(rows: NumberRows) -> tuple[Slope, ...]:
    """Straight pieces over the slip between rows [slip speed, torque]."""
    found = []
    for (start, low), (end, high) in pairwise(rows):
        slope = (high - low) / (end - start)
        found.append(Slope(low - slope * start, 0, slope, start, end))
    return tuple(found)
