"""Frequencies for a response, dense enough around every resonance to show its peak."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated, TypeAlias

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.result_rows import Out
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.linear.modes.modes import Modes

PEAK_PHASE_RANGE = 85.0
"""Phase in degrees to either side of a resonance that gets dense points, beyond which the flanks of a peak are
smooth."""
UNDAMPED_HALF_WIDTH = 1e-6
"""Half width given to a peak without damping, as a share of its frequency, so that points stand on both sides of it."""
RANGE_BELOW, RANGE_ABOVE = 10.0, 2.0
"""Factors of a frequency range below the lowest and above the highest vibration, so that the asymptotes show."""
FIRST_SEEN, MARGIN_BELOW, MARGIN_ABOVE = 6, 3.0, 1.5
"""Number of vibrations in the first view of a response, and factors of its range below and above them."""
RANGE_WITHOUT_MODES = (0.1, 100.0)
"""Frequency range in Hz that is shown of a drivetrain without vibrations, where no mode says which."""
EQUAL_FREQUENCY_DISTANCE = 1e-10
"""Relative distance of frequencies below which two points count as one, since rounding would show as peaks between
them."""


@dataclass(frozen=True)
class Adaptive:
    """Frequency range in Hz that gets as many points as the peaks of a response need. Pass it as ``frequencies=``.

    Parameters
    ----------
    start, stop : float
        Hz.
    points : int
        Evenly spaced ones (by equal factors where the range is more than a decade and does not begin at 0).
    per_peak : int
        More of them around every mode in the range, at f = f_d + zeta f_0 tan(phi) for equal steps of phi: a resonance
        of half-power bandwidth 2 zeta f_0 has a phase of 90 degrees - phi there.

    Examples
    --------
    >>> import torsionnet as tn
    >>> H = tn.load("dmf_rig").frequency_response("theta_1", "T_T", tn.Adaptive(1, 200))
    >>> len(H.frequencies) > 200
    True
    """

    start: float
    stop: float
    points: int = 200
    per_peak: int = 35

    def __post_init__(self) -> None:
        if not (0 <= self.start < self.stop < np.inf) or min(self.points, self.per_peak) < 1:
            raise UsageError(
                f"a range of frequencies needs 0 <= start < stop and points, got {self}", kind="unordered-rows"
            )

    def frequencies(self, *modes: Modes) -> FloatArray:
        """Frequencies (n,) in Hz, rising, that resolve the peaks of these modes."""
        spaced = np.geomspace if 0 < 10 * self.start <= self.stop else np.linspace
        phase = np.radians(np.linspace(-PEAK_PHASE_RANGE, PEAK_PHASE_RANGE, self.per_peak))
        frequencies = [np.asarray(spaced(self.start, self.stop, self.points))]
        for mode in modes:
            eigenvalues = mode.eigenvalues[mode.eigenvalues.imag > 0]
            # f = f_d + zeta f_0 tan(phi), with zeta f_0 = -Re lambda / 2 pi
            peak = eigenvalues.imag / (2 * np.pi)
            width = np.maximum(-eigenvalues.real / (2 * np.pi), UNDAMPED_HALF_WIDTH * peak)
            frequencies.append((peak[:, None] + width[:, None] * np.tan(phase)).ravel())
        f = np.unique(np.concatenate(frequencies))
        # Two systems may have a mode in common but for rounding: points that close would show noise as peaks.
        apart = np.append(True, np.diff(f) > EQUAL_FREQUENCY_DISTANCE * f[1:])
        return np.asarray(f[apart & (f >= self.start) & (f <= self.stop)])


def vibration_range(*modes: Modes) -> tuple[float, float]:
    """Frequency range in Hz from a tenth of the lowest to twice the highest vibration of all modes.

    Both ends are round numbers.

    >>> import torsionnet as tn
    >>> vibration_range(tn.load("dmf_rig").modes())
    (0.5, 200.0)
    """
    vibrations = [value for mode in modes for value in mode.damped_frequencies if value > 0]
    if not vibrations:
        return RANGE_WITHOUT_MODES
    low, high = float(min(vibrations)), float(max(vibrations))
    return round_number(low / RANGE_BELOW, up=False), round_number(high * RANGE_ABOVE, up=True)


def opening_range(*modes: Modes) -> tuple[float, float]:
    """Frequency range in Hz to show first, around the lowest few vibrations of each drivetrain.

    Both ends are round numbers.

    >>> import torsionnet as tn
    >>> opening_range(tn.load("six_cylinder_diesel").modes())
    (50.0, 5000.0)
    """
    vibrations = [sorted(float(value) for value in mode.damped_frequencies if value > 0)[:FIRST_SEEN] for mode in modes]
    if not any(vibrations):
        return RANGE_WITHOUT_MODES
    low, high = min(few[0] for few in vibrations if few), max(few[-1] for few in vibrations if few)
    return round_number(low / MARGIN_BELOW, up=False), round_number(high * MARGIN_ABOVE, up=True)


def round_number(value: float, *, up: bool) -> float:
    """Next round number of the series 1, 2, 5 times a power of ten, up or down from a value.

    >>> round_number(0.71, up=False), round_number(162, up=True)
    (0.5, 200.0)
    """
    decade = 10.0 ** math.floor(math.log10(value))
    steps = [factor * decade for factor in (1, 2, 5, 10)]
    return (
        next(step for step in steps if step >= value) if up else next(step for step in reversed(steps) if step <= value)
    )


# Static value and peaks of a frequency response of one output to one input.

Solver: TypeAlias = Callable[[FloatArray], FrequencyResponse]
"""Function that returns the frequency response of a drivetrain at given frequencies in Hz."""

REFINEMENT_ROUNDS, REFINEMENT_POINTS = 3, 41
"""Number of rounds that refine a peak, and points in each, so that every round divides the interval by twenty."""
PEAK_PROMINENCE = 1e-9
"""Share of a magnitude by which a peak must exceed the valleys beside it, since less may be rounding."""


@dataclass(frozen=True)
class Peak:
    """Local maximum of a response's magnitude, as frequency in Hz, magnitude in SI units and phase in degrees."""

    frequency: Annotated[float, Out(json="frequency_Hz")]
    magnitude: float
    phase: Annotated[float, Out(json="phase_deg")]


