"""Weighted residuals of measured orders against the calculated ones, over their intervals.

Reference angles of measured orders from which a fit starts. A test that counts its angle from elsewhere than the model
turns order o by exp(j o psi). The sum of squares over psi has as many minima as the highest order has periods in a
cycle, and an even engine without misfire looks the same every firing interval: minima are looked for with the other
unknowns following each angle by a linear step.

Orders of several measurements of one drivetrain, calculated together once for the same values of the unknowns. A
campaign has many records with few lines each: the work of an evaluation hardly depends on the number of lines.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass, field

import numpy as np

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.identification.orders.order_lines import OrderLines, order_lines
from torsionnet.identification.orders.parametric_orders import ParametricOrders, excited_orders
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.noise import Noise, noise_between_lines
from torsionnet.identification.residuals.response_blocks import STATED_ERROR_CERTAINTY
from torsionnet.identification.residuals.sampled_response import Form
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.sensitivity.parametric import Evaluation
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
        amplitudes, slopes = self.predicted(values)
        noise = self.noise if self.lines.is_known else 0.0
        # Noise sigma in both parts lengthens a phasor A, to first order to sqrt(A^2 + sigma^2).
        size = np.sqrt(np.abs(amplitudes) ** 2 + noise)
        rates = (amplitudes.conj()[:, None] * slopes).real / np.maximum(size, np.finfo(float).tiny)[:, None]
        return (size - np.abs(self.measured)) / self.sizes, rates / self.sizes[:, None]

    @property
    def remark(self) -> str:
        remarks = []
        if self.lines.left_out:
            orders = comma_list([f"{order:g}" for order in self.lines.left_out])
            remarks.append(f"has orders that the model does not excite, which are left out: {orders}")
        if not self.lines.has_phase:
            data = self.measurement.data
            why = "phases without a reference" if isinstance(data, TrackedOrders) else "no phases"
            remarks.append(f"has {why}, so amplitudes are compared")
        if not self.lines.is_known:
            remarks.append("has no intervals: its noise is taken from the scatter over speed")
        return f"{self.measurement.label} {'; '.join(remarks)}" if remarks else ""

    def measured_noise(self, values: FloatArray) -> Noise | None:
        if self.lines.is_known:
            return Noise(self.lines.deviations**2 / self.noise, STATED_ERROR_CERTAINTY)
        residual, _ = self.residuals(values)
        count = len(self.frequencies)
        lines = residual if self.parts == 1 else residual[:count] + 1j * residual[count:]
        related = self.known_correlation[:count, :count]
        by_run = [noise_between_lines(lines[run], related[run, run]) for run in self.runs]
        known = [noise for noise in by_run if noise is not None]
        if len(known) < len(by_run):
            return None
        return Noise(np.concatenate([noise.ratio for noise in known]), sum(noise.certainty for noise in known))

    def take_measured_noise(self, noise: Noise) -> None:
        self.noise = self.noise * noise.ratio

    def take_noise(self, other: MeasurementBlock, left: float) -> None:
        assert isinstance(other, OrderBlock)
        self.noise = other.noise * left

    def with_model(self, rig: AssembledModel, measurement: Measurement, parameters: tuple[str, ...]) -> OrderBlock:
        block = copy(self)
        block.measurement = measurement
        block.response = _response(rig, measurement, self.lines, parameters)
        return block


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
        raise UsageError(f"{measurement.label}: {text}", kind="wrong-unit")
    return OrderBlock(measurement, response, lines, form=form if lines.has_phase else "magnitude")


@contextmanager
def _labelled(measurement: Measurement) -> Iterator[None]:
    """Put the label of a measurement before messages on the model that it is compared with."""
    try:
        yield
    except UsageError as error:
        raise UsageError(f"{measurement.label}: {error}", kind=error.kind) from None


def _response(
    rig: AssembledModel, measurement: Measurement, lines: OrderLines, parameters: tuple[str, ...]
) -> ParametricOrders:
    output = measurement.model_output or measurement.output
    return ParametricOrders.of(rig, output, lines.orders, lines.speeds, parameters, measurement.speed_of)


# Reference angles of measured orders from which a fit starts.

ANGLES_PER_PERIOD = 12
"""Number of angles within a period of the highest order at which a minimum is looked for."""
LONGEST_CYCLE = 4 * np.pi
"""Crank angle in rad of the longest common cycle, of a four-stroke engine, after which a reference comes again."""
MOST_MINIMA = 6
"""Number of minima from which a fit starts, one for each firing interval of an engine with six cylinders."""
LIKELY_EXCESS = 0.5
"""Share of the largest sum of squares, above the smallest, within which a minimum is worth a start."""


def reference_angles(block: OrderBlock, values: FloatArray) -> tuple[float, ...]:
    """Reference angles in rad at which the model is near the test, the nearest first; in (-360, 360] degrees.

    Parameters
    ----------
    block : OrderBlock
        With phases, its reference angle being an unknown.
    values : (n,) array
        Values of the unknowns of the block; the reference angle itself does not matter.
    """
    place = len(block.response.names) + block.extra.index("reference_angle")
    others = np.arange(len(values)) != place
    at = values.copy()
    at[place] = 0.0
    predicted, slopes = block.predicted(at)
    weight = 1 / np.sqrt(block.noise)
    size = np.where(values[others] != 0, np.abs(values[others]), 1.0)
    moving = slopes[:, others] * size * weight[:, None]
    highest = max(float(block.line_orders.max()), 1.0)
    steps = int(np.ceil(ANGLES_PER_PERIOD * highest * LONGEST_CYCLE / (2 * np.pi)))
    angles = (np.arange(steps) - steps // 2) * (LONGEST_CYCLE / steps)
    # Each angle over the longest cycle, with the other unknowns following by a linear step.
    costs = np.array(
        [
            _cost_after_step(turn * predicted * weight - block.measured * weight, turn[:, None] * moving)
            for turn in np.exp(1j * angles[:, None] * block.line_orders)
        ]
    )
    likely = costs <= costs.min() + LIKELY_EXCESS * (costs.max() - costs.min())
    minima = [k for k in np.flatnonzero(likely) if costs[k] <= costs[k - 1] and costs[k] < costs[(k + 1) % steps]]
    # Equal minima, as without half orders: the smallest angle first.
    ranked = sorted(minima, key=lambda k: (round(costs[k] / max(costs.max(), np.finfo(float).tiny), 9), abs(angles[k])))
    return tuple(float(angles[k]) for k in ranked[:MOST_MINIMA])


def _cost_after_step(residual: np.ndarray, moving: np.ndarray) -> float:
    """Sum of squares after a linear step of the other unknowns, each held near its value by its own size."""
    count = moving.shape[1]
    if not count:
        return float(np.sum(np.abs(residual) ** 2))
    # min over x of |residual - moving x|^2 + |x|^2, by the normal equations.
    rows = np.concatenate([moving.real, moving.imag, np.eye(count)])
    left = np.concatenate([residual.real, residual.imag, np.zeros(count)])
    normal, side = rows.T @ rows, rows.T @ left
    return float(left @ left - side @ np.linalg.solve(normal, side))


# Orders of several measurements of one drivetrain, calculated together once for the same values of the unknowns.

MOST_LINES_TOGETHER = 5000
"""Number of lines up to which measurements are calculated together: with 40 causes of a misfit as unknowns, the
derivatives of the receptances of an engine of six cylinders then take some 20 MB for each output."""


@dataclass(frozen=True, eq=False)
class PartOfOrders:
    """Complex amplitudes of one measurement of orders, a part of those calculated together, in SI units."""

    whole: ParametricOrders
    lines: slice

    @property
    def drivetrain(self) -> AssembledModel:
        return self.whole.drivetrain

    @property
    def names(self) -> tuple[str, ...]:
        return self.whole.names

    @property
    def start(self) -> FloatArray:
        """Values (n,) of the unknowns in the model as given, in SI units."""
        return self.whole.start

    @property
    def frequencies(self) -> FloatArray:
        """Frequency in Hz of each measured line, order times speed, shape (n_lines,)."""
        return self.whole.frequencies[self.lines]

    @property
    def unit(self) -> str:
        """SI unit of the amplitudes."""
        return self.whole.units[int(self.whole.output_of[self.lines.start])]

    def evaluation(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Amplitudes (n_lines, 1, 1) and derivatives (n_lines, 1, 1, n), in SI units, at values (n,) of the unknowns.

        Raises
        ------
        SolveError
            They are not finite there.
        """
        evaluation = self.whole.evaluation(values)
        return Evaluation(evaluation.values[self.lines], evaluation.jacobian[self.lines])


