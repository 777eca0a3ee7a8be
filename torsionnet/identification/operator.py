"""The same-estimator route: what Welch's method would make of the output that a model predicts from the measured input.

The prediction is G(f) X(f) over the whole record, and everything after it (cutting into windows, taking out means,
averaging) is linear in the output. So the estimate of the prediction is a matrix times G, and its derivative the same
matrix times dG: leakage and windows act on model and test alike, and cancel.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.errors import UsageError
from torsionnet.signals.blocks import check_processable
from torsionnet.signals.decimation import decimate
from torsionnet.signals.recording import Recording
from torsionnet.signals.welch import Welch

REACH = 2.0
"""A window's side lobes are followed to this multiple of the highest line, plus 20 lines."""


@dataclass(frozen=True, eq=False)
class WindowedEstimate:
    """H1 of a record at some lines, and how it follows from a transfer function.

    Attributes
    ----------
    frequencies : (n_b,) array
        Lines of the estimate, Hz.
    measured : (n_b,) complex array
        H1 of the record.
    fine : (n_f,) array
        Frequencies at which the transfer function is needed, Hz.
    forward, mirrored : (n_b, n_f) complex array
        Estimate of the prediction = forward @ G + mirrored @ conj(G).
    rows : (n_b, n) complex array
        H1 = rows @ output, for the samples of the (decimated) output.
    """

    frequencies: FloatArray
    measured: ComplexArray
    fine: FloatArray
    forward: ComplexArray
    mirrored: ComplexArray
    rows: ComplexArray
    record: Recording
    output: str
    input: str
    settings: Welch
    first_segment: int

    def predicted(self, G: ComplexArray) -> ComplexArray:
        """Estimate of the output predicted by G (n_f,) or several of them (n_f, n_p)."""
        return np.asarray(self.forward @ G + self.mirrored @ G.conj())

    def output_covariance(self) -> FloatArray:
        """Of real and imaginary parts of H1 (2 n_b, 2 n_b), for unit white noise on the output."""
        return _covariance(self.rows)

    def input_covariance(self, G: ComplexArray) -> FloatArray:
        """The same for unit white noise on the input, which the prediction passes on through G."""
        n, count = _padded(self.rows.shape[1]), self.rows.shape[1]
        first = round(float(self.fine[0]) * n / self.record.sampling_rate)
        both = np.zeros(n, dtype=complex)
        both[first : first + len(G)] = G.conj()
        both[n - first - len(G) + 1 : n - first + 1] = G[::-1]
        return _covariance(np.fft.ifft(np.fft.fft(self.rows, n, axis=1) * both, axis=1)[:, :count])

    def unexplained(self, G: ComplexArray) -> FloatArray:
        """Mean square of the lines of measured minus predicted output, over that of unit white noise, (n_b,).

        Segments count by the power of the input in them: in a sweep a line is measured while the sweep passes it, and
        what an encoder's steps do then is not what they do at other times.
        """
        x, y = _from_rest(self.record, self.input), _from_rest(self.record, self.output)
        n = _padded(len(x))
        lines = np.fft.rfft(x, n)
        spectrum = np.zeros(len(lines), dtype=complex)
        first = round(float(self.fine[0]) * n / self.record.sampling_rate)
        spectrum[first : first + len(G)] = G * lines[first : first + len(G)]
        rest = y - np.fft.irfft(spectrum, n)[: len(y)]
        rows = _rows(self.settings, self.record.sampling_rate, _bins(self.frequencies, self.settings, self.record))
        noise, drive = (
            np.abs(_segments(values, self.settings, self.record.sampling_rate)[self.first_segment :] @ rows.T) ** 2
            for values in (rest, x)
        )
        return np.asarray((noise * drive).sum(axis=0) / drive.sum(axis=0) / (np.abs(rows) ** 2).sum(axis=1))


