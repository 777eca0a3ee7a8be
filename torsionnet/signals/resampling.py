"""Resampling of recordings with non-uniform time stamps and of signals to other rates, and decimation by filters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, remedy
from torsionnet.signals.recording import FloatArray, Recording, Signal

# Resampling of recordings with non-uniform time stamps to a uniform rate, and of signals to other sampling times.

# Limits for the number of samples made from a record, which times in a wrong unit would exceed by far.

ALWAYS_ALLOWED_COUNT, MOST_MULTIPLE = 10_000_000, 100
"""Number of values that may be made from any record, and multiple of its own number for longer ones, beyond which the
unit of the times must be wrong."""


def check_count(wanted: float, given: int, what: str, remedy: str) -> None:
    """Raise an error if far more values would be made from a record than the ``given`` ones.

    Parameters
    ----------
    wanted : float
        Number of values to be made; may be too large for an integer.
    given : int
        Number of values in the record.
    what : str
        Description of the record, the beginning of the message.
    remedy : str
        Advice, the end of the message.

    Raises
    ------
    UsageError
        ``wanted`` is more than a hundred times those given, and more than ten million.

    Examples
    --------
    >>> try:
    ...     check_count(3.2e11, 6000, "6000 pulses over 3.2e+08 s", "give the unit of the times")
    ... except UsageError as error:
    ...     print(error)
    6000 pulses over 3.2e+08 s would become 3.2e+11 numbers, more than can be kept; give the unit of the times
    """
    if not wanted <= max(ALWAYS_ALLOWED_COUNT, MOST_MULTIPLE * given):
        raise UsageError(f"{what} would become {wanted:.3g} numbers, more than can be kept; {remedy}", kind="too-large")


def even_times(first: float, last: float, sampling_rate: float, given: int, what: str) -> FloatArray:
    """Uniform times in s from the first to the last, one sampling interval apart, shape (n,).

    A whole number of intervals that misses the last time by a rounding error does not lose its sample.

    Parameters
    ----------
    first, last : float
        First and last time, s.
    sampling_rate : float
        Sampling rate, Hz.
    given : int
        Number of samples or pulses between the two; far more than these are refused.
    what : str
        Name of the given values, such as "pulses".

    Raises
    ------
    UsageError
        There would be far more times than values given.

    Examples
    --------
    >>> even_times(1.0, 1.5, 4.0, 9, "pulses").tolist()
    [1.0, 1.25, 1.5]
    """
    intervals = (last - first) * sampling_rate
    about = f"{given} {what} over {last - first:.4g} s, sampled at {sampling_rate:.6g} Hz,"
    check_count(intervals, given, about, "if the times are not in s, give their unit; or take a lower rate")
    return np.asarray(np.minimum(first + np.arange(int(np.floor(intervals + 1e-9)) + 1) / sampling_rate, last))


# Gaps and jitter of the time stamps of a recording.

GAP_RATIO = 1.9
"""Interval of time stamps over the usual one above which it is a gap, just below 2, where one sample is missing."""


def gaps(times: FloatArray) -> NDArray[np.intp]:
    """Indices of the last sample before every gap in time stamps, (n_gaps,).

    >>> gaps(np.array([0.0, 1.0, 2.0, 5.0, 6.0]))
    array([2])
    """
    intervals = np.diff(times)
    return np.flatnonzero(intervals > GAP_RATIO * np.median(intervals)) if len(intervals) else np.empty(0, np.intp)


def jitter(times: FloatArray) -> float:
    """Standard deviation of the sampling intervals over their mean, without unit, gaps left out.

    >>> round(jitter(np.array([0.0, 0.9, 2.0, 2.9, 4.0])), 9)
    0.1
    """
    intervals = np.delete(np.diff(times), gaps(times))
    return float(np.std(intervals) / np.mean(intervals)) if len(intervals) else 0.0


LEAST_RATE_SHARE = 0.99
"""Least new rate as a share of a recording's mean rate, below 1 only by rounding, as a lower one needs an anti-alias
filter."""

VALID_SHARE = 0.8
"""Share of half the lower of two sampling rates up to which a signal brought from one to the other is valid."""
STOP_BAND_SHARE = 1e-4
"""Share of an amplitude that the interpolating filter leaves above half the lower sampling rate, -80 dB."""
VALUES_PER_CHUNK = 2**21
"""Number of products of samples and filter coefficients formed together, which limits the memory."""


def interpolated_at(values: FloatArray, rate: float, start: float, times: FloatArray, new_rate: float) -> FloatArray:
    """Values (n,) of a uniformly sampled signal at other times, band-limited, in its unit.

    The filter is a sinc under a Kaiser window, between 0.8 and 1.0 times half the lower of the two rates, so that
    what the new rate cannot hold is removed and not folded. Beyond its ends the signal is reflected about its end
    points.

    Parameters
    ----------
    values : (m,) array
        Samples, finite.
    rate, start : float
        Their sampling rate, Hz, and the time of the first, s.
    times : (n,) array
        New times, s, within the span of the samples.
    new_rate : float
        Sampling rate of the new times, Hz.

    Examples
    --------
    >>> slow = np.sin(2 * np.pi * 3 * np.arange(400) / 100)
    >>> times = 1.0 + np.arange(5) / 1000
    >>> slow_again = interpolated_at(slow, 100.0, 0.0, times, 1000.0)
    >>> bool(np.abs(slow_again - np.sin(2 * np.pi * 3 * times)).max() < 1e-4)
    True
    """
    from scipy.signal import kaiser_beta, kaiserord

    # Sinc under a Kaiser window: the stop band gives beta, the width of the passage the length.
    lower = min(rate, new_rate)
    count, _ = kaiserord(-20 * np.log10(STOP_BAND_SHARE), (1 - VALID_SHARE) * lower / rate)
    half, beta = count // 2 + 1, float(kaiser_beta(-20 * np.log10(STOP_BAND_SHARE)))
    cutoff = (1 + VALID_SHARE) / 2 * lower / rate
    wide = _reflected(np.asarray(values, dtype=np.float64), half)
    places = (np.asarray(times, dtype=np.float64) - start) * rate
    interpolated = np.empty(len(places))
    shifts = np.arange(-half, half + 1)
    for begin in range(0, len(places), max(1, VALUES_PER_CHUNK // len(shifts))):
        part = slice(begin, begin + max(1, VALUES_PER_CHUNK // len(shifts)))
        whole = np.clip(np.rint(places[part]).astype(np.intp), 0, len(values) - 1)
        away = (places[part] - whole)[:, None] - shifts
        inside = np.sqrt(np.maximum(1 - (away / (half + 0.5)) ** 2, 0.0))
        weights = np.sinc(cutoff * away) * np.i0(beta * inside)
        # Of sum 1, so that a constant stays what it is.
        weights /= weights.sum(axis=1, keepdims=True)
        interpolated[part] = np.einsum("ij,ij->i", weights, wide[whole[:, None] + shifts + half])
    return interpolated


def band_loss(values: FloatArray, rate: float, new_rate: float) -> str:
    """Text on what :func:`interpolated_at` keeps of a signal (m,) and what it loses, from the spectrum of the signal.

    >>> slow = np.sin(2 * np.pi * 3 * np.arange(400) / 100) + 0.1 * np.sin(2 * np.pi * 45 * np.arange(400) / 100)
    >>> band_loss(slow, 100.0, 1000.0)
    'band-limited: holds up to 40 Hz with an error of 0.01 %; 10 % of its rms lies above'
    """
    limit = VALID_SHARE * min(rate, new_rate) / 2
    shares, powers = _power_shares(values)
    above = float(np.sqrt(powers[shares * rate > limit].sum()))
    text = f"band-limited: holds up to {limit:g} Hz with an error of {100 * STOP_BAND_SHARE:g} %"
    return f"{text}; {f'{100 * above:.2g}' if above >= STOP_BAND_SHARE else 'under 0.01'} % of its rms lies above"


def spline_error(values: FloatArray) -> float:
    """Rms error of a cubic spline between even samples (m,) over the rms of the signal, about.

    At a frequency of nu times the sampling rate the spline has the gain B(nu), and images B(nu + k) at the whole
    numbers k, with B(nu) = sinc(nu)^4 / (2/3 + cos(2 pi nu)/3) (M. Unser, IEEE Signal Processing Magazine 16 (1999),
    no. 6, pp. 22-38). The spectrum of the signal weighs them.

    >>> tone = np.sin(2 * np.pi * 0.1 * np.arange(1000))
    >>> round(spline_error(tone), 5)
    0.00029
    """
    shares, powers = _power_shares(values)

    # Response of the cubic spline through samples at nu cycles per sample; at nu + k it is that of the images.
    def gain(nu: FloatArray) -> FloatArray:
        return np.asarray(np.sinc(nu) ** 4 / (2 / 3 + np.cos(2 * np.pi * nu) / 3))

    images = sum(gain(shares + k) ** 2 for k in (-2, -1, 1, 2))
    return float(np.sqrt(np.sum(powers * ((1 - gain(shares)) ** 2 + images))))


def _power_shares(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frequencies over the sampling rate, (k,), and the share of the power about the mean at each, (k,).

    The straight line through the samples is left out of the spectrum, as its ends would count as all frequencies.
    """
    count, window = np.arange(len(values)), np.hanning(len(values))
    line = np.polynomial.Polynomial.fit(count, values, 1)(count) if len(values) > 2 else values
    powers = np.asarray(np.abs(np.fft.rfft((values - line) * window)) ** 2, dtype=np.float64)
    total = float((np.abs(np.fft.rfft((values - np.mean(values)) * window)) ** 2).sum())
    return np.fft.rfftfreq(len(values)).astype(np.float64), powers / total if total > 0 else 0 * powers


