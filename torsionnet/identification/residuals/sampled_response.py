"""Response of the model as a fit compares it with a test: sampled, smoothed by windows, as residuals.

Where a measured torque is the input, its samples and those of the motion follow from the same torque that drives, and
each has images of its own above half the sampling rate: their responses are folded before one is divided by the other.

Smoothing of a model's response by the windows of Welch's method, before comparison with an estimate. Under a stationary
input the estimate at f tends to the transform of the impulse response times the lag window, which is the window's
correlation with itself. In frequency that is a weighted mean of the response about f.

Residuals between prediction and test as complex numbers, log magnitude and phase, or log magnitude alone. Errors are
small against the values, so the error of log(prediction / test) is the relative error of the line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples, Folding
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.sensitivity.parametric import Evaluation, ParametricResponse

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
