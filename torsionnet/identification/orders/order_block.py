"""Weighted residuals of measured orders against the calculated ones, over their intervals."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass, field

import numpy as np

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.identification.orders.order_lines import OrderLines, order_lines
from torsionnet.identification.orders.parametric_orders import (
    ParametricOrders,
    excited_orders,
)
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.noise import Noise, noise_between_lines
from torsionnet.identification.residuals.residual_forms import Form
from torsionnet.identification.residuals.response_block import STATED_ERROR_CERTAINTY
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.signals.orders.tracked_orders import TrackedOrders


@dataclass(eq=False)
class OrderBlock(MeasurementBlock):
    """Weighted residuals of complex orders, or of their amplitudes where the test has no phases."""

    lines: OrderLines
    noise: FloatArray = field(init=False)
    """Variance of real and of imaginary part of each line, SI, (n_lines,)."""

    def __post_init__(self) -> None:
        self.noise = self.lines.deviations**2

    @property
    def frequencies(self) -> FloatArray:
        return self.response.frequencies

    @property
    def measured(self) -> ComplexArray:
        return self.lines.values

    @property
    def has_phase(self) -> bool:
        return self.lines.has_phase

    @property
    def noise_is_stated(self) -> bool:
        return self.lines.is_known

    @property
    def noise_is_unknown(self) -> bool:
        return not self.lines.is_known

    @property
    def unit(self) -> str:
        return self.response.unit

    @property
    def runs(self) -> tuple[slice, ...]:
        return self.lines.runs

    @property
    def line_orders(self) -> FloatArray:
        return self.lines.orders

    @property
    def line_speeds(self) -> FloatArray:
        return self.lines.speeds

    @property
    def description(self) -> str:
        many = len(self.lines.runs)
        return f"{len(self.frequencies)} lines of {many} order{'s' * (many > 1)}"

    def noise_covariance(self, backward: FloatArray) -> FloatArray:
        lines = self.lines.correlation
        if lines is None:
            return super().noise_covariance(backward)
        return np.asarray(sum(part @ (lines @ part.T) for part in np.split(backward, self.parts, axis=1)))

    @property
    def squared_correlations(self) -> float:
        lines = self.lines.correlation
        return self.count if lines is None else self.parts * float((lines**2).sum())

    @property
    def known_correlation(self) -> FloatArray:
        lines = self.lines.correlation
        return super().known_correlation if lines is None else np.kron(np.eye(self.parts), lines.toarray())

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        return self._distorted(values, self.frequencies)

    @property
    def deviations(self) -> FloatArray:
        return np.tile(np.sqrt(self.noise), 2)

    @property
    def sizes(self) -> FloatArray:
        size = np.sqrt(self.noise) / (np.abs(self.measured) if self.form == "log" else 1.0)
        return np.tile(size, self.parts)

    @property
    def absolute_scale(self) -> FloatArray:
        return self.sizes * (np.tile(np.abs(self.measured), self.parts) if self.form == "log" else 1.0)

    def residuals(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted residuals, model minus test (count,), and their derivatives (count, n).

        Without phases amplitudes are compared. Noise of the deviation sigma in real and imaginary part makes the mean
        of a measured amplitude sqrt(A^2 + sigma^2), as long as sigma is not above A (S. O. Rice, Mathematical Analysis
        of Random Noise, section 3.10).
        """
        if self.form != "magnitude":
            return super().residuals(values)
        found, slopes = self.predicted(values)
        noise = self.noise if self.lines.is_known else 0.0
        size = np.sqrt(np.abs(found) ** 2 + noise)
        rates = (found.conj()[:, None] * slopes).real / np.maximum(size, np.finfo(float).tiny)[:, None]
        return (size - np.abs(self.measured)) / self.sizes, rates / self.sizes[:, None]

    @property
    def remark(self) -> str:
        found = []
        if self.lines.left_out:
            orders = comma_list([f"{one:g}" for one in self.lines.left_out])
            found.append(f"has orders that the model does not excite, which are left out: {orders}")
        if not self.lines.has_phase:
            data = self.measurement.data
            why = "phases without a reference" if isinstance(data, TrackedOrders) else "no phases"
            found.append(f"has {why}, so amplitudes are compared")
        if not self.lines.is_known:
            found.append("has no intervals: its noise is taken from the scatter over speed")
        return f"{self.measurement.label} {'; '.join(found)}" if found else ""

    def measured_noise(self, values: FloatArray) -> Noise | None:
        if self.lines.is_known:
            return Noise(self.lines.deviations**2 / self.noise, STATED_ERROR_CERTAINTY)
        residual, _ = self.residuals(values)
        count = len(self.frequencies)
        lines = residual if self.parts == 1 else residual[:count] + 1j * residual[count:]
        related = self.known_correlation[:count, :count]
        found = [noise_between_lines(lines[run], related[run, run]) for run in self.runs]
        known = [one for one in found if one is not None]
        if len(known) < len(found):
            return None
        return Noise(np.concatenate([one.ratio for one in known]), sum(one.certainty for one in known))

    def take_measured_noise(self, noise: Noise) -> None:
        self.noise = self.noise * noise.ratio

    def take_noise(self, other: MeasurementBlock, left: float) -> None:
        assert isinstance(other, OrderBlock)
        self.noise = other.noise * left

    def with_model(self, rig: AssembledModel, measurement: Measurement, parameters: tuple[str, ...]) -> OrderBlock:
        found = copy(self)
        found.measurement = measurement
        found.response = _response(rig, measurement, self.lines, parameters)
        return found


def order_block(rig: AssembledModel, measurement: Measurement, parameters: tuple[str, ...], form: Form) -> OrderBlock:
    """Weighted residuals between a model and measured orders, ready for a fit.

    Raises
    ------
    UsageError
        Orders or speeds that the model or the test lacks, unlike units, or a phase to be found from amplitudes.
    """
    with _labelled(measurement):
        excited = excited_orders(rig, measurement.speed_of)
    lines = order_lines(measurement, excited)
    with _labelled(measurement):
        response = _response(rig, measurement, lines, parameters)
        unit = response.unit
    data = measurement.data
    if isinstance(data, TrackedOrders) and data.unit and data.unit != unit:
        text = f"{measurement.output} is in {data.unit} in the data, in {unit} in the model"
        raise UsageError(f"{measurement.label}: {text}")
    return OrderBlock(measurement, response, lines, form=form if lines.has_phase else "magnitude")


@contextmanager
def _labelled(measurement: Measurement) -> Iterator[None]:
    """Put the label of a measurement before messages on the model that it is compared with."""
    try:
        yield
    except UsageError as error:
        raise UsageError(f"{measurement.label}: {error}") from None


def _response(
    rig: AssembledModel, measurement: Measurement, lines: OrderLines, parameters: tuple[str, ...]
) -> ParametricOrders:
    output = measurement.model_output or measurement.output
    return ParametricOrders.of(rig, output, lines.orders, lines.speeds, parameters, measurement.speed_of)
