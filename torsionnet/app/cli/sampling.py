"""Frequencies of a response from the command line: a list, a range, or a range chosen from the modes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.responses.grid import RANGE_BELOW, vibration_range

if TYPE_CHECKING:
    from collections.abc import Sequence

    from torsionnet.app.cli.cases import ConfiguredCase
    from torsionnet.linear.frequency_response import FloatArray

DEFAULT_POINTS, MOST_POINTS = 500, 1_000_000
"""Number of frequencies in a range unless ``--points`` is given, and the largest number that a list may have."""


@dataclass(frozen=True)
class Sampling:
    """Options on the frequencies of a response as given on the command line, in the unit chosen there.

    None: not given.
    """

    start: float | None = None
    stop: float | None = None
    points: int | None = None
    logarithmic: bool | None = None
    listed: str | None = None

    def frequencies(self, cases: Sequence[ConfiguredCase], scale: float) -> FloatArray:
        """Frequencies of the response in Hz, shape (n_f,); ``scale`` converts Hz to the unit chosen."""
        if self.listed is not None:
            if any(given is not None for given in (self.start, self.stop, self.points, self.logarithmic)):
                raise UsageError("give --frequencies, or --from, --to and --points, not both")
            return read_list(self.listed) / scale
        start, stop = self.start, self.stop
        if start is None or stop is None:
            low, high = vibration_range(*(case.drivetrain.modes() for case in cases))
            start = min(low * scale, stop / RANGE_BELOW if stop else math.inf) if start is None else start
            stop = max(high * scale, start * RANGE_BELOW) if stop is None else stop
        return frequency_range(start, stop, self.points or DEFAULT_POINTS, self.logarithmic) / scale


def frequency_range(start: float, stop: float, points: int, logarithmic: bool | None) -> FloatArray:
    """Frequencies from start to stop in the unit of both, linearly or logarithmically spaced, shape (points,).

    ``logarithmic`` None: if the range is more than a decade and does not begin at 0.
    """
    if not (math.isfinite(start) and math.isfinite(stop) and 0 <= start < stop):
        raise UsageError(f"--from must not be negative and must be smaller than --to, got {start:g} and {stop:g}")
    if logarithmic is None:
        logarithmic = 0 < start <= stop / RANGE_BELOW
    if logarithmic and start == 0:
        raise UsageError("a logarithmic range cannot begin at 0; give --from above 0, in Hz")
    return np.asarray(np.geomspace(start, stop, points) if logarithmic else np.linspace(start, stop, points))


def read_list(text: str) -> FloatArray:
    """Frequencies in Hz, shape (n,), from ``0.1:40:0.1`` (start:stop:step, the stop included) or ``1,2,5.5``.

    >>> read_list("0:1:0.25,5").tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0, 5.0]
    """
    parts = [_part(part, text) for part in text.split(",")]
    frequencies = np.unique(np.concatenate(parts))
    if frequencies[0] < 0:
        raise UsageError(f"a frequency must not be negative, got {frequencies[0]:g} Hz")
    return frequencies


def _part(part: str, text: str) -> FloatArray:
    try:
        numbers = [float(number) for number in part.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 3) or not all(map(math.isfinite, numbers)):
        raise _unreadable(text)
    if len(numbers) == 1:
        return np.array(numbers)
    start, stop, step = numbers
    if step <= 0 or stop < start:
        raise _unreadable(text)
    count = math.floor((stop - start) / step * (1 + 1e-12) + 1e-9) + 1
    if count > MOST_POINTS:
        raise UsageError(
            f'"{part}" are {count} frequencies, and at most {MOST_POINTS} are calculated at once: take a larger step'
        )
    return np.asarray(start + step * np.arange(count), dtype=np.float64)


def _unreadable(text: str) -> UsageError:
    return UsageError(f'frequencies are written "start:stop:step" or "1,2,5", got "{text}"')
