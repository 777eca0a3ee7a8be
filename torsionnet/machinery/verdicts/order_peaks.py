"""Peaks of single orders at critical speeds, each as a ratio to the value that a limit allows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict

LEAST_SHARE = 0.1
"""Ratio of the amplitude of one order to the value that a limit allows, from which on a critical speed matters: ten
such orders at one speed would use the limit up. A smaller value lists more critical speeds that nobody feels."""
SMALL_SHARE = 0.01
"""Ratio of the amplitude of one order to the value that a limit allows below which the order is named alone."""
PEAK_WINDOW = 0.1
"""Distance from a critical speed, as a share of that speed, within which the peak of its order is looked for: damping
moves peaks by less, unless it leaves none."""
HALF_WIDTHS, OWN_DROP = 3, 0.3
"""Half widths of a resonance within which the amplitude of its order drops on both sides, and by which share of the
peak at least: what a mode makes by half drops by more."""


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


def order_peaks(check: LimitCheck, critical_speeds: CriticalSpeeds) -> tuple[OrderPeak, ...]:
    """Peak amplitudes (SI) of each order at its critical speeds in the speed range, each with the limit used most.

    Parameters
    ----------
    check : LimitCheck
        Limits of one condition over speed.
    critical_speeds : CriticalSpeeds
        Critical speeds in the same condition.

    Returns
    -------
    tuple of OrderPeak
        In the order of the critical speeds, without those of overdamped modes. A critical speed at which the order has
        no local maximum that the mode makes is not among them: one outside the range, or on the flank of another.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("bulk_carrier").configured("normal")
    >>> peaks = order_peaks(ship.check_limits(), ship.critical_speeds())
    >>> worst = max(peaks, key=lambda peak: peak.share)
    >>> worst.critical.mode.number, worst.critical.line, worst.verdict.limit, round(worst.rpm)
    (1, '6', 'propeller_shaft', 51)
    """
    found_there = (max(peaks_in_limits(check, critical_speeds, critical), key=lambda peak: peak.share, default=None)
                   for critical in critical_speeds.crossings)  # fmt: skip
    return tuple(peak for peak in found_there if peak is not None)


def order_shares(check: LimitCheck) -> FloatArray:
    """Largest ratio of amplitude to value allowed over all limits and speeds, by order line, shape (n_lines,)."""
    largest = [np.zeros(len(check.lines))]
    for verdict in vibratory_verdicts(check):
        assert verdict.orders is not None
        with np.errstate(invalid="ignore", divide="ignore"):
            # Without a finite value allowed above 0 there is no share.
            shares = np.where(_counts(verdict)[:, None], verdict.orders / verdict.allowed[:, None], 0.0)
        largest.append(shares.max(axis=0, initial=0.0))
    return np.asarray(np.max(largest, axis=0))


def vibratory_verdicts(check: LimitCheck) -> list[LimitVerdict]:
    """Verdicts on the limits of vibration that could be judged, with the amplitudes (SI) of their orders."""
    return [verdict for verdict in check.verdicts if verdict.orders is not None and len(verdict.values)]


def largest_orders(check: LimitCheck, verdict: LimitVerdict, at: int, most: int = 3) -> list[tuple[str, complex]]:
    """Pairs of name and complex amplitude (SI) of the largest orders behind a limit's value at a speed, by its index.

    They are those of the case of excitation to which the value belongs. Lines of one frequency are one order, their
    sum with their phases, as a test measures it.
    """
    if verdict.amplitudes is None:
        return []
    phasors = verdict.amplitudes.phasors[at]
    sums = [(order.name, complex(phasors[[*order.places]].sum())) for order in check.summed]
    return sorted(sums, key=lambda pair: -abs(pair[1]))[:most]


def line_index(check: LimitCheck, critical_speeds: CriticalSpeeds, critical: CriticalSpeed) -> int | None:
    """Index among the orders of a check of the one that meets a critical speed; None where it does not act there."""
    name = next((str(line) for line in critical_speeds.lines if _is_of(critical, line)), "")
    return check.lines.index(name) if name in check.lines else None


def peaks_in_limits(
    check: LimitCheck, critical_speeds: CriticalSpeeds, critical: CriticalSpeed
) -> tuple[OrderPeak, ...]:
    """Peaks of an order at one of its critical speeds, one for each limit in which the mode makes one."""
    line = line_index(check, critical_speeds, critical)
    if line is None or math.isnan(critical.mode.natural_frequency):
        return ()
    peaks = []
    for verdict in vibratory_verdicts(check):
        assert verdict.orders is not None
        sizes = verdict.orders[:, line]
        at = _made_by_mode(check.speeds, sizes, critical, critical_speeds.crossings)
        if at is not None and _counts(verdict)[at]:
            peaks.append(OrderPeak(critical, verdict, check, at, float(sizes[at])))
    return tuple(peaks)


def local_maxima(values: FloatArray) -> list[int]:
    """Indices of the local maxima of a curve over speed, without its ends.

    Examples
    --------
    >>> local_maxima(np.array([3.0, 1.0, 2.0, 2.0, 1.0, 4.0]))
    [2]
    """
    inner = values[1:-1]
    return (np.flatnonzero((inner > values[:-2]) & (inner >= values[2:])) + 1).tolist()


def _counts(verdict: LimitVerdict) -> FloatArray:
    """Flags (n_speeds,) whether a limit allows a finite value above 0 at each speed."""
    return np.asarray(np.isfinite(verdict.allowed) & (verdict.allowed > 0))


def _made_by_mode(
    speeds: FloatArray, sizes: FloatArray, critical: CriticalSpeed, crossings: Sequence[CriticalSpeed]
) -> int | None:
    """Index of the local maximum of an order's amplitude that the mode of a critical speed makes; None without one."""
    low, high = _reach(critical, crossings)
    near = [at for at in local_maxima(sizes) if low <= speeds[at] <= high]
    if not near:
        return None
    top = max(near, key=lambda at: sizes[at])
    # A mode alone drops to a third within three half widths, zeta n each; on what other modes and the torques
    # themselves make, it is a ripple that hardly drops.
    away = HALF_WIDTHS * critical.mode.damping_ratio * critical.natural_speed
    drops = []
    for side in (slice(top, None, -1), slice(top, None)):
        far = np.abs(speeds[side] - speeds[top]) >= away * (1 - 1e-9)
        if far[1:].any():
            drops.append(float(sizes[side][: max(2, int(np.argmax(far)) + 1)].min()) <= (1 - OWN_DROP) * sizes[top])
    return top if all(drops) else None


