"""Lines of the windows of a signal, and rows over a whole record that are sums of them.

A row has a value for every sample of a record and there is one for every line: 80 lines of two minutes at 5 kHz would
fill 770 MB, and filtered copies several times that. They are made of short pieces, one for each window, so that what
is asked of them can be had from the pieces.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.signals.detrending import without_trend
from torsionnet.signals.welch import Welch

BATCH = 2**21
"""Numbers that are transformed together."""
HELD = 3 * 2**27
"""Bytes of filtered rows that are kept at a time; what takes more is calculated block by block, twice over."""


@dataclass(frozen=True, eq=False)
class Segments:
    """Windows over a record, and the lines taken of each.

    Attributes
    ----------
    settings : Welch
    rate : float
        Hz.
    bins : (n_b,) int array
        Lines taken, in multiples of one over the length of a window; neither 0 nor the half rate.
    first : int
        Number of windows at the start that are left out.
    """

    settings: Welch
    rate: float
    bins: NDArray[np.intp]
    first: int = 0

    @property
    def length(self) -> int:
        return self.settings.samples(self.rate)

    @property
    def step(self) -> int:
        return self.settings.step(self.rate)

    def starts(self, count: int) -> NDArray[np.intp]:
        """First samples of the windows in a record of so many samples."""
        return np.arange(self.first * self.step, count - self.length + 1, self.step)

    def lines(self, values: FloatArray) -> ComplexArray:
        """Lines (n_segments, n_b) of the windows of a signal (n,)."""
        starts = self.starts(len(values))
        found = np.zeros((len(starts), len(self.bins)), dtype=complex)
        if len(starts):
            views = np.lib.stride_tricks.sliding_window_view(values, self.length)
            weights, batch = self.settings.weights(self.rate), max(1, BATCH // self.length)
            for begin in range(0, len(starts), batch):
                plain = without_trend(views[starts[begin : begin + batch]], self.settings.detrend)
                found[begin : begin + batch] = np.fft.rfft(plain * weights, axis=-1)[:, self.bins]
        return found

    def pieces(self, lines: slice = slice(None)) -> ComplexArray:
        """Rows (n_b, length) that make of a window its lines without its trend."""
        turn = np.exp(-2j * np.pi * np.outer(self.bins[lines], np.arange(self.length)) / self.length)
        rows = self.settings.weights(self.rate) * turn
        return without_trend(rows.real, self.settings.detrend) + 1j * without_trend(rows.imag, self.settings.detrend)


@dataclass(frozen=True, eq=False)
class SegmentRows:
    """Rows (n_b, n) of a matrix, each the sum over windows of a weight times the piece that makes its line.

    Attributes
    ----------
    segments : Segments
    weights : (n_segments, n_b) complex array
    count : int
        Number of samples n.
    """

    segments: Segments
    weights: ComplexArray
    count: int

    def apply(self, values: FloatArray) -> ComplexArray:
        """Rows @ values (n,), (n_b,)."""
        return np.asarray((self.weights * self.segments.lines(values)).sum(axis=0))

    def only(self, lines: NDArray[np.bool_]) -> SegmentRows:
        """The rows of some lines."""
        chosen = replace(self.segments, bins=self.segments.bins[lines])
        return SegmentRows(chosen, self.weights[:, lines], self.count)

    def dense(self, lines: slice = slice(None)) -> ComplexArray:
        """The rows themselves."""
        pieces, length = self.segments.pieces(lines), self.segments.length
        rows = np.zeros((len(pieces), self.count), dtype=complex)
        for start, weights in zip(self.segments.starts(self.count), self.weights[:, lines], strict=True):
            rows[:, start : start + length] += weights[:, None] * pieces
        return rows

    @cached_property
    def squares(self) -> FloatArray:
        """Sum of the squares of each piece, (n_b,)."""
        return np.concatenate([(np.abs(self.segments.pieces(lines)) ** 2).sum(axis=1) for lines in self._pieces_held()])

    def covariance(self) -> FloatArray:
        """Of real and imaginary parts of rows @ white noise of unit variance, (2 n_b, 2 n_b).

        Windows share noise as far as they overlap: what they share follows from the pieces, once for each lag.
        """
        pieces, step, length = self.segments.pieces(), self.segments.step, self.segments.length
        size = (len(pieces), len(pieces))
        conjugate, plain = np.zeros(size, dtype=complex), np.zeros(size, dtype=complex)
        for lag in range(min(len(self.weights), -(-length // step))):
            late, early = pieces[:, lag * step :], pieces[:, : length - lag * step]
            first, second = self.weights[: len(self.weights) - lag].T, self.weights[lag:]
            one = (late @ early.conj().T) * (first @ second.conj())
            other = (late @ early.T) * (first @ second)
            conjugate += one + one.conj().T if lag else one
            plain += other + other.T if lag else other
        return _parts_covariance(conjugate, plain)

    def filtered_covariance(self, spectrum: ComplexArray) -> FloatArray:
        """The same for noise that a filter has passed: a spectrum (n,) of twice the record or more, without circling.

        ``spectrum`` is that of the filter turned back in time, by which each row is multiplied.
        """
        lines = len(self.segments.bins)
        most = max(1, HELD // (16 * self.count))
        blocks = [slice(begin, min(begin + most, lines)) for begin in range(0, lines, most)]
        found = np.zeros((2, lines, 2, lines))
        for place, one in enumerate(blocks):
            rows = self._filtered(one, spectrum)
            for other in blocks[place:]:
                others = rows if other is one else self._filtered(other, spectrum)
                part = np.tensordot(rows, others, axes=(2, 2))
                found[:, one, :, other] = part
                found[:, other, :, one] = part.transpose(2, 3, 0, 1)
        return found.reshape(2 * lines, 2 * lines)

    def _filtered(self, lines: slice, spectrum: ComplexArray) -> FloatArray:
        """Real and imaginary parts of filtered rows, (2, n_lines, n)."""
        found = np.empty((2, lines.stop - lines.start, self.count))
        batch = max(1, BATCH // len(spectrum))
        for begin in range(lines.start, lines.stop, batch):
            some = slice(begin, min(begin + batch, lines.stop))
            passed = np.fft.fft(self.dense(some), len(spectrum), axis=1)
            passed *= spectrum
            rows = np.fft.ifft(passed, axis=1)[:, : self.count]
            found[:, begin - lines.start : some.stop - lines.start] = rows.real, rows.imag
        return found

    def _pieces_held(self) -> Iterator[slice]:
        batch, lines = max(1, BATCH // self.segments.length), len(self.segments.bins)
        yield from (slice(begin, min(begin + batch, lines)) for begin in range(0, lines, batch))


def _parts_covariance(conjugate: ComplexArray, plain: ComplexArray) -> FloatArray:
    """Of real and imaginary parts of complex numbers z with means z z^H and z z^T."""
    both, apart = conjugate + plain, conjugate - plain
    return np.block([[both.real, -apart.imag], [both.imag, apart.real]]) / 2
