"""Refinement of speeds at which curves are calculated, until maxima and crossings no longer depend on the speed step.

Of a curve over speed the highest value matters, and where it crosses a level. Both are known once the speeds around
them lie close enough together; until then, these functions give the speeds to calculate next.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sized
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import FloatArray

RESOLVED_DROP = 0.004
"""Largest relative drop from a maximum over speed to its neighbours at which the maximum counts as resolved: its error
is 1/8 of that."""
RESOLVED_INTERVAL = 2e-4
"""Relative distance of two speeds within which a straight line gives the crossing of a level."""
LEAST_DROP = 1e-6
"""Relative drop from a maximum from which on a point tells where its top is: rounding is far smaller."""
SAME_SPEED_DISTANCE = 1e-9
"""Relative distance of two speeds below which they are the same."""
LONG_INTERVAL = 0.01
"""Relative length of a speed interval with a crossing of a level above which the middle of the interval is calculated
as well."""
HIDDEN_RISE_SHARE = 0.5
"""Share of the drop from the highest calculated value to its neighbours by which the true maximum may exceed it."""
WIDEST_START_STEP = 0.02
"""Largest relative step between speeds at the start of their refinement."""
MOST_REFINEMENTS = 10
"""Largest number of times that speeds are added to the calculated ones; each shortens the intervals around maxima and
crossings several times."""

T = TypeVar("T")
S = TypeVar("S", bound=Sized)


def refine_speeds(first: T, wanted: Callable[[T], S], looked: Callable[[T, S], T]) -> T:
    """Result over speed with values at further speeds added until ``wanted`` gives no more speeds.

    The values at wanted speeds come from ``looked``.
    """
    known = first
    for _ in range(MOST_REFINEMENTS):
        more = wanted(known)
        if not len(more):
            break
        known = looked(known, more)
    return known


def fill_speed_gaps(speeds: FloatArray) -> FloatArray:
    """Speeds in rising order, in the unit given, shape (n,), with further speeds in gaps of more than 2 %.

    Examples
    --------
    >>> fill_speed_gaps(np.array([100.0, 101.0, 105.0])).round(2).tolist()
    [100.0, 101.0, 103.0, 105.0]
    """
    rising = np.unique(speeds)
    parts = [
        np.linspace(low, high, max(1, math.ceil((high / low - 1) / WIDEST_START_STEP)), endpoint=False)
        for low, high in pairwise(rising.tolist())
    ]
    return np.concatenate([*parts, rising[-1:]])


def new_speeds(speeds: FloatArray, more: FloatArray) -> FloatArray:
    """Rising speeds (n,) of ``more``, in their unit, inside the range of ``speeds`` and different from all of them."""
    inside = np.unique(more[(more > speeds[0]) & (more < speeds[-1])])
    if not len(inside):
        return inside
    inside = inside[np.append(True, np.diff(inside) > SAME_SPEED_DISTANCE * inside[1:])]
    after = np.searchsorted(speeds, inside)
    distance = np.minimum(speeds[after] - inside, inside - speeds[after - 1])
    return np.asarray(inside[distance > SAME_SPEED_DISTANCE * inside])


def speeds_to_refine(speeds: FloatArray, curves: FloatArray, level: float | None = None) -> FloatArray:
    """Speeds (n,), in the unit of ``speeds``, at which curves have to be calculated next.

    There are none once maxima and crossings are known.

    Parameters
    ----------
    speeds : (n_speeds,) array
        Calculated speeds, rising.
    curves : (n_speeds, n_curves) array
        Curves over speed, not negative; NaN where a curve has no value.
    level : float, optional
        Limit whose crossings are wanted, and peaks and valleys that may reach it.

    Examples
    --------
    >>> speeds = np.arange(10.0, 15.0)
    >>> curve = lambda n: 1 / np.hypot(1, 5 * (n - 12.3))[:, None]
    >>> more = speeds_to_refine(speeds, curve(speeds))
    >>> bool(curve(more).max() > 0.999)
    True
    """
    further = [speed for curve in curves.T for speed in _of_curve(speeds, curve, level)]
    return new_speeds(speeds, np.array(further))


def vertex_speed(speeds: FloatArray, values: FloatArray, at: int) -> float:
    """Speed, in the unit given, of the maximum at a curve's highest value, by a parabola through three points."""
    # Around undamped resonances speeds lie so close that a wide maximum beside them does not drop between two.
    lower = np.flatnonzero(values < values[at] * (1 - LEAST_DROP))
    before, after = lower[lower < at], lower[lower > at]
    if not len(before) or not len(after):
        return float(speeds[at])
    three = [before[-1], at, after[0]]
    with np.errstate(all="ignore"):
        # Around a resonance u^-2 runs as a + b (n - n_0)^2, a parabola, where u itself is pointed.
        place, top, _ = _parabola(speeds[three], values[three] ** -2.0)
    inside = math.isfinite(top) and speeds[three[0]] <= place <= speeds[three[2]]
    return place if inside else float(speeds[at])


