"""Loop of arc springs about a mean torque: in closed form, marched where the flange leaves them."""

from __future__ import annotations

import math
from functools import lru_cache

from torsionnet.model.arc_spring.segment_chain import marched_loop, segments_needed
from torsionnet.model.arc_spring.slow_loop import ArcSprings, SlowLoop, closed_loop, loop_from_top

LOCKED_SHARE = 0.75 - 2 / math.pi
"""Factor of S^2 in the mean torque of a loop with locked coils, where v = S/2 + sqrt(u_m - .1134 S^2)."""
LOSS_SHARE = 0.002
"""Largest share by which a chain of segments may miss the loss of a cycle."""
FIRST_SEGMENTS = 40
"""Segments of the first march, which tells the depth that the swing reaches."""
MOST_SEGMENTS = 400
"""Segments beyond which a march would not tell more than how small the swing is."""
STEPS = 60
"""Halvings of the interval of a mean, to the last digit of a double."""
SAME_TWIST = 1e-8
"""Share by which a marched loop may miss its mean twist."""


@lru_cache(maxsize=4096)
def loop_at_torque(springs: ArcSprings, amplitude: float, mean_torque: float) -> SlowLoop:
    """Slow loop of an amplitude in rad, the mean torque in N m of which over time, under a sine of twist, is given.

    The springs are loaded once from nothing to the top and then swing. Where the flange leaves them in the cycle, as
    without mean torque, a chain of segments is marched, as many as its loss needs.

    >>> springs = ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, 3000 * math.pi / 30)
    >>> loop = loop_at_torque(springs, math.radians(2), 276.2278014)
    >>> round(loop.secant_stiffness, 3), round(math.degrees(loop.mean_twist), 6)
    (2933.899, 20.0)
    """
    if mean_torque < 0:
        return loop_at_torque(springs, amplitude, -mean_torque).mirrored()
    top = _top(springs, amplitude, mean_torque)
    if top is not None:
        loop = closed_loop(springs, amplitude, springs.first_twist(top) - amplitude)
        if loop is not None:
            return loop
    return _marched(springs, amplitude, mean_torque)


def _top(springs: ArcSprings, amplitude: float, mean_torque: float) -> float | None:
    """Torque in N m at the top of the loop with a mean torque, or None where the flange leaves the springs."""
    u, swing = mean_torque + springs.base, 2 * amplitude
    # Locked coils: u_t = v^2, u_b = (v - S)^2 with S^2 = k e q, and mean u = v^2 - v S + S^2 (1 - 2/pi).
    square = springs.stiffness * springs.winding * swing
    if u > LOCKED_SHARE * square:
        root = math.sqrt(u - LOCKED_SHARE * square) + math.sqrt(square) / 2
        loop = loop_from_top(springs, amplitude, root**2 - springs.base)
        if loop is not None and loop.depth < 1:
            return loop.top
    low, high = mean_torque, mean_torque + (springs.stiffness * swing + springs.base) * math.exp(2 * springs.winding)
    for _ in range(STEPS):
        middle = (low + high) / 2
        loop = loop_from_top(springs, amplitude, middle)
        low, high = (middle, high) if loop is None or loop.mean_torque < mean_torque else (low, middle)
    loop = loop_from_top(springs, amplitude, high)
    return high if loop is not None and math.isclose(loop.mean_torque, mean_torque, rel_tol=1e-9) else None


def _marched(springs: ArcSprings, amplitude: float, mean_torque: float) -> SlowLoop:
    """Loop in which the flange leaves the springs: about the mean twist that gives the mean torque."""
    from scipy.optimize import brentq

    segments = FIRST_SEGMENTS
    depth = marched_loop(springs, amplitude, springs.first_twist(mean_torque), segments).depth
    segments = min(MOST_SEGMENTS, max(segments, segments_needed(max(depth, 1 / segments), LOSS_SHARE)))

    def over(twist: float) -> float:
        return marched_loop(springs, amplitude, twist, segments).mean_torque - mean_torque

    # The mean torque rises with the mean twist, also in steps. About no twist it is below none, as coils stay where
    # the first loading left them, or none.
    highest = springs.first_twist(mean_torque) + 2 * amplitude
    below = over(0.0) < -SAME_TWIST * springs.stiffness * amplitude
    mean_twist = brentq(over, 0.0, highest, rtol=SAME_TWIST) if below else 0.0
    return marched_loop(springs, amplitude, mean_twist, segments)