def _reflected(values: FloatArray, count: int) -> FloatArray:
    """Values with ``count`` more at either end, reflected about the end points; one value stays the same."""
    if len(values) < 2:
        return np.pad(values, count, mode="edge")
    return np.pad(values, count, mode="reflect", reflect_type="odd")


def resampled(recording: Recording, sampling_rate: float | None = None, *, bridge_gaps: bool = False) -> Recording:
    """Recording resampled to a uniform rate (Hz) by cubic splines through its samples.

    Parameters
    ----------
    recording : Recording
    sampling_rate : float, optional
        New rate in Hz, by default the mean rate. Not lower than that: fewer samples need an anti-alias filter first.
    bridge_gaps : bool
        Draw the spline across gaps in the time stamps, which invents data there.

    Raises
    ------
    UsageError
        The rate is too low or far too high, values are not finite, or there are gaps.

    Examples
    --------
    >>> times = np.array([0.0, 0.9, 2.1, 3.0])
    >>> record = Recording((Signal("phi", "angle", 2 * times),), 1.0, times=times)
    >>> resampled(record)["phi"].values.round(9).tolist()
    [0.0, 2.0, 4.0, 6.0]
    """
    new = recording.sampling_rate if sampling_rate is None else sampling_rate
    if recording.times is None and new == recording.sampling_rate:
        return recording
    _check(recording, new, bridge_gaps)
    time = recording.time
    even = even_times(float(time[0]), float(time[-1]), new, len(time), "samples")
    signals = tuple(_resampled(signal, recording, even) for signal in recording)
    error = max((spline_error(signal.values) for signal in signals), default=0.0)
    note = (
        f"resampled to {new:g} Hz by cubic splines, with errors up to about {100 * error:.2g} % of the rms of a signal"
    )
    return replace(recording, signals=signals, sampling_rate=new, start=float(time[0]), times=None).with_notes(note)


