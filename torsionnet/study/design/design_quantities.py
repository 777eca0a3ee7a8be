"""Quantities of designs in all configurations of a study, together and singly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.core.errors import SolveError
from torsionnet.solve.sensitivity.mode_sensitivities import ModeSensitivities, mode_sensitivities
from torsionnet.solve.sensitivity.parametric import ParametricResponse, parametric_response
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.natural_frequency import UNDAMPED, DampingRatio, ModeQuantity, NaturalFrequency
from torsionnet.study.quantities.quantity import StudyQuantity
from torsionnet.study.quantities.response import ResponseQuantity
from torsionnet.study.quantities.variant_block import VariantBlock

SAME = 1e-6
"""Relative distance of a pole found together with others and the one with derivatives."""
DECIBEL = 20 / np.log(10)


@dataclass(frozen=True, eq=False)
class ExactSlopes:
    """Derivatives of those quantities of an evaluator that have exact ones; ``Slopes`` of a design problem."""

    evaluator: Evaluator
    wanted: tuple[str, ...]
    """Quantities that derivatives are asked of."""

    def __call__(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """Quantity -> derivatives (n_points, n_p), SI."""
        numbers = self.evaluator.once(f"slopes of {self.wanted}", values, lambda: self._whole(values).ravel())
        parts = np.split(numbers.reshape(-1, len(self.evaluator.names)), np.cumsum(self._sizes)[:-1])
        return {name: slopes for name, slopes in zip(self.wanted, parts, strict=True) if np.isfinite(slopes).all()}

    def _whole(self, values: Mapping[str, float]) -> FloatArray:
        """Those of all quantities (n_points of all, n_p), nan where there are none."""
        found = self._found(values)
        nothing = [np.full((size, len(self.evaluator.names)), np.nan) for size in self._sizes]
        return np.concatenate([found.get(name, nan) for name, nan in zip(self.wanted, nothing, strict=True)])

    @cached_property
    def _sizes(self) -> list[int]:
        """Points of every quantity."""
        forms = [one.measured(self.evaluator.model, self.evaluator.quantities) for one in self._asked.values()]
        return [len(one.points) for one in forms]

    def _found(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        found = {name: self._of_response(one, values) for name, one in self._responses.items()}
        modal = self._modal
        if modal:
            moved = mode_sensitivities(self.evaluator.model.configured(**values), list(self.evaluator.names))
            block = self.evaluator.block({name: np.array([value]) for name, value in values.items()})
            found |= {name: _of_mode(one, complex(one.eigenvalue(block)[0]), moved) for name, one in modal.items()}
        return {name: slopes for name, slopes in found.items() if np.isfinite(slopes).all()}

    @property
    def _asked(self) -> dict[str, StudyQuantity]:
        return {name: self.evaluator.quantities[name] for name in self.wanted}

    @cached_property
    def _modal(self) -> dict[str, ModeQuantity]:
        """Natural frequencies with damping and damping ratios."""
        return {
            name: one
            for name, one in self._asked.items()
            if isinstance(one, DampingRatio) or (isinstance(one, NaturalFrequency) and one.which != UNDAMPED)
        }

    @cached_property
    def _responses(self) -> dict[str, tuple[ResponseQuantity, ParametricResponse]]:
        """Transfer functions above 0 Hz."""
        return {
            name: (
                one,
                parametric_response(
                    self.evaluator.model,
                    one.output,
                    one.input,
                    one.frequencies,
                    list(self.evaluator.names),
                    excitation=one.excitation,
                ),
            )
            for name, one in self._asked.items()
            if isinstance(one, ResponseQuantity) and (one.frequencies > 0).all()
        }

    def _of_response(self, one: tuple[ResponseQuantity, ParametricResponse], values: Mapping[str, float]) -> FloatArray:
        quantity, response = one
        try:
            found = response.at([values[name] for name in self.evaluator.names])
        except SolveError:
            return np.array([[np.nan]])
        return _part(quantity.part, found.values[:, 0, 0], found.jacobian[:, 0, 0])


def _part(part: str, y: ComplexArray, dy: ComplexArray) -> FloatArray:
    """Derivatives (n_f, n_p) of a part of y (n_f,) from those (n_f, n_p) of y."""
    if part in ("real", "imaginary"):
        return np.asarray(dy.real if part == "real" else dy.imag)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = dy / y[:, None]
    if part == "phase":
        return np.asarray(relative.imag)
    return np.asarray(relative.real * (DECIBEL if part == "dB" else np.abs(y)[:, None]))


def _of_mode(quantity: ModeQuantity, eigenvalue: complex, moved: ModeSensitivities) -> FloatArray:
    """Derivatives (1, n_p); nan where the mode is not among those with derivatives."""
    size = len(moved.parameters)
    if not np.isfinite(eigenvalue) or not len(moved.poles):
        return np.full((1, size), np.nan)
    place = int(np.argmin(np.abs(moved.poles - eigenvalue)))
    if abs(moved.poles[place] - eigenvalue) > SAME * abs(eigenvalue):
        return np.full((1, size), np.nan)
    if isinstance(quantity, DampingRatio):
        return moved.damping_slopes[place : place + 1]
    if isinstance(quantity, NaturalFrequency) and quantity.which == "damped":
        return np.asarray(moved.pole_slopes[place : place + 1].imag / (2 * np.pi))
    return moved.frequency_slopes[place : place + 1]


@dataclass(frozen=True, eq=False)
class DesignQuantities:
    """Values of quantities in one configuration after the other, as points of one curve.

    So a target is one in every configuration, a limit holds in all, and what is made small is the worst of them.

    Attributes
    ----------
    evaluators : tuple of Evaluator
        One for each configuration.
    wanted : tuple of str
        Quantities that are asked for.
    """

    evaluators: tuple[Evaluator, ...]
    wanted: tuple[str, ...]

    def __call__(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n, n_configurations * n_points) by quantity."""
        count = len(next(iter(values.values())))
        found = [one(_completed(one, values, count), self.wanted) for one in self.evaluators]
        return {name: np.concatenate([one[name].reshape(count, -1) for one in found], axis=1) for name in self.wanted}

    def slopes(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """Exact derivatives (n_configurations * n_points, n_p) of those quantities that have some everywhere."""
        found = [one(values) for one in self._exact]
        everywhere = [name for name in self.wanted if all(name in one for one in found)]
        return {name: np.concatenate([one[name] for one in found]) for name in everywhere}

    @cached_property
    def _exact(self) -> list[ExactSlopes]:
        return [ExactSlopes(one, self.wanted) for one in self.evaluators]

    def singly(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """The same values (n_configurations * n_points,) by models with these values of their own."""
        at = {name: np.array([value]) for name, value in values.items()}
        blocks = [VariantBlock(one.model, at, one.quantities, None) for one in self.evaluators]
        return {name: np.concatenate([block.of(name)[0] for block in blocks]) for name in self.wanted}


def _completed(evaluator: Evaluator, values: Mapping[str, FloatArray], count: int) -> dict[str, FloatArray]:
    """With the model's own values (count,) of what may vary and is not given."""
    own = evaluator.model.parameters
    return {name: values[name] if name in values else np.full(count, own[name]) for name in evaluator.names}
