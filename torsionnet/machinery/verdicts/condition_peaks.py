"""Peaks of single orders and of their sum in one condition, each a record of mode, order, component and limits.

Peaks are looked for over the speeds of a check of limits, and may be calculated once more at their own speeds, which
the steps of the check miss by up to half a step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.criticals.critical_speeds import NEGLIGIBLE_FORCE, CriticalSpeed, CriticalSpeeds
from torsionnet.machinery.orders.order_amplitudes import SummedOrder
from torsionnet.machinery.orders.speed_refinement import vertex_speed
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_checking import limits_at
from torsionnet.machinery.verdicts.limit_conclusion import WorstLimit
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.machinery.verdicts.order_peaks import (
    LEAST_SHARE,
    SMALL_SHARE,
    OrderPeak,
    line_index,
    line_name,
    local_maxima,
    peaks_in_limits,
    vibratory_verdicts,
)

SAME_PEAK = 0.02
"""Relative distance of the speed of a peak of the sum of all orders from the peak of one of them within which that
order makes it; beyond, orders may make it together."""
SUM_DROP = 0.05
"""Drop of the sum of all orders on both sides of a maximum, as a share of it, from which on it is a peak of its own."""


@dataclass(frozen=True, eq=False)
class JudgedPoint:
    """Values (SI) of one limit at one speed: what is judged, and what is allowed in continuous operation and passing.

    Attributes
    ----------
    check : LimitCheck
    verdict : LimitVerdict
        On the criterion for continuous operation, of a limit without one on that in passing.
    at : int
        Index of the speed in the check.
    """

    check: LimitCheck
    verdict: LimitVerdict
    at: int

    @property
    def rpm(self) -> float:
        """Speed in r/min of the reference shaft."""
        return float(self.check.rpm[self.at])

    @property
    def value(self) -> float:
        """Value that the limit judges, such as the half range of the sum of all orders, in SI."""
        return float(self.verdict.values[self.at])

    @property
    def continuous(self) -> float:
        """Value allowed in continuous operation at this speed in SI, NaN where none is."""
        return math.nan if self.verdict.in_passing else float(self.verdict.allowed[self.at])

    @property
    def in_passing(self) -> float:
        """Value that the same limit allows in passing at this speed in SI, NaN where none is said."""
        own = self.verdict
        allowed = [
            float(verdict.allowed[self.at])
            for verdict in self.check.verdicts
            if verdict.in_passing
            and (verdict.limit, verdict.quantity, verdict.unit) == (own.limit, own.quantity, own.unit)
        ]
        return min(allowed, default=math.nan)

    @property
    def utilisation(self) -> float:
        """Ratio of the value to that allowed in continuous operation, else to that in passing, without unit."""
        allowed = self.continuous if math.isfinite(self.continuous) else self.in_passing
        return self.value / allowed if allowed else math.nan

    @property
    def case(self) -> str:
        """Name of the case of excitation to which the value belongs, such as a misfire; empty where there is one."""
        if self.verdict.amplitudes is None or not self.check.cases:
            return ""
        return self.check.cases[int(self.verdict.amplitudes.cases[self.at])]

    def order(self, places: Sequence[int]) -> float:
        """Amplitude in SI of the sum of some orders, by their indices, in the case to which the value belongs."""
        assert self.verdict.amplitudes is not None
        return float(abs(self.verdict.amplitudes.phasors[self.at, [*places]].sum()))


@dataclass(frozen=True, eq=False)
class JudgedCritical:
    """Critical speed with the vibration that its order, and all orders, make in the component that it uses most.

    Attributes
    ----------
    critical : CriticalSpeed
        With the generalised force of the case of excitation to which the values belong.
    point : JudgedPoint or None
        At the peak of the order; without a peak at the critical speed itself; None where that is out of the range.
    rated : JudgedPoint or None
        The same limit at rated speed.
    line : int
        Index of the order in the checks.
    is_peak : bool
        Whether the order has a local maximum there that the mode makes.
    """

    critical: CriticalSpeed
    point: JudgedPoint | None
    rated: JudgedPoint | None
    line: int
    is_peak: bool

    @property
    def name(self) -> str:
        """Name of the excitation and the order, such as ``engine 6``."""
        return f"{self.critical.excitation} {self.critical.line}"

    @property
    def key(self) -> tuple[int, str]:
        """Number of the mode and name of the order, by which conditions are compared."""
        return self.critical.mode.number, self.name

    @property
    def amplitude(self) -> float:
        """Amplitude of the order alone in SI of the limit, NaN out of the range."""
        return math.nan if self.point is None else self.point.order((self.line,))

    @property
    def share(self) -> float:
        """Ratio of the order's amplitude to the value that the limit allows, without unit; 0 out of the range."""
        if self.point is None or not self.point.value:
            return 0.0
        return self.amplitude / self.point.value * self.point.utilisation

    @property
    def utilisation(self) -> float:
        """Ratio of the value of all orders to the value allowed, without unit; NaN out of the range."""
        return math.nan if self.point is None else self.point.utilisation


