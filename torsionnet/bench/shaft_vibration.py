"""Vibration of the channels of a bench that turns, at any time: steady orders in closed form, or along a speed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from torsionnet.bench.mean_motion import MeanMotion
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.machinery.passage.passage_response import PassageResponse
from torsionnet.signals.recording import FloatArray

SPLINE_DEGREE = 5
"""Degree of the spline through the steps of a passage, 16 in a period of its highest order: it misses that order by
about 1e-5 of its amplitude."""
VALUES_PER_CHUNK = 2**16
"""Number of times at which all orders are summed together, which limits the memory."""


class Vibration(Protocol):
    """Vibration of channels about their mean values, at any time of a test."""

    def at(self, place: int, times: FloatArray, derivative: int = 0) -> FloatArray:
        """Vibration of a channel in SI units, or its derivative over time, at times in s, shape (n,)."""
        ...


@dataclass(frozen=True, eq=False)
class SteadyVibration:
    """Steady vibration: a sum of orders and of fixed frequencies, exact at every time.

    Attributes
    ----------
    mean : MeanMotion
        Rotation at constant speed.
    relative : (n_lines,) array
        Vibrations per revolution of the reference shaft.
    fixed : (n_lines,) array
        Angular frequencies that come on top, rad/s.
    values : (n_lines, n_sensors) complex array
        Peak amplitudes, SI.
    """

    mean: MeanMotion
    relative: FloatArray
    fixed: FloatArray
    values: ComplexArray

    def at(self, place: int, times: FloatArray, derivative: int = 0) -> FloatArray:
        """Vibration of a channel in SI units, or its derivative over time, at times in s, shape (n,)."""
        rates = self.relative * self.mean.speeds[0] + self.fixed
        amplitudes = self.values[:, place] * (1j * rates) ** derivative
        found = np.empty(len(times))
        for part in _chunks(len(times)):
            at = times[part]
            turning = np.outer(self.mean.angle(at), self.relative) + np.outer(at, self.fixed)
            found[part] = (np.exp(1j * turning) @ amplitudes).real
        return found


@dataclass(frozen=True, eq=False)
class PassageVibration:
    """Vibration along a speed over time, by a spline through the steps of a passage.

    ``drift`` is what the angle of each channel drifts from the mean rotation, (2, n_sensors): at time 0 in its unit,
    and per s.
    """

    run: PassageResponse
    drift: FloatArray

    @cached_property
    def _splines(self) -> list[Any]:
        from scipy.interpolate import make_interp_spline

        times = self.run.times
        line = self.drift[0] + np.outer(times, self.drift[1])
        return [
            make_interp_spline(times, column, k=SPLINE_DEGREE)
            for column in (self.run.values[:, : line.shape[1]] - line).T
        ]

    def at(self, place: int, times: FloatArray, derivative: int = 0) -> FloatArray:
        """Vibration of a channel in SI units, or its derivative over time, at times in s, shape (n,)."""
        return np.asarray(self._splines[place](times, nu=derivative))


def _chunks(count: int) -> Iterator[slice]:
    yield from (slice(begin, begin + VALUES_PER_CHUNK) for begin in range(0, count, VALUES_PER_CHUNK))
