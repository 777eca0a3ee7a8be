"""Weighted residuals of a frequency response, and of a record through the same estimator as the model."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.noise import (
    FEWEST_SCATTERED_LINES,
    USUAL_OVERLAP,
    USUAL_WINDOW,
    Noise,
    averaging_of,
    line_correlation,
    line_noise,
    noise_between_windows,
    noise_powers_between_lines,
    sensor_noise_powers,
)
from torsionnet.identification.residuals.sampled_response import (
    REST_POSITIONS,
    SMOOTHING_ERROR_SHARE,
    SensorSteps,
    Smoothing,
    covariance_in_form,
    errors_in_form,
    parts,
    unexcited_windows,
)
from torsionnet.identification.residuals.windowed_estimate import WindowedEstimate
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals.recording import Recording

# Weighted residuals of a frequency response against the model, without the record behind it.

STATED_ERROR_CERTAINTY = 1e6
"""Number of independent values attributed to the stated error of a response, so large that the error counts as
known."""
ROUNDED_SHARE = 1e-13
"""Share of the magnitude that counts as noise in any case, as rounding leaves about as much."""


@dataclass(eq=False)
class ResponseBlock(MeasurementBlock):
    """Weighted residuals of a response without its record; windows smooth the model as under a stationary input.

    Attributes
    ----------
    noise : (n_b,) array
        Variance of the real part of each line, equal to that of the imaginary part, SI.
    magnitude : (n_b,) array
        Magnitude to which relative errors refer, SI: that of the test, or of the model where the test says nothing of
        its noise, as noise lowers some lines and raises others.
    """

    data: FrequencyResponse
    smoothing: Smoothing | None = None
    noise: FloatArray = field(init=False)
    magnitude: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.forget_noise()

    def forget_noise(self) -> None:
        """Weigh lines by what the test says of its noise, or by its magnitudes."""
        self.noise = line_noise(self.data, self.measurement.error)
        self.magnitude = np.abs(self.measured)

    @property
    def noise_is_unknown(self) -> bool:
        return self.measurement.error is None and self.data.coherence is None

    def learn_noise(self, values: FloatArray, variances: FloatArray | None = None) -> None:
        """Weigh lines by a constant noise and one in proportion to the model, as the scatter from line to line says.

        Of few lines, which show no scatter, the noise is taken as proportional to the model.

        Parameters
        ----------
        values : (n,) array
        variances : (n_b,) array, optional
            Variance that each line says, instead of the scatter, where the model fits.
        """
        predicted = self.predicted(values)[0]
        self.magnitude = np.maximum(np.abs(predicted), np.finfo(float).tiny ** 0.25)
        residual = self.magnitude - np.abs(self.measured) if self.form == "magnitude" else predicted - self.measured
        count, gain = len(residual), self.magnitude**2
        constant, relative = 0.0, 1.0
        if count >= FEWEST_SCATTERED_LINES:
            related = self.known_correlation[:count, :count]
            constant, relative = (
                noise_powers_between_lines(residual, related, gain)
                if variances is None
                else sensor_noise_powers(variances, gain, np.zeros(count))
            )
        # Rounding is noise in proportion to the model, and keeps the weights finite.
        self.noise = constant + max(relative, ROUNDED_SHARE**2) * gain

    @property
    def frequencies(self) -> FloatArray:
        return self.data.frequencies

    @property
    def stated_course(self) -> BetweenSamples | None:
        return self.data.inputs[0].course

    @property
    def corrected_course(self) -> BetweenSamples | None:
        return self.stated_course

    @property
    def measured(self) -> ComplexArray:
        return np.asarray(self.data.values[:, 0, 0])

    @property
    def fine(self) -> FloatArray:
        """Frequencies at which the model is evaluated before smoothing, Hz, (n_f,)."""
        return self.frequencies if self.smoothing is None else self.smoothing.fine

    def curve(self, values: FloatArray) -> ComplexArray:
        """Response of the model at ``fine`` before smoothing by windows, complex, SI, (n_f,)."""
        return self._distorted(values, self.fine)[0]

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        exact = self._distorted(values, self.fine)
        return exact if self.smoothing is None else self.smoothing.smoothed(*exact)

    @property
    def deviations(self) -> FloatArray:
        return np.tile(np.sqrt(self.noise), 2)

    @property
    def sizes(self) -> FloatArray:
        size = np.sqrt(self.noise) / (1.0 if self.form == "complex" else self.magnitude)
        return np.tile(size, self.parts)

    @property
    def absolute_scale(self) -> FloatArray:
        return self.sizes * (1.0 if self.form == "complex" else np.tile(self.magnitude, self.parts))

    def noise_covariance(self, backward: FloatArray) -> FloatArray:
        lines = self._line_correlation
        if lines is None:
            return super().noise_covariance(backward)
        return np.asarray(sum(part @ (lines @ part.T) for part in np.split(backward, self.parts, axis=1)))

    @property
    def squared_correlations(self) -> float:
        lines = self._line_correlation
        return self.count if lines is None else self.parts * float((lines**2).sum())

    @property
    def known_correlation(self) -> FloatArray:
        lines = self._line_correlation
        return super().known_correlation if lines is None else np.kron(np.eye(self.parts), lines.toarray())

    @property
    def _line_correlation(self) -> scipy.sparse.csr_array | None:
        """Correlation (n_b, n_b) of the random errors of the lines, or None where it is unknown."""
        averaged = averaging_of(self.data) if self.measurement.error is None else self.data.estimation
        return None if averaged is None else line_correlation(self.frequencies, averaged)

    def shared_covariance(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        if self.smoothing is None or self.smoothing.exact:
            return super().shared_covariance(backward, values)
        plain = self.curve(values)[self.smoothing.line_indices]
        doubtful = parts(SMOOTHING_ERROR_SHARE * (self.predicted(values)[0] - plain))[:, None]
        moved = backward @ (errors_in_form(self.form, doubtful, self.measured) / self.sizes[:, None])
        return np.asarray(moved @ moved.T)

    def systematic_covariance(self, values: FloatArray) -> FloatArray:
        if self.smoothing is None or self.smoothing.exact:
            return super().systematic_covariance(values)
        covariance = self.smoothing.covariance(
            self.predicted(values)[0] - self.curve(values)[self.smoothing.line_indices]
        )
        return np.asarray(covariance_in_form(self.form, covariance, self.measured) / np.outer(self.sizes, self.sizes))

    @property
    def remark(self) -> str:
        remarks = []
        if not self.data.has_phase:
            remarks.append("has no phase, so magnitudes are compared")
        if self.measurement.error is None and self.data.estimation is None and self._line_correlation is not None:
            usual = f"a {USUAL_WINDOW} window with {100 * USUAL_OVERLAP:.0f} % overlap"
            text = "has a coherence but does not say how it was averaged: neighbours are related as by"
            remarks.append(f"{text} {usual}")
        cut = 0.0 if self.measurement.band or self.smoothing is None else lowest_settled_frequency(self.data)
        if cut:
            remarks.append(f"is used from {cut:.3g} Hz, as a sweep passed what is below within the first window")
        said = f"{self.measurement.label} {'; '.join(remarks)}" if remarks else ""
        return "; ".join(filter(None, (said, super().remark)))

    def measured_noise(self, values: FloatArray) -> Noise | None:
        if self.measurement.error is None:
            return super().measured_noise(values)
        return Noise(line_noise(self.data, self.measurement.error) / self.noise, STATED_ERROR_CERTAINTY)

    def take_measured_noise(self, noise: Noise) -> None:
        self.noise = self.noise * noise.ratio

    def take_noise(self, other: MeasurementBlock, left: float) -> None:
        assert isinstance(other, ResponseBlock)
        self.noise, self.magnitude = other.noise * left, other.magnitude


def lowest_settled_frequency(data: FrequencyResponse) -> float:
    """Lowest usable frequency of a response from a sweep in Hz, after its first window; 0 with its record at hand."""
    return data.estimation.settled_from if data.estimation and data.estimation.record is None else 0.0


# Weighted residuals of a record against the model, both through the same estimator.

MOST_NOISE_RATIO = 100.0
"""Largest noise power of excited windows over that of unexcited ones, as a larger residual that does not follow the
input from window to window is the error of a model with other resonances."""

CLEARLY_LESS = 0.9
"""Share of the unexplained power that may be left where a record is taken to begin with a sudden torque."""


@dataclass(eq=False)
class RecordBlock(MeasurementBlock):
    """Weighted residuals of a record, or of a response that keeps its record, by the same estimator as the prediction.

    Attributes
    ----------
    sensor : SensorSteps
        Steps of the output's sensor.
    estimated_lines : (n_b,) complex array, optional
        Lines of a response that was estimated before, used instead of estimating the record again.
    step_errors : (places, 2 n_b) array
        Errors of real and imaginary parts by the steps of the sensor, for each rest position within a step.
    """

    windowed: WindowedEstimate
    kept: NDArray[np.bool_]
    sensor: SensorSteps
    estimated_lines: ComplexArray | None = field(default=None, kw_only=True)
    covariance: FloatArray = field(init=False)
    sources: tuple[float, float] = field(init=False, default=(0.0, 0.0))
    step_errors: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.covariance = self._part(self.windowed.output_covariance())
        self.step_errors = np.zeros((REST_POSITIONS, len(self.covariance)))

    @property
    def stated_course(self) -> BetweenSamples:
        record, name = self.windowed.record, self.windowed.input
        whole, drives = self.measurement.data, [*self.response.drivetrain.inputs]
        if isinstance(whole, Recording) and not self.is_driven and len(drives) == 1 and drives[0] in whole.names:
            record, name = whole, drives[0]  # as simulate writes it beside the torque that a meter reads
        return record[name].course(record.sampling_rate)

    @property
    def description(self) -> str:
        return f"{super().description} of {self.windowed.instrument}"

    @property
    def frequencies(self) -> FloatArray:
        return np.asarray(self.windowed.frequencies[self.kept])

    @property
    def measured(self) -> ComplexArray:
        return np.asarray(self.windowed.measured[self.kept]) if self.estimated_lines is None else self.estimated_lines

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        G, slopes = self._distorted(values, self.windowed.fine)
        estimate_of = self.windowed.predicted(np.column_stack([G, slopes]))[self.kept]
        return estimate_of[:, 0], estimate_of[:, 1:]

    @property
    def deviations(self) -> FloatArray:
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def sizes(self) -> FloatArray:
        return np.asarray(np.sqrt(np.diag(covariance_in_form(self.form, self._whole, self.measured))))

    @property
    def correlation(self) -> FloatArray:
        size = self.sizes
        return np.asarray(covariance_in_form(self.form, self.covariance, self.measured) / np.outer(size, size))

    @property
    def squared_correlations(self) -> float:
        """Sum of the squared correlations of all pairs of residuals by noise, without errors by sensor steps."""
        noise = covariance_in_form(self.form, self.covariance, self.measured)
        size = np.sqrt(np.diag(noise))
        return float(np.sum((noise / np.outer(size, size)) ** 2))

    def step_shifts(self, backward: FloatArray) -> FloatArray:
        """Errors (n, n_positions), by the sensor's steps at each rest position, of ``backward`` @ residuals."""
        return np.asarray(
            backward @ (errors_in_form(self.form, self.step_errors.T, self.measured) / self.sizes[:, None])
        )

    def shared_covariance(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        del values
        shifts = self.step_shifts(backward)
        return np.asarray(shifts @ shifts.T / REST_POSITIONS)

    @property
    def sensors(self) -> tuple[str, str, float]:
        """Names of output and input, and sampling rate in Hz; records where all are equal share their noise level."""
        return self.windowed.output, self.windowed.input, self.windowed.record.sampling_rate

    def choose_start(self, values: FloatArray) -> None:
        """Take the input's first value as sudden where that explains the output better than a long action."""
        if not self.windowed.suddenly and self.course is not None:
            G, _ = self._distorted(values, self.windowed.fine)
            sudden = self.windowed.begun_suddenly(self.course)
            left, before = (block.unexplained(G)[self.kept].sum() for block in (sudden, self.windowed))
            if left < CLEARLY_LESS * before:
                self.windowed = sudden

    @property
    def remark(self) -> str:
        remark = super().remark
        if self.windowed.suddenly:
            name, record = self.windowed.input, self.windowed.record
            begins = (
                f"{record[name].values[0]:.4g} {record[name].unit} of {name} act from the first sample on, not before"
            )
            remark = "; ".join(filter(None, (f"{self.measurement.label}: {begins}", remark)))
        return remark

    def unexplained(self, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Residual power, squared response and power of step errors at each line, (n_b,), over unit white noise."""
        G, _ = self._distorted(values, self.windowed.fine)
        self._take_steps(G)
        steps = self._variance_of_steps / self._unit
        return self.windowed.unexplained(G)[self.kept], np.abs(self.measured) ** 2, steps

    def input_noise(self, values: FloatArray, on_output: float) -> tuple[float, float] | None:
        """Noise power of the input sensor (variance) and its standard error, or None with too few windows."""
        G, _ = self._distorted(values, self.windowed.fine)
        return unexcited_windows(self.windowed, G).input_noise(on_output)

    def take_sources(self, values: FloatArray, on_output: float, on_input: float) -> None:
        """Weigh the residuals by white noise of the given powers (variances) on output and input."""
        G, _ = self._distorted(values, self.windowed.fine)
        self.sources = on_output, on_input
        # P_out R R^H + P_in (R G)(R G)^H, for the rows R from samples to lines.
        self.covariance = on_output * self._part(self.windowed.output_covariance())
        if on_input:
            self.covariance = self.covariance + on_input * self._part(self.windowed.input_covariance(G))

    def measured_noise(self, values: FloatArray) -> Noise | None:
        G, _ = self._distorted(values, self.windowed.fine)
        supposed = (self.deviations**2).reshape(2, -1).sum(axis=0)
        independent = self.count * len(self.frequencies) / self.squared_correlations
        between = noise_between_windows(self.windowed, G, self.kept, supposed, independent)
        if between is None:
            return super().measured_noise(values)
        # Noise above what is left where nothing excites a line is error of the model, beyond a margin.
        quiet = self._unit * unexcited_windows(self.windowed, G).floor()[self.kept] + self._variance_of_steps
        return replace(between, ratio=np.minimum(between.ratio, MOST_NOISE_RATIO * quiet / supposed))

    def take_measured_noise(self, noise: Noise) -> None:
        size = np.sqrt(np.tile(noise.ratio, 2))
        self.covariance = self.covariance * np.outer(size, size)

    def take_noise(self, other: MeasurementBlock, left: float) -> None:
        del left
        assert isinstance(other, RecordBlock)
        self.covariance, self.step_errors = other.covariance, other.step_errors

    @property
    def _whole(self) -> FloatArray:
        """Covariance (2 n_b, 2 n_b) of the lines' real and imaginary parts by noise and sensor steps, SI."""
        return np.asarray(self.covariance + self.step_errors.T @ self.step_errors / REST_POSITIONS)

    @property
    def _unit(self) -> FloatArray:
        """Variance of each line of the estimate for unit white noise on the output, (n_b,)."""
        return np.asarray(np.diag(self._part(self.windowed.output_covariance())).reshape(2, -1).sum(axis=0))

    @property
    def _variance_of_steps(self) -> FloatArray:
        return np.asarray(np.mean(self.step_errors**2, axis=0).reshape(2, -1).sum(axis=0))

    def _take_steps(self, G: ComplexArray) -> None:
        if self.sensor.size:
            _, motion = self.windowed.residual_and_prediction(G)
            lines = self.sensor.errors(motion, self.windowed.rows.only(self.kept))
            self.step_errors = np.concatenate([lines.real, lines.imag], axis=1)

    def _part(self, whole: FloatArray) -> FloatArray:
        """Part of a covariance of all lines that belongs to the lines compared, (2 n_b, 2 n_b)."""
        lines = np.flatnonzero(self.kept)
        both = np.concatenate([lines, len(self.windowed.frequencies) + lines])
        return np.asarray(whole[np.ix_(both, both)])