@dataclass(frozen=True, eq=False)
class SumPeak:
    """Largest sum of all orders near one speed in one component, and the order and mode that make it.

    Attributes
    ----------
    point : JudgedPoint
    order : str
        Name of the order, with those of other sources at its frequency.
    mode : int or None
        Number of the mode, None where no mode makes it.
    is_peak : bool
        Whether it is a local maximum; otherwise the largest value is at an end of the range.
    """

    point: JudgedPoint
    order: str
    mode: int | None
    is_peak: bool


@dataclass(frozen=True, eq=False)
class ConditionPeaks:
    """Critical speeds and peaks of one condition, and its limits at rated speed.

    Attributes
    ----------
    check : LimitCheck
        Over the speeds of the condition.
    points : LimitCheck
        At the speeds of the peaks and at rated speed; ``check`` itself where these were not calculated.
    rated : int or None
        Index of the rated speed in ``points``; None where it is not in the range.
    criticals : tuple of JudgedCritical
        By mode and speed.
    sums : tuple of SumPeak
        By limit and speed.
    """

    check: LimitCheck
    points: LimitCheck
    rated: int | None
    criticals: tuple[JudgedCritical, ...]
    sums: tuple[SumPeak, ...]


def condition_peaks(
    drivetrain: AssembledModel,
    check: LimitCheck,
    critical_speeds: CriticalSpeeds,
    rated: float | None = None,
    *,
    refine: bool = True,
) -> ConditionPeaks:
    """Critical speeds and peaks of one condition with the values of its limits at their own speeds.

    Parameters
    ----------
    drivetrain : AssembledModel
        In the condition of the check.
    check : LimitCheck
        All limits over speed.
    critical_speeds : CriticalSpeeds
        In the same condition.
    rated : float, optional
        Rated speed in rad/s of the reference shaft.
    refine : bool
        Whether limits are calculated once more at the speeds of the peaks and at rated speed. Otherwise the nearest
        speeds of the check stand for them: values there are lower by 1 % or less where its steps resolve a resonance.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("bulk_carrier").configured("normal")
    >>> peaks = condition_peaks(ship, ship.check_limits(), ship.critical_speeds(lines=["engine 6"]))
    >>> worst = peaks.criticals[0]
    >>> worst.critical.mode.number, round(worst.point.rpm), worst.point.verdict.limit, round(worst.utilisation, 2)
    (1, 51, 'propeller_shaft', 1.29)
    """
    # What rounding leaves of a force is none, as on a part that nothing connects to the machine that runs.
    kept = tuple(critical for critical in critical_speeds.crossings if not critical.relative_force < NEGLIGIBLE_FORCE)
    critical_speeds = replace(critical_speeds, crossings=kept)
    low, high = float(check.speeds[0]), float(check.speeds[-1])
    inside = [speed for speed in (rated,) if speed is not None and low * (1 - 1e-9) <= speed <= high * (1 + 1e-9)]
    met = [critical for critical in critical_speeds.crossings if math.isfinite(critical.natural_speed)]
    each = [(critical, line, peaks_in_limits(check, critical_speeds, critical))
            for critical in met if (line := line_index(check, critical_speeds, critical)) is not None]  # fmt: skip
    # A mode with little damping answers a generalised force that is small beside a cylinder's torque: its peak says so.
    peaks = [(critical, line, own) for critical, line, own in each
             if critical.excited is not False or any(peak.share >= SMALL_SHARE for peak in own)]  # fmt: skip
    wanted = [*inside, *(speed for critical, line, own in peaks for speed in _speeds(check, critical, own, line))]
    tops = [top for verdict in vibratory_verdicts(check) if not verdict.in_passing for top in _tops(check, verdict)]
    wanted += [vertex_speed(check.speeds, top.verdict.values, top.at) for top in tops]
    speeds = np.clip(np.unique(np.array(wanted)), low, high)
    if not len(speeds):
        outside = tuple(JudgedCritical(critical, None, None, line, False) for critical, line, _ in peaks)
        return ConditionPeaks(check, check, None, outside, ())
    points = limits_at(drivetrain, speeds) if refine else check
    index = _index(points, inside[0]) if inside else None
    criticals = tuple(_record(check, points, index, critical, own, line) for critical, line, own in peaks)
    sums = tuple(_sum_peaks(check, points, tops, [peak for _, _, own in peaks for peak in own]))
    ordered = sorted(criticals, key=lambda record: (record.critical.mode.number, record.critical.natural_speed))
    return ConditionPeaks(check, points, index, tuple(ordered), sums)