def _resampled(signal: Signal, recording: Recording, even: FloatArray) -> Signal:
    from scipy.interpolate import CubicSpline

    values = CubicSpline(recording.time, signal.values)(even)
    return signal.at_other_rate(np.asarray(values, dtype=float), recording.sampling_rate)


def _check(recording: Recording, rate: float, bridge_gaps: bool) -> None:
    if not (np.isfinite(rate) and rate >= LEAST_RATE_SHARE * recording.sampling_rate):
        raise UsageError(
            f"cannot resample {recording.sampling_rate:g} Hz to {rate:g} Hz: decimate with a filter instead",
            kind="out-of-range",
        )
    if len(recording) < 2 or not np.all(np.diff(recording.time) > 0):
        raise UsageError("resampling needs at least two samples, and time stamps that increase", kind="unordered-rows")
    broken = [signal.name for signal in recording if not np.all(np.isfinite(signal.values))]
    if broken:
        raise UsageError(
            f"cannot resample {', '.join(broken)}: some values are not finite; cut them out or mend them first",
            kind="not-finite",
        )
    breaks = gaps(recording.time)
    if len(breaks) and not bridge_gaps:
        where = ", ".join(f"{recording.time[at]:.6g} s" for at in breaks[:3])
        text = f"cannot resample across {len(breaks)} gaps (after {where}); cut the record there, or take "
        raise UsageError(f"{text}{remedy('bridge_gaps=True')}", kind="uneven-samples")


