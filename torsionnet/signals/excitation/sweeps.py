"""Sines whose frequency changes: linearly, by equal factors, or in steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.signals.excitation.excitation import Excitation, FloatArray
from torsionnet.signals.excitation.frequencies import Frequencies

TURN = 2 * np.pi


@dataclass(frozen=True, kw_only=True)
class _Sweep(Excitation):
    """A sine between two frequencies.

    Attributes
    ----------
    start, stop : float
        Hz.
    duration : float
        s.
    """

    start: float = entry(Value("first frequency", "frequency"))
    stop: float = entry(Value("last frequency", "frequency"))
    duration: float = entry(Value("length of the sweep", "time"))

    @property
    def length(self) -> float:
        return self.duration

    @property
    def highest_frequency(self) -> float:
        return max(self.start, self.stop)

    def _contradictions(self) -> list[str]:
        return ["start and stop are the same frequency"] if self.start == self.stop else []


@dataclass(frozen=True, kw_only=True)
class LinearChirp(_Sweep):
    """A sine whose frequency changes by the same number of Hz every second.

    f(t) = f_0 + (f_1 - f_0) t / T, and its phase is the integral 2 pi (f_0 t + (f_1 - f_0) t^2 / (2 T)). Equations (1)
    and (2) of Galvagno et al. (2015) print sin(2 pi f(t) t) and f_0 - f_1, which would run the wrong way and twice as
    fast.

    Examples
    --------
    >>> chirp = LinearChirp(start=0.1, stop=80, duration=100, amplitude=15)
    >>> round(float(chirp.frequency(50.0)), 3), len(chirp.samples(10e3))
    (40.05, 1000000)
    """

    kind: ClassVar[str] = "linear chirp"
    _may_be_zero: ClassVar[tuple[str, ...]] = ("start", "stop")

    def frequency(self, time: FloatArray | float) -> FloatArray:
        """Instantaneous frequency in Hz at times in s."""
        return np.asarray(self.start + (self.stop - self.start) * np.asarray(time) / self.duration)

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        cycles = (self.start + (self.stop - self.start) * time / (2 * self.duration)) * time
        return np.asarray(np.sin(TURN * cycles))


@dataclass(frozen=True, kw_only=True)
class LogarithmicSweep(_Sweep):
    """A sine whose frequency changes by the same factor every second: f(t) = f_0 (f_1/f_0)^(t/T).

    It stays longer at low frequencies, where the resonances of drivetrains with soft springs lie close together.

    Examples
    --------
    >>> sweep = LogarithmicSweep(start=1, stop=100, duration=60)
    >>> float(sweep.frequency(30.0))
    10.0
    """

    kind: ClassVar[str] = "logarithmic sweep"

    def frequency(self, time: FloatArray | float) -> FloatArray:
        """Instantaneous frequency in Hz at times in s."""
        return np.asarray(self.start * (self.stop / self.start) ** (np.asarray(time) / self.duration))

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        rate = np.log(self.stop / self.start) / self.duration
        return np.asarray(np.sin(TURN * self.start * np.expm1(rate * time) / rate))


@dataclass(frozen=True, kw_only=True)
class SteppedSine(Excitation):
    """One frequency after the other, each held for whole periods; the phase never jumps.

    Attributes
    ----------
    frequencies : tuple of float
        Hz.
    hold : float
        Time for each in s, rounded up to whole periods.

    Examples
    --------
    >>> steps = SteppedSine(frequencies=(2.0, 5.0), hold=1.1)
    >>> steps.starts.round(6).tolist(), round(steps.length, 6)
    ([0.0, 1.5], 2.7)
    """

    kind: ClassVar[str] = "stepped sine"

    frequencies: tuple[float, ...] = entry(Frequencies("frequencies, one after the other"))
    hold: float = entry(Value("time for each frequency, rounded up to whole periods", "time"))

    def _contradictions(self) -> list[str]:
        sound = all(np.isfinite(f) and f > 0 for f in self.frequencies) and len(self.frequencies) > 0
        return [] if sound else ["frequencies must be positive numbers, at least one"]

    @property
    def _durations(self) -> FloatArray:
        f = np.asarray(self.frequencies, dtype=float)
        return np.asarray(np.ceil(self.hold * f - 1e-9) / f)

    @property
    def starts(self) -> FloatArray:
        """Time in s at which each frequency begins."""
        return np.concatenate([[0.0], np.cumsum(self._durations)[:-1]])

    @property
    def length(self) -> float:
        return float(self._durations.sum())

    @property
    def highest_frequency(self) -> float:
        return max(self.frequencies)

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        step = np.searchsorted(self.starts, time, side="right") - 1
        f = np.asarray(self.frequencies, dtype=float)[step]
        return np.asarray(np.sin(TURN * f * (time - self.starts[step])))
