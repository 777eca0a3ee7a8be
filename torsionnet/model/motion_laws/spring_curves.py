"""Torque curves over twist: springs in stages with preload, rows of twist and torque, and clearances."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.spring_stages import NumberRows, SpringStage, stage_spans
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope, symmetric_curve


def stage_curve(stages: Sequence[SpringStage], value: Values) -> PieceCurve:
    """Curve of a spring in stages, the same both ways, in numbers of the algebra of ``value``.

    On stage i the torque is T_i + k_i (gamma - gamma_i), which begins at the end gamma_i of the stage before it, with
    T_i the torque there plus the preload P_i of the stage. Where P_i is not zero, the twist stands still at gamma_i
    while the torque lies between T_i - P_i and T_i, and at zero between -P_1 and P_1.

    Examples
    --------
    >>> from torsionnet.base.expressions import FLOAT
    >>> stages = (SpringStage(100, "0.1 rad"), SpringStage(400, preload="5 N*m"))
    >>> curve = stage_curve(stages, Values({}, FLOAT))
    >>> curve.torque(0.05, 0), curve.torque(0.1, 0), round(curve.torque(0.2, 0), 9), curve.torque(-0.05, 0)
    (5.0, 15.0, 55.0, -5.0)
    >>> [state.twist for state in curve.states_at(12)]
    [0.1]
    """
    above: list[Slope | Hold] = []
    for place, span in enumerate(stage_spans(stages, value)):
        twist, low = span.begin.twist, span.begin.torque
        torque = low + span.preload
        if span.preload > 0:
            above.append(Hold(twist, low if place else -span.preload, torque))
        upper = None if span.end is None else span.end.twist
        above.append(Slope(torque - span.stiffness * twist, span.stiffness, 0, twist, upper))
    return symmetric_curve("twist", tuple(above)).entered(value.algebra.number)


def twist_table_curve(rows: NumberRows) -> PieceCurve:
    """Curve of rows [twist, torque] in numbers of one algebra, joined by straight lines, which ends at the last row.

    Rows from zero on hold both ways; a torque in the first of them is that under which the springs are installed.

    Examples
    --------
    >>> curve = twist_table_curve(((-1.0, -5.0), (0.0, 20.0), (2.0, 30.0)))
    >>> curve.torque(-0.5, 0), curve.torque(1, 0), curve.energy(1), curve.range()
    (7.5, 25.0, 22.5, (-1.0, 2.0))
    """
    slopes = []
    for (start, low), (end, high) in pairwise(rows):
        stiffness = (high - low) / (end - start)
        slopes.append(Slope(low - stiffness * start, stiffness, 0, start, end))
    if rows[0][0] == 0:
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
