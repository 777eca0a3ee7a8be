"""Times of pulses from a recorded channel that holds the output of an encoder."""

from __future__ import annotations

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response.recording import FloatArray

LOW_PERCENTILE, HIGH_PERCENTILE = 1.0, 99.0
"""Percentiles of a channel's values that are taken as the two levels of its pulses, so that single spikes do not
count."""
HYSTERESIS = 0.2
"""Share of the pulse height by which a signal must pass the middle on either side, so that noise makes no pulse."""
LEAST_SAMPLES_PER_PULSE = 4.0
"""Least number of samples from one pulse to the next, as with fewer the times of rises are not reliable."""


def holds_pulse_times(values: FloatArray) -> bool:
    """Whether a channel holds the times of pulses, which only increase, rather than the shape of pulses."""
    return len(values) > 2 and bool(np.all(np.diff(values) > 0))


def pulse_times(values: FloatArray, times: FloatArray) -> FloatArray:
    """Times in s (n_pulses,) at which a signal rises through the middle between its two levels.

    Noise of less than a fifth of the height makes no pulse.

    Parameters
    ----------
    values : (n,) array
        Voltage, or whatever was recorded.
    times : (n,) array
        Times of the samples, s.

    Raises
    ------
    UsageError
        There are no pulses, or too few samples from one to the next.

    Examples
    --------
    >>> time = np.arange(2000) / 1000
    >>> pulse_times(np.where(np.sin(2 * np.pi * 10 * time) > 0, 5.0, 0.0), time)[:3].round(4)
    array([0.0005, 0.1005, 0.2005])
    """
    low, high = np.percentile(values, [LOW_PERCENTILE, HIGH_PERCENTILE])
    middle, hysteresis = (low + high) / 2, HYSTERESIS * (high - low)
    state = np.where(values > middle + hysteresis, 1, np.where(values < middle - hysteresis, -1, 0))
    sure = np.flatnonzero(state)
    rises = np.flatnonzero(np.diff(state[sure]) > 0)
    if not high > low or len(rises) < 2:
        raise UsageError("there are no pulses: the signal does not rise between two levels at least twice")
    # Of the samples between one level and the other, the pair around the middle.
    after = np.array(
        [
            first + 1 + int(np.argmax(values[first + 1 : last + 1] > middle))
            for first, last in zip(sure[rises], sure[rises + 1], strict=True)
        ]
    )
    spacing = float(np.median(np.diff(after)))
    if spacing < LEAST_SAMPLES_PER_PULSE:
        raise UsageError(
            f"there are only {spacing:g} samples from pulse to pulse, {LEAST_SAMPLES_PER_PULSE:g} are needed; "
            "sample faster"
        )
    share = (middle - values[after - 1]) / (values[after] - values[after - 1])
    return np.asarray(times[after - 1] + share * (times[after] - times[after - 1]))
