"""Between which speeds curves have to be looked at again, so that their step is of no account.

What counts of a curve over speed is its highest value, and where it comes to a level. Either is known once the speeds
around it lie close enough together; until then, these are the speeds to be looked at next.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sized
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.frequency_response import FloatArray

KNOWN = 0.004
"""Share by which the speeds on both sides of a maximum are lower at most: between them it is higher by 1/8 of that."""
END = 2e-4
"""Share of a speed: between two so close to each other, a straight line gives the crossing."""
FINEST = 1e-9
"""Share of a speed below which two of them are one."""
FAR = 0.01
"""Share of a speed: a longer interval with a crossing is halved as well."""
HIDDEN = 0.5
"""A maximum between speeds is higher than the highest of them by this share of the fall to its neighbours at most."""
WIDEST = 0.02
"""Largest share of a speed from one to the next before anything is known."""
ROUNDS = 10

T = TypeVar("T")
S = TypeVar("S", bound=Sized)


def refined(first: T, wanted: Callable[[T], S], looked: Callable[[T, S], T]) -> T:
    """What is known at last, of what is known at first, which speeds it asks for, and what those add to it."""
    found = first
    for _ in range(ROUNDS):
        more = wanted(found)
        if not len(more):
            break
        found = looked(found, more)
    return found


def filled(speeds: FloatArray) -> FloatArray:
    """Rising speeds, with others in gaps of more than 2 %.

    Examples
    --------
    >>> filled(np.array([100.0, 101.0, 105.0])).round(2).tolist()
    [100.0, 101.0, 103.0, 105.0]
    """
    rising = np.unique(speeds)
    parts = [
        np.linspace(low, high, max(1, math.ceil((high / low - 1) / WIDEST)), endpoint=False)
        for low, high in pairwise(rising.tolist())
    ]
    return np.concatenate([*parts, rising[-1:]])


def added(speeds: FloatArray, more: FloatArray) -> FloatArray:
    """Those of other speeds, rising, that lie between the first and the last and are none of them but for rounding."""
    inside = np.unique(more[(more > speeds[0]) & (more < speeds[-1])])
    if not len(inside):
        return inside
    inside = inside[np.append(True, np.diff(inside) > FINEST * inside[1:])]
    after = np.searchsorted(speeds, inside)
    apart = np.minimum(speeds[after] - inside, inside - speeds[after - 1])
    return np.asarray(inside[apart > FINEST * inside])


def speeds_wanted(speeds: FloatArray, curves: FloatArray, level: float | None = None) -> FloatArray:
    """Speeds, rising, at which to look next; none where all that counts is known.

    Parameters
    ----------
    speeds : (n_speeds,) array
        Rising.
    curves : (n_speeds, n_curves) array
        Not negative; NaN where a curve has no value.
    level : float, optional
        What curves may come to: crossings of it are wanted, and peaks and valleys that may reach it.

    Examples
    --------
    >>> speeds = np.arange(10.0, 15.0)
    >>> curve = lambda n: 1 / np.hypot(1, 5 * (n - 12.3))[:, None]
    >>> more = speeds_wanted(speeds, curve(speeds))
    >>> bool(curve(more).max() > 0.999)
    True
    """
    found = [speed for curve in curves.T for speed in _of_curve(speeds, curve, level)]
    return added(speeds, np.array(found))


def vertex(speeds: FloatArray, values: FloatArray, at: int) -> float:
    """Speed of the maximum next to the place of the highest of some values, by the speeds on both sides of it."""
    if not 0 < at < len(speeds) - 1:
        return float(speeds[at])
    with np.errstate(all="ignore"):
        place, top, _ = _parabola(speeds[at - 1 : at + 2], values[at - 1 : at + 2] ** -2.0)
    inside = math.isfinite(top) and speeds[at - 1] <= place <= speeds[at + 1]
    return place if inside else float(speeds[at])


def _of_curve(speeds: FloatArray, curve: FloatArray, level: float | None) -> Iterator[float]:
    known = np.flatnonzero(np.isfinite(curve))
    if not len(known) or not curve[known].max() > 0:
        return
    best = float(curve[known].max())
    for run in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1):
        x, u = speeds[run], curve[run]
        if len(run) > 2:
            yield from _around_maxima(x, u, best, level)
        if level is not None and len(run) > 1:
            yield from _around_minima(x, u, level)
            yield from _around_crossings(x, u, level)


def _around_maxima(x: FloatArray, u: FloatArray, best: float, level: float | None) -> Iterator[float]:
    for at in _maxima(u):
        middle = min(max(at, 1), len(x) - 2)
        three = slice(middle - 1, middle + 2)
        drop = float(u[at] - u[three].min())
        if max(u[at] - u[max(at - 1, 0)], u[at] - u[min(at + 1, len(x) - 1)]) <= KNOWN * u[at] or u[at] <= 0:
            continue
        with np.errstate(all="ignore"):
            place, top, bend = _parabola(x[three], u[three] ** -2.0)
        highest = max(top**-0.5 if top > 0 else math.inf, float(u[at]) + HIDDEN * drop)
        if highest < best and not (level is not None and u[at] < level <= highest):
            continue
        yield from _in_bracket(x, at, place, math.sqrt(KNOWN * top / bend) if top > 0 and bend > 0 else 0.0)


def _around_minima(x: FloatArray, u: FloatArray, level: float) -> Iterator[float]:
    """Of valleys whose lowest speed lies above the level, and that may come below it."""
    for at in _maxima(-u):
        if not 0 < at < len(x) - 1 or u[at] <= level:
            continue
        three = slice(at - 1, at + 2)
        rise = float(u[three].max() - u[at])
        if rise <= KNOWN * u[at] or u[at] - HIDDEN * rise > level:
            continue
        place, bottom, bend = _parabola(x[three], u[three] ** 2.0)
        yield from _in_bracket(x, at, place, math.sqrt(KNOWN * u[at] ** 2 / bend) if bottom > 0 and bend > 0 else 0.0)


def _around_crossings(x: FloatArray, u: FloatArray, level: float) -> Iterator[float]:
    above = u > level
    for at in np.flatnonzero(above[1:] != above[:-1]).tolist():
        low, high = float(x[at]), float(x[at + 1])
        if high - low <= END * high:
            continue
        before, after = (float(np.log(max(value, 1e-6 * level) / level)) for value in u[at : at + 2])
        place = low + (high - low) * before / (before - after)
        reach = END / 2 * high
        yield min(max(place - reach, low), high)
        yield min(max(place + reach, low), high)
        if high - low > FAR * high:
            yield (low + high) / 2


def _in_bracket(x: FloatArray, at: int, place: float, reach: float) -> Iterator[float]:
    """Speeds between those next to the highest: around the vertex of the parabola if that lies there, else halfway."""
    low, high = float(x[max(at - 1, 0)]), float(x[min(at + 1, len(x) - 1)])
    is_end = at in (0, len(x) - 1)
    if reach and low < place < high:
        yield from (speed for speed in (place - reach, place, place + reach) if low < speed < high)
    elif reach and is_end:
        return  # it goes on rising to the end
    if not reach or not low < place - reach < place + reach < high:
        yield from ((float(x[at]) + end) / 2 for end in (low, high))


def _maxima(u: FloatArray) -> NDArray[np.intp]:
    """Places of values that none next to them exceeds, ends among them; of equal ones the first."""
    rim = np.array([-np.inf])
    before, after = np.concatenate([rim, u[:-1]]), np.concatenate([u[1:], rim])
    return np.flatnonzero((u > before) & (u >= after))


def _parabola(x: FloatArray, g: FloatArray) -> tuple[float, float, float]:
    """Place, value and half curvature of the lowest point of a parabola; NaN where it has none."""
    h, k = float(x[1] - x[0]), float(x[2] - x[1])
    left, right = float(g[1] - g[0]) / h, float(g[2] - g[1]) / k
    bend = (right - left) / (h + k)
    if not (bend > 0 and math.isfinite(bend)):
        return math.nan, math.nan, math.nan
    slope = left + bend * h  # at the middle
    shift = -slope / (2 * bend)
    return float(x[1]) + shift, float(g[1]) - bend * shift**2, bend
