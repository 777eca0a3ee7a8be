"""Torque curves over twist: springs in stages with preload, rows of twist and torque, and clearances."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from torsionnet.core.piecewise_linear import Rows
from torsionnet.core.units import exact
from torsionnet.model.element_base.spring_stages import SpringStage, stage_ends
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope, symmetric_curve


def stage_curve(stages: Sequence[SpringStage], number: Callable[[Fraction], Any]) -> PieceCurve:
    """Curve of a spring in stages, the same both ways; ``number`` brings coefficients into an algebra.

    On stage i the torque is T_i + k_i (gamma - gamma_i), which begins at the end gamma_i of the stage before it, with
    T_i the torque there plus the preload P_i of the stage. Where P_i is not zero, the twist stands still at gamma_i
    while the torque lies between T_i - P_i and T_i, and at zero between -P_1 and P_1.

    Examples
    --------
    >>> from torsionnet.core.expressions import FLOAT
    >>> stages = (SpringStage(100, "0.1 rad"), SpringStage(400, preload="5 N*m"))
    >>> curve = stage_curve(stages, FLOAT.number)
    >>> curve.torque(0.05, 0), curve.torque(0.1, 0), round(curve.torque(0.2, 0), 9), curve.torque(-0.05, 0)
    (5.0, 15.0, 55.0, -5.0)
    >>> [state.twist for state in curve.states_at(12)]
    [0.1]
    """
    above: list[Slope | Hold] = []
    torque = twist = Fraction(0)
    for place, (stage, end) in enumerate(zip(stages, stage_ends(stages), strict=True)):
        preload, stiffness = exact(stage.preload or 0), exact(stage.stiffness)
        if preload:
            low = torque if place else -preload
            above.append(Hold(number(twist), number(low), number(torque + preload)))
        torque += preload
        upper = None if end is None else number(end.twist)
        above.append(Slope(number(torque - stiffness * twist), number(stiffness), 0, number(twist), upper))
        if end is not None:
            torque, twist = end.torque, end.twist
    return symmetric_curve("twist", tuple(above))


def twist_table_curve(rows: Rows, number: Callable[[Fraction], Any]) -> PieceCurve:
    """Curve of rows [twist, torque], joined by straight lines, which ends at the last row.

    Rows from zero on hold both ways; a torque in the first of them is that under which the springs are installed.

    Examples
    --------
    >>> from torsionnet.core.expressions import FLOAT, Number
    >>> rows = tuple((Number(twist), Number(torque)) for twist, torque in ((-1, -5), (0, 20), (2, 30)))
    >>> curve = twist_table_curve(rows, FLOAT.number)
    >>> curve.torque(-0.5, 0), curve.torque(1, 0), curve.energy(1), curve.range()
    (7.5, 25.0, 22.5, (-1.0, 2.0))
    """
    slopes = []
    for (start, low), (end, high) in pairwise((row[0].value, row[1].value) for row in rows):
        stiffness = Fraction(high - low) / (end - start)
        slopes.append(Slope(number(low - stiffness * start), number(stiffness), 0, number(start), number(end)))
    if rows[0][0].value == 0:
        return symmetric_curve("twist", tuple(slopes))
    return PieceCurve("twist", tuple(slopes))


def clearance_curve(gap: Any, stiffness: Any, damping: Any) -> PieceCurve:
    """Curve of a clearance: no torque from -gap/2 to gap/2, beyond it max(0, k d + c d') at the penetration d.

    On the positive side d = gamma - gap/2 and d' = gamma'; the negative side is its mirror image.

    >>> clearance_curve(0.2, 100, 1).torque(0.3, -50), clearance_curve(0.2, 100, 1).torque(-0.3, 0)
    (0.0, -20.0)
    """
    contact = Slope(-stiffness * gap / 2, stiffness, damping, gap / 2, None, 1)
    return symmetric_curve("twist", (Slope(lower=0, upper=gap / 2), contact))