def windowed_estimate(
    recording: Recording, output: str, input: str, settings: Welch, band: tuple[float, float], settling: float = 0.0
) -> WindowedEstimate:
    """Prepare the route for one record.

    Parameters
    ----------
    recording : Recording
        Begins at rest, or ``settling`` seconds of its start are left out of the estimate.
    output, input : str
    settings : Welch
        Its estimator is taken to be H1, which noise on the output (an encoder's steps) leaves unbiased.
    band : tuple of float
        Lowest and highest line, Hz.
    settling : float, optional
        s.
    """
    chosen = recording.select([output, input])
    check_processable(chosen)
    record = decimate(chosen, settings.decimation)
    rate, step = record.sampling_rate, settings.step(recording.sampling_rate / settings.decimation)
    bins = _lines_in(band, settings, rate)
    rows = _rows(settings, rate, bins)
    first = int(np.ceil(settling * rate / step))
    x, y = _from_rest(record, input), _from_rest(record, output)
    segments = _segments(x, settings, rate)
    if len(segments) <= first:
        msg = (
            f"the record of {record.duration:g} s is too short for one window of {settings.seconds:g} s after settling"
        )
        raise UsageError(msg)
    X = segments[first:] @ rows.T
    power = (np.abs(X) ** 2).sum(axis=0)
    q = _adjoint(X, rows, len(x), step, first) / power[:, None]
    n = _padded(len(x))
    top = min(rate / 2, REACH * float(bins[-1]) / settings.samples(rate) * rate + 20 * rate / settings.samples(rate))
    fine = np.arange(1, int(top * n / rate))
    spectrum, lines = np.fft.fft(q, n, axis=1), np.fft.rfft(x, n)[fine]
    return WindowedEstimate(
        frequencies=bins * rate / settings.samples(rate),
        measured=q @ y,
        fine=fine * rate / n,
        forward=spectrum[:, n - fine] * lines / n,
        mirrored=spectrum[:, fine] * lines.conj() / n,
        rows=q,
        record=record,
        output=output,
        input=input,
        settings=replace(settings, decimation=1),
        first_segment=first,
    )


def _lines_in(band: tuple[float, float], settings: Welch, rate: float) -> NDArray[np.intp]:
    length = settings.samples(rate)
    every = np.arange(1, length // 2)
    f = every * rate / length
    kept = every[(f >= band[0] * (1 - 1e-9)) & (f <= band[1] * (1 + 1e-9))]
    if not len(kept):
        apart = f"its lines are {rate / length:g} Hz apart"
        msg = f"no line of the estimate lies between {band[0]:g} and {band[1]:g} Hz; {apart}"
        raise UsageError(msg)
    return kept


def _bins(frequencies: FloatArray, settings: Welch, record: Recording) -> NDArray[np.intp]:
    return np.rint(frequencies * settings.samples(record.sampling_rate) / record.sampling_rate).astype(np.intp)


def _rows(settings: Welch, rate: float, bins: NDArray[np.intp]) -> ComplexArray:
    """Rows (n_b, length) that make of a segment its windowed line without its trend."""
    length = settings.samples(rate)
    turn = np.exp(-2j * np.pi * np.outer(bins, np.arange(length)) / length)
    rows = settings.weights(rate) * turn
    degree = {"none": 0, "mean": 1, "linear": 2}[settings.detrend]
    if degree:
        basis, _ = np.linalg.qr(np.linspace(-1, 1, length)[:, None] ** np.arange(degree))
        rows = rows - (rows @ basis) @ basis.T
    return np.asarray(rows)


def _from_rest(record: Recording, name: str) -> FloatArray:
    values = record[name].values
    return np.asarray(values - values[0])


def _padded(count: int) -> int:
    """Length after zeros in which a response dies away: twice that of the record."""
    from scipy.fft import next_fast_len

    return int(next_fast_len(2 * count, real=True))


def _segments(values: FloatArray, settings: Welch, rate: float) -> FloatArray:
    length = settings.samples(rate)
    if len(values) < length:
        return np.zeros((0, length))
    return np.lib.stride_tricks.sliding_window_view(values, length)[:: settings.step(rate)]


def _adjoint(X: ComplexArray, rows: ComplexArray, count: int, step: int, first: int) -> ComplexArray:
    """Rows q (n_b, n): the sum over segments of conj(X) times the row at its place; q @ y sums conj(X) Y."""
    q = np.zeros((len(rows), count), dtype=complex)
    length = rows.shape[1]
    for number, lines in enumerate(X):
        start = (first + number) * step
        q[:, start : start + length] += lines.conj()[:, None] * rows
    return q


def _covariance(q: ComplexArray) -> FloatArray:
    parts = np.concatenate([q.real, q.imag])
    return np.asarray(parts @ parts.T)
