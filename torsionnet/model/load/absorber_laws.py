"""Laws of motion of what a load absorbs: its torque over the speed of its node, in time."""

from __future__ import annotations

import math
from itertools import pairwise

from torsionnet.model.element_base.laws import MotionLaw, Row
from torsionnet.model.load.absorber import Absorber
from torsionnet.model.motion_laws.piece_curve import PieceCurve, Slope, symmetric_curve
from torsionnet.model.motion_laws.power_curve import PowerCurve


def absorber_law(absorber: Absorber, row: Row, rated: float | None = None, ratio: float = 1.0) -> MotionLaw:
    """Law of motion of an absorber on the row of its node, over the absolute speed of that row.

    The torque is T_r (omega/omega_r)^m; that of a table has straight pieces, which go on beyond its ends and mirror
    where the table begins at rest. Torques of absorbers with an exponent of 0 or less keep the sense of the mean
    motion.

    Parameters
    ----------
    absorber : Absorber
    row : Row
        Weights of the nodes' angles in that of the absorber.
    rated : float, optional
        Rated speed of the node in rad/s, where the absorber has none itself.
    ratio : float
        A number with the sign of the mean speed of the row.

    Examples
    --------
    >>> screw = absorber_law(Absorber(torque="9 kN*m", torque_exponent=2, rated="30 rad/s"), {"prop": 1})
    >>> screw.torque(0, 15), screw.torque(0, -15)
    (2250.0, -2250.0)
    >>> pump = absorber_law(Absorber(over_speed={"10 rad/s": "5 N*m", "20 rad/s": "25 N*m"}), {"pump": 1}, ratio=-2)
    >>> pump.row, pump.torque(0, 15)
    ({'pump': -1.0}, 15.0)
    """
    forward = {node: math.copysign(1, ratio) * share for node, share in row.items()}
    if not absorber.over_speed:
        own = absorber.rated or rated
        if own is None:
            raise ValueError("an absorber with an exponent needs a rated speed")
        curve = PowerCurve(absorber.torque_at(own, own), own, absorber.torque_exponent)
        return MotionLaw(forward, curve)
    slopes = []
    for (start, low), (end, high) in pairwise(absorber.over_speed):
        slope = (high - low) / (end - start)
        slopes.append(Slope(low - slope * start, 0, slope, start, end))
    if absorber.over_speed[0][0] == 0:
        return MotionLaw(forward, symmetric_curve("rate", tuple(slopes)))
    return MotionLaw(forward, PieceCurve("rate", tuple(slopes)))
