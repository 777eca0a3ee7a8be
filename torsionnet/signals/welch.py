"""Settings of Welch's method of averaging, and the effective number of its overlapping segments.

Lag between two signals of a record, and what the windows of Welch's method lose by it. A window sees the output that an
input causes for as long as both lie in it: with a lag tau the mean of the windows' products is less by the window's
correlation with itself, 1 - tau/T for a plain one, and the coherence by its square.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, get_args

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean, remedy
from torsionnet.base.notes import Note, warning
from torsionnet.signals.recording import FloatArray, Recording, Signal

# Removal of the mean or of a straight line from signals.

Trend: TypeAlias = Literal["none", "mean", "linear"]


def without_trend(values: FloatArray, trend: Trend) -> FloatArray:
    """Values with their mean or straight line along the last axis removed, same shape and unit."""
    if check_trend(trend) == "none":
        return values
    centred = values - values.mean(axis=-1, keepdims=True)
    if trend == "mean" or values.shape[-1] == 1:
        return np.asarray(centred, dtype=np.float64)
    ramp = np.linspace(-1, 1, values.shape[-1])
    slope = centred @ ramp / (ramp @ ramp)
    return np.asarray(centred - slope[..., None] * ramp, dtype=np.float64)


def check_trend(trend: Trend) -> Trend:
    """Name of a trend unchanged if it is known (none, mean, linear), else an error is raised."""
    known = get_args(Trend)
    if trend not in known:
        raise UsageError(
            f'no trend is named "{trend}"{did_you_mean(trend, known)}; there is {", ".join(known)}', kind="unknown-word"
        )
    return trend


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
            raise UsageError(
                f"overlap is a number from 0 to below 1 (0.5 for 50 %), got {self.overlap}", kind="out-of-range"
            )
        if not SHORTEST_SEGMENT <= self.seconds <= LONGEST_SEGMENT:
            raise UsageError(
                f"a segment must have a length from {SHORTEST_SEGMENT:g} to {LONGEST_SEGMENT:g} s, "
                f"got {self.seconds:g}",
                kind="out-of-range",
            )

    def samples(self, sampling_rate: float) -> int:
        """Number of samples of a segment, at least 2."""
        count = round(min(self.seconds * sampling_rate, MOST_SAMPLES))
        if count < 2:
            what = f"a segment of {self.seconds:g} s has less than two samples at {sampling_rate:g} Hz"
            raise UsageError(f"{what}; take longer ones, or say what unit the times are in", kind="too-short")
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
                f'no window is named "{self.window}"{did_you_mean(self.window, WINDOWS)}; e.g. {", ".join(WINDOWS)}',
                kind="unknown-word",
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
        # Spectra of two segments correlate by the product of their windows, and powers by the square of that.
        common = float(weights[: length - lag * step] @ weights[lag * step :] / (weights @ weights))
        shared += 2 * (1 - lag / count) * common**2
    return float(count / (1 + shared))


# Lag between two signals of a record, and what the windows of Welch's method lose by it.

DRIVEN_AMPLITUDE = 0.03
"""Share of the largest amplitude in the input's spectrum from which a frequency tells the lag."""
LEAST_CONCENTRATION = 0.5
"""Share of the lines that must agree on a lag; fewer show the phase of resonances, or noise."""
LEAST_LAG_PERIODS = 2.0
"""Least lag in periods of the driven bandwidth, as the phase of one resonance looks like a shorter one."""
NOTED_LOSS = 0.05
"""Share of a response that a lag must cost by the windows for a warning."""


def lag_between(record: Recording, output: str, input: str) -> float:
    """Lag in s of an output behind an input, from the phase over all driven frequencies; 0 where they tell none.

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal(4000)
    >>> late = Signal("y", "angle", np.concatenate([np.zeros(40), noise[:-40]]))
    >>> lag_between(Recording((Signal("x", "torque", noise), late), 100.0), "y", "x")
    0.4
    """
    size = 2 * len(record)
    X, Y = (np.fft.rfft(record[name].values - record[name].values.mean(), size) for name in (input, output))
    driven = np.abs(X) >= DRIVEN_AMPLITUDE * np.abs(X).max(initial=0.0)
    cross = np.where(driven, X.conj() * Y, 0.0)
    # Each driven line by its phase alone, as the spectrum of the drive says nothing of the lag.
    turns = np.divide(cross, np.abs(cross), out=np.zeros_like(cross), where=cross != 0)
    count = int(np.count_nonzero(turns))
    if not count:
        return 0.0
    # One side of the spectrum: its transform is the envelope, which does not mind a constant phase.
    envelope = np.abs(np.fft.ifft(turns, size)) * size / count
    place = int(np.argmax(envelope))
    lag = (place if place < size // 2 else place - size) / record.sampling_rate
    bandwidth = count * record.sampling_rate / size
    is_clear = envelope[place] >= LEAST_CONCENTRATION and abs(lag) * bandwidth >= LEAST_LAG_PERIODS
    return float(lag) if is_clear else 0.0


def kept_share(settings: Welch, rate: float, lag: float) -> float:
    """Share of a response that windows keep where the output lags by so many seconds.

    >>> round(kept_share(Welch("boxcar", 2.0), 100.0, 0.4), 3)
    0.8
    """
    weights = settings.weights(rate)
    away = min(round(abs(lag) * rate), len(weights))
    return float(weights[away:] @ weights[: len(weights) - away] / (weights @ weights))


def lag_warnings(record: Recording, outputs: tuple[str, ...], input: str, settings: Welch) -> list[Note]:
    """Warnings on outputs that lag so far behind the input that windows lose more than 5 % of the response."""
    notes = []
    for output in outputs:
        lag = lag_between(record, output, input)
        kept = kept_share(replace(settings, decimation=1), record.sampling_rate, lag)
        if kept <= 1 - NOTED_LOSS:
            behind = f"{output} lags {input} by {lag:.3g} s" if lag > 0 else f"{input} lags {output} by {-lag:.3g} s"
            lost = (
                f"they lose {100 * (1 - kept):.0f} % of |{output}/{input}|, and the coherence is at most {kept**2:.2f}"
            )
            text = f"{behind}, windows last {settings.seconds:g} s: {lost}"
            mended = f"take longer windows, or align the signals ({remedy('align=True')})"
            notes.append(warning(f"{text}; {mended}"))
    return notes


def aligned(record: Recording, output: str, input: str) -> tuple[Recording, float]:
    """Record with an output earlier by its lag behind an input, in whole samples, and that lag in s."""
    samples = round(lag_between(record, output, input) * record.sampling_rate)
    first, last = max(samples, 0), len(record) + min(samples, 0)

    def moved(signal: Signal) -> Signal:
        start = first if signal.name == output else first - samples
        return replace(signal, values=signal.values[start : start + last - first])

    return replace(record, signals=tuple(map(moved, record))), samples / record.sampling_rate
