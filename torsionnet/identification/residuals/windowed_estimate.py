"""Response estimated by windows from a record, and the same estimate from the output that a model predicts.

The prediction is G(f) X(f) over the whole record, and everything after it (cutting into windows, taking out means,
averaging) is linear in the output. So the estimate of the prediction is linear in G, and its derivative is that of dG.
Leakage and windows act on model and test in the same way, and cancel.

Lines (Fourier coefficients) of a signal's windows, and linear maps from a record to weighted sums of them. Such a map
has a row for each line with a value for each sample: 80 lines of two minutes at 5 kHz would fill 770 MB, and filtered
copies several times that. Rows consist of short pieces, one for each window, so products and covariances are calculated
from the pieces.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.identification.residuals.measurement import Instrument, without_background
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples
from torsionnet.signals.recording import Recording
from torsionnet.signals.resampling import check_processable, decimate
from torsionnet.signals.welch import Welch, without_trend

# Lines (Fourier coefficients) of a signal's windows, and linear maps from a record to weighted sums of them.

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
        coefficients = np.zeros((len(starts), len(self.bins)), dtype=complex)
        if len(starts):
            views = np.lib.stride_tricks.sliding_window_view(values, self.length)
            weights, batch = self.settings.weights(self.rate), max(1, NUMBERS_PER_BATCH // self.length)
            for begin in range(0, len(starts), batch):
                plain = without_trend(views[starts[begin : begin + batch]], self.settings.detrend)
                coefficients[begin : begin + batch] = np.fft.rfft(plain * weights, axis=-1)[:, self.bins]
        return coefficients

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
            # Windows some steps apart have white noise in common only where they overlap.
            late, early = pieces[:, lag * step :], pieces[:, : length - lag * step]
            first, second = self.weights[: len(self.weights) - lag].T, self.weights[lag:]
            product = (late @ early.conj().T) * (first @ second.conj())
            other = (late @ early.T) * (first @ second)
            conjugate += product + product.conj().T if lag else product
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
            # A row of (R S)(R S)^H: back through the filter S, forward again, then through all rows R.
            before = np.fft.fft(self._backwards(slice(line, line + 1), spectrum)[0], len(spectrum))
            after = np.fft.ifft(before * spectrum)[: self.count]
            real, imaginary = self.apply(after.real), self.apply(after.imag)
            # E[z z^*] and E[z z], as real and imaginary parts may correlate.
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


SIDE_LOBE_FACTOR = 2.0
"""Multiple of the highest line (plus 20 lines) up to which the model is evaluated, so that the side lobes of windows
are covered."""


@dataclass(frozen=True, eq=False)
class WindowedEstimate:
    """Frequency response estimated from a record, and the linear map from a transfer function to such an estimate.

    Attributes
    ----------
    frequencies : (n_b,) array
        Lines of the estimate, Hz.
    measured : (n_b,) complex array
        Estimate of the record: sum over segments of output times instrument, over the sum of input times instrument.
    fine : (n_f,) array
        Frequencies at which the transfer function is needed, Hz.
    drive : (n_f,) complex array
        Spectrum of the input at ``fine``, of the record followed by as many zeros.
    rows : SegmentRows
        Rows with estimate = rows @ output, for the samples of the (decimated) output.
    instrument : Instrument
    power : (n_b,) complex array
        Sum over the segments of input times instrument.
    background : (n_b,) bool array
        Whether squared noise of the instrument is in that sum.
    suddenly : bool
        Whether the first value of the input acts from its sample on, and nothing before; else it has acted for long.
    """

    frequencies: FloatArray
    measured: ComplexArray
    fine: FloatArray
    drive: ComplexArray
    rows: SegmentRows
    record: Recording
    output: str
    input: str
    instrument: Instrument
    power: ComplexArray
    background: NDArray[np.bool_]
    suddenly: bool = False

    def begun_suddenly(self, course: BetweenSamples) -> WindowedEstimate:
        """Estimate of the same record, which begins at rest, with an input that is there at once."""
        first = float(self.record[self.input].values[0])
        turns = 2j * np.pi * self.fine / self.record.sampling_rate
        # Spectrum of as many samples of one, by the sum of a geometric series, and of none before.
        constant = (1 - np.exp(-turns * self.rows.count)) / (1 - np.exp(-turns))
        drive = self.drive + first * constant
        if course.between == "straight":
            # Nothing rises to the first sample: half of its triangle, (1 + t/h) before it, is left out.
            x = 2j * np.pi * self.fine / course.rate
            rise = (1 / x - (1 - np.exp(-x)) / x**2).conj()
            drive = drive - first * rise / course.share(self.fine)
        return replace(self, drive=drive, suddenly=True)

    def predicted(self, G: ComplexArray) -> ComplexArray:
        """Estimates of a response (n_b,) or (n_b, n_p) from outputs that G (n_f,) or (n_f, n_p) predicts."""
        columns = [self.rows.apply(self._passed(column)) for column in G.reshape(len(G), -1).T]
        return np.stack(columns, axis=1).reshape(-1, *G.shape[1:])

    def output_covariance(self) -> FloatArray:
        """Covariance (2 n_b, 2 n_b) of the estimate's real and imaginary parts, for unit white noise on the output."""
        return self.rows.covariance()

    def input_covariance(self, G: ComplexArray) -> FloatArray:
        """Covariance (2 n_b, 2 n_b) of the predicted estimate, for unit white noise on the input of G (n_f,)."""
        n, first = _padded(self.rows.count), self._first
        # The conjugate at negative frequencies: a real signal stays real.
        both = np.zeros(n, dtype=complex)
        both[first : first + len(G)] = G
        both[n - first - len(G) + 1 : n - first + 1] = G[::-1].conj()
        return self.rows.filtered_covariance(both)

    def unexplained(self, G: ComplexArray) -> FloatArray:
        """Power of measured minus predicted output at each line, over that of unit white noise, (n_b,).

        Segments are weighted as in the estimate: in a sweep a line is measured while the sweep passes it, and the
        errors by an encoder's steps differ then from those at other times.
        """
        rest, _ = self.residual_and_prediction(G)
        noise, drive = np.abs(self.rows.segments.lines(rest)) ** 2, np.abs(self.rows.weights) ** 2
        return np.asarray((noise * drive).sum(axis=0) / drive.sum(axis=0) / self.rows.squares)

    def residual_and_prediction(self, G: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Output measured minus that predicted by G (n_f,), and that predicted, each (n,), in the output's unit."""
        predicted = self._passed(G)
        predicted = predicted - predicted[0] if self.suddenly else predicted
        return _from_rest(self.record, self.output) - predicted, predicted

    @property
    def input_from_rest(self) -> FloatArray:
        """Input signal of the record minus its first value, (n,), in its unit."""
        return _from_rest(self.record, self.input)

    @property
    def _first(self) -> int:
        """Index, in the spectrum of the input, of the lowest frequency at which the model is evaluated."""
        return round(float(self.fine[0]) * _padded(self.rows.count) / self.record.sampling_rate)

    def _passed(self, G: ComplexArray) -> FloatArray:
        """Output (n,) in its unit that the transfer function G (n_f,) predicts from the measured input."""
        n = _padded(self.rows.count)
        spectrum = np.zeros(n // 2 + 1, dtype=complex)
        spectrum[self._first : self._first + len(G)] = G * self.drive
        return np.asarray(np.fft.irfft(spectrum, n)[: self.rows.count])


def windowed_estimate(
    recording: Recording,
    output: str,
    input: str,
    settings: Welch,
    band: tuple[float, float],
    settling: float = 0.0,
    instrument: Instrument | None = None,
) -> WindowedEstimate:
    """Frequency response estimated from one record by windows, ready to compare with models.

    Parameters
    ----------
    recording : Recording
        Begins at rest, or ``settling`` seconds of its start are left out of the estimate.
    output, input : str
    settings : Welch
        Averaging; its estimator is not used here.
    band : tuple of float
        Lowest and highest line, Hz.
    settling : float, optional
        Seconds left out at the start.
    instrument : Instrument, optional
        By default the input, as for H1 in Welch's method.

    Raises
    ------
    UsageError
        The record is too short or cannot be processed, the band has no lines, or the input does not follow the
        reference.
    """
    instrument = instrument or Instrument("H1", input, plain=True)
    chosen = recording.select(dict.fromkeys([output, input, instrument.signal]))
    check_processable(chosen)
    record = decimate(chosen, settings.decimation)
    rate, step = record.sampling_rate, settings.step(recording.sampling_rate / settings.decimation)
    bins = _lines_in(band, settings, rate)
    segments = Segments(replace(settings, decimation=1), rate, bins, int(np.ceil(settling * rate / step)))
    x, y = _from_rest(record, input), _from_rest(record, output)
    X = segments.lines(x)
    if not len(X):
        raise UsageError(
            f"the record of {record.duration:g} s is too short for one window of {settings.seconds:g} s after "
            "settling; take shorter windows (seconds)",
            kind="too-short",
        )
    instrument, R = instrument.lines(X, lambda name: segments.lines(_from_rest(record, name)))
    if instrument.is_clean or instrument.plain:
        background = np.full(len(bins), not instrument.is_clean)
    else:
        R, background = without_background(R)
    # H1, H2 and Hr alike are sum R^* Y/sum R^* X, where R is the input, the output or a reference.
    power = (R.conj() * X).sum(axis=0)
    rows = SegmentRows(segments, R.conj() / power, len(x))
    n = _padded(len(x))
    # Side lobes of the window bring what is beyond the last line: the model is asked for as far as they matter.
    top = min(
        rate / 2,
        SIDE_LOBE_FACTOR * float(bins[-1]) / settings.samples(rate) * rate + 20 * rate / settings.samples(rate),
    )
    fine = np.arange(1, int(top * n / rate))
    return WindowedEstimate(
        frequencies=bins * rate / settings.samples(rate),
        measured=rows.apply(y),
        fine=fine * rate / n,
        drive=np.fft.rfft(x, n)[fine],
        rows=rows,
        record=record,
        output=output,
        input=input,
        instrument=instrument,
        power=power,
        background=background,
    )


def _lines_in(band: tuple[float, float], settings: Welch, rate: float) -> NDArray[np.intp]:
    length = settings.samples(rate)
    every = np.arange(1, length // 2)
    f = every * rate / length
    kept = every[(f >= band[0] * (1 - 1e-9)) & (f <= band[1] * (1 + 1e-9))]
    if not len(kept):
        lines_are = f"its lines are {rate / length:g} Hz apart"
        raise UsageError(
            f"no line of the estimate lies between {band[0]:g} and {band[1]:g} Hz; {lines_are}", kind="missing-data"
        )
    return kept


def _from_rest(record: Recording, name: str) -> FloatArray:
    values = record[name].values
    return np.asarray(values - values[0])


def _padded(count: int) -> int:
    """Number of samples, twice ``count`` or more, to which zeros lengthen a record so that responses die away."""
    from scipy.fft import next_fast_len

    return int(next_fast_len(2 * count, real=True))