def _of_curve(speeds: FloatArray, curve: FloatArray, level: float | None) -> Iterator[float]:
    known = np.flatnonzero(np.isfinite(curve))
    if not len(known) or not curve[known].max() > 0:
        return
    best = float(curve[known].max())
    # Stretches between speeds without a value are curves of their own.
    for run in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1):
        x, u = speeds[run], curve[run]
        if len(run) > 2:
            yield from _around_maxima(x, u, best, level)
        if level is not None and len(run) > 1:
            yield from _around_minima(x, u, level)
            yield from _around_crossings(x, u, level)


def _around_maxima(x: FloatArray, u: FloatArray, best: float, level: float | None) -> Iterator[float]:
    for at in _maxima(u):
        # A maximum at an end has the parabola of the three outermost points.
        middle = min(max(at, 1), len(x) - 2)
        three = slice(middle - 1, middle + 2)
        drop = float(u[at] - u[three].min())
        if max(u[at] - u[max(at - 1, 0)], u[at] - u[min(at + 1, len(x) - 1)]) <= RESOLVED_DROP * u[at] or u[at] <= 0:
            continue
        with np.errstate(all="ignore"):
            # g = u^-2 is a parabola around a resonance; its minimum g_0 gives the height g_0^(-1/2).
            place, top, bend = _parabola(x[three], u[three] ** -2.0)
        # What the curve may reach between the points, by the parabola and by the drop where the parabola misleads.
        highest = max(top**-0.5 if top > 0 else math.inf, float(u[at]) + HIDDEN_RISE_SHARE * drop)
        if highest < best and not (level is not None and u[at] < level <= highest):
            continue
        # g = g_0 (1 + d) at a distance of sqrt(d g_0/bend): there u has dropped by d/2, so that the maximum counts
        # as resolved.
        yield from _in_bracket(x, at, place, math.sqrt(RESOLVED_DROP * top / bend) if top > 0 and bend > 0 else 0.0)


def _around_minima(x: FloatArray, u: FloatArray, level: float) -> Iterator[float]:
    """Yield speeds, in the unit of ``x``, around minima of a curve above a level that may truly fall below it."""
    for at in _maxima(-u):
        if not 0 < at < len(x) - 1 or u[at] <= level:
            continue
        three = slice(at - 1, at + 2)
        rise = float(u[three].max() - u[at])
        if rise <= RESOLVED_DROP * u[at] or u[at] - HIDDEN_RISE_SHARE * rise > level:
            continue
        # Around an antiresonance u^2 is a parabola.
        place, bottom, bend = _parabola(x[three], u[three] ** 2.0)
        yield from _in_bracket(
            x, at, place, math.sqrt(RESOLVED_DROP * u[at] ** 2 / bend) if bottom > 0 and bend > 0 else 0.0
        )


def _around_crossings(x: FloatArray, u: FloatArray, level: float) -> Iterator[float]:
    above = u > level
    for at in np.flatnonzero(above[1:] != above[:-1]).tolist():
        low, high = float(x[at]), float(x[at + 1])
        if high - low <= RESOLVED_INTERVAL * high:
            continue
        # Interpolated in log u, in which flanks of a resonance are straighter; the floor keeps the logarithm of a
        # zero finite.
        before, after = (float(np.log(max(value, 1e-6 * level) / level)) for value in u[at : at + 2])
        place = low + (high - low) * before / (before - after)
        # A speed on either side of the expected crossing leaves an interval that is short enough if it lies between
        # them.
        half_width = RESOLVED_INTERVAL / 2 * high
        yield min(max(place - half_width, low), high)
        yield min(max(place + half_width, low), high)
        if high - low > LONG_INTERVAL * high:
            yield (low + high) / 2


def _in_bracket(x: FloatArray, at: int, place: float, half_width: float) -> Iterator[float]:
    """Yield speeds in the unit of ``x``, around an extremum expected at ``place`` or midway to neighbouring speeds."""
    low, high = float(x[max(at - 1, 0)]), float(x[min(at + 1, len(x) - 1)])
    is_end = at in (0, len(x) - 1)
    if half_width and low < place < high:
        yield from (speed for speed in (place - half_width, place, place + half_width) if low < speed < high)
    elif half_width and is_end:
        return  # it goes on rising to the end
    if not half_width or not low < place - half_width < place + half_width < high:
        yield from ((float(x[at]) + end) / 2 for end in (low, high))


def _maxima(u: FloatArray) -> NDArray[np.intp]:
    """Indices of local maxima of a curve, ends included; the first of equal values."""
    rim = np.array([-np.inf])
    before, after = np.concatenate([rim, u[:-1]]), np.concatenate([u[1:], rim])
    return np.flatnonzero((u > before) & (u >= after))


def _parabola(x: FloatArray, g: FloatArray) -> tuple[float, float, float]:
    """Position, value and half the curvature of the minimum of a parabola through three given points.

    NaN if it has none.
    """
    h, k = float(x[1] - x[0]), float(x[2] - x[1])
    # Divided differences, g = g_1 + slope (x - x_1) + bend (x - x_1)^2, also for uneven steps.
    left, right = float(g[1] - g[0]) / h, float(g[2] - g[1]) / k
    bend = (right - left) / (h + k)
    if not (bend > 0 and math.isfinite(bend)):
        return math.nan, math.nan, math.nan
    slope = left + bend * h  # at the middle
    shift = -slope / (2 * bend)
    return float(x[1]) + shift, float(g[1]) - bend * shift**2, bend
