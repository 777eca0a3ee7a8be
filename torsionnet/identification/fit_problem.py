"""All measurements of a fit as one least-squares problem in one vector."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.identification.natures import nature
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.measurement_blocks import make_block
from torsionnet.identification.residuals.record_block import RecordBlock
from torsionnet.identification.sources import together, two_sources
from torsionnet.identification.unknown import Unknown

EXTRAS = {"delay": (0.0, (-np.inf, np.inf), "s"), "gain": (1.0, (-np.inf, np.inf), "")}
POSITIVE = (0.0, np.inf)
"""Of a gain that magnitudes tell: whether a channel is reversed they do not."""


@dataclass(eq=False)
class FitProblem:
    """Blocks, and which entries of the vector each of them sees.

    Attributes
    ----------
    names : tuple of str
        Entries of the vector: ``c_O``, ``c_O[V]`` where it is free per configuration, ``delay[V]``.
    start, lower, upper : (n,) array
    priors : mapping of index to (mean, standard deviation)
    """

    names: tuple[str, ...]
    start: FloatArray
    lower: FloatArray
    upper: FloatArray
    priors: Mapping[int, tuple[float, float]]
    blocks: tuple[MeasurementBlock, ...]
    places: tuple[NDArray[np.intp], ...]
    unknowns: Mapping[str, Unknown] = field(default_factory=dict)

    def residuals(self, values: FloatArray) -> FloatArray:
        return self.both(values)[0]

    def jacobian(self, values: FloatArray) -> FloatArray:
        return self.both(values)[1]

    def both(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted residuals of all measurements and priors, and their derivatives; the last ones are kept."""
        key = values.tobytes()
        if self._known is not None and self._known[0] == key:
            return self._known[1]
        parts, slopes = [], []
        for block, place in zip(self.blocks, self.places, strict=True):
            residual, jacobian = block.residuals(values[place])
            whole = np.zeros((len(residual), len(values)))
            np.add.at(whole.T, place, jacobian.T)
            parts.append(residual)
            slopes.append(whole)
        for index, (mean, deviation) in self.priors.items():
            parts.append(np.array([(values[index] - mean) / deviation]))
            slopes.append(np.eye(len(values))[index : index + 1] / deviation)
        found = np.concatenate(parts), np.concatenate(slopes)
        self._known = (key, found)
        return found

    _known: tuple[bytes, tuple[FloatArray, FloatArray]] | None = field(default=None, init=False, repr=False)

    def learn_noise(self, values: FloatArray) -> None:
        """Let records take as noise what the model leaves unexplained; the same sensors have the same in all tests."""
        records = [
            (block, values[place])
            for block, place in zip(self.blocks, self.places, strict=True)
            if isinstance(block, RecordBlock)
        ]
        for sensors in dict.fromkeys(block.sensors for block, _ in records):
            alike = [(block, mine) for block, mine in records if block.sensors == sensors]
            found = zip(*(block.unexplained(mine) for block, mine in alike), strict=True)
            level, gain, steps = (np.concatenate(parts) for parts in found)
            repeated = sum(block.squares for block, _ in alike) / sum(block.count for block, _ in alike)
            sources = two_sources(level, gain, steps, repeated)
            seen = together(block.input_noise(mine, sources[0]) for block, mine in alike)
            if seen:
                sources = two_sources(level, gain, steps, repeated, seen)
            for block, mine in alike:
                block.take_sources(mine, *sources)
        self.forget()

    def take_measured_noise(self, values: FloatArray) -> None:
        """Let measurements take the noise there is, whatever the model leaves."""
        for block, place in zip(self.blocks, self.places, strict=True):
            noise = block.measured_noise(values[place])
            if noise is not None:
                block.take_measured_noise(noise)
        self.forget()

    def reversed_where_nearer(self, start: FloatArray) -> FloatArray:
        """The start (n,), with a negative gain where that brings the model nearer to the test: a reversed channel."""
        found = start.copy()
        for block, place in zip(self.blocks, self.places, strict=True):
            if "gain" in block.extra and block.form != "magnitude":
                predicted, (real, imaginary) = block.predicted(start[place])[0], np.split(block.deviations, 2)
                if np.sum((predicted.conj() * block.measured).real / (real**2 + imaginary**2)) < 0:
                    found[place[-1]] *= -1
        return found

    @property
    def has_records(self) -> bool:
        return any(isinstance(block, RecordBlock) for block in self.blocks)

    @property
    def noise_is_measured(self) -> bool:
        """Whether the size of all noise is known from windows, and not only how it is shared out over the lines."""
        return all(isinstance(block, RecordBlock) and any(block.sources) for block in self.blocks)

    def forget(self) -> None:
        """After the noise of a block has changed."""
        self._known = None

    def under_noise(self, backward: FloatArray) -> FloatArray:
        """Covariance of backward (n, n_residuals) @ residuals; measurements and priors are independent."""
        total, start = np.zeros((len(backward), len(backward))), 0
        for block in self.blocks:
            total += block.under_noise(backward[:, start : start + block.count])
            start += block.count
        return total + backward[:, start:] @ backward[:, start:].T

    def under_shared(self, backward: FloatArray, values: FloatArray) -> FloatArray:
        """Covariance of backward (n, n_residuals) @ residuals by errors that lines share, as of a sensor's steps."""
        total = np.zeros((len(backward), len(backward)))
        for block, span, place in zip(self.blocks, self.spans, self.places, strict=True):
            total += block.under_shared(backward[:, span], values[place])
        return total

    def under_steps(self, backward: FloatArray) -> list[FloatArray]:
        """By how much the steps of the sensor of each record move backward @ residuals, (n, places)."""
        return [
            block.under_steps(backward[:, span])
            for block, span in zip(self.blocks, self.spans, strict=True)
            if isinstance(block, RecordBlock) and block.sensor.size
        ]

    @property
    def spans(self) -> tuple[slice, ...]:
        """Where the residuals of every block stand."""
        ends = np.cumsum([0, *(block.count for block in self.blocks)]).tolist()
        return tuple(slice(begin, end) for begin, end in pairwise(ends))

    @property
    def effective_count(self) -> float:
        """Number of independent values that the correlated residuals are worth."""
        count = sum(block.count for block in self.blocks) + len(self.priors)
        return float(count**2 / (sum(block.squares for block in self.blocks) + len(self.priors)))

    @property
    def lines(self) -> int:
        return sum(len(block.frequencies) for block in self.blocks)


