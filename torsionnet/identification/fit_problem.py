"""Least-squares problem of a fit, residuals and derivatives of all measurements over one vector of unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.identification.orders.order_block import OrderBlock, reference_angles, with_shared_orders
from torsionnet.identification.orders.order_lines import parts_by_phase
from torsionnet.identification.orders.parametric_orders import numbers_of_excitations
from torsionnet.identification.plan.fit_entries import Unknown, parameter_quantity
from torsionnet.identification.residuals.equation_block import EquationBlock
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.measurement_blocks import make_block
from torsionnet.identification.residuals.noise import sensor_noise_powers, weighted_mean
from torsionnet.identification.residuals.response_blocks import RecordBlock, ResponseBlock
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray

CHANNEL_UNKNOWNS = {
    "delay": (0.0, (-np.inf, np.inf), "s"), "gain": (1.0, (-np.inf, np.inf), ""),
    "reference_angle": (0.0, (-np.inf, np.inf), "rad"), "moving_inertia": (0.0, (-np.inf, np.inf), "kg*m^2"),
}  # fmt: skip
LEAST_FREE_SHARE = 1e-3
"""Share of a residual's variance that the fit leaves it at least, so that a line that decides alone says no noise."""
FIRST_MISFIRE_SHARE = 0.1
"""Share of misfire at which a search begins where the model has none: at 0 the half orders of an even engine vanish,
and with them the derivatives of their amplitudes."""
GAIN_BOUNDS_OF_MAGNITUDES = (0.0, np.inf)
"""Lower and upper bound of a channel's gain where only magnitudes are compared, which do not show whether it is
reversed."""