# Decimation of recordings, by an anti-alias filter from which every n-th sample is taken.

# Recordings in blocks, which are parts of a long record or repeated tests.

Recordings: TypeAlias = Recording | Iterable[Recording]


def blocks_in_order(recordings: Recordings) -> Iterator[tuple[Recording, bool]]:
    """Yield the blocks of recordings in order, each with a flag whether it begins where the one before ended.

    A block that does not is a separate test: nothing is averaged or filtered across the gap.

    Raises
    ------
    UsageError
        The blocks differ in signals or sampling rate, or one cannot be processed: its sampling is not uniform, or
        values are not finite.
    """
    end: float | None = None
    kinds: tuple[tuple[str, ...], float] | None = None  # not the first block, which would stay in memory
    for block in [recordings] if isinstance(recordings, Recording) else recordings:
        kinds = kinds or (block.names, block.sampling_rate)
        _check_alike(block, *kinds)
        check_processable(block)
        half_a_sample = 0.5 / block.sampling_rate
        yield block, end is not None and abs(block.start - end) < half_a_sample
        end = block.start + block.duration


def stacked(recording: Recording) -> FloatArray:
    """Values of all signals of a recording as one array, shape (n_signals, n), each in its unit."""
    return np.array([signal.values for signal in recording], dtype=np.float64)


def check_processable(block: Recording) -> None:
    """Raise an error for a recording with non-uniform time stamps, or with values that are not finite."""
    if block.times is not None:
        raise UsageError(
            "sampling is not uniform: the recording has time stamps; resample it first", kind="uneven-samples"
        )
    for signal in block:
        missing = int(np.count_nonzero(~np.isfinite(signal.values)))
        if missing:
            raise UsageError(
                f"{signal.name} has {missing} values that are not finite; repair or leave them out first",
                kind="not-finite",
            )


def _check_alike(block: Recording, names: tuple[str, ...], rate: float) -> None:
    if block.names != names:
        raise UsageError(
            f"blocks of one test must have the same signals: {', '.join(names)}; then {', '.join(block.names)}",
            kind="unlike-results",
        )
    if block.sampling_rate != rate:
        raise UsageError(
            f"blocks of one test must have the same sampling rate: {rate:g} Hz, then {block.sampling_rate:g} Hz",
            kind="unlike-results",
        )


FILTER_HALF_LENGTH = 10
"""Half length of the anti-alias filter in samples after decimation, as a longer one has a steeper edge but reaches
further into the ends."""
UNDECIMATED_RATE, LEAST_DECIMATED_RATE = 1000.0, 200.0
"""Sampling rate in Hz up to which records are not decimated, and the least rate in Hz of faster ones after decimation,
that of the source paper."""


def decimate(recording: Recording, factor: int) -> Recording:
    """Recording with every n-th sample behind a linear-phase anti-alias filter without delay.

    The filter is a windowed sinc (Hamming) of ``20 factor + 1`` taps, 6 dB down at the new half rate. Beyond its
    ends the record is reflected about its end points, so a mean or a slope makes no step there. The notes say up to
    which frequency the result is valid.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> record = Recording((Signal("T", "torque", np.ones(20_000)),), sampling_rate=10e3)
    >>> short = decimate(record, 50)
    >>> len(short), short.sampling_rate
    (400, 200.0)
    """
    parts = list(decimated(recording, factor))
    joined = np.concatenate([stacked(part) for part in parts], axis=1)
    return _with_values(parts[0], joined)


def decimated(recordings: Recordings, factor: int) -> Iterator[Recording]:
    """Yield the blocks of recordings decimated by a whole factor, in bounded memory, without seams between them."""
    if factor < 1 or int(factor) != factor:
        raise UsageError(f"the decimation factor must be a whole number from 1, got {factor}", kind="out-of-range")
    if factor == 1:
        yield from [recordings] if isinstance(recordings, Recording) else recordings
        return
    stream: _Stream | None = None
    for block, follows in blocks_in_order(recordings):
        if stream is None or not follows:
            yield from stream.rest() if stream else ()
            stream = _Stream(block, factor)
        yield from stream.push(stacked(block))
    yield from stream.rest() if stream else ()