def with_shared_orders(blocks: Sequence[MeasurementBlock]) -> list[MeasurementBlock]:
    """Residual blocks, those of orders of the same drivetrain with their orders calculated together."""
    shared = list(blocks)
    groups: dict[tuple[int, str], list[int]] = {}
    for place, block in enumerate(blocks):
        if isinstance(block, OrderBlock) and isinstance(block.response, ParametricOrders):
            groups.setdefault((id(block.response.drivetrain), block.response.speed_of), []).append(place)
    for group in groups.values():
        for together in _in_batches(group, [len(block.frequencies) for block in blocks]):
            whole = _joined([blocks[place].response for place in together])  # type: ignore[misc]
            first = 0
            for place in together if len(together) > 1 else ():
                last = first + len(blocks[place].frequencies)
                shared[place] = copy(blocks[place])
                shared[place].response = PartOfOrders(whole, slice(first, last))
                first = last
    return shared


def _in_batches(places: Sequence[int], counts: Sequence[int]) -> list[list[int]]:
    """Places of blocks that are calculated together, as many as their lines (``counts``) allow."""
    batches: list[list[int]] = []
    lines = 0
    for place in places:
        lines += counts[place]
        if not batches or lines > MOST_LINES_TOGETHER:
            batches.append([])
            lines = counts[place]
        batches[-1].append(place)
    return batches


def _joined(several: Sequence[ParametricOrders]) -> ParametricOrders:
    first = several[0]
    outputs = tuple(dict.fromkeys(output for orders in several for output in orders.outputs))
    output_of = [np.full(len(orders.orders), outputs.index(orders.outputs[0]), dtype=np.intp) for orders in several]
    return ParametricOrders(
        first.drivetrain,
        first.names,
        outputs,
        np.concatenate([orders.orders for orders in several]),
        np.concatenate([orders.speeds for orders in several]),
        np.concatenate(output_of),
        first.speed_of,
    )