def _speeds(check: LimitCheck, critical: CriticalSpeed, peaks: Sequence[OrderPeak], line: int) -> Iterator[float]:
    """Yield the speed in rad/s at which a critical speed is calculated once more; none out of the range."""
    if peaks:
        best = max(peaks, key=lambda peak: peak.share)
        assert best.verdict.orders is not None
        yield vertex_speed(check.speeds, best.verdict.orders[:, line], best.at)
    elif check.speeds[0] <= critical.natural_speed <= check.speeds[-1]:
        yield critical.natural_speed


def _record(
    check: LimitCheck,
    points: LimitCheck,
    rated: int | None,
    critical: CriticalSpeed,
    peaks: Sequence[OrderPeak],
    line: int,
) -> JudgedCritical:
    """Record of a critical speed in the limit that its order uses most."""
    speed = next(_speeds(check, critical, peaks, line), None)
    if speed is None:
        return JudgedCritical(critical, None, None, line, False)
    at = _index(points, speed)
    if peaks:
        best = max(peaks, key=lambda peak: peak.share).verdict
        verdict = _same(points, best)
    else:
        verdict = max(vibratory_verdicts(points), key=lambda judged: _share(points, judged, at, line))
    rest = None if rated is None else JudgedPoint(points, verdict, rated)
    point = JudgedPoint(points, verdict, at)
    return JudgedCritical(critical.in_case(point.case), point, rest, line, bool(peaks))


def _share(points: LimitCheck, verdict: LimitVerdict, at: int, line: int) -> float:
    """Ratio of an order's amplitude at a speed to the value that a limit allows there, -1 where it allows none."""
    allowed = float(verdict.allowed[at])
    return JudgedPoint(points, verdict, at).order((line,)) / allowed if allowed > 0 else -1.0


@dataclass(frozen=True)
class _Top:
    """Maximum of the sum of all orders of a limit over speed by index, and the higher of the valleys beside it."""

    verdict: LimitVerdict
    at: int
    valley: int

    def made_by(self, summed: Sequence[SummedOrder]) -> SummedOrder:
        """Order that makes the maximum: that whose amplitude drops most from it to the valley."""
        assert self.verdict.orders is not None
        drops = self.verdict.orders[self.at] - self.verdict.orders[self.valley]
        return max(summed, key=lambda order: float(drops[[*order.places]].max()))


def _tops(check: LimitCheck, verdict: LimitVerdict) -> Iterator[_Top]:
    """Yield the maxima over speed that are peaks of their own, of those that use little the most used one alone."""
    values, worst = verdict.values, verdict.worst
    if worst is None:
        return
    for at in local_maxima(values):
        # Down to the valley on either side, as far as the curve does not rise above this maximum.
        higher = np.flatnonzero(values > values[at])
        first = int(max(higher[higher < at], default=-1)) + 1
        last = int(min(higher[higher > at], default=len(values)))
        sides = first + int(np.argmin(values[first:at])), at + int(np.argmin(values[at:last]))
        top = _Top(verdict, at, max(sides, key=lambda side: values[side]))
        matters = np.nan_to_num(verdict.utilisation[at]) >= LEAST_SHARE or _is_near(check, top, worst)
        if matters and values[top.valley] <= (1 - SUM_DROP) * values[at]:
            yield top


