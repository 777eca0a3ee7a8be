"""Response of the model as a fit compares it with a test, sampled and smoothed, and errors by steps of sensors.

Where a measured torque is the input, its samples and those of the motion follow from the same torque that drives, and
each has images of its own above half the sampling rate: their responses are folded before one is divided by the other.

Smoothing of a model's response by the windows of Welch's method, before comparison with an estimate. Under a stationary
input the estimate at f tends to the transform of the impulse response times the lag window, which is the window's
correlation with itself. In frequency that is a weighted mean of the response about f.

Residuals between prediction and test as complex numbers, log magnitude and phase, or log magnitude alone. Errors are
small against the values, so the error of log(prediction / test) is the relative error of the line.

Errors of a measured response by the steps (resolution) of the output's sensor.

The motion that a model predicts is rounded to steps as by the sensor, from several rest positions within a step. The
position is unknown, but the same for a whole test of a rig that is held: its errors are common to all lines, and no
averaging reduces them. A sine of A steps comes out up to 0.2 / A^1.5 too large or too small.

Noise of a record's input sensor, from windows in which a line is not excited. There the measured input is almost only
noise, and so is the output that a model predicts from it: the mean of their product over thousands of windows and lines
is the power of that noise. Among the lines that a fit compares, few have an input noise as large as that of the output,
and the fit has adapted to them. The error of a wrong model follows the excitation, which is absent from these windows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.identification.residuals.windowed_estimate import SegmentRows, WindowedEstimate
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples, Folding
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.sensitivity.parametric import Evaluation, ParametricResponse
from torsionnet.signals.recording import Recording
from torsionnet.signals.resampling import FILTER_HALF_LENGTH, anti_alias_taps
from torsionnet.signals.uncertainty import step_of, sweep_amplitudes

# Response of the model as a fit compares it with a test: sampled, smoothed by windows, as residuals.

# Response of the model from the samples of a torque to those of a motion, as a fit compares it with measured ones.


@dataclass(frozen=True, eq=False)
class SampledResponse:
    """Transfer function between samples as a function of parameters, with exact derivatives, over that of ``divisor``.

    Attributes
    ----------
    plain : ParametricResponse
        The same in continuous time.
    folded : ParametricResponse
        From what drives to output and measured input, at the frequencies of all images.
    folding : Folding
    divisor : (n_f,) complex array
        What the test was divided by already, without unit.
    """

    plain: ParametricResponse
    folded: ParametricResponse
    folding: Folding
    divisor: ComplexArray

    @property
    def drivetrain(self) -> AssembledModel:
        return self.plain.drivetrain

    @property
    def names(self) -> tuple[str, ...]:
        return self.plain.names

    @property
    def start(self) -> FloatArray:
        return self.plain.start

    @property
    def frequencies(self) -> FloatArray:
        return self.plain.frequencies

    @property
    def unit(self) -> str:
        return self.plain.unit

    def evaluation(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Transfer function and derivatives between samples, in SI units, for these parameter values (n_p,)."""
        continuous = self.folded.evaluation(values)
        G, slopes = self.folding.folded(continuous.values), self.folding.folded(continuous.jacobian)
        if self.plain.request.is_measured:
            # Ratio G of two responses u/T, with derivatives by the quotient rule, (u' - G T')/T.
            torque = G[:, 1:]
            G = G[:, :1] / torque
            slopes = (slopes[:, :1] - G[..., None] * slopes[:, 1:]) / torque[..., None]
        scale = self.divisor[:, None, None]
        return Evaluation(G / scale, slopes / scale[..., None])


def between_samples(
    response: ParametricResponse, course: BetweenSamples | None, stated: BetweenSamples | None
) -> ParametricResponse | SampledResponse:
    """Response of one output to one input between samples of that course; the plain one where it is band-limited.

    ``stated`` is the course for which a measured response was corrected when it was estimated.
    """
    lines = response.frequencies
    if course is None or (course.is_band_limited and (stated is None or stated.is_band_limited)):
        return response
    folding, request = Folding(course, lines), response.request
    if request.is_measured:
        every = (*request.outputs, *request.inputs)
        request = replace(request, outputs=every, inputs=(), is_measured=False)
    driven = replace(response, request=request, frequencies=folding.frequencies, _known=[])
    divisor = np.ones(len(lines), dtype=complex) if stated is None else stated.share(lines)
    return SampledResponse(response, driven, folding, divisor)


# Smoothing of a model's response by the windows of Welch's method, before comparison with an estimate.

