"""Settings of Welch's method of averaging, and the effective number of its overlapping segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.signals.detrending import Trend, check_trend
from torsionnet.signals.recording import FloatArray

WINDOWS = ("hamming", "hann", "boxcar", "blackman", "blackmanharris", "flattop", "bartlett")
"""Names of common windows for Welch's method, offered where a name is unknown to scipy."""

MOST_SAMPLES = 2.0**62
"""Largest number of samples in a segment, more than any record has, but still exact as an integer."""
SHORTEST_SEGMENT, LONGEST_SEGMENT = 1e-6, 1e6
"""Shortest and longest segment in s, as any other length is a mistake in the unit."""


@dataclass(frozen=True)
class Welch:
    """Settings of Welch's method (window, segment length, overlap, detrending, decimation, estimator).

    Attributes
    ----------
    window : str
        A name that ``scipy.signal.get_window`` knows.
    seconds : float
        Length of a segment; the bins are ``1 / seconds`` apart.
    overlap : float
        Overlap of neighbouring segments as a share of a segment, 0 to below 1.
    detrend : {"mean", "linear", "none"}
        Trend removed from every segment. Unless it is ``none``, there is no bin at 0 Hz.
    decimation : int
        Factor by which the sampling rate is reduced first.
    estimator : str
        Estimator of frequency responses without a reference; empty for ``H1``, or in a fit for the one least biased
        by noise.
    """

    window: str = "hamming"
    seconds: float = 2.0
    overlap: float = 0.8
    detrend: Trend = "mean"
    decimation: int = 1
    estimator: str = ""

    def __post_init__(self) -> None:
        check_trend(self.detrend)
        if not 0 <= self.overlap < 1:
            raise UsageError(f"overlap is a number from 0 to below 1 (0.5 for 50 %), got {self.overlap}")
        if not SHORTEST_SEGMENT <= self.seconds <= LONGEST_SEGMENT:
            raise UsageError(
                f"a segment must have a length from {SHORTEST_SEGMENT:g} to {LONGEST_SEGMENT:g} s, got {self.seconds:g}"
            )

    def samples(self, sampling_rate: float) -> int:
        """Number of samples of a segment, at least 2."""
        count = round(min(self.seconds * sampling_rate, MOST_SAMPLES))
        if count < 2:
            what = f"a segment of {self.seconds:g} s has less than two samples at {sampling_rate:g} Hz"
            raise UsageError(f"{what}; take longer ones, or say what unit the times are in")
        return count

    def step(self, sampling_rate: float) -> int:
        """Number of samples from the start of a segment to the start of the next."""
        length = self.samples(sampling_rate)
        return max(1, length - round(self.overlap * length))

    def weights(self, sampling_rate: float) -> FloatArray:
        """Values of the window over one segment, (n,), without unit."""
        from scipy.signal import get_window

        try:
            return np.asarray(get_window(self.window, self.samples(sampling_rate)), dtype=np.float64)
        except ValueError:
            raise UsageError(
                f'no window is named "{self.window}"{did_you_mean(self.window, WINDOWS)}; e.g. {", ".join(WINDOWS)}'
            ) from None

    def __str__(self) -> str:
        return f"Welch, {self.window} {self.seconds:g} s, overlap {self.overlap:.0%}, detrend {self.detrend}"


PAPER = Welch(window="hamming", seconds=2.0, overlap=0.8, decimation=50, estimator="H2")
"""Welch settings of the source paper, records of 10 kHz decimated to 200 Hz, Hamming 2 s, 80 % overlap, H2."""


def effective_averages(weights: FloatArray, step: int, count: int) -> float:
    """Effective number of independent segments for ``count`` overlapping ones of a stationary random signal.

    Welch's formula: neighbours share information as far as the window overlaps with itself.

    >>> effective_averages(np.ones(100), 100, 30)
    30.0
    >>> round(effective_averages(np.hanning(100), 50, 30), 1)
    28.6
    """
    length = len(weights)
    shared = 0.0
    for lag in range(1, min(count, -(-length // step))):
        common = float(weights[: length - lag * step] @ weights[lag * step :] / (weights @ weights))
        shared += 2 * (1 - lag / count) * common**2
    return float(count / (1 + shared))
