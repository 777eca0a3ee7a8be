"""History of a torque over time as a sum of straight lines and of waves that may decay, exact at every time."""

from __future__ import annotations

from bisect import bisect_right
from cmath import exp
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, pi
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np  # reading and checking a model file does without
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
SAMPLE_SLACK = 1e-6
"""Share of a sampling interval by which a piece may begin after a sample and still hold at it, since times of samples
are quotients and rounded."""


@dataclass(frozen=True)
class Wave:
    """Term Re(A exp(s (t - t_0))) of a history, with the complex amplitude A and the exponent s in 1/s."""

    amplitude: complex
    exponent: complex


@dataclass(frozen=True)
class HistoryPiece:
    """Piece value + slope (t - t_0) + sum of waves of a history, which holds from t_0 = ``start`` in s.

    Attributes
    ----------
    start : float
        s.
    value, slope : float
        Unit of the history, and that in a second.
    waves : tuple of Wave
    """

    start: float
    value: float = 0.0
    slope: float = 0.0
    waves: tuple[Wave, ...] = ()

    def at(self, times: FloatArray) -> FloatArray:
        """Values (n,) of the piece at times in s, also where another piece holds."""
        import numpy as np

        passed = times - self.start
        total = self.value + self.slope * passed
        for wave in self.waves:
            total = total + (wave.amplitude * np.exp(wave.exponent * passed)).real
        return np.asarray(total, dtype=float)

    def begun(self, start: float) -> HistoryPiece:
        """Piece with the same values, counted from another time in s."""
        passed = start - self.start
        waves = tuple(Wave(one.amplitude * exp(one.exponent * passed), one.exponent) for one in self.waves)
        return HistoryPiece(start, self.value + self.slope * passed, self.slope, waves)


@dataclass(frozen=True)
class TimeHistory:
    """History of a torque, or of what scales one, over time: each piece holds until the next one begins.

    Before the first piece, which begins at 0 s, its value there holds.

    Examples
    --------
    >>> ramp = TimeHistory((HistoryPiece(0.0, 20.0, 4600.0), HistoryPiece(0.05, 250.0)))
    >>> ramp.samples(100.0, 8).tolist()
    [20.0, 66.0, 112.0, 158.0, 204.0, 250.0, 250.0, 250.0]
    """

    pieces: tuple[HistoryPiece, ...]

    @property
    def first(self) -> float:
        """Value of the history at 0 s."""
        begun = self.pieces[0].begun(0.0)
        return begun.value + sum(wave.amplitude.real for wave in begun.waves)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times in s at which a new piece begins, that of the first left out."""
        return tuple(one.start for one in self.pieces[1:])

    def samples(self, rate: float, count: int) -> FloatArray:
        """Values (count,) of the history at ``rate`` Hz from 0 s; where it jumps, those after the jump."""
        import numpy as np

        values = np.zeros(count)
        for number, piece in enumerate(self.pieces):
            begin = 0 if number == 0 else first_sample(piece.start, rate)
            values[begin:] = piece.at(np.arange(begin, max(begin, count)) / rate)
        return values

    def piece_at(self, time: float) -> HistoryPiece:
        """Piece that holds from a time in s on."""
        return self.pieces[max(0, bisect_right(self.pieces, time, key=lambda piece: piece.start) - 1)]

    def times(self, factor: float) -> TimeHistory:
        """History of ``factor`` times the values."""
        return TimeHistory(
            tuple(
                HistoryPiece(
                    one.start,
                    factor * one.value,
                    factor * one.slope,
                    tuple(Wave(factor * wave.amplitude, wave.exponent) for wave in one.waves),
                )
                for one in self.pieces
            )
        )

    def __add__(self, other: TimeHistory) -> TimeHistory:
        starts = sorted({piece.start for one in (self, other) for piece in one.pieces})
        pieces = []
        for start in starts:
            one, two = (history.piece_at(start).begun(start) for history in (self, other))
            pieces.append(HistoryPiece(start, one.value + two.value, one.slope + two.slope, (*one.waves, *two.waves)))
        return TimeHistory(tuple(pieces))

    @property
    def fastest(self) -> float:
        """Highest frequency in Hz of the waves of the history, 0 without waves."""
        sizes = (abs(wave.exponent.imag) for piece in self.pieces for wave in piece.waves)
        return max(sizes, default=0.0) / (2 * pi)


def first_sample(start: float, rate: float) -> int:
    """Number of the first sample at ``rate`` Hz that does not lie before a time in s.

    >>> first_sample(0.1, 1e3), first_sample(0.1001, 1e3)
    (100, 101)
    """
    return max(0, ceil(start * rate - SAMPLE_SLACK))


def held_course(values: FloatArray, rate: float) -> TimeHistory:
    """History of values at ``rate`` Hz from 0 s, each of which holds until the next."""
    listed = values.tolist()
    new = [number for number, value in enumerate(listed) if not number or value != listed[number - 1]]
    return TimeHistory(tuple(HistoryPiece(number / rate, listed[number]) for number in new))


def constant(value: float) -> TimeHistory:
    """History of one value."""
    return TimeHistory((HistoryPiece(0.0, value),))


def straight(rows: Iterable[tuple[float, float]]) -> TimeHistory:
    """History that runs straight between rows (time in s, value) and stands still before and after them.

    A time given twice is a jump.

    >>> straight([(0.1, 0.0), (0.1, 5.0), (0.3, 9.0)]).samples(10.0, 5).tolist()
    [0.0, 5.0, 7.0, 9.0, 9.0]
    """
    listed = list(rows)
    pieces = [HistoryPiece(0.0, listed[0][1])] if listed[0][0] > 0 or len(listed) == 1 else []
    for (begin, low), (end, high) in pairwise(listed):
        if end > begin:
            pieces.append(HistoryPiece(begin, low, (high - low) / (end - begin)))
    if len(listed) > 1:
        pieces.append(HistoryPiece(listed[-1][0], listed[-1][1]))
    return TimeHistory(tuple(pieces))
