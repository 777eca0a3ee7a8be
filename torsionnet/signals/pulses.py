"""Repair of encoder pulses, in which lost ones are counted, double ones left out, and others refused."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import SolveError, UsageError, comma_list
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.wheel import runs_in_words

# Removal of double pulses of an encoder, caused by a bouncing contact or a disturbance.

MEDIAN_INTERVALS = 5
"""Number of intervals whose median is the usual interval where lost pulses are counted, few so that it follows the
speed."""
WIDE_MEDIAN_INTERVALS = 9
"""Number of intervals whose median is the usual interval where double pulses are searched, more since each spoils two
intervals."""
SHORT_INTERVAL_SHARE, SAME_INTERVAL_RATIO = 0.6, 1.25
"""Interval over the usual one below which a pulse may be double, and factor within which the interval joined without it
is usual again."""
CLEAR_MISFIT_DIFFERENCE = 0.1
"""Difference of the logarithm of an interval over the usual one by which the rarer kind of double pulse must fit
better."""


def indices_without_double(times: FloatArray) -> NDArray[np.intp]:
    """Indices of an encoder's pulses that remain when double ones are left out."""
    intervals = np.diff(times)
    if len(intervals) < MEDIAN_INTERVALS:
        return np.arange(len(times))
    level = running_median(intervals, WIDE_MEDIAN_INTERVALS)
    stay, done = np.ones(len(times), dtype=bool), 0
    for place in np.flatnonzero(intervals < SHORT_INTERVAL_SHARE * level):
        if place >= done:
            first, last = _false(times, int(place), float(level[place]))
            stay[first:last] = False
            done = last
    return np.flatnonzero(stay)


def _false(times: FloatArray, place: int, level: float) -> tuple[int, int]:
    """Range (first, last) of the superfluous pulses at a short interval, empty where no choice gives even intervals.

    Either those after this pulse up to the next good one, as by a bouncing contact, or this pulse and those after it:
    whichever leaves the more regular intervals.
    """
    after, misfit = _next(times, place, level)
    if place:
        misfit = max(misfit, _misfit(times[place] - times[place - 1], level))
        good, other = _next(times, place - 1, level)
        other = max(other, _next(times, good, level)[1])
        if other < misfit - CLEAR_MISFIT_DIFFERENCE and other < np.log(SAME_INTERVAL_RATIO):
            return place, good
    return (place + 1, after) if misfit < np.log(SAME_INTERVAL_RATIO) else (place, place)


def _next(times: FloatArray, place: int, level: float) -> tuple[int, float]:
    """Index of the pulse nearest to one usual interval later, and the logarithm of its interval over the usual."""
    due = times[place] + level
    near = int(np.searchsorted(times, due))
    nearest = min(
        (pulse for pulse in (near - 1, near) if place < pulse < len(times)), key=lambda pulse: abs(times[pulse] - due)
    )
    return nearest, _misfit(times[nearest] - times[place], level)


def _misfit(interval: float, level: float) -> float:
    return abs(float(np.log(interval / level)))


