"""Limits for the number of samples made from a record, which times in a wrong unit would exceed by far."""

from __future__ import annotations

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray

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
    >>> check_count(3.2e11, 6000, "6000 pulses over 3.2e+08 s", "give the unit of the times")
    Traceback (most recent call last):
    torsionnet.base.errors.UsageError: 6000 pulses over 3.2e+08 s would become 3.2e+11 numbers, more than can be kept; \
give the unit of the times
    """
    if not wanted <= max(ALWAYS_ALLOWED_COUNT, MOST_MULTIPLE * given):
        raise UsageError(f"{what} would become {wanted:.3g} numbers, more than can be kept; {remedy}")


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
