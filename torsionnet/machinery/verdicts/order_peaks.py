"""Peaks of single orders at critical speeds, each as a ratio to the value that a limit allows."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds
from torsionnet.machinery.verdicts.limit_check import LimitCheck, LimitVerdict
from torsionnet.machinery.verdicts.limit_conclusion import WorstLimit

LEAST_SHARE = 0.1
"""Ratio of the amplitude of one order to the value that a limit allows, from which on a critical speed matters: ten
such orders at one speed would use the limit up. A smaller value lists more critical speeds that nobody feels."""
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


def order_peaks(check: LimitCheck, found: CriticalSpeeds) -> tuple[OrderPeak, ...]:
    """Peak amplitudes (SI) of each order at its critical speeds in the speed range, each with the limit used most.

    Parameters
    ----------
    check : LimitCheck
        Limits of one condition over speed.
    found : CriticalSpeeds
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
    >>> worst = max(peaks, key=lambda one: one.share)
    >>> worst.critical.mode.number, worst.critical.line, worst.verdict.limit, round(worst.rpm)
    (1, '6', 'propeller_shaft', 51)
    """
    found_there = (max(peaks_in_limits(check, found, one), key=lambda one: one.share, default=None)
                   for one in found.crossings)  # fmt: skip
    return tuple(peak for peak in found_there if peak is not None)


def order_shares(check: LimitCheck) -> FloatArray:
    """Largest ratio of amplitude to value allowed over all limits and speeds, by order line, shape (n_lines,)."""
    found = [np.zeros(len(check.lines))]
    for one in vibratory_verdicts(check):
        assert one.orders is not None
        with np.errstate(invalid="ignore", divide="ignore"):
            # Without a finite value allowed above 0 there is no share.
            shares = np.where(_counts(one)[:, None], one.orders.largest / one.allowed[:, None], 0.0)
        found.append(shares.max(axis=0, initial=0.0))
    return np.asarray(np.max(found, axis=0))


def vibratory_verdicts(check: LimitCheck) -> list[LimitVerdict]:
    """Verdicts on the limits of vibration that could be judged, with the amplitudes (SI) of their orders."""
    return [one for one in check.verdicts if one.orders is not None and len(one.values)]


def largest_orders(check: LimitCheck, verdict: LimitVerdict, at: int, most: int = 3) -> list[tuple[str, float]]:
    """Pairs of name and amplitude (SI) of the largest orders behind a limit's value at a speed, given by its index.

    They are those of the case of excitation to which the value belongs. Lines of one frequency are one order, their
    sum with their phases, as a test measures it.
    """
    if verdict.orders is None:
        return []
    phasors = verdict.orders.phasors[at]
    sizes = [(one.name, float(abs(phasors[[*one.places]].sum()))) for one in check.summed]
    return sorted(sizes, key=lambda pair: -pair[1])[:most]


def line_index(check: LimitCheck, found: CriticalSpeeds, critical: CriticalSpeed) -> int | None:
    """Index among the orders of a check of the one that meets a critical speed; None where it does not act there."""
    name = next((str(line) for line in found.lines if _is_of(critical, line)), "")
    return check.lines.index(name) if name in check.lines else None


def peaks_in_limits(check: LimitCheck, found: CriticalSpeeds, critical: CriticalSpeed) -> tuple[OrderPeak, ...]:
    """Peaks of an order at one of its critical speeds, one for each limit in which the mode makes one."""
    line = line_index(check, found, critical)
    if line is None or math.isnan(critical.mode.natural_frequency):
        return ()
    peaks = []
    for one in vibratory_verdicts(check):
        assert one.orders is not None
        sizes = one.orders.largest[:, line]
        at = _made_by_mode(check.speeds, sizes, critical, found.crossings)
        if at is not None and _counts(one)[at]:
            peaks.append(OrderPeak(critical, one, check, at, float(sizes[at])))
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


def _counts(one: LimitVerdict) -> FloatArray:
    """Flags (n_speeds,) whether a limit allows a finite value above 0 at each speed."""
    return np.asarray(np.isfinite(one.allowed) & (one.allowed > 0))


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


def _is_of(one: object, other: object) -> bool:
    """Whether two order lines or critical speeds have the same excitation, order and fixed frequency."""
    return all(getattr(one, name) == getattr(other, name) for name in ("excitation", "order", "fixed"))


# Peaks of single orders at critical speeds that matter for limits, each order in the worst of all conditions.

SAME_SHARE = 0.05
"""Relative difference of an order's shares of a limit in two conditions up to which one condition stands for both: a
smaller value spreads the orders over conditions that hardly differ."""

LITTLE_DAMPING = 0.005
"""Damping ratio, a magnifier of 100, below which a governing value at a resonance is said to depend on it. What models
leave out, such as friction in the steel of shafts and in joints, makes about a tenth of a per cent; below five times as
much it changes the peak by more than a fifth."""
LEAST_USE = 0.5
"""Utilisation from which on that is said: below it the limit still holds with half the damping."""
SAME_PLACE = 0.01
"""Relative difference up to which the peak of an order and the worst speed of a limit count as one resonance."""


@dataclass(frozen=True, eq=False)
class GoverningPeaks:
    """Peaks at critical speeds where one order uses at least a given share of a limit, each in its worst condition.

    Attributes
    ----------
    peaks : tuple of OrderPeak
        By condition in the order of the checks, then by mode and speed.
    others : tuple of str
        Names of the orders that use less of every limit in all conditions and at all speeds.
    """

    peaks: tuple[OrderPeak, ...]
    others: tuple[str, ...]


def governing_peaks(
    checks: Sequence[LimitCheck],
    critical_speeds: Callable[[LimitCheck, Sequence[str]], CriticalSpeeds],
    least: float = LEAST_SHARE,
) -> GoverningPeaks:
    """Peaks at critical speeds where one order uses at least the share ``least`` of a limit, in its worst condition.

    Conditions with a misfiring cylinder are looked at for themselves, for orders that are larger there.
    Critical speeds are asked for only in those
    conditions in which some order is worst, and only of these orders.

    Parameters
    ----------
    checks : sequence of LimitCheck
        One for each condition.
    critical_speeds : callable
        Gives the critical speeds of some order lines, by name, in the condition of a check.
    least : float
        Smallest amplitude of an order over the value allowed.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("bulk_carrier").configured("normal")
    >>> found = governing_peaks([ship.check_limits()], lambda check, lines: ship.critical_speeds(lines=lines))
    >>> [(line_name(one), round(one.rpm)) for one in found.peaks], len(found.others)
    ([('engine 6', 51), ('screw 4', 76), ('engine 4', 77), ('engine 3', 102)], 12)
    """
    normal, misfiring = ([place for place, one in enumerate(checks) if one.misfiring is way] for way in (False, True))
    wanted: dict[int, list[str]] = {}
    known: dict[str, float] = {}
    for places in (normal, misfiring):
        for line, (share, place) in _worst_conditions([checks[one] for one in places], least).items():
            # With a cylinder out only orders count that are clearly larger than in normal firing.
            if share > (1 + SAME_SHARE) * known.get(line, 0.0):
                wanted.setdefault(places[place], []).append(line)
            known.setdefault(line, share)
    kept: list[OrderPeak] = []
    for place, lines in sorted(wanted.items()):
        peaks = [one for one in order_peaks(checks[place], critical_speeds(checks[place], lines)) if one.share >= least]
        kept += sorted(peaks, key=lambda one: (one.critical.mode.number, one.rpm))
    felt = {line for lines in wanted.values() for line in lines}
    every = dict.fromkeys(line for check in checks for line in check.lines)
    return GoverningPeaks(tuple(kept), tuple(line for line in every if line not in felt))


def little_damped(worst: Sequence[WorstLimit], peaks: Sequence[OrderPeak]) -> tuple[tuple[WorstLimit, OrderPeak], ...]:
    """Limits whose worst speed is at a resonance with a damping ratio below ``LITTLE_DAMPING``, each with that peak.

    Limits used by less than ``LEAST_USE`` are left out. The order that is in resonance uses a tenth of the limit or
    more, as all of ``peaks`` do, in any condition.
    """
    found = []
    for one in worst:
        there = [
            peak
            for peak in peaks
            if (peak.verdict.limit, peak.verdict.criterion) == (one.verdict.limit, one.verdict.criterion)
            and one.rpm is not None
            and (one.utilisation or 0.0) >= LEAST_USE
            and abs(peak.rpm / one.rpm - 1) <= SAME_PLACE
            and 0 <= peak.critical.mode.damping_ratio < LITTLE_DAMPING
        ]
        if there:
            found.append((one, max(there, key=lambda peak: peak.share)))
    return tuple(found)


def line_name(peak: OrderPeak) -> str:
    """Name of the excitation and the order of a peak, such as ``engine 6``, as in the check of limits."""
    return f"{peak.critical.excitation} {peak.critical.line}"


def _worst_conditions(checks: Sequence[LimitCheck], least: float) -> dict[str, tuple[float, int]]:
    """Largest share of a limit and index of the condition with it, by name of the order, where at least ``least``.

    Conditions taken for a larger order are taken again where they are as bad within ``SAME_SHARE``.
    """
    shares: dict[str, dict[int, float]] = {}
    for place, check in enumerate(checks):
        for line, share in zip(check.lines, np.nan_to_num(order_shares(check)).tolist(), strict=True):
            shares.setdefault(line, {})[place] = share
    largest = {line: max(by_place.values()) for line, by_place in shares.items()}
    taken: list[int] = []
    found: dict[str, tuple[float, int]] = {}
    # The largest order first, so that its condition stands for smaller orders that are as bad there.
    for line in sorted(largest, key=lambda name: -largest[name]):
        if largest[line] < least:
            break
        alike = [place for place, share in shares[line].items() if share >= (1 - SAME_SHARE) * largest[line]]
        known = [place for place in taken if place in alike]
        place = known[0] if known else max(alike, key=lambda one: shares[line][one])
        taken += [] if known else [place]
        found[line] = (largest[line], place)
    return found


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
    found: dict[int, list[str]] = {}
    for line in dict.fromkeys(name for one in tops for name in one):
        places = [place for place, one in enumerate(tops) if place and one.get(line)]
        known = [tops[0].get(line, {})]
        for place in sorted(places, key=lambda one: -max(use for *_, use in tops[one][line].values())):
            if not any(_alike(tops[place][line], other) for other in known):
                known.append(tops[place][line])
                found.setdefault(place, []).append(line)
    return dict(sorted(found.items()))


Top: TypeAlias = tuple[float, float, float]
"""Largest share of a limit that an order uses, its speed in rad/s, and the utilisation by all orders at that speed."""


def _largest_shares(check: LimitCheck, least: float) -> dict[str, dict[tuple[str, str], Top]]:
    """Largest share of each limit that an order alone uses by ``least`` or more, by order and by limit."""
    found: dict[str, dict[tuple[str, str], Top]] = {line: {} for line in check.lines}
    for one in vibratory_verdicts(check):
        assert one.orders is not None
        with np.errstate(invalid="ignore", divide="ignore"):
            shares = np.where(_counts(one)[:, None], one.orders.largest / one.allowed[:, None], 0.0)
        for number, at in enumerate(shares.argmax(axis=0).tolist()):
            if shares[at, number] >= least:
                top = float(shares[at, number]), float(check.speeds[at]), float(one.utilisation[at])
                found[check.lines[number]][one.limit, one.criterion] = top
    return found


def _alike(own: Mapping[tuple[str, str], Top], other: Mapping[tuple[str, str], Top]) -> bool:
    """Whether an order has the same largest shares at the same speeds in two conditions, within ``SAME_SHARE``."""
    return all(
        limit in other and all(abs(a - b) <= SAME_SHARE * b for a, b in zip(top, other[limit], strict=True))
        for limit, top in own.items()
    )