def usable_up_to(sampling_rate: float, factor: int) -> float:
    """Highest frequency in Hz at which a signal decimated from ``sampling_rate`` (Hz) is valid.

    >>> usable_up_to(10e3, 50)
    80.0
    """
    return VALID_SHARE * sampling_rate / factor / 2


def factor_for(sampling_rate: float, highest: float = 0.0) -> int:
    """Default decimation factor of a record that has to be valid up to ``highest`` Hz.

    Records up to 1 kHz stay as they are; faster ones keep 200 Hz or more, and what ``highest`` needs.

    >>> factor_for(10e3), factor_for(5e3, highest=40), factor_for(5e3, highest=150), factor_for(500, highest=10)
    (50, 25, 13, 1)
    """
    if sampling_rate <= UNDECIMATED_RATE:
        return 1
    return max(1, int(sampling_rate / max(LEAST_DECIMATED_RATE, 2 * highest / VALID_SHARE) + 1e-9))


def anti_alias_taps(factor: int) -> FloatArray:
    """Coefficients of the anti-alias filter at the sampling rate before decimation, (20 factor + 1,)."""
    from scipy.signal import firwin

    return np.asarray(firwin(2 * FILTER_HALF_LENGTH * factor + 1, 1 / factor, window="hamming"), dtype=np.float64)


class _Stream:
    """Decimation filter of one test that keeps its state between blocks."""

    def __init__(self, first: Recording, factor: int) -> None:
        self.first, self.factor, self.half = first, factor, FILTER_HALF_LENGTH * factor
        self.taps: FloatArray | None = None
        self.pending = np.empty((len(first.signals), 0))
        self.primed = False
        self.done = 0

    def push(self, values: FloatArray) -> Iterator[Recording]:
        self.pending = np.concatenate([self.pending, values], axis=1)
        if not self.primed:
            if self.pending.shape[1] <= self.half:
                return
            # Reflected oddly about the first sample, so that value and slope go on beyond it.
            head = 2 * self.pending[:, :1] - self.pending[:, self.half : 0 : -1]
            self.pending = np.concatenate([head, self.pending], axis=1)
            self.primed = True
        yield from self._filtered()

    def rest(self) -> Iterator[Recording]:
        if not self.primed:
            need = self.half + 1
            raise UsageError(
                f"{self.pending.shape[1]} samples are too few to decimate by {self.factor}; it takes {need}",
                kind="too-short",
            )
        tail = 2 * self.pending[:, -1:] - self.pending[:, -2 : -self.half - 2 : -1]
        self.pending = np.concatenate([self.pending, tail], axis=1)
        yield from self._filtered()

    def _filtered(self) -> Iterator[Recording]:
        from scipy.signal import upfirdn

        count = (self.pending.shape[1] - 2 * self.half - 1) // self.factor + 1
        if count <= 0:
            return
        if self.taps is None:  # not before there are samples for as many
            self.taps = anti_alias_taps(self.factor)
        filtered = np.asarray(upfirdn(self.taps, self.pending, 1, self.factor, axis=1), dtype=np.float64)
        values = filtered[:, 2 * FILTER_HALF_LENGTH : 2 * FILTER_HALF_LENGTH + count]
        self.pending = self.pending[:, count * self.factor :]
        start = self.first.start + self.done * self.factor / self.first.sampling_rate
        self.done += count
        rate, signals = self.first.sampling_rate / self.factor, self.first.signals
        signals = tuple(signal.at_other_rate(signal.values, self.first.sampling_rate) for signal in signals)
        template = replace(self.first, signals=signals, sampling_rate=rate, start=start)
        yield _with_values(template, values).with_notes(self._note())

    def _note(self) -> str:
        rate = self.first.sampling_rate
        limit, new = usable_up_to(rate, self.factor), rate / self.factor
        return (
            f"decimated by {self.factor} to {new:g} Hz behind a linear-phase filter; holds up to {limit:g} Hz, onto "
            f"which what was above {new - limit:g} Hz folds at least 50 dB weaker; filter ends reach "
            f"{self.half / rate:g} s into the record"
        )


def _with_values(recording: Recording, values: FloatArray) -> Recording:
    signals = (replace(signal, values=row) for signal, row in zip(recording, values, strict=True))
    return replace(recording, signals=tuple(signals))
