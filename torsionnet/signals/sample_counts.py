"""How many numbers may be made of those there are: times in another unit than s ask for more than any machine holds."""

from __future__ import annotations

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response.recording import FloatArray

ALWAYS, TIMES = 10_000_000, 100
"""So many numbers may be made of any record, and so many times as many as it has."""


def check_count(wanted: float, given: int, what: str, remedy: str) -> None:
    """Refuse to make far more numbers than are ``given``.

    Parameters
    ----------
    wanted : float
        How many numbers would be made; too many for any integer, too.
    given : int
        How many there are.
    what : str
        What they are made of, the beginning of a sentence.
    remedy : str
        What to do instead.

    Raises
    ------
    UsageError
        More than a hundred times those given, and more than ten million.

    Examples
    --------
    >>> check_count(3.2e11, 6000, "6000 pulses over 3.2e+08 s", "give the unit of the times")
    Traceback (most recent call last):
    torsionnet.core.errors.UsageError: 6000 pulses over 3.2e+08 s would become 3.2e+11 numbers, more than can be kept; \
give the unit of the times
    """
    if not wanted <= max(ALWAYS, TIMES * given):
        raise UsageError(f"{what} would become {wanted:.3g} numbers, more than can be kept; {remedy}")


def even_times(first: float, last: float, sampling_rate: float, given: int, what: str) -> FloatArray:
    """Times from the first to the last, one sampling interval apart, s, shape (n,).

    A whole number of intervals that misses the last time by a rounding error does not lose its sample.

    Parameters
    ----------
    first, last : float
        s.
    sampling_rate : float
        Hz.
    given : int
        Number of the samples or pulses between the two, far more than which are refused.
    what : str
        What these are, such as "pulses".

    Raises
    ------
    UsageError
        There would be far more than are given.

    Examples
    --------
    >>> even_times(1.0, 1.5, 4.0, 9, "pulses").tolist()
    [1.0, 1.25, 1.5]
    """
    intervals = (last - first) * sampling_rate
    about = f"{given} {what} over {last - first:.4g} s, sampled at {sampling_rate:.6g} Hz,"
    check_count(intervals, given, about, "if the times are not in s, give their unit; or take a lower rate")
    return np.asarray(np.minimum(first + np.arange(int(np.floor(intervals + 1e-9)) + 1) / sampling_rate, last))
