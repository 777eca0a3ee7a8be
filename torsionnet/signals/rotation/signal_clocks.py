"""Drift between the clocks of two measuring systems from a signal, as a torque, that both recorded."""

from __future__ import annotations

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import interpolated_at
from torsionnet.signals.rotation.clock_drift import (
    COMMON,
    HALF_WIDTH_DEVIATIONS,
    MOST_DRIFT,
    ClockDrift,
    variance_factor,
)

LEAST_CORRELATION = 0.5
"""Least correlation of two signals in a window from which a delay is read; below it they have too little in common."""
SECOND_PEAK = 0.95
"""Share of the largest correlation that another delay may reach before the delay counts as ambiguous."""
MOST_LAG_SHARE = 0.5
"""Share of a window by which the first delay of two signals may differ from nought."""
FEWEST_WINDOWS = 4
"""Fewest windows of a signal from which drift and its interval are found."""


def signal_clocks(first: Recording, second: Recording, name: str, *, seconds: float | None = None) -> ClockDrift:
    """Drift and offset in s of the clock of a second system, from one signal, as a torque, that both recorded.

    In windows one after the other the delay is read from the slope of the phase between the two. A window begins
    where the drift found so far puts it, so that a delay may grow beyond a period of the signal.

    Parameters
    ----------
    first, second : Recording
        Records that hold the signal under one name; its quantity or gain may differ.
    name : str
    seconds : float, optional
        Length of a window, s; by default a twentieth of the shorter record, 0.5 s or more.

    Raises
    ------
    UsageError
        The two have too little in common, or the records are too short.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> chance = np.random.default_rng(1)
    >>> noise = np.convolve(chance.normal(size=8100), np.hanning(9), "valid")
    >>> ours = Recording((Signal("T", "torque", noise[100:8000]),), 1000.0)
    >>> theirs = Recording((Signal("T", "torque", noise[:7900]),), 1000.0)
    >>> round(signal_clocks(ours, theirs, "T").offset, 4)
    0.1
    """
    ours, theirs, rate = first[name].values, second[name].values, first.sampling_rate
    span = min(first.duration, second.duration)
    length = round((seconds or max(span / 20, 0.5)) * rate)
    starts = np.arange(0, len(ours) - length + 1, length)
    if len(starts) < FEWEST_WINDOWS:
        raise UsageError(f"{name}: {len(starts)} windows are too few to compare clocks; record longer; {COMMON}")
    centres, delays, weights, period = list[float](), list[float](), list[float](), 0.0
    guess = second.start - first.start
    lag = MOST_LAG_SHARE * length / rate
    for begin in starts:
        middle = first.start + (begin + length / 2) / rate
        # Twice the lag on either side, so that the window of the second holds what the first saw.
        margin = round(lag * rate)
        wanted = first.start + guess + (begin - margin + np.arange(length + 2 * margin)) / rate
        inside = (wanted >= second.start) & (wanted <= second.start + (len(theirs) - 1) / second.sampling_rate)
        if not inside[margin : margin + length].all():
            continue
        there = np.where(inside, interpolated_at(theirs, second.sampling_rate, second.start, wanted, rate), 0.0)
        found = _delay(ours[begin : begin + length], there, margin, rate)
        if found is None:
            continue
        shift, correlation, repeat = found
        period = period or repeat
        centres.append(middle)
        delays.append(guess + shift)
        weights.append(correlation)
        guess += shift
        # The first window finds the offset; the next differ by the drift alone.
        lag = min(lag, max(4 / rate, 4 * MOST_DRIFT * length / rate))
    if len(centres) < FEWEST_WINDOWS:
        raise UsageError(
            f"{name}: the two records correlate in {len(centres)} of {len(starts)} windows, less than "
            f"{LEAST_CORRELATION:g} in the others; they have too little in common to compare their clocks; {COMMON}"
        )
    return _line(np.array(centres), np.array(delays), np.array(weights), period, name)


def _delay(ours: FloatArray, there: FloatArray, margin: int, rate: float) -> tuple[float, float, float] | None:
    """Delay in s of the second window, its correlation, and the period in s at which it recurs, 0 where it does not."""
    a = ours - ours.mean()
    size = float(np.sqrt(np.sum(a**2)))
    lags = np.arange(-margin, margin + 1)
    scores = np.empty(len(lags))
    count = len(a)
    sums = np.correlate(there, a, "valid")
    squares = np.concatenate([[0.0], np.cumsum(there**2)])
    means = np.concatenate([[0.0], np.cumsum(there)])
    power = squares[count:] - squares[:-count] - (means[count:] - means[:-count]) ** 2 / count
    scores = sums / np.maximum(size * np.sqrt(np.maximum(power, 0.0)), 1e-300)
    best = int(np.argmax(scores))
    if not size or scores[best] < LEAST_CORRELATION:
        return None
    shift = float(lags[best])
    if 0 < best < len(scores) - 1:
        before, at, after = scores[best - 1 : best + 2]
        curve = before - 2 * at + after
        shift += 0.5 * float((before - after) / curve) if curve else 0.0
    peaks = [n for n in range(1, len(scores) - 1) if scores[n] >= max(scores[n - 1], scores[n + 1]) and n != best]
    again = [abs(n - best) for n in peaks if scores[n] > SECOND_PEAK * scores[best]]
    return shift / rate, float(scores[best]), min(again) / rate if again else 0.0


def _line(times: FloatArray, delays: FloatArray, weights: FloatArray, period: float, name: str) -> ClockDrift:
    """Straight line through the delays in s over time in s: the slope is the drift."""
    matrix = np.stack([np.ones(len(times)), times], axis=1)
    root = np.sqrt(weights)
    found = np.linalg.lstsq(matrix * root[:, None], delays * root, rcond=None)[0]
    left = delays - matrix @ found
    deviation = float(np.sqrt(np.sum(weights * left**2) / np.sum(weights) * len(left) / (len(left) - 2)))
    inverse = np.linalg.inv(matrix.T @ matrix)
    half = HALF_WIDTH_DEVIATIONS * deviation * np.sqrt(np.diag(inverse) * variance_factor(left))
    said = f"clocks from the delay of {name} in {len(times)} windows: {1e6 * found[1]:.4g} ppm, offset {found[0]:.6g} s"
    remarks: list[NoteOrText] = [said]
    if period:
        text = f"{name} repeats itself: the offset is open by whole multiples of {period:.4g} s"
        remarks.append(warning(f"{text}; {COMMON}"))
    return ClockDrift(
        float(found[1]), float(half[1]), float(found[0]), float("inf") if period else float(half[0]), period,
        tuple(remarks),
    )  # fmt: skip