def running_median(values: FloatArray, count: int) -> FloatArray:
    """Median of the ``count`` values around each value, (n,), in their unit."""
    from scipy.ndimage import median_filter

    return np.asarray(median_filter(values, min(count, (len(values) - 1) // 2 * 2 + 1), mode="mirror"))


MOST_INTERVAL_RATIO = 1.5
"""Largest ratio of neighbouring pulse intervals that a change of speed may explain, less than a lost or double pulse
makes."""
SIDE_INTERVALS, UNCLEAR_COUNT = 3, 0.2
"""Number of intervals on either side from which the pulses lost in a gap are counted, and the largest distance of that
count from a whole number."""
FEWEST_GAPS, REGULAR_SHARE = 4, 0.8
"""Fewest gaps by which a wheel with missing teeth is recognised, and the least share of gaps at equal distances."""
SWING, SWING_SHARE = 1.25, 0.25
"""Ratio of neighbouring intervals from which on they swing, and share of the intervals that do where vibration, not
lost and double pulses, may make them as uneven as these do."""
USUAL_STEPS, MOST_BEYOND_BAND = 60, 0.02
"""Steps of a turn where they are not given, and RMS in steps beyond the band of pulses that vibration explains: up to
3 degrees of order 12 leave 0.01 at most, numbers that are wrong in every turn more than repaired ones."""
MOST_REPAIRED = 0.1
"""Share of the pulses above which they are not repaired: what returns so often is the wheel, or the pickup."""
INTERVALS_TOGETHER = 2**17
"""Number of intervals that are compared together, which limits the memory."""
MOST_GAPS = 8
"""Most gaps in a turn of a wheel that a question names."""
MOST_LISTED_PULSES = 3
"""Number of pulses that a remark on repairs lists at most, so that it stays short."""


@dataclass(frozen=True, eq=False)
class MissingPulses:
    """Missing pulses of an encoder, ``counts`` of them after each pulse ``after`` (pulses counted from 0)."""

    after: NDArray[np.intp]
    counts: NDArray[np.intp]

    @property
    def total(self) -> int:
        """Number of missing pulses of the encoder over all gaps."""
        return int(self.counts.sum())


@dataclass(frozen=True, eq=False)
class Pulses:
    """Repaired pulses of an encoder, with times (s) and numbers of those kept and what was missing or left out.

    Attributes
    ----------
    times : (n,) array
        Times of the pulses kept, s.
    numbers : (n,) int array
        Encoder steps since the first pulse, lost ones included.
    spurious : (m,) int array
        Indices of the pulses left out, among those given.
    missing : MissingPulses
        Missing pulses, by indices among those kept.
    left_out : (m,) array
        Times of the spurious pulses, s.
    period : int
        Steps from gap to gap of a wheel with missing teeth; 0 if it has none.
    """

    times: FloatArray
    numbers: NDArray[np.intp]
    spurious: NDArray[np.intp]
    missing: MissingPulses
    left_out: FloatArray = field(repr=False)
    period: int = 0

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks on repairs of encoder pulses, with time in s and number of the pulses, as sentences."""
        remarks = []
        if len(self.spurious):
            where = comma_list(
                [f"pulse {n} at {t:.6g} s" for n, t in zip(self.spurious, self.left_out, strict=True)],
                MOST_LISTED_PULSES,
            )
            remarks.append(f"{_count(len(self.spurious))} too many left out: {where}")
        lost = self.irregular
        if lost.total:
            where = comma_list(
                [f"{c} after pulse {n} at {self.times[n]:.6g} s" for n, c in zip(lost.after, lost.counts, strict=True)],
                MOST_LISTED_PULSES,
            )
            remarks.append(f"{_count(lost.total)} missing and counted: {where}")
        return tuple(remarks)

    @property
    def irregular(self) -> MissingPulses:
        """Missing pulses of the encoder without those of missing teeth of its wheel."""
        if not self.period or not self.missing.total:
            return self.missing
        # In the gap of a wheel pulses are missing each turn, at other teeth now and then.
        phase = self.numbers[self.missing.after] % self.period
        phases, often = np.unique(phase, return_counts=True)
        own = phase != phases[often.argmax()]
        return MissingPulses(self.missing.after[own], self.missing.counts[own])


def missing_pulses(times: ArrayLike) -> MissingPulses:
    """Lost pulses of an encoder, found by intervals that are whole multiples of those around them.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse, s. The speed may change, but by less than half between pulses.

    Examples
    --------
    >>> missing_pulses([0.0, 1.0, 2.0, 5.0, 6.0, 7.0, 8.0]).counts
    array([2])
    """
    intervals = np.diff(np.asarray(times, dtype=float))
    if len(intervals) < MEDIAN_INTERVALS:
        return MissingPulses(np.empty(0, np.intp), np.empty(0, np.intp))
    if not np.all(intervals > 0):
        raise UsageError("the times of pulses must be finite and increase", kind="unordered-rows")
    # Over the median around them, which single gaps leave as it is.
    intervals /= running_median(intervals, MEDIAN_INTERVALS)
    steps = np.rint(intervals, out=intervals)
    after = np.flatnonzero(steps > 1)
    return MissingPulses(after, steps[after].astype(np.intp) - 1)


def repaired_pulses(times: ArrayLike, steps_per_revolution: float = 0.0) -> Pulses:
    """Pulses of an encoder with double ones left out and missing ones counted in the numbers of the others.

    Both show in the ratio of neighbouring intervals: a double pulse splits one in two, a lost one joins two. Gaps that
    return once per turn are missing teeth of the wheel.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse, s.
    steps_per_revolution : float, optional
        Steps per revolution, missing teeth included; the distance of regular gaps is compared with it.

    Raises
    ------
    UsageError
        Intervals that neither explains, a gap whose pulses cannot be counted, or regular gaps at another distance
        than a turn; the message has time and number of the pulse.

    Examples
    --------
    >>> pulses = repaired_pulses([0.0, 1.0, 2.0, 2.1, 3.0, 4.0, 6.0, 7.0, 8.0, 9.0])
    >>> pulses.numbers.tolist()
    [0, 1, 2, 3, 4, 6, 7, 8, 9]
    >>> pulses.remarks
    ('1 pulse too many left out: pulse 3 at 2.1 s', '1 pulse missing and counted: 1 after pulse 4 at 4 s')
    """
    stamps = check_pulses(times)
    beyond = _beyond_band_as_they_are(stamps, steps_per_revolution or USUAL_STEPS)
    whole = np.arange(len(stamps))
    none = np.empty(0, np.intp)
    as_they_are = Pulses(stamps, whole, none, MissingPulses(none, none), np.empty(0))
    try:
        pulses = _repaired(stamps, steps_per_revolution)
    except UsageError:
        if beyond < MOST_BEYOND_BAND:
            return as_they_are
        raise
    # Repairs have to make the rotation smoother than vibration alone explains it, or the pulses stay as they are.
    if pulses.missing.total + len(pulses.spurious) and beyond < MOST_BEYOND_BAND:
        repaired = rotation_beyond_band(pulses.times, pulses.numbers, steps_per_revolution or USUAL_STEPS)
        if beyond <= repaired:
            return as_they_are
    lost = pulses.irregular
    if (
        lost.total + len(pulses.spurious) > MOST_REPAIRED * len(stamps)
        and len(lost.after) + len(pulses.spurious) > FEWEST_GAPS
    ):
        raise UsageError(
            f"{len(pulses.spurious)} pulses would be too many and {lost.total} missing of {len(stamps)}: these are no "
            f"faults of single pulses{both_flanks(stamps)}{_gaps_in_words(pulses)}; check the wheel and its pickup",
            kind="unfit-wheel",
        )
    return pulses


def _beyond_band_as_they_are(times: FloatArray, steps: float) -> float:
    """RMS in steps beyond the band if no pulse is lost or double; inf where vibration does not make intervals swing."""
    intervals = np.log(np.diff(times))
    # Vibration makes many intervals swing, single faults of pulses a few.
    swings = np.abs(np.diff(intervals)) > np.log(SWING)
    if swings.sum() <= SWING_SHARE * len(times):
        return np.inf
    return rotation_beyond_band(times, np.arange(len(times)), steps)


def rotation_beyond_band(times: FloatArray, numbers: NDArray[np.intp], steps: float) -> float:
    """RMS in steps of what pulses with these numbers leave beyond the band kept; inf where they cannot be followed."""
    from torsionnet.signals.bandlimited import Rotation

    try:
        return Rotation(times, numbers, steps).beyond_band
    except SolveError:
        return np.inf


def both_flanks(times: FloatArray) -> str:
    """Words on pulses of which every second interval is longer, as rising and falling flanks make them; else empty."""
    intervals = np.diff(times)
    ratio = float(np.median(intervals[::2]) / np.median(intervals[1::2])) if len(intervals) > 1 else 1.0
    ratio = max(ratio, 1 / ratio)
    if ratio < SWING:
        return ""
    return (
        f"; every second interval is {ratio:.3g} times as long: are rising and falling flanks both counted? take one "
        "kind (edge: rising)"
    )


def _repaired(stamps: FloatArray, steps_per_revolution: float) -> Pulses:
    """Pulses with double ones left out and missing ones counted; an error where that does not explain them."""
    kept = indices_without_double(stamps)
    clean = stamps if len(kept) == len(stamps) else stamps[kept]
    missing = missing_pulses(clean)
    numbers = np.ones(len(clean), dtype=np.intp)
    numbers[0] = 0
    # Steps between neighbours, one where nothing is lost; their sum numbers the pulses.
    numbers[missing.after + 1] += missing.counts
    _require_regular(clean, numbers[1:], kept)
    np.cumsum(numbers, out=numbers)
    left_out = np.ones(len(stamps), dtype=bool)
    left_out[kept] = False
    spurious = np.flatnonzero(left_out)
    period = _period(numbers[missing.after], clean[missing.after], steps_per_revolution)
    return Pulses(clean, numbers, spurious, missing, stamps[spurious], period)


def check_pulses(times: ArrayLike) -> FloatArray:
    """Times of pulses in s as an array (n,), refused unless there are two or more and they increase."""
    stamps = np.asarray(times, dtype=float)
    if len(stamps) < 2 or not np.all(stamps[1:] > stamps[:-1]):
        raise UsageError("an angle needs at least two pulses, at finite times that increase", kind="unordered-rows")
    return stamps


@np.errstate(over="ignore", invalid="ignore")  # intervals near 0
def _require_regular(times: FloatArray, steps: NDArray[np.intp], places: NDArray[np.intp]) -> None:
    """Raise an error for intervals that neither lost nor double pulses nor a change of speed explain."""
    each = np.diff(times)
    # Interval of one step: a lost pulse or a gap counts with the steps that it has.
    each /= steps
    if len(each) <= MEDIAN_INTERVALS:
        return
    gaps = np.flatnonzero(steps > 1)
    sides = np.array([_level_beside(each, gaps, -1), _level_beside(each, gaps, 1)])
    intervals = times[gaps + 1] - times[gaps]
    # How many intervals of its left and of its right side a gap is long; the two have to agree on a whole number.
    of_sides = intervals / np.where(np.isnan(sides), sides[::-1], sides)
    unclear = (np.ptp(of_sides, axis=0) > 1) | (np.abs(of_sides.mean(axis=0) - steps[gaps]) > UNCLEAR_COUNT)
    for gap, interval, counts in zip(gaps[unclear], intervals[unclear], of_sides.T[unclear], strict=True):
        where = f"the gap of {interval:.4g} s after pulse {places[gap]} at {times[gap]:.6g} s"
        raise UsageError(
            f"{where} is {counts.min():.2f} to {counts.max():.2f} times as long as those around it: how many "
            "pulses are missing cannot be told; cut the record there",
            kind="lost-pulses",
        )
    largest, at = 0.0, 0
    for begin in range(0, len(each) - 1, INTERVALS_TOGETHER):
        some = each[begin : begin + INTERVALS_TOGETHER + 1]
        change = np.maximum(some[1:] / some[:-1], some[:-1] / some[1:])
        if change.max() > largest:
            largest, at = float(change.max()), begin + int(change.argmax())
    if largest > MOST_INTERVAL_RATIO:
        raise UsageError(
            f"the intervals on either side of pulse {places[at + 1]} at {times[at + 1]:.6g} s differ by a factor of "
            f"{largest:.2f}: neither a lost pulse nor one too many explains that{both_flanks(times)}; cut the record "
            "there",
            kind="lost-pulses",
        )


def _level_beside(values: FloatArray, places: NDArray[np.intp], side: int) -> FloatArray:
    """Median of the values on one side of each place, (n,), in their unit; NaN where there are none."""
    around = places[:, None] + side * np.arange(1, SIDE_INTERVALS + 1)
    inside = (around >= 0) & (around < len(values))
    known = np.where(inside, values[np.clip(around, 0, len(values) - 1)], np.nan)
    result = np.full(len(places), np.nan)
    some = inside.any(axis=1)
    result[some] = np.nanmedian(known[some], axis=1)
    return result


def _period(numbers: NDArray[np.intp], times: FloatArray, steps: float) -> int:
    """Number of encoder steps between gaps that return regularly, or 0 if they do not."""
    if len(numbers) < FEWEST_GAPS:
        return 0
    distances, counts = np.unique(np.diff(numbers), return_counts=True)
    most = int(counts.argmax())
    period = int(distances[most])
    if counts[most] < REGULAR_SHARE * (len(numbers) - 1):
        return 0
    if steps and period != steps:
        raise UsageError(
            f"pulses are missing every {period} pulses, first at {times[0]:.6g} s: a wheel with a gap, of {period} "
            f"steps per revolution with the missing ones; give this number instead of {steps:g}",
            kind="unfit-wheel",
        )
    return period


def _gaps_in_words(pulses: Pulses) -> str:
    """Question after the gaps of a wheel, where several return in the same sequence, for an error; else empty."""
    missing = pulses.missing
    numbers = pulses.numbers[missing.after]
    for gaps in range(2, min(MOST_GAPS, len(numbers) // 2) + 1):
        distances = numbers[gaps:] - numbers[:-gaps]
        again = (distances == np.median(distances)) & (missing.counts[gaps:] == missing.counts[:-gaps])
        if again.mean() >= REGULAR_SHARE:
            turn = int(np.median(distances))
            runs = runs_in_words(zip(numbers[:gaps].tolist(), missing.counts[:gaps].tolist(), strict=True), turn)
            return f"; gaps return every {turn} places: if the wheel is like that, give teeth: {turn}, pattern: {runs}"
    return ""


def _count(number: int) -> str:
    return f"{number} pulse{'s' * (number != 1)}"
