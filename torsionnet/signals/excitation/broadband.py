"""Broadband test signals to excite a drivetrain with, periodic multisines and bursts of noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, entry
from torsionnet.base.errors import UsageError
from torsionnet.signals.excitation.excitation import Excitation, FloatArray

ComplexArray = NDArray[np.complex128]

WHOLE_PERIOD_TOLERANCE = 1e-9
"""Relative distance of a period from a whole number of samples up to which it counts as one, as floats are rounded."""
PEAK_POINTS_PER_CYCLE = 8
"""Number of points per cycle of the highest line at which the peak of a multisine is searched, to miss little of it."""
CLIPPING_ITERATIONS = 200
"""Number of times a multisine is clipped and its amplitudes are restored, after which the crest factor hardly falls
further."""


@dataclass(frozen=True, kw_only=True)
class _Periodic(Excitation):
    """Test signal of several periods of one length, with lines at multiples of 1/period in a band (base class).

    Attributes
    ----------
    start, stop : float
        Band in Hz.
    period : float
        s; lines are 1/period apart.
    periods : int
    seed : int
        The same seed gives the same signal.
    """

    start: float = entry(Value("lower end of the band", "frequency"))
    stop: float = entry(Value("upper end of the band", "frequency"))
    period: float = entry(Value("length of a period; lines are 1/period apart", "time"))
    periods: int = entry(Count("how many periods", upper=100_000), 1)
    seed: int = entry(Count("the same seed gives the same signal", lower=0, upper=2**32 - 1), 0)

    @property
    def length(self) -> float:
        return self.period * self.periods

    @property
    def highest_frequency(self) -> float:
        return self.stop

    @property
    def lines(self) -> FloatArray:
        """Frequencies of the excited lines in Hz, (n_lines,)."""
        return np.asarray(self._numbers / self.period)

    @property
    def _numbers(self) -> NDArray[np.int_]:
        """Number of cycles per period of each excited line, (n_lines,)."""
        first, last = np.ceil(self.start * self.period - 1e-9), np.floor(self.stop * self.period + 1e-9)
        return np.arange(max(int(first), 1), int(last) + 1)

    def _count(self, sampling_rate: float) -> int:
        """Number of samples in one period of the signal.

        Raises
        ------
        UsageError
            It is not a whole number, so that the lines would leak.
        """
        count = round(self.period * sampling_rate)
        if abs(count - self.period * sampling_rate) > WHOLE_PERIOD_TOLERANCE * count:
            raise UsageError(
                f"{self.kind}: a period of {self.period:g} s is not a whole number of samples at {sampling_rate:g} Hz; "
                "change one of them"
            )
        return count

    def _contradictions(self) -> list[str]:
        if self.start >= self.stop:
            return ["start must be below stop"]
        if not len(self.lines):
            return [f"no line between {self.start:g} and {self.stop:g} Hz with a period of {self.period:g} s"]
        return []


@dataclass(frozen=True, kw_only=True)
class Multisine(_Periodic):
    """Test signal, a multisine with equal amplitudes at all lines of a band, and phases for a low peak.

    From Schroeder's phases on, the signal is clipped and its amplitudes are restored again and again (Van der Ouderaa,
    Schoukens and Renneboog 1988).

    Examples
    --------
    >>> burst = Multisine(start=0.5, stop=40, period=8, periods=5)
    >>> x = burst.samples(1000)
    >>> bool(abs(x).max() / x.std() < 1.6), len(burst.lines)
    (True, 317)
    """

    kind: ClassVar[str] = "multisine"

    @cached_property
    def _spectrum(self) -> ComplexArray:
        """Complex amplitudes (n_lines,) of the multisine's lines, scaled to a peak of 1."""
        numbers = self._numbers
        size, order = int(PEAK_POINTS_PER_CYCLE * numbers[-1]), np.arange(len(numbers))
        # Schroeder's phases, whose peak is low; clipping with the magnitudes put back lowers it further.
        values = np.exp(-1j * np.pi * order * (order - 1) / len(numbers))
        best, lowest = values, np.inf
        for level in np.linspace(0.75, 0.95, CLIPPING_ITERATIONS):
            signal = _periodic(numbers, values, size)
            peak = np.abs(signal).max()
            if peak < lowest:
                best, lowest = values, peak
            clipped = np.fft.rfft(np.clip(signal, -level * peak, level * peak))[numbers]
            values = np.exp(1j * np.angle(clipped))
        return np.asarray(best / np.abs(_periodic(numbers, best, 4 * size)).max())

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        return np.tile(_periodic(self._numbers, self._spectrum, self._count(sampling_rate)), self.periods)


@dataclass(frozen=True, kw_only=True)
class BurstRandom(_Periodic):
    """Test signal, a burst of noise in a band for a share of each period, then silence in which the drivetrain rests.

    Every period has noise of its own. ``amplitude`` is the peak.

    Attributes
    ----------
    share : float
        Of a period with noise, 0 to 1.

    Examples
    --------
    >>> x = BurstRandom(start=1, stop=40, period=4, periods=3, share=0.5, seed=7).samples(200)
    >>> float(abs(x[400:800]).max()), float(abs(x).max())
    (0.0, 1.0)
    """

    kind: ClassVar[str] = "burst random"

    share: float = entry(Value("share of a period with noise", "1"), 0.5)

    def _contradictions(self) -> list[str]:
        return super()._contradictions() + ([] if self.share <= 1 else ["share must be at most 1"])

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        rng = np.random.default_rng(self.seed)
        count = self._count(sampling_rate)
        noise = rng.standard_normal((2, self.periods, len(self._numbers)))
        bursts = [_periodic(self._numbers, real + 1j * imag, count) for real, imag in zip(*noise, strict=True)]
        gate = np.arange(count) < self.share * count
        signal = np.concatenate([gate * burst for burst in bursts])
        return np.asarray(signal / np.abs(signal).max())


def _periodic(numbers: NDArray[np.int_], values: ComplexArray, size: int) -> FloatArray:
    """Samples (size,) of one period of a signal, from the complex amplitudes of its lines."""
    spectrum = np.zeros(size // 2 + 1, dtype=complex)
    spectrum[numbers] = values
    return np.asarray(np.fft.irfft(spectrum, size) * size / 2)
