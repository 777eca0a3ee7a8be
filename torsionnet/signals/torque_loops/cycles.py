"""Cycles of a slow test of a component, cut at the reversals of its twist, and gathered where they repeat."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

BoolArray = NDArray[np.bool_]

TURNED_BACK = 0.5
"""Share of the smallest swing looked for by which the twist has to turn back until a reversal counts."""
SMALLEST_SWING = 0.02
"""Smallest swing that is looked for, as a share of the whole range of the twist."""
CLEAR_OF_NOISE = 20.0
"""Smallest swing over the noise of the twist, standard deviations."""
END_SHARE = 0.05
"""Share of a cycle next to a reversal through which a parabola is laid to find the value at the reversal."""
FEWEST = 8
"""Fewest samples of such a parabola, and of a branch."""
ALIKE = 0.03
"""Largest difference of the reversals of two cycles that repeat each other, as a share of their swing."""
DEGREES = (7, 5, 3, 1)
"""Degrees of the polynomial for the twist of a branch over time: half a sine asks for more than a straight line."""
AS_GOOD = 1.2
"""Largest ratio of what a polynomial leaves of the twist to what the highest degree leaves, if it is as good."""
AS_LONG = 1.1
"""Largest ratio of the lengths of two cycles that repeat each other."""
REGULAR = 0.03
"""Largest deviation of the times of reversals from even ones, as a share of the period, of cycles of one period."""


@dataclass(frozen=True, eq=False)
class Cycle:
    """Cycle of a twist from one lowest value to the next, as places in a record.

    Attributes
    ----------
    first, top, last : int
        Samples of the lowest value where it begins, of the highest, and of the lowest where it ends.
    low, high, end : float
        Twist there in rad, by parabolas through the samples before and behind.
    """

    first: int
    top: int
    last: int
    low: float
    high: float
    end: float

    @property
    def swing(self) -> float:
        """Highest less lowest twist of a cycle in rad."""
        return self.high - (self.low + self.end) / 2

    def repeats(self, other: Cycle) -> bool:
        """Whether another cycle reverses at the same twists and takes as long."""
        lengths = sorted((self.last - self.first, other.last - other.first))
        if lengths[1] > AS_LONG * lengths[0]:
            return False
        largest = ALIKE * max(self.swing, other.swing)
        # A drift moves the lower reversal within a cycle: the mean of begin and end counts.
        lows = abs((self.low + self.end) / 2 - (other.low + other.end) / 2)
        return max(abs(self.high - other.high), lows, abs(self.low - self.end)) <= largest


def noise_of(values: FloatArray) -> float:
    """Standard deviation of the noise of a signal that is smooth from sample to sample, by its second differences.

    Steps of an encoder count as noise where a step is shorter than about three samples.

    >>> samples = np.sin(np.arange(4000) / 100) + np.random.default_rng(1).normal(0, 0.1, 4000)
    >>> round(noise_of(samples), 2)
    0.1
    """
    # White noise of variance s^2 makes second differences of variance (1 + 4 + 1) s^2.
    bend = np.diff(values, 2)
    return float(np.sqrt(np.mean(np.clip(bend, *np.quantile(bend, (0.01, 0.99))) ** 2) / 6)) if len(bend) else 0.0


def reversals(twist: FloatArray, least: float) -> list[int]:
    """Places where a twist (n,) turns back by at least ``least`` in rad, in turn lowest and highest values.

    >>> reversals(np.array([0.0, 1, 2, 1.9, 2.1, 1, 0, 1]), 0.5)
    [4, 6]
    """
    turns: list[int] = []
    place, until, sense = 0, 0, 0
    for at, value in enumerate(twist.tolist()):
        beyond = value - twist[place]
        if sense == 0:
            if abs(beyond) >= least:
                sense, place, until = (1 if beyond > 0 else -1), at, at
        elif beyond == 0:
            until = at
        elif beyond * sense > 0:
            place, until = at, at
        elif -beyond * sense >= least:
            turns.append((place + until) // 2)  # an encoder stands still between its steps
            sense, place, until = -sense, at, at
    return turns


def end_value(values: FloatArray, beyond: int = 0) -> float:
    """Last value of a piece of a signal (n,), or that some samples beyond it, by a parabola through all of it."""
    place = np.arange(-len(values) - beyond + 1, 1 - beyond) / len(values)
    columns = place[:, None] ** np.arange(3)
    return float(np.linalg.lstsq(columns, values, rcond=None)[0][0])


def cut_cycles(twist: FloatArray, noise: float) -> list[Cycle]:
    """Cycles of a twist (n,) in rad from one lowest value to the next, in their order."""
    span = float(np.ptp(twist)) if len(twist) else 0.0
    least = TURNED_BACK * max(SMALLEST_SWING * span, CLEAR_OF_NOISE * noise)
    places = reversals(twist, least) if span > 0 else []
    if not places:
        return []
    first = int(len(places) > 1 and twist[places[0]] > twist[places[1]])  # cycles begin at a lowest value
    return [
        cycle_at(twist, *bounds)
        for bounds in zip(places[first::2], places[first + 1 :: 2], places[first + 2 :: 2], strict=False)
        if min(np.diff(bounds)) >= FEWEST
    ]


def cycle_at(twist: FloatArray, first: int, top: int, last: int) -> Cycle:
    """Cycle with its reversals at samples of a twist (n,) in rad.

    The largest sample has its noise with it; parabolas through the samples before and behind have not.
    """
    reach = max(FEWEST, int(END_SHARE * (last - first)))

    def turning(at: int, *, before: bool, behind: bool) -> float:
        left = [end_value(twist[max(0, at - reach) : at + 1])] if before else []
        right = [end_value(twist[at : at + reach + 1][::-1])] if behind else []
        return float(np.mean([*left, *right]))

    low = turning(first, before=first >= FEWEST, behind=True)
    end = turning(last, before=True, behind=len(twist) - 1 - last >= FEWEST)
    return Cycle(first, top, last, low, turning(top, before=True, behind=True), end)


def repeated_cycles(cycles: Sequence[Cycle]) -> list[list[Cycle]]:
    """Runs of cycles that follow each other and reverse at the same twists, in their order; single ones as well."""
    runs: list[list[Cycle]] = []
    for cycle in cycles:
        if runs and runs[-1][-1].last == cycle.first and runs[-1][0].repeats(cycle) and runs[-1][-1].repeats(cycle):
            runs[-1].append(cycle)
        else:
            runs.append([cycle])
    return runs


def even_bounds(cycles: Sequence[Cycle], time: FloatArray) -> FloatArray:
    """Times in s at which the cycles of a run begin and end, shape (n + 1,), on an even grid where they are even.

    The time of a single reversal of a sine is known to a few samples only.
    """
    ends = np.array([time[cycle.first] for cycle in cycles] + [time[cycles[-1].last]])
    tops = np.array([time[cycle.top] for cycle in cycles])
    number = np.arange(len(ends))
    halves, times = np.concatenate([number, number[:-1] + 0.5]), np.concatenate([ends, tops])
    # Reversals are half a period apart only if both ways take equally long: a column for the other case.
    columns = np.stack([np.ones_like(halves), halves, halves % 1 > 0], axis=1)
    (begin, period, _), *_ = np.linalg.lstsq(columns, times, rcond=None)
    even = begin + period * number
    is_even = np.abs(even - ends).max() <= REGULAR * period and even[0] >= time[0] and even[-1] <= time[-1]
    return np.asarray(even if is_even else ends)


def rising_of(cycles: Sequence[Cycle]) -> tuple[NDArray[np.intp], FloatArray]:
    """Samples of a run of cycles, and the sense of the twist there, 1 where it rises and -1 where it falls."""
    places = np.arange(cycles[0].first, cycles[-1].last)
    sense = np.empty(len(places))
    for cycle, (begin, end) in zip(cycles, pairwise([*(c.first for c in cycles), cycles[-1].last]), strict=True):
        sense[begin - places[0] : end - places[0]] = np.where(np.arange(begin, end) < cycle.top, 1.0, -1.0)
    return places, sense


def smooth_twist(twist: FloatArray, cycle: Cycle) -> FloatArray:
    """Twist in rad over the samples of a cycle without noise and steps: a polynomial for each way.

    It is good for half a sine and for a straight line.
    """
    halves = np.split(twist[cycle.first : cycle.last], [cycle.top - cycle.first])
    return np.concatenate([_polynomial(half) for half in halves])


def _polynomial(branch: FloatArray) -> FloatArray:
    """Values of the polynomial of the lowest degree that is good enough: higher ones follow the steps of an encoder."""
    place = np.linspace(-1, 1, len(branch))
    best: FloatArray | None = None
    least = 0.0
    for degree in DEGREES:
        fitted = np.polynomial.Chebyshev.fit(place, branch, degree)(place)
        left = float(np.std(branch - fitted))
        if best is not None and left > AS_GOOD * least:
            break
        best, least = fitted, least or max(left, 1e-9 * float(np.ptp(branch)))
    assert best is not None
    return np.asarray(best)