NEIGHBOUR_BINS = 8
"""Number of bins on either side of a line that a window mixes into it, beyond which its side lobes are negligible."""
POINTS_PER_BIN = 8
"""Number of points per bin at which a response is evaluated for smoothing, as more give a smoother mean at more
cost."""
SMOOTHING_ERROR_SHARE = 0.15
"""Standard error of the smoothing of all lines together, as a share of it, if the input was a sweep, which is not
stationary."""
LINE_ERROR_RATIO = 1.5
"""Standard error of a single line's smoothing as a multiple of it under a sweep, where the slope of the input's power
has as much effect as the curvature of the response."""
ERROR_CORRELATION_LINES = 1.5
"""Distance in lines over which the smoothing errors of lines are correlated, about the width of a window's band."""


@dataclass(frozen=True, eq=False)
class Smoothing:
    """Linear smoothing of a response G, forward @ G + mirrored @ conj(G); for H2 applied to 1/G, then inverted.

    Attributes
    ----------
    fine : (n_f,) array
        Frequencies at which the transfer function is needed, Hz.
    forward, mirrored : (n_b, n_f) sparse array
    inverted : bool
    exact : bool
        Whether this is the exact mean effect of the windows (stationary input).
    line_indices : (n_b,) array of int
        Indices of the lines in ``fine``.
    """

    fine: FloatArray
    forward: scipy.sparse.csr_array
    mirrored: scipy.sparse.csr_array
    inverted: bool
    exact: bool
    line_indices: NDArray[np.intp]

    def smoothed(self, G: ComplexArray, slopes: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Smoothed response at the lines (n_b,) and derivatives (n_b, n), from G (n_f,) and derivatives (n_f, n)."""
        if not self.inverted:
            return self._linear(G), self._linear(slopes)
        below = self._linear(1 / G)
        return 1 / below, self._linear(slopes / (G**2)[:, None]) / (below**2)[:, None]

    def covariance(self, change: ComplexArray) -> FloatArray:
        """Covariance (2 n_b, 2 n_b) of the errors of a model's smoothed response where the input was a sweep.

        Real parts stand before imaginary ones; ``change`` (n_b,) is smoothed minus exact.
        """
        far = np.subtract.outer(self.line_indices, self.line_indices) / POINTS_PER_BIN / ERROR_CORRELATION_LINES
        both = LINE_ERROR_RATIO**2 * np.outer(change, change.conj()) * np.exp(-(far**2) / 2)
        return np.block([[both.real, -both.imag], [both.imag, both.real]]) / 2

    def _linear(self, G: ComplexArray) -> ComplexArray:
        return np.asarray(self.forward @ G + self.mirrored @ G.conj())


def smoothing(frequencies: FloatArray, estimation: Estimation) -> Smoothing:
    """Smoothing of a model's response for the lines (n_b,) in Hz of an estimate, by its window and estimator."""
    step = 1 / (estimation.seconds * POINTS_PER_BIN)
    offsets = np.arange(-NEIGHBOUR_BINS * POINTS_PER_BIN, NEIGHBOUR_BINS * POINTS_PER_BIN + 1)
    inverted, exact = estimation.estimator == "H2", not estimation.swept
    weights = _shares(estimation, offsets)
    if estimation.aligned:
        # Windows saw G exp(j omega lag), whose phase was put back at each line: neighbours are turned against it.
        turn = 2j * np.pi * offsets * step * estimation.aligned
        weights = weights * np.exp(-turn if inverted else turn)
    lines = np.rint(frequencies / step).astype(np.intp)
    places = lines[:, None] + offsets
    count = int(np.abs(places).max())
    # There is no response at 0 Hz to ask for: the real part of its neighbour stands in.
    targets, half = np.maximum(np.abs(places), 1), np.where(places == 0, 0.5, 1.0)
    # A line mixes frequencies of both signs; below 0 the response is the conjugate.
    forward = _sparse(np.where(places >= 0, weights * half, 0.0), targets, count)
    mirrored = _sparse(np.where(places <= 0, weights * half, 0.0), targets, count)
    fine = np.asarray(np.arange(1, count + 1) * step, dtype=np.float64)
    return Smoothing(fine, forward, mirrored, inverted, exact, lines - 1)


def _sparse(weights: FloatArray, places: NDArray[np.intp], count: int) -> scipy.sparse.csr_array:
    """Sparse matrix (n_b, count) from weights (n_b, n) and the numbers of their columns, counted from 1."""
    lines = np.repeat(np.arange(len(places)), places.shape[1])
    return scipy.sparse.csr_array((weights.ravel(), (lines, places.ravel() - 1)), shape=(len(places), count))


def _shares(estimation: Estimation, offsets: NDArray[np.intp]) -> FloatArray:
    """Weights with which a window mixes the response at frequency offsets (in fine steps) into a line, sum 1."""
    samples = 4 * NEIGHBOUR_BINS * POINTS_PER_BIN
    window = np.asarray(scipy.signal.get_window(estimation.window, samples), dtype=np.float64)
    # Power spectrum of the window, zero-padded to the fine steps.
    power = np.abs(np.fft.fft(window, samples * POINTS_PER_BIN)) ** 2
    share = power[offsets % len(power)]
    return np.asarray(share / share.sum())


# Residuals between prediction and test as complex numbers, log magnitude and phase, or log magnitude alone.

Form: TypeAlias = str
FORMS = ("complex", "log", "magnitude")
"""Names of the forms of residuals (difference of complex values, of log magnitude and phase, of log magnitude
alone)."""


def parts(values: ComplexArray | FloatArray) -> FloatArray:
    """Real parts of complex values, then their imaginary parts, as one real array (2 n, ...)."""
    return np.concatenate([values.real, values.imag])


def residuals_in_form(
    form: Form, predicted: ComplexArray, slopes: ComplexArray, measured: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Residuals between prediction and test as real numbers in a form, and their derivatives (n_residuals, n_p)."""
    if form == "complex":
        return parts(predicted - measured), parts(slopes)
    with np.errstate(
        divide="ignore", invalid="ignore"
    ):  # a gain of 0 gives an infinite residual, and the search takes a smaller step
        # ln(predicted/measured): relative error of the magnitude, and j times that of the phase in rad.
        ratio, relative = np.log(predicted / measured), slopes / predicted[:, None]
    return (ratio.real, relative.real) if form == "magnitude" else (parts(ratio), parts(relative))


def errors_in_form(form: Form, errors: FloatArray, measured: ComplexArray) -> FloatArray:
    """Small errors of a response's real and imaginary parts (2 n, k) as errors of residuals in a form, (.., k)."""
    if form == "complex":
        return errors
    count = len(measured)
    relative = (errors[:count] + 1j * errors[count:]) / measured[:, None]
    return np.asarray(relative.real) if form == "magnitude" else parts(relative)


def covariance_in_form(form: Form, covariance: FloatArray, measured: ComplexArray) -> FloatArray:
    """Covariance of the residuals in a form, from that of a response's real and imaginary parts (2 n, 2 n)."""
    return errors_in_form(form, errors_in_form(form, covariance, measured).T, measured)


# Errors of a measured response by the steps (resolution) of the output's sensor.

REST_POSITIONS = 16
"""Number of rest positions within a step of a sensor for which errors are calculated, as the true one is unknown."""


@dataclass(frozen=True)
class SensorSteps:
    """Step size of a sensor in SI, and the decimation factor of its samples.

    Attributes
    ----------
    size : float
        Size of a step, SI; 0 if the sensor has none.
    decimation : int
        Samples of the sensor for each sample of the record.
    """

    size: float = 0.0
    decimation: int = 1

    def errors(self, motion: FloatArray, rows: SegmentRows) -> ComplexArray:
        """Errors (REST_POSITIONS, n_b) of an estimate's lines by the sensor's steps, for a motion (n,) in SI.

        The motion has the sampling rate of the record.
        """
        if not self.size:
            return np.zeros((REST_POSITIONS, len(rows.segments.bins)), dtype=complex)
        # Steps act before decimation; where in a step the rest lies is open, so places are tried evenly.
        fine = _finer(motion, self.decimation)
        places = (np.arange(REST_POSITIONS) + 0.5) / REST_POSITIONS * self.size
        return np.array([rows.apply(self._error(fine + place, len(motion))) for place in places])

    def _error(self, motion: FloatArray, count: int) -> FloatArray:
        error = self.size * np.rint(motion / self.size) - motion
        if self.decimation == 1:
            return error
        # Through the filter of the decimation, as the record went.
        return scipy.signal.upfirdn(anti_alias_taps(self.decimation), error, 1, self.decimation)[
            FILTER_HALF_LENGTH : FILTER_HALF_LENGTH + count
        ]


def find_sensor_steps(record: Recording, output: str, input: str, decimation: int) -> SensorSteps:
    """Steps of the output's sensor before decimation, of size 0 where the input is not a swept sine.

    Under other inputs, and in rigs that turn, readings fall on all positions within a step: errors are noise.
    """
    is_swept = len(sweep_amplitudes(record, output, input)[0]) > 1
    return SensorSteps(step_of(record[output].values) if is_swept else 0.0, decimation)


def _finer(motion: FloatArray, factor: int) -> FloatArray:
    """Motion of a sensor at ``factor`` times the sampling rate, (n * factor,), interpolated without new frequencies."""
    if factor == 1:
        return motion
    count = 2 * len(motion)
    return np.asarray(np.fft.irfft(factor * np.fft.rfft(motion, count), factor * count)[: factor * len(motion)])


# Noise of a record's input sensor, from windows in which a line is not excited.

NOISE_WINDOW = "blackmanharris"
"""Window for the search of noise, with side lobes of -92 dB, so that a sweep at other lines does not cover the
noise."""
WINDOWS_PER_LENGTH = 4
"""Number of windows that start within the length of one window in the search of noise (overlap of 3/4)."""
EXCITATION_CELLS = 5
"""Number of windows and of lines over which the power of the input is averaged to decide whether a line is excited."""
UNEXCITED_POWER_SHARE = 0.03
"""Share of a line's highest input power over all windows below which a window does not excite the line."""
LEAST_UNEXCITED_WINDOWS = 0.3
"""Least share of unexcited windows of a line, as fewer are chance, because lines of a stationary input come and go."""
FEWEST_VALUES = 100
"""Fewest independent values in unexcited windows whose mean gives the noise power of the input, as few scatter
widely."""
FEWEST_WINDOWS = 2
"""Fewest separate unexcited windows of a line whose median gives the noise of the output there, as one alone may hold
ringing."""
SMOOTHING_CELLS = 15
"""Number of windows and of lines over which the power of the input is smoothed for weights, as weights from the noise
of a single cell would favour cells that have little by chance."""


@dataclass(frozen=True, eq=False)
class UnexcitedWindows:
    """Powers of a record's input and residual by window (n_s) and line (n_b), with a mask of what is not excited.

    Attributes
    ----------
    unexcited : (n_s, n_b) bool array
        Whether a line is not excited in a window.
    moment : (n_s, n_b) array
        Product of the residual and the prediction of the model, as variance of white input noise times ``squared``.
    power : (n_s, n_b) array
        Power of the input as the variance of white noise with that power; smoothed.
    left : (n_s, n_b) array
        Power of the residual of the output as the variance of white noise.
    squared : (n_b,) array
        Squared magnitude of the response.
    """

    unexcited: NDArray[np.bool_]
    moment: FloatArray
    power: FloatArray
    left: FloatArray
    squared: FloatArray

    def input_noise(self, output_noise: float) -> tuple[float, float] | None:
        """Noise power of the input sensor (variance of its samples) and its standard error.

        None where too few windows are free of excitation. The noise power of the output is needed for the weights.
        """
        if np.count_nonzero(self.unexcited) < FEWEST_VALUES * WINDOWS_PER_LENGTH:
            return None
        on_output, level, total = 1.0, 0.0, 0.0
        for _ in range(2):
            # Least squares of moment = P_in |G|^2, by weights that hold P_in themselves, hence twice.
            weights = self.unexcited / (self.power * (on_output + level * self.squared))
            total = float((weights * self.squared).sum())
            level = max(float((weights * self.moment).sum()) / total, 0.0)
            on_output = output_noise
        # Of a complex product the real part has half the variance, and overlapping windows repeat what they share.
        return level, float(np.sqrt(WINDOWS_PER_LENGTH / 2 / total))

    def floor(self) -> FloatArray:
        """Noise power of the output at each line, (n_b,), the median over unexcited windows; infinite with too few.

        Not the mean: ringing after the sweep, which a wrong model lacks, is in some windows only.
        """
        floor = np.full(self.unexcited.shape[1], np.inf)
        for line in np.flatnonzero(self.unexcited.sum(axis=0) >= FEWEST_WINDOWS * WINDOWS_PER_LENGTH):
            floor[line] = np.median(self.left[self.unexcited[:, line], line]) / np.log(2)
        return floor


def unexcited_windows(windowed: WindowedEstimate, G: ComplexArray) -> UnexcitedWindows:
    """Windows of a record in which lines are not excited, with the residuals of a transfer function G (n_f,)."""
    own = windowed.rows.segments
    segments = replace(own, settings=replace(own.settings, window=NOISE_WINDOW, overlap=1 - 1 / WINDOWS_PER_LENGTH))
    rest, _ = windowed.residual_and_prediction(G)
    left, into = segments.lines(rest), segments.lines(windowed.input_from_rest)
    at = windowed.frequencies
    gain = np.interp(at, windowed.fine, G.real) + 1j * np.interp(at, windowed.fine, G.imag)
    unit = (np.abs(segments.pieces()) ** 2).sum(axis=1)
    # In Y - G X noise N of the input's sensor is -G N, which correlates with G times the input read.
    power, moment = np.abs(into) ** 2 / unit, -(left * (into * gain).conj()).real / unit
    near = scipy.ndimage.uniform_filter(power, EXCITATION_CELLS)
    unexcited = near < UNEXCITED_POWER_SHARE * near.max(axis=0)
    unexcited &= unexcited.mean(axis=0) > LEAST_UNEXCITED_WINDOWS
    smooth = scipy.ndimage.uniform_filter(power, SMOOTHING_CELLS)
    return UnexcitedWindows(unexcited, moment, smooth, np.abs(left) ** 2 / unit, np.abs(gain) ** 2)