@dataclass(eq=False)
class FitProblem:
    """Least-squares problem of a fit with residuals of all measurements as functions of one vector of unknowns.

    Attributes
    ----------
    names : tuple of str
        Entries of the vector: ``c_O``, ``c_O[V]`` where it is free per configuration, ``delay[V]``.
    start, lower, upper : (n,) array
        Start values and bounds, SI.
    priors : mapping of index to (mean, standard deviation)
    unknown_indices : tuple of int arrays
        For each block the indices of its unknowns in the vector.
    """

    names: tuple[str, ...]
    start: FloatArray
    lower: FloatArray
    upper: FloatArray
    priors: Mapping[int, tuple[float, float]]
    blocks: tuple[MeasurementBlock, ...]
    unknown_indices: tuple[NDArray[np.intp], ...]
    unknowns: Mapping[str, Unknown] = field(default_factory=dict)

    def residuals(self, values: FloatArray) -> FloatArray:
        """Weighted residuals of all measurements and priors at ``values`` of the unknowns, (n_residuals,)."""
        return self.residuals_and_jacobian(values)[0]

    def jacobian(self, values: FloatArray) -> FloatArray:
        """Derivatives of all weighted residuals with respect to the unknowns at ``values``, (n_residuals, n)."""
        return self.residuals_and_jacobian(values)[1]

    def residuals_and_jacobian(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted residuals (n_residuals,) of the fit and their derivatives by the unknowns (n_residuals, n)."""
        key = values.tobytes()
        if self._known is not None and self._known[0] == key:
            return self._known[1]
        parts, slopes = [], []
        for block, place in zip(self.blocks, self.unknown_indices, strict=True):
            residual, jacobian = block.residuals(values[place])
            whole = np.zeros((len(residual), len(values)))
            np.add.at(whole.T, place, jacobian.T)
            parts.append(residual)
            slopes.append(whole)
        # A prior is one more measurement, of the value itself.
        for index, (mean, deviation) in self.priors.items():
            parts.append(np.array([(values[index] - mean) / deviation]))
            slopes.append(np.eye(len(values))[index : index + 1] / deviation)
        both = np.concatenate(parts), np.concatenate(slopes)
        self._known = (key, both)
        return both

    _known: tuple[bytes, tuple[FloatArray, FloatArray]] | None = field(default=None, init=False, repr=False)

    def learn_noise(self, values: FloatArray) -> None:
        """Weigh records, and responses of unknown noise, by the noise in what the model leaves unexplained of them.

        Equations of motion take that of their sensors at the values.
        """
        for block, place in zip(self.blocks, self.unknown_indices, strict=True):
            if isinstance(block, EquationBlock) or (isinstance(block, ResponseBlock) and block.noise_is_unknown):
                block.learn_noise(values[place])
        records = [
            (block, values[place])
            for block, place in zip(self.blocks, self.unknown_indices, strict=True)
            if isinstance(block, RecordBlock)
        ]
        for block, mine in records:
            block.choose_start(mine)
        for sensors in dict.fromkeys(block.sensors for block, _ in records):
            # Sensors have one noise in all of their records; then what pauses of the input show is taken in.
            alike = [(block, mine) for block, mine in records if block.sensors == sensors]
            unexplained = zip(*(block.unexplained(mine) for block, mine in alike), strict=True)
            level, gain, steps = (np.concatenate(parts) for parts in unexplained)
            repeated = sum(block.squared_correlations for block, _ in alike) / sum(block.count for block, _ in alike)
            sources = sensor_noise_powers(level, gain, steps, repeated)
            seen = weighted_mean(block.input_noise(mine, sources[0]) for block, mine in alike)
            if seen:
                sources = sensor_noise_powers(level, gain, steps, repeated, seen)
            for block, mine in alike:
                block.take_sources(mine, *sources)
        self.clear_cache()

    def forget_noise(self) -> None:
        """Weigh responses of unknown noise by their measured magnitudes, as before anything was learnt."""
        for block in self.blocks:
            if isinstance(block, ResponseBlock) and block.noise_is_unknown:
                block.forget_noise()
        self.clear_cache()

    def learn_from_residuals(self, values: FloatArray, trust: FloatArray) -> None:
        """Weigh responses that say nothing of their noise by what a model that fits leaves of them.

        A residual has the variance of its noise times 1 - h, with its leverage h on the fit; ``trust`` are the weights
        (n_residuals,) of a robust loss.
        """
        residuals, slopes = self.residuals_and_jacobian(values)
        basis, _ = np.linalg.qr(slopes / np.maximum(np.linalg.norm(slopes, axis=0), np.finfo(float).tiny))
        # A residual has the variance sigma^2 (1 - h) with the leverage h, the diagonal of Q Q^T.
        variances = (trust * residuals) ** 2 / np.maximum(1 - np.sum(basis**2, axis=1), LEAST_FREE_SHARE)
        for block, span, place in zip(self.blocks, self.residual_slices, self.unknown_indices, strict=True):
            if isinstance(block, ResponseBlock) and block.noise_is_unknown:
                each = (variances[span] * block.absolute_scale**2).reshape(block.parts, -1)
                block.learn_noise(values[place], each.mean(axis=0))
        self.clear_cache()

    def take_measured_noise(self, values: FloatArray) -> None:
        """Weigh all measurements by their noise as measured, which does not depend on the misfit of the model."""
        for block, place in zip(self.blocks, self.unknown_indices, strict=True):
            noise = block.measured_noise(values[place])
            if noise is not None:
                block.take_measured_noise(noise)
        self.clear_cache()

    def start_with_reversed_channels(self, start: FloatArray) -> FloatArray:
        """Start values (n,), the gain of a channel negated where the model is then nearer to the test."""
        turned = start.copy()
        for block, place in zip(self.blocks, self.unknown_indices, strict=True):
            if "gain" in block.extra and block.form != "magnitude":
                predicted, (real, imaginary) = block.predicted(start[place])[0], np.split(block.deviations, 2)
                # Re sum conj(G) H, below 0 if the test is rather minus the model.
                if np.sum((predicted.conj() * block.measured).real / (real**2 + imaginary**2)) < 0:
                    turned[place[len(block.response.names) + block.extra.index("gain")]] *= -1
        return turned

    def start_with_long_delays(self, start: FloatArray) -> FloatArray:
        """Start values (n,), with the delays of channels that no search from there would reach."""
        delayed = start.copy()
        for block, place in zip(self.blocks, self.unknown_indices, strict=True):
            if "delay" in block.extra:
                at = place[len(block.response.names) + block.extra.index("delay")]
                delayed[at] += block.likely_delay(start[place])
        return delayed

    def starts_with_other_references(self, start: FloatArray) -> list[FloatArray]:
        """Start values, each (n,), with other likely angles of the references of measured orders; often none.

        All measurements begin at the angles nearest to one of those of the first: they were often made together.
        """
        turned = [
            (place[len(block.response.names) + block.extra.index("reference_angle")], block, place)
            for block, place in zip(self.blocks, self.unknown_indices, strict=True)
            if isinstance(block, OrderBlock) and "reference_angle" in block.extra
        ]
        likely = [(index, reference_angles(block, start[place])) for index, block, place in turned]
        starts = []
        for angle in likely[0][1] if likely else ():
            other = start.copy()
            for index, angles in likely:
                other[index] = min(
                    angles, key=lambda near: abs(np.exp(0.5j * near) - np.exp(0.5j * angle)), default=angle
                )
            if not np.array_equal(other, start):
                starts.append(other)
        return starts

    @property
    def has_records(self) -> bool:
        """Whether any measurement is a record of signals (or a response with its record)."""
        return any(isinstance(block, RecordBlock | EquationBlock) for block in self.blocks)

    @property
    def has_equations(self) -> bool:
        """Whether equations of motion lead a search to its start, as for laws of motion at several amplitudes."""
        return any(block.has_equations for block in self.blocks)

    @property
    def has_unknown_noise(self) -> bool:
        """Whether any measurement is a response that says nothing of its noise."""
        return any(isinstance(block, ResponseBlock) and block.noise_is_unknown for block in self.blocks)

    @property
    def noise_is_measured(self) -> bool:
        """Whether the noise level of all measurements is known from windows, not only its distribution over lines."""
        return all(isinstance(block, RecordBlock) and any(block.sources) for block in self.blocks)

    def clear_cache(self) -> None:
        """Forget the residuals calculated last, as the noise that weights a measurement has changed."""
        self._known = None

    def noise_covariance(self, backward: FloatArray) -> FloatArray:
        """Covariance (n, n), due to noise, of the sums ``backward`` (n, n_residuals) @ residuals."""
        total, start = np.zeros((len(backward), len(backward))), 0
        for block in self.blocks:
            total += block.noise_covariance(backward[:, start : start + block.count])
            start += block.count
        return total + backward[:, start:] @ backward[:, start:].T

    def shared_covariance(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        """Covariance (n, n), due to errors that all lines share, of ``backward`` (n, n_residuals) @ residuals."""
        total = np.zeros((len(backward), len(backward)))
        for block, span, place in zip(self.blocks, self.residual_slices, self.unknown_indices, strict=True):
            total += block.shared_covariance(backward[:, span], values[place])
        return total

    def step_shifts(self, backward: FloatArray) -> list[FloatArray]:
        """Errors (n, n_positions), by the steps of each record's sensor, of the sums ``backward`` @ residuals."""
        return [
            block.step_shifts(backward[:, span])
            for block, span in zip(self.blocks, self.residual_slices, strict=True)
            if isinstance(block, RecordBlock) and block.sensor.size
        ]

    @property
    def residual_slices(self) -> tuple[slice, ...]:
        """Slice of each measurement in the vector of weighted residuals."""
        ends = np.cumsum([0, *(block.count for block in self.blocks)]).tolist()
        return tuple(slice(begin, end) for begin, end in pairwise(ends))

    @property
    def effective_count(self) -> float:
        """Number of independent values that the correlated residuals of all measurements are worth."""
        count = sum(block.count for block in self.blocks) + len(self.priors)
        return float(count**2 / (sum(block.squared_correlations for block in self.blocks) + len(self.priors)))

    @property
    def lines(self) -> int:
        """Number of frequency lines of all measurements together."""
        return sum(len(block.frequencies) for block in self.blocks)


def make_problem(
    model: AssembledModel, measurements: Sequence[Measurement], unknowns: Mapping[str, Unknown], form: str
) -> FitProblem:
    """Least-squares problem for the unknowns of a model and the measurements they are fitted to.

    Raises
    ------
    UsageError
        Measurements of one name, or names that the model or the data lack.
    """
    labels = [measurement.label for measurement in measurements]
    if len(set(labels)) != len(labels):
        twice = sorted({label for label in labels if labels.count(label) > 1})
        raise UsageError(f"several measurements are called {', '.join(twice)}; give them names", kind="repeated-name")
    parts = [part for measurement in measurements for part in parts_by_phase(measurement)]
    named = {part.configuration for part in parts}
    rigs = {name: model.configured(name) if name else model for name in named}
    blocks = [make_block(rigs[part.configuration], part, tuple(unknowns), form) for part in parts]
    if idle := [name for name in unknowns if all(name not in block.response.names for block in blocks)]:
        does = "does" if len(idle) == 1 else "do"
        raise UsageError(
            f"{', '.join(idle)} {does} not act on responses; add a measurement of orders, or leave it out",
            kind="unseen-parameter",
        )
    _refuse_unseen_phases(model, blocks, unknowns)
    return lay_out_problem(model, blocks, unknowns)


def _refuse_unseen_phases(
    model: AssembledModel, blocks: Sequence[MeasurementBlock], unknowns: Mapping[str, Unknown]
) -> None:
    """Raise UsageError for phases of excitations to be found where no measurement of orders has phases."""
    phases = [number.name for number in numbers_of_excitations(model, tuple(unknowns)).values() if number.is_phase]
    blind = [block.measurement.label for block in blocks if block.line_orders is not None and not block.has_phase]
    seeing = any(block.line_orders is not None and block.has_phase for block in blocks)
    if phases and blind and not seeing:
        text = f"{', '.join(phases)} cannot be found: {', '.join(blind)} has no phases against a reference"
        raise UsageError(f"{text}; track the orders against a pulse, or fix the phase", kind="missing-data")


def lay_out_problem(
    model: AssembledModel,
    blocks: Sequence[MeasurementBlock],
    unknowns: Mapping[str, Unknown],
    known: Mapping[str, float] | None = None,
) -> FitProblem:
    """Least-squares problem of residual blocks and unknowns; ``known`` replaces start values by name of the entry."""
    entries: dict[str, tuple[float, tuple[float, float]]] = {}
    priors: dict[str, tuple[float, float]] = {}
    entries_of_blocks: list[list[str]] = []
    if not any(unknown.per_configuration for unknown in unknowns.values()):
        blocks = with_shared_orders(blocks)
    for block in blocks:
        mine = []
        for number, name in enumerate(block.response.names):
            unknown = unknowns[name]
            entry = f"{name}[{block.measurement.label}]" if unknown.per_configuration else name
            mine.append(entry)
            begin = float(block.response.start[number])
            entries.setdefault(entry, _begin(model, name, unknown, begin))
            if unknown.prior:
                priors[entry] = unknown.prior
        for extra in block.extra:
            entry = f"{extra}[{block.measurement.label}]"
            mine.append(entry)
            begin, span, _ = CHANNEL_UNKNOWNS[extra]
            entries[entry] = begin, GAIN_BOUNDS_OF_MAGNITUDES if extra == "gain" and block.form == "magnitude" else span
        entries_of_blocks.append(mine)
    entries |= {entry: (value, entries[entry][1]) for entry, value in (known or {}).items() if entry in entries}
    for block, mine in zip(blocks, entries_of_blocks, strict=True):
        entry = f"reference_angle[{block.measurement.label}]"
        if isinstance(block, OrderBlock) and entry in mine and entry not in (known or {}):
            nearest = reference_angles(block, np.array([entries[name][0] for name in mine]))
            entries[entry] = nearest[0] if nearest else 0.0, entries[entry][1]
    order = {entry: index for index, entry in enumerate(entries)}
    limits = np.array([bounds for _, bounds in entries.values()]).reshape(-1, 2)
    return FitProblem(
        names=tuple(entries),
        start=np.array([start for start, _ in entries.values()]),
        lower=limits[:, 0],
        upper=limits[:, 1],
        priors={order[entry]: prior for entry, prior in priors.items()},
        blocks=tuple(blocks),
        unknown_indices=tuple(np.array([order[entry] for entry in mine], dtype=np.intp) for mine in entries_of_blocks),
        unknowns=dict(unknowns),
    )


def _begin(model: AssembledModel, name: str, unknown: Unknown, value: float) -> tuple[float, tuple[float, float]]:
    start = value if unknown.start is None else unknown.start
    number = numbers_of_excitations(model, [name]).get(name)
    if number and unknown.start is None and value == 0 and number.path[0] == "misfire_share":
        start = FIRST_MISFIRE_SHARE
    stated = model.parameter_definitions[name].bounds if name in model.parameter_definitions else None
    bounds = unknown.bounds or stated or (number.bounds if number else physical_bounds(model, name, start))
    if not bounds[0] <= start <= bounds[1]:
        raise UsageError(
            f"{name} begins at {start:g}, outside its bounds {bounds[0]:g} to {bounds[1]:g}; change start or bounds",
            kind="out-of-range",
        )
    return start, bounds


def physical_bounds(model: AssembledModel, name: str, start: float) -> tuple[float, float]:
    """Lower and upper physical bound of a parameter in SI; without any, a value that starts above 0 stays positive."""
    lower, upper = parameter_quantity(model, name).bounds
    return (lower, upper) if np.isfinite(lower) or start <= 0 else (0.0, upper)
