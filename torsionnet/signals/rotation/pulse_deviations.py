"""Errors of the times and of the places of a wheel's pulses: what the counter leaves, and what the pulses show.

What repeats from turn to turn are places of teeth or whole orders; what does not are times, or half orders. Both have
slow parts that are vibration: only the sixth difference from tooth to tooth is taken, in which independent errors grow
by sqrt(924) and order o of z by (2 sin(pi o/z))^6, at order 6 of 60 to a twentieth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import comb, sqrt

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

DIFFERENCES = 6
"""Number of times that differences from tooth to tooth are taken, so that orders up to a tenth of the teeth vanish."""
DIFFERENCE_GAIN = sqrt(comb(2 * DIFFERENCES, DIFFERENCES))
"""Factor by which the differences raise the standard deviation of independent errors."""
FEWEST_TURNS, FEWEST_TEETH = 3, 12
"""Fewest turns, and teeth of a turn, from which errors of times and places are told apart."""
NORMAL_FROM_MEDIAN = 1.4826
"""Standard deviation of normal errors over the median of their sizes, which single disturbances leave as it is."""
PULSES_TOGETHER = 2**17
"""Number of pulses whose differences are taken together, which limits the memory."""
UNIFORM_STEPS = sqrt(12)
"""Step of a counter over the standard deviation of the time it leaves."""


@dataclass(frozen=True)
class PulseDeviations:
    """Standard deviations of the times and of the places of a wheel's pulses.

    Attributes
    ----------
    tick : float
        Step of the counter, s; 0 where it is not known.
    jitter : float or None
        Standard deviation of the times that the pulses show, s, with that of the counter; None where they are too few.
    places : float or None
        Standard deviation of the places of the teeth on the wheel, rad, as far as they are independent from tooth to
        tooth; None where the pulses are too few.
    pattern : float or None
        That of a pitch pattern which was removed, rad, from its intervals; None without one.
    """

    tick: float = 0.0
    jitter: float | None = None
    places: float | None = None
    pattern: float | None = None

    @property
    def time(self) -> float:
        """Standard deviation of the times of pulses in s: what the counter leaves, or more if more is seen."""
        return max(self.tick / UNIFORM_STEPS, self.jitter or 0.0)

    @property
    def place(self) -> float:
        """Standard deviation of the places of teeth in rad on the wheel: by the pattern, or more if more is seen."""
        return max(self.pattern or 0.0, self.places or 0.0)


def seen_deviations(
    read: Callable[[slice], tuple[FloatArray, FloatArray]], numbers: NDArray[np.intp], teeth: int
) -> tuple[float | None, float | None]:
    """Standard deviations of the times in s and of the places in rad that pulses show, None where they are too few.

    Parameters
    ----------
    read : callable
        Angle of the wheel beyond a smooth course in rad, and its speed in rad/s, at a range of the pulses.
    numbers : (n,) int array
        Tooth of each pulse, counted on from turn to turn.
    teeth : int
    """
    turns = int(numbers[-1] - numbers[0]) // teeth
    if turns < FEWEST_TURNS or teeth < FEWEST_TEETH:
        return None, None
    sums, counts, of_speeds = np.zeros(teeth), np.zeros(teeth), 0.0
    sizes, count = np.empty((turns - 1) * teeth), 0
    together = max(PULSES_TOGETHER // teeth, 1)
    for turn in range(0, turns, together):
        last = turn + together >= turns
        steps, between, speeds = _turns(read, numbers, teeth, turn, None if last else turn + together)
        known = np.isfinite(steps)
        counts += known.sum(axis=0)
        sums += np.where(known, steps, 0.0).sum(axis=0)
        of_speeds += speeds
        sizes[count : count + len(between)] = between
        count += len(between)
    # Errors of times differ from turn to turn, errors of places stay in the mean over the turns.
    jitter = _standard_deviation(sizes[:count])
    some = counts > 0
    means = sums[some] / counts[some]
    if jitter is None or len(means) < 2:
        return jitter, None
    # Jitter, as an angle at the mean speed, stays in a mean over n turns by 1/sqrt(n); its square is taken off.
    of_times = jitter * of_speeds / len(numbers) / sqrt(float(counts[some].mean()))
    squared = float(np.mean(means**2)) / DIFFERENCE_GAIN**2 - of_times**2
    return jitter, sqrt(max(squared, 0.0))


def _turns(
    read: Callable[[slice], tuple[FloatArray, FloatArray]],
    numbers: NDArray[np.intp],
    teeth: int,
    begin: int,
    end: int | None,
) -> tuple[FloatArray, FloatArray, float]:
    """Differences from tooth to tooth in rad in the turns from ``begin`` up to ``end``, by turn and tooth.

    And what differs in the next turn, in s, where it is known; and the sum of the speeds at the pulses in rad/s.
    """
    turns = int(numbers[-1] - numbers[0]) // teeth
    stop, next_stop = end or turns, min((end or turns) + 1, turns)
    first = numbers[0] + begin * teeth
    # Differences need some teeth of the turn behind, and speeds the pulse behind it.
    count = min((next_stop - begin) * teeth + DIFFERENCES, (turns - begin) * teeth)
    low, own, high = np.searchsorted(numbers, [first, numbers[0] + stop * teeth, first + count])
    part = slice(int(low), len(numbers) if end is None else int(high) + 1)
    residuals, speeds = read(part)
    at = numbers[part] - first
    whole = np.full(count, np.nan)
    inside = at < count
    whole[at[inside]] = residuals[inside]
    # High differences take out vibration of low orders and keep the errors of single teeth.
    steps = np.diff(whole, DIFFERENCES)
    # A tooth has the same place a turn later, so that times alone differ; sqrt(2) as two errors add in squares.
    between = (steps[teeth:] - steps[:-teeth]) / sqrt(2)
    rates = np.interp(np.arange(len(between)) + teeth, at, speeds)
    differing = (between / rates)[: (stop - begin) * teeth]
    by_turn = np.concatenate([steps, np.full(DIFFERENCES, np.nan)])[: (stop - begin) * teeth].reshape(-1, teeth)
    return by_turn, differing[np.isfinite(differing)], float(speeds[: None if end is None else own - low].sum())


def _standard_deviation(differences: FloatArray) -> float | None:
    """Standard deviation of errors from their differences, which are overwritten; None where there are too few."""
    if len(differences) < 2:
        return None
    sizes = np.abs(differences, out=differences)
    return NORMAL_FROM_MEDIAN * float(np.median(sizes, overwrite_input=True)) / DIFFERENCE_GAIN
