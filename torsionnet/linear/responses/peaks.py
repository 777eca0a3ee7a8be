"""Static value and peaks of a frequency response of one output to one input."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.frequency_response import FrequencyResponse

Solver: TypeAlias = Callable[[FloatArray], FrequencyResponse]
"""Function that returns the frequency response of a drivetrain at given frequencies in Hz."""

REFINEMENT_ROUNDS, REFINEMENT_POINTS = 3, 41
"""Number of rounds that refine a peak, and points in each, so that every round divides the interval by twenty."""
PEAK_PROMINENCE = 1e-9
"""Share of a magnitude by which a peak must exceed the valleys beside it, since less may be rounding."""


@dataclass(frozen=True)
class Peak:
    """Local maximum of a response's magnitude, as frequency in Hz, magnitude in SI units and phase in degrees."""

    frequency: float
    magnitude: float
    phase: float


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
    found = []
    for index in inner_maxima(values):
        valleys = []
        for side in (values[index::-1], values[index:]):
            higher = np.flatnonzero(side > values[index])
            valleys.append(side[: higher[0] if len(higher) else None].min())
        if max(valleys) < (1 - PEAK_PROMINENCE) * values[index]:
            found.append(index)
    return found


def static_value(solve: Solver, output: int, input: int) -> complex:
    """Complex value of the response at 0 Hz in SI units, nan where the request has no answer there."""
    try:
        return complex(solve(np.zeros(1)).values[0, output, input])
    except UsageError:
        return complex(math.nan)
