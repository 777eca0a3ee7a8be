"""Peaks of single orders at critical speeds, each as a ratio to the value that a limit allows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds
from torsionnet.machinery.verdicts.limit_check import LimitCheck, LimitVerdict

LEAST_SHARE = 0.1
"""Ratio of the amplitude of one order to the value that a limit allows, from which on a critical speed matters: ten
such orders at one speed would use the limit up. A smaller value lists more critical speeds that nobody feels."""
PEAK_WINDOW = 0.1
"""Distance from a critical speed, as a share of that speed, within which the peak of its order is looked for: damping
moves peaks by less, unless it leaves none."""
RANGE_REACH = 0.2
"""Distance beyond an end of the speed range, as a share of that speed, up to which critical speeds count: a usual
barred range does not reach further."""


@dataclass(frozen=True, eq=False)
class OrderPeak:
    """Amplitude (SI) of one order at its peak near a critical speed, with the limit of which it uses the largest share.

    Attributes
    ----------
    critical : CriticalSpeed
    verdict : LimitVerdict
        Verdict on the limit, with values over the speeds of its check.
    check : LimitCheck
    at : int
        Index of the speed of the peak.
    amplitude : float
        Amplitude of the order alone at the peak, in SI units of the limit.
    """

    critical: CriticalSpeed
    verdict: LimitVerdict
    check: LimitCheck
    at: int
    amplitude: float

    @property
    def share(self) -> float:
        """Ratio of one order's amplitude to the value that the limit allows at its peak, without unit."""
        return self.amplitude / float(self.verdict.allowed[self.at])

    @property
    def utilisation(self) -> float:
        """Ratio of the value of all orders together to the value that the limit allows at a peak, without unit."""
        return float(self.verdict.utilisation[self.at])

    @property
    def rpm(self) -> float:
        """Speed of the peak of an order in r/min of the reference shaft."""
        return float(self.check.rpm[self.at])


def order_peaks(check: LimitCheck, found: CriticalSpeeds) -> tuple[OrderPeak, ...]:
    """Peak amplitudes (SI) of each order at its critical speeds near the speed range, each with the limit used most.

    Parameters
    ----------
    check : LimitCheck
        Limits of one condition over speed.
    found : CriticalSpeeds
        Critical speeds in the same condition.

    Returns
    -------
    tuple of OrderPeak
        In the order of the critical speeds, without those of overdamped modes and those further than
        :data:`RANGE_REACH` from the range of speeds. Of a critical speed outside the range the value at its nearer end.
        A mode that an order hardly excites is among them only if there is a peak of that order.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("bulk_carrier").configured("normal")
    >>> peaks = order_peaks(ship.check_limits(), ship.critical_speeds())
    >>> worst = max(peaks, key=lambda one: one.share)
    >>> worst.critical.mode.number, worst.critical.line, worst.verdict.limit, round(worst.rpm)
    (1, '6', 'propeller_shaft', 51)
    """
    return tuple(
        peak
        for critical in found.crossings
        if not math.isnan(critical.mode.natural_frequency)
        if (peak := _peak(check, found, critical)) is not None
    )


def order_shares(check: LimitCheck) -> FloatArray:
    """Largest ratio of amplitude to value allowed over all limits and speeds, by order line, shape (n_lines,)."""
    found = [np.zeros(len(check.lines))]
    for one in vibratory_verdicts(check):
        assert one.orders is not None
        with np.errstate(invalid="ignore", divide="ignore"):
            shares = np.where(_counts(one)[:, None], one.orders / one.allowed[:, None], 0.0)
        found.append(shares.max(axis=0, initial=0.0))
    return np.asarray(np.max(found, axis=0))


def vibratory_verdicts(check: LimitCheck) -> list[LimitVerdict]:
    """Verdicts on the limits of vibration that could be judged, with the amplitudes (SI) of their orders."""
    return [one for one in check.verdicts if one.orders is not None and len(one.values)]


def largest_orders(check: LimitCheck, verdict: LimitVerdict, at: int, most: int = 3) -> list[tuple[str, float]]:
    """Pairs of name and amplitude (SI) of the largest orders of a limit's value at a speed, given by its index."""
    if verdict.orders is None:
        return []
    sizes = verdict.orders[at]
    return [(check.lines[place], float(sizes[place])) for place in np.argsort(-sizes, kind="stable")[:most].tolist()]


def _counts(one: LimitVerdict) -> FloatArray:
    """Flags (n_speeds,) whether a limit allows a finite value above 0 at each speed."""
    return np.asarray(np.isfinite(one.allowed) & (one.allowed > 0))


def _peak(check: LimitCheck, found: CriticalSpeeds, critical: CriticalSpeed) -> OrderPeak | None:
    speed = critical.speed("natural")
    low, high = float(check.speeds.min()), float(check.speeds.max())
    if not low * (1 - RANGE_REACH) <= speed <= high * (1 + RANGE_REACH):
        return None
    name = next((str(line) for line in found.lines if _is_of(critical, line)), "")
    if name not in check.lines:
        return None
    place = check.lines.index(name)
    near = _window(check.speeds, critical, found.crossings)
    peaks = _in_limits(check, critical, place, near) if near else ()
    return max(peaks, key=lambda one: one.share, default=None)


def _in_limits(check: LimitCheck, critical: CriticalSpeed, line: int, near: list[int]) -> Iterator[OrderPeak]:
    """Yield the peak of an order line in each limit, at one of the speeds with the indices ``near``."""
    nearest = min(near, key=lambda place: abs(check.speeds[place] - critical.speed("natural")))
    for one in vibratory_verdicts(check):
        assert one.orders is not None
        sizes = one.orders[:, line]
        at = max(near, key=lambda place: sizes[place])
        # An order that only rises towards another resonance, or to the end of the range, has no peak here.
        is_peak = at not in near[:1] + near[-1:]
        if not is_peak and critical.excited is False:
            continue
        if not is_peak and 0 < at < len(sizes) - 1:
            at = nearest
        if _counts(one)[at]:
            yield OrderPeak(critical, one, check, at, float(sizes[at]))


def _window(speeds: FloatArray, critical: CriticalSpeed, crossings: Sequence[CriticalSpeed]) -> list[int]:
    """Indices of the speeds at which the peak of a critical speed may lie: those within ``PEAK_WINDOW``.

    Of a critical speed further outside the range the nearer end; none that is nearer to another critical speed of the
    same order.
    """
    speed = critical.speed("natural")
    low, high = 0.0, math.inf
    for other in crossings:
        if other is not critical and _is_of(other, critical):
            middle = (speed + other.speed("natural")) / 2
            low, high = (max(low, middle), high) if middle < speed else (low, min(high, middle))
    inside = (speeds >= low) & (speeds <= high)
    near = np.flatnonzero(inside & (np.abs(speeds - speed) <= PEAK_WINDOW * speed)).tolist()
    nearest = int(np.argmin(np.abs(speeds - speed)))
    return near or ([nearest] if inside[nearest] else [])


def _is_of(one: object, other: object) -> bool:
    """Whether two order lines or critical speeds have the same excitation, order and fixed frequency."""
    return all(getattr(one, name) == getattr(other, name) for name in ("excitation", "order", "fixed"))