def _sum_peaks(
    check: LimitCheck, points: LimitCheck, tops: Sequence[_Top], peaks: Sequence[OrderPeak]
) -> Iterator[SumPeak]:
    """Yield the peaks of the sum of all orders by limit and speed, the place where it is used most among them."""
    for verdict in vibratory_verdicts(check):
        worst = verdict.worst
        if verdict.in_passing or worst is None:
            continue
        own, here = [top for top in tops if top.verdict is verdict], JudgedPoint(check, verdict, worst)
        near = [peak for peak in peaks if peak.verdict is verdict]
        sum_peaks = [] if any(_is_near(check, top, worst) for top in own) else [_without_mode(here)]
        nearest = min(own, key=lambda top: abs(top.at - worst), default=None)
        for top in own:
            # The most used place is that of the check itself, so that its numbers are the same everywhere.
            speed = vertex_speed(check.speeds, verdict.values, top.at)
            there = JudgedPoint(points, _same(points, verdict), _index(points, speed))
            order = top.made_by(check.summed)
            point = here if top is nearest and _is_near(check, top, worst) else there
            sum_peaks.append(SumPeak(point, order.name, _mode_near(point, order, near), True))
        yield from sorted(sum_peaks, key=lambda peak: peak.point.rpm)


def _is_near(check: LimitCheck, top: _Top, at: int) -> bool:
    return bool(abs(check.speeds[top.at] / check.speeds[at] - 1) <= SAME_PEAK)


def _without_mode(point: JudgedPoint) -> SumPeak:
    """Place where a limit is used most although the sum has no maximum there, as at the end of a range of speeds."""
    return SumPeak(point, max(point.check.summed, key=lambda order: point.order(order.places)).name, None, False)


def _mode_near(point: JudgedPoint, order: SummedOrder, peaks: Sequence[OrderPeak]) -> int | None:
    """Number of the mode whose peak of an order is nearest to a peak of the sum, None where none is near."""
    names = [point.check.lines[place] for place in order.places]
    off = {
        peak.critical.mode.number: abs(peak.rpm / point.rpm - 1) / max(SAME_PEAK, peak.critical.mode.damping_ratio)
        for peak in peaks
        if line_name(peak) in names
    }
    nearest = min(off, key=lambda mode: off[mode], default=None)
    return nearest if nearest is not None and off[nearest] <= 1 else None


def _same(points: LimitCheck, verdict: LimitVerdict) -> LimitVerdict:
    """Verdict on the same criterion of the same limit in another check."""
    return points.of(verdict.limit, verdict.criterion)


def _index(points: LimitCheck, speed: float) -> int:
    return int(np.argmin(np.abs(points.speeds - speed)))


# Limits whose worst speed is at a resonance that hardly anything damps.

LITTLE_DAMPING = 0.005
"""Damping ratio, a magnifier of 100, below which a governing value at a resonance is said to depend on it. What models
leave out, such as friction in the steel of shafts and in joints, makes about a tenth of a per cent; below five times as
much it changes the peak by more than a fifth."""
LEAST_USE = 0.5
"""Utilisation from which on that is said: below it the limit still holds with half the damping."""
SAME_PLACE = 0.01
"""Relative difference up to which the peak of an order and the worst speed of a limit count as one resonance."""


def little_damped(
    worst: Sequence[WorstLimit], records: Sequence[JudgedCritical]
) -> tuple[tuple[WorstLimit, JudgedCritical], ...]:
    """Limits whose worst speed is at a resonance with a damping ratio below ``LITTLE_DAMPING``, each with that peak.

    Limits used by less than ``LEAST_USE`` are left out, and orders that use less than ``LEAST_SHARE`` of the limit.
    """
    near_resonance = []
    for limit in worst:
        there = [
            (record.share, record)
            for record in records
            if record.point is not None and record.is_peak and limit.rpm is not None
            if record.point.verdict.limit == limit.verdict.limit
            and record.point.verdict.criterion == limit.verdict.criterion
            and (limit.utilisation or 0.0) >= LEAST_USE
            and record.share >= LEAST_SHARE
            and abs(record.point.rpm / limit.rpm - 1) <= SAME_PLACE
            and 0 <= record.critical.mode.damping_ratio < LITTLE_DAMPING
        ]
        if there:
            near_resonance.append((limit, max(there, key=lambda pair: pair[0])[1]))
    return tuple(near_resonance)
