"""Ends of the cycles of a turning shaft, and the integrals of its angle over them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray

KEPT_POINTS = 32
"""Points kept from one block to the next, so that its spline is as good at the seam as inside: the influence of an end
falls by 0.27 a point."""
SECANT_STEPS = 5
"""Steps of Newton's method to the end of a cycle, from the point beside it."""


@dataclass(frozen=True, eq=False)
class Cycles:
    """Cycles of a turning shaft.

    Attributes
    ----------
    ends : (n + 1,) array
        Times at which they begin, and the last one ends, s.
    angles : (n + 1,) array
        Angle read at these times, rad.
    integrals : (n,) array
        Integral of the angle since the begin of a cycle over its time, rad s.
    """

    ends: FloatArray
    angles: FloatArray
    integrals: FloatArray


def cycles_of(read: Iterator[tuple[FloatArray, FloatArray]], turn: float, name: str) -> Cycles:
    """Cycles of ``turn`` rad each from blocks of times in s and angles in rad, one after the other.

    Raises
    ------
    UsageError
        The shaft turns backwards.
    """
    times, angles = np.empty(0), np.empty(0)
    ends: list[float] = []
    found: list[float] = []
    sums: list[float] = []
    first: float | None = None
    for more_times, more_angles in read:
        times, angles = np.concatenate([times, more_times]), np.concatenate([angles, more_angles])
        if len(times) < 2 * KEPT_POINTS:
            continue
        first = angles[0] if first is None else first
        used = _take(times, angles, len(times) - KEPT_POINTS, turn, first, (ends, found, sums), name)
        times, angles = times[used:], angles[used:]
    if len(times) > 3:
        first = angles[0] if first is None else first
        _take(times, angles, len(times), turn, first, (ends, found, sums), name)
    return Cycles(np.array(ends), np.array(found), np.array(sums))


def _take(
    times: FloatArray, angles: FloatArray, count: int, turn: float, first: float,
    into: tuple[list[float], list[float], list[float]], name: str,
) -> int:  # fmt: skip
    """Append the cycles that end within the first ``count`` points; return how many points are no longer needed."""
    from scipy.interpolate import CubicSpline

    if angles[-1] <= angles[0]:
        raise UsageError(f"{name}: the angle falls: the shaft turns backwards there; say that the wheel is reversed")
    ends, found, sums = into
    highest = np.maximum.accumulate(angles[:count])
    begin = len(ends)
    last = int(np.floor((highest[-1] - first) / turn * (1 + 1e-12)))
    marks = first + turn * np.arange(begin, last + 1)
    if not len(marks):
        return 0
    spline = CubicSpline(times, angles)
    at = times[np.searchsorted(highest, marks - 1e-9 * turn).clip(0, count - 1)]
    for _ in range(SECANT_STEPS):
        at = np.clip(at - (spline(at) - marks) / spline(at, 1), times[0], times[-1])
    values = spline(at)
    integral = spline.antiderivative()
    if begin:
        at, values = np.concatenate([[ends[-1]], at]), np.concatenate([[found[-1]], values])
    whole = np.diff(integral(at)) - values[:-1] * np.diff(at)
    fresh = slice(1, None) if begin else slice(None)
    ends.extend(at[fresh].tolist())
    found.extend(values[fresh].tolist())
    sums.extend(whole.tolist())
    return max(int(np.searchsorted(times, ends[-1])) - KEPT_POINTS, 0)