def peaks(response: FrequencyResponse, solve: Solver, output: int, input: int) -> Iterator[Peak]:
    """Yield local maxima of a response's magnitude inside its frequency range, each refined on ever finer grids."""
    magnitude = response.magnitude[:, output, input]
    for index in _standing_out(magnitude):
        low, high = response.frequencies[index - 1], response.frequencies[index + 1]
        for _ in range(REFINEMENT_ROUNDS):
            grid = np.linspace(low, high, REFINEMENT_POINTS)
            fine = solve(grid)
            best = int(np.argmax(fine.magnitude[:, output, input]))
            low, high = grid[max(best - 1, 0)], grid[min(best + 1, REFINEMENT_POINTS - 1)]
        value = fine.values[best, output, input]
        yield Peak(float(grid[best]), float(abs(value)), float(np.degrees(np.angle(value))))


def inner_maxima(values: FloatArray) -> list[int]:
    """Indices of values above the one before and not below the one after, where the ends do not count.

    >>> inner_maxima(np.array([3.0, 1.0, 2.0, 2.0, 1.0, 4.0]))
    [2]
    """
    rises, falls = values[1:-1] > values[:-2], values[1:-1] >= values[2:]
    return [int(index) + 1 for index in np.flatnonzero(rises & falls)]


def _standing_out(values: FloatArray) -> list[int]:
    """Indices of inner maxima that are more than rounding. A constant has none.

    >>> _standing_out(np.array([1.0, 1 + 2e-16, 1.0, 1 + 4e-16, 1.0, 2.0, 1.5]))
    [5]
    """
    prominent = []
    for index in inner_maxima(values):
        # On both sides the lowest value before the curve is higher than here: the peak rises above both.
        valleys = []
        for side in (values[index::-1], values[index:]):
            higher = np.flatnonzero(side > values[index])
            valleys.append(side[: higher[0] if len(higher) else None].min())
        if max(valleys) < (1 - PEAK_PROMINENCE) * values[index]:
            prominent.append(index)
    return prominent


def static_value(solve: Solver, output: int, input: int) -> complex:
    """Complex value of the response at 0 Hz in SI units, nan where the request has no answer there."""
    try:
        return complex(solve(np.zeros(1)).values[0, output, input])
    except UsageError:
        return complex(math.nan)
