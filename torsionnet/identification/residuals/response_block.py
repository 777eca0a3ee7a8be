"""Weighted residuals of a frequency response against the model, without the record behind it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy

from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.noise import (
    FEWEST_SCATTERED_LINES,
    USUAL_OVERLAP,
    USUAL_WINDOW,
    Noise,
    averaging_of,
    line_correlation,
    line_noise,
    noise_powers_between_lines,
    sensor_noise_powers,
)
from torsionnet.identification.residuals.sampled_response import (
    SMOOTHING_ERROR_SHARE,
    Smoothing,
    covariance_in_form,
    errors_in_form,
    parts,
)
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples
from torsionnet.linear.frequency_response import FrequencyResponse

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
