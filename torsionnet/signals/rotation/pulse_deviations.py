"""Errors of the times and of the places of a wheel's pulses: what the counter leaves, and what the pulses show.

What repeats from turn to turn are places of teeth or whole orders; what does not are times, or half orders. Both have
slow parts that are vibration: only the sixth difference from tooth to tooth is taken, in which independent errors grow
by sqrt(924) and order o of z by (2 sin(pi o/z))^6, at order 6 of 60 to a twentieth.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, sqrt

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.recording import FloatArray

DIFFERENCES = 6
"""Number of times that differences from tooth to tooth are taken, so that orders up to a tenth of the teeth vanish."""
DIFFERENCE_GAIN = sqrt(comb(2 * DIFFERENCES, DIFFERENCES))
"""Factor by which the differences raise the standard deviation of independent errors."""
FEWEST_TURNS, FEWEST_TEETH = 3, 12
"""Fewest turns, and teeth of a turn, from which errors of times and places are told apart."""
NORMAL_FROM_MEDIAN = 1.4826
"""Standard deviation of normal errors over the median of their sizes, which single disturbances leave as it is."""
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
    residuals: FloatArray, speeds: FloatArray, numbers: NDArray[np.intp], teeth: int
) -> tuple[float | None, float | None]:
    """Standard deviations of the times in s and of the places in rad that pulses show, None where they are too few.

    Parameters
    ----------
    residuals : (n,) array
        Angle of the wheel at each pulse beyond a smooth course, rad.
    speeds : (n,) array
        Speed of the wheel at each pulse, rad/s.
    numbers : (n,) int array
        Tooth of each pulse, counted on from turn to turn.
    teeth : int
    """
    turns = int(numbers[-1] - numbers[0]) // teeth
    if turns < FEWEST_TURNS or teeth < FEWEST_TEETH:
        return None, None
    whole = np.full(turns * teeth, np.nan)
    inside = numbers - numbers[0] < len(whole)
    whole[numbers[inside] - numbers[0]] = residuals[inside]
    steps = np.diff(whole, DIFFERENCES)
    between = (steps[teeth:] - steps[:-teeth]) / sqrt(2)
    rates = np.interp(np.arange(len(between)) + teeth, numbers - numbers[0], speeds)
    jitter = _standard_deviation(between / rates)
    by_tooth = np.concatenate([steps, np.full(DIFFERENCES, np.nan)]).reshape(turns, teeth)
    known = np.isfinite(by_tooth)
    counts = known.sum(axis=0)
    means = np.where(known, by_tooth, 0.0).sum(axis=0)[counts > 0] / counts[counts > 0]
    if jitter is None or len(means) < 2:
        return jitter, None
    of_times = jitter * float(np.mean(speeds)) / sqrt(float(counts[counts > 0].mean()))
    squared = float(np.mean(means**2)) / DIFFERENCE_GAIN**2 - of_times**2
    return jitter, sqrt(max(squared, 0.0))


def _standard_deviation(differences: FloatArray) -> float | None:
    known = differences[np.isfinite(differences)]
    if len(known) < 2:
        return None
    return NORMAL_FROM_MEDIAN * float(np.median(np.abs(known))) / DIFFERENCE_GAIN
