"""Response estimated by windows from a record, and the same estimate from the output that a model predicts.

The prediction is G(f) X(f) over the whole record, and everything after it (cutting into windows, taking out means,
averaging) is linear in the output. So the estimate of the prediction is linear in G, and its derivative is that of dG.
Leakage and windows act on model and test in the same way, and cancel.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.identification.residuals.instrument import Instrument, without_background
from torsionnet.identification.residuals.segments import SegmentRows, Segments
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples
from torsionnet.signals.decimation import decimate
from torsionnet.signals.record_blocks import check_processable
from torsionnet.signals.recording import Recording
from torsionnet.signals.welch import Welch

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
            "settling; take shorter windows (seconds)"
        )
    instrument, R = instrument.lines(X, lambda name: segments.lines(_from_rest(record, name)))
    if instrument.is_clean or instrument.plain:
        background = np.full(len(bins), not instrument.is_clean)
    else:
        R, background = without_background(R)
    power = (R.conj() * X).sum(axis=0)
    rows = SegmentRows(segments, R.conj() / power, len(x))
    n = _padded(len(x))
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
        raise UsageError(f"no line of the estimate lies between {band[0]:g} and {band[1]:g} Hz; {lines_are}")
    return kept


def _from_rest(record: Recording, name: str) -> FloatArray:
    values = record[name].values
    return np.asarray(values - values[0])


def _padded(count: int) -> int:
    """Number of samples, twice ``count`` or more, to which zeros lengthen a record so that responses die away."""
    from scipy.fft import next_fast_len

    return int(next_fast_len(2 * count, real=True))
