"""Lines (Fourier coefficients) of a signal's windows, and linear maps from a record to weighted sums of them.

Such a map has a row for each line with a value for each sample: 80 lines of two minutes at 5 kHz would fill 770 MB, and
filtered copies several times that. Rows consist of short pieces, one for each window, so products and covariances are
calculated from the pieces.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.signals.detrending import without_trend
from torsionnet.signals.welch import Welch

NUMBERS_PER_BATCH = 2**21
"""Number of samples that are Fourier transformed together, as more take more memory and fewer more calls."""
MOST_ROW_BYTES = 2**28
"""Bytes of filtered rows up to which all are held in memory together, beyond which they are made one by one."""


@dataclass(frozen=True, eq=False)
class Segments:
    """Windows over a record, and the lines (Fourier coefficients) that are taken from each window.

    Attributes
    ----------
    settings : Welch
    rate : float
        Sampling rate, Hz.
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
        """Number of samples in each of the windows over a record."""
        return self.settings.samples(self.rate)

    @property
    def step(self) -> int:
        """Number of samples from the start of a window to the start of the next."""
        return self.settings.step(self.rate)

    def starts(self, count: int) -> NDArray[np.intp]:
        """Index of the first sample of each window in a record of ``count`` samples, (n_segments,)."""
        return np.arange(self.first * self.step, count - self.length + 1, self.step)

    def lines(self, values: FloatArray) -> ComplexArray:
        """Fourier coefficients (n_segments, n_b) of every window of a signal (n,), at the lines taken."""
        starts = self.starts(len(values))
        found = np.zeros((len(starts), len(self.bins)), dtype=complex)
        if len(starts):
            views = np.lib.stride_tricks.sliding_window_view(values, self.length)
            weights, batch = self.settings.weights(self.rate), max(1, NUMBERS_PER_BATCH // self.length)
            for begin in range(0, len(starts), batch):
                plain = without_trend(views[starts[begin : begin + batch]], self.settings.detrend)
                found[begin : begin + batch] = np.fft.rfft(plain * weights, axis=-1)[:, self.bins]
        return found

    def pieces(self, lines: slice = slice(None)) -> ComplexArray:
        """Matrix (n_b, length) that gives the Fourier coefficients of a window from its samples, trend removed."""
        turn = np.exp(-2j * np.pi * np.outer(self.bins[lines], np.arange(self.length)) / self.length)
        rows = self.settings.weights(self.rate) * turn
        return without_trend(rows.real, self.settings.detrend) + 1j * without_trend(rows.imag, self.settings.detrend)


@dataclass(frozen=True, eq=False)
class SegmentRows:
    """Linear map (n_b, n) from a record's samples to weighted sums of its windows' lines, never stored as a matrix.

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
        """Weighted sums (n_b,) over all windows of the Fourier coefficients of a signal with ``values`` (n,)."""
        return np.asarray((self.weights * self.segments.lines(values)).sum(axis=0))

    def only(self, lines: NDArray[np.bool_]) -> SegmentRows:
        """Copy of the matrix with the rows of some lines only, those where the mask ``lines`` (n_b,) is true."""
        chosen = replace(self.segments, bins=self.segments.bins[lines])
        return SegmentRows(chosen, self.weights[:, lines], self.count)

    def dense(self, lines: slice = slice(None)) -> ComplexArray:
        """Matrix (n_b, n) from the samples of a record to the weighted sums of lines, as a dense array."""
        pieces, length = self.segments.pieces(lines), self.segments.length
        rows = np.zeros((len(pieces), self.count), dtype=complex)
        for start, weights in zip(self.segments.starts(self.count), self.weights[:, lines], strict=True):
            rows[:, start : start + length] += weights[:, None] * pieces
        return rows

    @cached_property
    def squares(self) -> FloatArray:
        """Sum of the squared magnitudes of each row of the matrix from a window to its lines, (n_b,)."""
        some = self._some(self.segments.length)
        return np.concatenate([(np.abs(self.segments.pieces(lines)) ** 2).sum(axis=1) for lines in some])

    def covariance(self) -> FloatArray:
        """Covariance (2 n_b, 2 n_b) of the weighted sums' real and imaginary parts, for unit white noise on the record.

        Windows share noise as far as they overlap, which follows from the pieces, once for each lag.
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
        """Covariance (2 n_b, 2 n_b) of the weighted sums for unit white noise behind a filter of given spectrum."""
        if 16 * self.count * len(self.segments.bins) > MOST_ROW_BYTES:
            return self._row_by_row(spectrum)
        rows = np.concatenate([self._backwards(lines, spectrum) for lines in self._some(len(spectrum))])
        parts = np.concatenate([rows.real, rows.imag])
        return np.asarray(parts @ parts.T)

    def _row_by_row(self, spectrum: ComplexArray) -> FloatArray:
        """Covariance (2 n_b, 2 n_b) of the weighted sums for filtered white noise, one row in memory at a time."""
        size = (len(self.segments.bins),) * 2
        conjugate, plain = np.zeros(size, dtype=complex), np.zeros(size, dtype=complex)
        for line in range(len(self.segments.bins)):
            before = np.fft.fft(self._backwards(slice(line, line + 1), spectrum)[0], len(spectrum))
            after = np.fft.ifft(before * spectrum)[: self.count]
            real, imaginary = self.apply(after.real), self.apply(after.imag)
            conjugate[:, line], plain[:, line] = real - 1j * imaginary, real + 1j * imaginary
        return _parts_covariance(conjugate, plain)

    def _backwards(self, lines: slice, spectrum: ComplexArray) -> ComplexArray:
        """Effect (n_lines, n) of each sample before a filter on the weighted sums of lines behind it."""
        passed = np.fft.fft(self.dense(lines), len(spectrum), axis=1)
        passed *= spectrum.conj()
        return np.fft.ifft(passed, axis=1)[:, : self.count]

    def _some(self, size: int) -> Iterator[slice]:
        """Yield slices of the lines in batches, where each line takes ``size`` numbers."""
        batch, lines = max(1, NUMBERS_PER_BATCH // size), len(self.segments.bins)
        yield from (slice(begin, min(begin + batch, lines)) for begin in range(0, lines, batch))


def _parts_covariance(conjugate: ComplexArray, plain: ComplexArray) -> FloatArray:
    """Covariance (2 n, 2 n) of real and imaginary parts of complex numbers z from the means of z z^H and z z^T."""
    both, difference = conjugate + plain, conjugate - plain
    return np.block([[both.real, -difference.imag], [both.imag, difference.real]]) / 2