def make_problem(
    model: AssembledModel, measurements: Sequence[Measurement], unknowns: Mapping[str, Unknown], form: str
) -> FitProblem:
    """Lay out the vector.

    Raises
    ------
    UsageError
        Anything the measurements or parameters name that is not there.
    """
    labels = [measurement.label for measurement in measurements]
    if len(set(labels)) != len(labels):
        twice = sorted({label for label in labels if labels.count(label) > 1})
        raise UsageError(f"several measurements are called {', '.join(twice)}; give them names")
    return laid_out(model, [make_block(model, one, tuple(unknowns), form) for one in measurements], unknowns)


def laid_out(
    model: AssembledModel,
    blocks: Sequence[MeasurementBlock],
    unknowns: Mapping[str, Unknown],
    known: Mapping[str, float] | None = None,
) -> FitProblem:
    """One vector for blocks and unknowns, beginning at values that are ``known`` by the names of its entries."""
    entries: dict[str, tuple[float, tuple[float, float]]] = {}
    priors: dict[str, tuple[float, float]] = {}
    places: list[list[str]] = []
    for block in blocks:
        mine = []
        for number, (name, unknown) in enumerate(unknowns.items()):
            entry = f"{name}[{block.measurement.label}]" if unknown.per_configuration else name
            mine.append(entry)
            begin = float(block.response.start[number])
            entries.setdefault(entry, _begin(model, name, unknown, begin))
            if unknown.prior:
                priors[entry] = unknown.prior
        for extra in block.extra:
            entry = f"{extra}[{block.measurement.label}]"
            mine.append(entry)
            begin, span, _ = EXTRAS[extra]
            entries[entry] = begin, POSITIVE if extra == "gain" and block.form == "magnitude" else span
        places.append(mine)
    entries |= {entry: (value, entries[entry][1]) for entry, value in (known or {}).items() if entry in entries}
    order = {entry: index for index, entry in enumerate(entries)}
    limits = np.array([bounds for _, bounds in entries.values()]).reshape(-1, 2)
    return FitProblem(
        names=tuple(entries),
        start=np.array([start for start, _ in entries.values()]),
        lower=limits[:, 0],
        upper=limits[:, 1],
        priors={order[entry]: prior for entry, prior in priors.items()},
        blocks=tuple(blocks),
        places=tuple(np.array([order[entry] for entry in mine], dtype=np.intp) for mine in places),
        unknowns=dict(unknowns),
    )


def _begin(model: AssembledModel, name: str, unknown: Unknown, value: float) -> tuple[float, tuple[float, float]]:
    start = value if unknown.start is None else unknown.start
    stated = model.parameter_definitions[name].bounds if name in model.parameter_definitions else None
    bounds = unknown.bounds or stated or natural_bounds(model, name, start)
    if not bounds[0] <= start <= bounds[1]:
        raise UsageError(f"{name} begins at {start:g}, outside its bounds {bounds[0]:g} to {bounds[1]:g}")
    return start, bounds


def natural_bounds(model: AssembledModel, name: str, start: float) -> tuple[float, float]:
    """What a value can be by nature; where that says nothing, one that begins above 0 stays there."""
    lower, upper = nature(model, name).bounds
    return (lower, upper) if np.isfinite(lower) or start <= 0 else (0.0, upper)
