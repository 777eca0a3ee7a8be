"""Weighted residuals of one measurement with exact derivatives (base class for records and for responses).

Lines become real vectors, divided by their standard deviation by noise. Neighbouring lines share noise, since windows
smear it: weights do not use that (the noise of an encoder is not quite what theory says), but the standard errors of a
fit do.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from typing import ClassVar, Protocol

import numpy as np
import scipy

from torsionnet.identification.orders.parametric_orders import parameters_of_drivetrain
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.noise import Noise, noise_between_lines
from torsionnet.identification.residuals.sampled_response import Form, between_samples, residuals_in_form
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples, check_between, course_remark
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.linear.sensitivity.parametric import Evaluation, parametric_response

FEWEST_DELAYED_LINES = 8
"""Fewest lines whose phases tell a delay of more than half a period."""
BINS_PER_LINE, DELAYS_PER_PERIOD = 4, 8
"""Bins to a mean distance of lines, and delays tried to a period of the highest line, in the search for a delay."""
CLEARLY_MORE = 1.5
"""Agreement in phase with a long delay over that without, above which a search begins at the delay, too."""


class ParametricCurve(Protocol):
    """Protocol of a curve of the model (frequency response or orders) as a function of unknowns, in SI units."""

    @property
    def drivetrain(self) -> AssembledModel: ...

    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def start(self) -> FloatArray: ...

    @property
    def frequencies(self) -> FloatArray: ...

    @property
    def unit(self) -> str: ...

    def evaluation(self, values: Sequence[float] | FloatArray) -> Evaluation: ...


@dataclass(eq=False)
class MeasurementBlock(ABC):
    """Weighted residuals of one measurement against the model, with their derivatives and covariance.

    Vectors of values hold the ``parameters`` of the model first, then delay, gain and reference angle where they are
    fitted.
    """

    has_equations: ClassVar[bool] = False
    """Whether equations of motion with laws in full lead a search to where motions can be compared, or are compared."""

    measurement: Measurement
    response: ParametricCurve
    form: Form = field(default="complex", kw_only=True)

    @property
    def parts(self) -> int:
        """Number of residuals per line, 1 for magnitudes alone, else 2."""
        return 1 if self.form == "magnitude" else 2

    @property
    def count(self) -> int:
        """Number of residuals of the measurement, lines times residuals per line."""
        return len(self.frequencies) * self.parts

    @property
    @abstractmethod
    def frequencies(self) -> FloatArray:
        """Frequencies of the lines at which test and model are compared, Hz, (n_b,)."""

    @property
    def runs(self) -> tuple[slice, ...]:
        """Slices of lines along which a misfit may have a pattern: all lines of a response, those of each order."""
        return (slice(0, len(self.frequencies)),)

    @property
    def line_orders(self) -> FloatArray | None:
        """Order of each line, vibrations per revolution, (n_b,); None for what is no measurement of orders."""
        return None

    @property
    def line_speeds(self) -> FloatArray | None:
        """Speed of the reference shaft at each line of orders, rad/s, (n_b,); None as well for responses."""
        return None

    @property
    def has_phase(self) -> bool:
        """Whether the test has phases, so that complex values can be compared."""
        data = self.measurement.data
        return not isinstance(data, FrequencyResponse) or data.has_phase

    @property
    def noise_is_stated(self) -> bool:
        """Whether the noise of the lines is stated with the test, and not estimated from residuals."""
        return self.measurement.error is not None

    @property
    def noise_is_unknown(self) -> bool:
        """Whether the test says nothing of its noise, which only the scatter of the residuals shows then."""
        return False

    @property
    def unit(self) -> str:
        """SI unit of the values compared."""
        return self.response.unit

    @property
    def description(self) -> str:
        """Short description of the data compared, such as '40 lines of H1'."""
        return f"{len(self.frequencies)} lines"

    @property
    @abstractmethod
    def measured(self) -> ComplexArray:
        """Measured response at the lines compared, complex, SI, (n_b,)."""

    @abstractmethod
    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Response predicted by the model at the lines, complex, (n_b,), SI, and its derivatives (n_b, n)."""

    @property
    @abstractmethod
    def deviations(self) -> FloatArray:
        """Standard deviations by noise of the lines' real, then imaginary parts, SI, (2 n_b,)."""

    @property
    @abstractmethod
    def sizes(self) -> FloatArray:
        """Standard deviations by which the residuals are divided to weight them, (count,)."""

    @property
    def absolute_scale(self) -> FloatArray:
        """Factors that turn weighted residuals into differences in the unit of the response, (count,)."""
        return self.sizes * (1.0 if self.form == "complex" else np.tile(np.abs(self.measured), self.parts))

    @property
    def correlation(self) -> FloatArray | None:
        """Correlation (count, count) of the weighted residuals by noise; None where they are independent."""
        return None

    def noise_covariance(self, backward: FloatArray) -> FloatArray:
        """Covariance (n, n), due to noise, of the sums ``backward`` (n, count) @ residuals."""
        correlation = self.correlation
        return np.asarray(backward @ (backward.T if correlation is None else correlation @ backward.T))

    @property
    def squared_correlations(self) -> float:
        """Sum of the squared correlations of all pairs of residuals of the measurement, without unit."""
        return float(self.count if self.correlation is None else np.sum(self.correlation**2))

    def shared_covariance(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        """Covariance (n, n), due to errors that all lines share, of the sums ``backward`` (n, count) @ residuals."""
        del values
        return np.zeros((len(backward), len(backward)))

    def systematic_covariance(self, values: FloatArray) -> FloatArray:
        """Covariance (count, count), due to systematic errors, of a correct model's weighted residuals."""
        return self.shared_covariance(np.eye(self.count), values)

    def residuals(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted residuals, model minus test (count,), and their derivatives (count, n)."""
        residuals, slopes = residuals_in_form(self.form, *self.predicted(values), self.measured)
        size = self.sizes
        return residuals / size, slopes / size[:, None]

    @property
    def remark(self) -> str:
        """Note on assumptions about the measurement for the notes of a fit, empty if there are none."""
        if self.course is None or (self.course.is_band_limited and not self.is_driven):
            return ""
        remark = course_remark(self.driving, self.course, float(self.frequencies.max()))
        return f"{self.measurement.label}: {remark}" if remark else ""

    def measured_noise(self, values: FloatArray) -> Noise | None:
        """Noise variance of each line (n_b,) over that which the weights suppose, without errors of the model.

        None where noise and errors of the model cannot be separated.
        """
        residual, _ = self.residuals(values)
        count = len(self.frequencies)
        lines = residual if self.parts == 1 else residual[:count] + 1j * residual[count:]
        noise = noise_between_lines(lines, self.known_correlation[:count, :count])
        if noise is None:
            return None
        # A useless model leaves residuals that jump between lines; noise cannot exceed the measured response.
        power = float(np.tile(noise.ratio, len(residual) // count) @ self.absolute_scale**2)
        most = float(np.sum(np.abs(self.measured) ** 2))
        return replace(noise, ratio=noise.ratio * min(1.0, most / power)) if power > 0 else noise

    @property
    def known_correlation(self) -> FloatArray:
        """Correlation (count, count) of the weighted residuals by noise, the identity where it is unknown."""
        return np.eye(self.count) if self.correlation is None else self.correlation

    @abstractmethod
    def take_measured_noise(self, noise: Noise) -> None:
        """Weigh the residuals by a noise that was measured, instead of that supposed so far."""

    @abstractmethod
    def take_noise(self, other: MeasurementBlock, left: float) -> None:
        """Take over the weights of another fit of this measurement, whose reduced chi squared is ``left``."""

    def with_model(
        self, rig: AssembledModel, measurement: Measurement, parameters: tuple[str, ...]
    ) -> MeasurementBlock:
        """Copy of the residuals against another model, with other flags of the measurement or other parameters."""
        block, old = copy(self), self.response
        block.measurement = measurement
        output, into = measurement.model_output or measurement.output, measurement.model_input or measurement.input
        names = parameters_of_drivetrain(rig, parameters)
        plain = parametric_response(rig, output, into, old.frequencies, names, driven_by=measurement.excitation)
        block.response = between_samples(plain, block.course, block.corrected_course)
        return block

    @property
    def stated_course(self) -> BetweenSamples | None:
        """Course of the input between its samples as the data state it; None where they have no samples."""
        return None

    @property
    def corrected_course(self) -> BetweenSamples | None:
        """Course for which the values of the test were corrected when they were estimated; None without correction."""
        return None

    @property
    def is_driven(self) -> bool:
        """Whether the input drives the model, and is not a reading of what another torque causes."""
        return (self.measurement.model_input or self.measurement.input) not in self.response.drivetrain.sensors

    @property
    def driving(self) -> str:
        """Words for the torque whose course between samples counts: the input, or what causes its reading."""
        return self.measurement.input if self.is_driven else f"what drives {self.measurement.input}"

    @property
    def course(self) -> BetweenSamples | None:
        """Course of the input between its samples as the measurement states it, else as the data do."""
        stated, asked = self.stated_course, self.measurement.between
        return replace(stated, between=check_between(asked)) if stated and asked else stated

    @property
    def extra(self) -> tuple[str, ...]:
        """Names of the channel's unknowns (delay, gain, angle, inertia), which follow the parameters in the values."""
        measurement = self.measurement
        asked = {
            "delay": measurement.delay,
            "gain": measurement.gain,
            "reference_angle": measurement.reference_angle and measurement.has_orders,
            "moving_inertia": measurement.moving_inertia,
        }
        return tuple(name for name, wanted in asked.items() if wanted)

    def likely_delay(self, values: FloatArray) -> float:
        """Delay in s, beside that in ``values``, with which the phase of the model runs along that of the test.

        0 where a search from there leads to it, within half a period of the highest line, where none is clear, and for
        orders.
        """
        f, predicted = self.frequencies, self.predicted(values)[0]
        if len(f) < FEWEST_DELAYED_LINES or self.form == "magnitude" or self.line_orders is not None:
            return 0.0
        real, imaginary = np.split(self.deviations, 2)
        cross = predicted.conj() * self.measured / (real**2 + imaginary**2)
        # Sum of cross exp(2 pi j f tau) at all delays tau by a Fourier transform, over lines put on a fine grid.
        width = float(f[-1] - f[0]) / (len(f) - 1) / BINS_PER_LINE
        bins = np.rint(f / width).astype(np.intp)
        size = int(scipy.fft.next_fast_len(DELAYS_PER_PERIOD * int(bins[-1])))
        spread = np.zeros(size, dtype=complex)
        np.add.at(spread, bins, cross)
        along, delays = np.fft.ifft(spread).real, np.fft.fftfreq(size, width)
        near, possible = np.abs(delays) <= 0.5 / f[-1], np.abs(delays) <= 0.5 / (BINS_PER_LINE * width)
        best = int(np.where(possible, along, -np.inf).argmax())
        return float(delays[best]) if along[best] > CLEARLY_MORE * along[near].max() else 0.0

    def _distorted(self, values: FloatArray, f: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Response of the model with delay and gain of the channel, SI, (n_f,), and derivatives (n_f, n)."""
        count = len(self.response.names)
        evaluation = self.response.evaluation(values[:count])
        G, slopes = evaluation.values[:, 0, 0], evaluation.jacobian[:, 0, 0]
        extra = dict(zip(self.extra, values[count:], strict=True))
        # Channel g exp(-j omega tau) exp(j o phi) behind G; the columns are its derivatives by the product rule.
        turn = -2j * np.pi * f
        late = np.exp(turn * extra.get("delay", 0.0))
        if "reference_angle" in extra:
            assert self.line_orders is not None
            late = late * np.exp(1j * self.line_orders * extra["reference_angle"])
        channel = extra.get("gain", 1.0) * late
        columns = [slopes * channel[:, None]]
        if "delay" in extra:
            columns.append((turn * G * channel)[:, None])
        if "gain" in extra:
            columns.append((G * late)[:, None])
        if "reference_angle" in extra:
            assert self.line_orders is not None
            columns.append((1j * self.line_orders * G * channel)[:, None])
        return np.asarray(G * channel), np.concatenate(columns, axis=1)