def _reach(critical: CriticalSpeed, crossings: Sequence[CriticalSpeed]) -> tuple[float, float]:
    """Lowest and highest speed in rad/s at which the peak of a critical speed may lie.

    None is nearer to another critical speed of the same order.
    """
    speed = critical.natural_speed
    low, high = speed * (1 - PEAK_WINDOW), speed * (1 + PEAK_WINDOW)
    for other in crossings:
        if other is not critical and _is_of(other, critical):
            # Speeds beyond halfway to the next critical speed of this order belong to that.
            middle = (speed + other.natural_speed) / 2
            low, high = (max(low, middle), high) if middle < speed else (low, min(high, middle))
    return low, high


def _is_of(line: object, other: object) -> bool:
    """Whether two order lines or critical speeds have the same excitation, order and fixed frequency."""
    return all(getattr(line, name) == getattr(other, name) for name in ("excitation", "order", "fixed"))


# Peaks that matter for limits: with little damping, and in conditions that differ from the normal one.

SAME_SHARE = 0.05
"""Relative difference of an order's shares of a limit in two conditions up to which one condition stands for both: a
smaller value spreads the orders over conditions that hardly differ."""


def line_name(peak: OrderPeak) -> str:
    """Name of the excitation and the order of a peak, such as ``engine 6``, as in the check of limits."""
    return f"{peak.critical.excitation} {peak.critical.line}"


def differing_lines(checks: Sequence[LimitCheck], least: float = LEAST_SHARE) -> dict[int, list[str]]:
    """Names of the orders that matter in conditions and differ there, by index of the condition.

    Orders that use at least the share ``least`` of a limit, and whose largest share, its speed, or the use by all
    orders there, differs by more than ``SAME_SHARE`` from those in the first condition and in each condition named
    before. Of conditions in which an order is alike that in which limits are used most is named.

    Parameters
    ----------
    checks : sequence of LimitCheck
        One for each condition, the normal one first.
    least : float
    """
    tops = [_largest_shares(check, least) for check in checks]
    lines_by_condition: dict[int, list[str]] = {}
    for line in dict.fromkeys(name for shares in tops for name in shares):
        places = [place for place, shares in enumerate(tops) if place and shares.get(line)]
        known = [tops[0].get(line, {})]
        for place in sorted(places, key=lambda place: -max(use for *_, use in tops[place][line].values())):
            if not any(_alike(tops[place][line], other) for other in known):
                known.append(tops[place][line])
                lines_by_condition.setdefault(place, []).append(line)
    return dict(sorted(lines_by_condition.items()))


Top: TypeAlias = tuple[float, float, float]
"""Largest share of a limit that an order uses, its speed in rad/s, and the utilisation by all orders at that speed."""


def _largest_shares(check: LimitCheck, least: float) -> dict[str, dict[tuple[str, str], Top]]:
    """Largest share of each limit that an order alone uses by ``least`` or more, by order and by limit."""
    tops: dict[str, dict[tuple[str, str], Top]] = {line: {} for line in check.lines}
    for verdict in vibratory_verdicts(check):
        assert verdict.orders is not None
        with np.errstate(invalid="ignore", divide="ignore"):
            shares = np.where(_counts(verdict)[:, None], verdict.orders / verdict.allowed[:, None], 0.0)
        for number, at in enumerate(shares.argmax(axis=0).tolist()):
            if shares[at, number] >= least:
                top = float(shares[at, number]), float(check.speeds[at]), float(verdict.utilisation[at])
                tops[check.lines[number]][verdict.limit, verdict.criterion] = top
    return tops


def _alike(own: Mapping[tuple[str, str], Top], other: Mapping[tuple[str, str], Top]) -> bool:
    """Whether an order has the same largest shares at the same speeds in two conditions, within ``SAME_SHARE``."""
    return all(
        limit in other and all(abs(a - b) <= SAME_SHARE * b for a, b in zip(top, other[limit], strict=True))
        for limit, top in own.items()
    )
