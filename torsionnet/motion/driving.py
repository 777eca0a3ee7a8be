"""Torques, and scales of torques, that act on a plant over time, as straight lines and waves between their breaks."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.scenarios.time_history import SAMPLE_SLACK, TimeHistory

KINK = 1e-12
"""Share of the largest torque by which three samples may miss a straight line through rounding."""


@dataclass(frozen=True, eq=False)
class DrivingWave:
    """Term Re(A exp(s (t - t_0))) of one entry of u in a stretch that begins at t_0."""

    entry: int
    amplitude: complex
    exponent: complex


@dataclass(frozen=True, eq=False)
class Stretch:
    """Values of all entries of u from ``start`` to ``end`` in s: straight lines and waves without a break.

    ``values`` and ``slopes`` (n_u,) are those of the straight lines at the start.
    """

    start: float
    end: float
    values: FloatArray
    slopes: FloatArray
    waves: tuple[DrivingWave, ...] = ()

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Values (n_u, n), and their rates of change, at times (n,) in s."""
        passed = times - self.start
        values = self.values[:, None] + self.slopes[:, None] * passed
        slopes = np.repeat(self.slopes[:, None], len(passed), axis=1)
        for one in self.waves:
            wave = one.amplitude * np.exp(one.exponent * passed)
            values[one.entry] += wave.real
            slopes[one.entry] += (one.exponent * wave).real
        return values, slopes

    def at_once(self, time: float) -> FloatArray:
        """Values (n_u,) at a time in s."""
        values = self.values + self.slopes * (time - self.start)
        for one in self.waves:
            values[one.entry] += (one.amplitude * np.exp(one.exponent * (time - self.start))).real
        return values


@dataclass(frozen=True, eq=False)
class Driving:
    """Entries of u over time, each given by samples (n,), straight between them, or by a history.

    ``rate`` is that of the samples in Hz and ``n`` their number.
    """

    entries: tuple[FloatArray | TimeHistory, ...]
    rate: float
    n: int

    @property
    def duration(self) -> float:
        """Time in s from the first to the last sample."""
        return (self.n - 1) / self.rate

    @property
    def first(self) -> FloatArray:
        """Values (n_u,) at the first sample."""
        return np.array([_value(one, 0.0) for one in self.entries])

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times in s within the duration at which a piece of a history begins."""
        starts = {self._at_sample(at) for one in self.entries if not isinstance(one, np.ndarray) for at in one.breaks}
        return tuple(sorted(start for start in starts if 0 < start < self.duration))

    def _at_sample(self, time: float) -> float:
        """Time in s, or that of the sample that it hits but for rounding."""
        number = round(time * self.rate)
        return number / self.rate if abs(time * self.rate - number) < SAMPLE_SLACK else time

    def straight(self, start: float, end: float) -> Stretch:
        """Stretch between two times in s with no break between them; samples give nothing to it."""
        values, slopes, waves = np.zeros(len(self.entries)), np.zeros(len(self.entries)), []
        for entry, one in enumerate(self.entries):
            if isinstance(one, np.ndarray):
                continue
            piece = one.piece_at(start + SAMPLE_SLACK / self.rate).begun(start)
            values[entry], slopes[entry] = piece.value, piece.slope
            waves += [DrivingWave(entry, wave.amplitude, wave.exponent) for wave in piece.waves]
        return Stretch(start, end, values, slopes, tuple(waves))

    def sampled(self, times: FloatArray) -> FloatArray:
        """Values (n_u, n_t) at times in s of the entries given by samples, 0 of the others."""
        found = np.zeros((len(self.entries), len(times)))
        places = times * self.rate
        for entry, one in enumerate(self.entries):
            if isinstance(one, np.ndarray):
                found[entry] = np.interp(places, np.arange(self.n), one)
        return found

    def stretches(self) -> tuple[Stretch, ...]:
        """Stretches in which no entry has a break or a corner, from the first to the last sample."""
        cuts = sorted({0.0, self.duration, *self.breaks, *self._corners()})
        if len(cuts) == 1:
            return ()
        at = self.sampled(np.array(cuts))
        found = []
        for place, (start, end) in enumerate(pairwise(cuts)):
            one = self.straight(start, end)
            slopes = (at[:, place + 1] - at[:, place]) / (end - start)
            found.append(Stretch(start, end, one.values + at[:, place], one.slopes + slopes, one.waves))
        return tuple(found)

    def _corners(self) -> set[float]:
        """Times in s of samples at which straight lines between samples meet at an angle."""
        found: set[float] = set()
        for one in self.entries:
            if isinstance(one, np.ndarray) and len(one) > 2:
                bent = np.abs(one[2:] - 2 * one[1:-1] + one[:-2]) > KINK * np.abs(one).max()
                found.update(((np.flatnonzero(bent) + 1) / self.rate).tolist())
        return found


def _value(entry: FloatArray | TimeHistory, time: float) -> float:
    return float(entry[0]) if isinstance(entry, np.ndarray) else float(entry.piece_at(time).at(np.array([time]))[0])
