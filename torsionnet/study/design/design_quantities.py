"""Quantities of designs in all configurations of a study, and their exact derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.frequency_response import Channel
from torsionnet.linear.sensitivity.parametric import ParametricResponse, parametric_response
from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeSensitivities, mode_sensitivities
from torsionnet.machinery.design.level_minimax import Levels, ReceptanceLevels, WorstLevels
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.natural_frequency import UNDAMPED, DampingRatio, ModeQuantity, NaturalFrequency
from torsionnet.study.quantities.peak import PeakMagnitude
from torsionnet.study.quantities.quantity import StudyQuantity, VariantBlock
from torsionnet.study.quantities.transfer_quantity import ResponseQuantity

SAME_POLE = 1e-6
"""Largest relative distance between a pole from a batch and the pole with derivatives that is taken for the same."""
DECIBELS_PER_NEPER = 20 / np.log(10)
"""Decibels per neper, the level in dB of a factor e, which turns relative derivatives into those of dB."""


@dataclass(frozen=True, eq=False)
class ExactSlopes:
    """Function to exact derivatives (n_points, n_p) in SI of those quantities of an evaluator that have them."""

    evaluator: Evaluator
    wanted: tuple[str, ...]
    """Names of the quantities whose derivatives are wanted."""

    def __call__(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """Exact derivatives (n_points, n_p) in SI of each quantity that has them, by its name."""
        numbers = self.evaluator.once(f"slopes of {self.wanted}", values, lambda: self._whole(values).ravel())
        parts = np.split(numbers.reshape(-1, len(self.evaluator.names)), np.cumsum(self._sizes)[:-1])
        return {name: slopes for name, slopes in zip(self.wanted, parts, strict=True) if np.isfinite(slopes).all()}

    def _whole(self, values: Mapping[str, float]) -> FloatArray:
        """Derivatives (n_points of all, n_p) in SI of all wanted quantities, NaN for those that have none."""
        slopes = self._derivatives(values)
        nothing = [np.full((size, len(self.evaluator.names)), np.nan) for size in self._sizes]
        return np.concatenate([slopes.get(name, nan) for name, nan in zip(self.wanted, nothing, strict=True)])

    @cached_property
    def _sizes(self) -> list[int]:
        """Number of points of each wanted quantity, 1 for a single number."""
        forms = [asked.measured(self.evaluator.model, self.evaluator.quantities) for asked in self._asked.values()]
        return [len(form.points) for form in forms]

    def _derivatives(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        derivatives = {name: self._of_response(quantity, values) for name, quantity in self._responses.items()}
        modal = self._modal
        if modal:
            moved = mode_sensitivities(self.evaluator.model.configured(**values), list(self.evaluator.names))
            block = self.evaluator.block({name: np.array([value]) for name, value in values.items()})
            derivatives |= {
                name: _of_mode(mode, complex(mode.eigenvalue(block)[0]), moved) for name, mode in modal.items()
            }
        return {name: slopes for name, slopes in derivatives.items() if np.isfinite(slopes).all()}

    @property
    def _asked(self) -> dict[str, StudyQuantity]:
        return {name: self.evaluator.quantities[name] for name in self.wanted}

    @cached_property
    def _modal(self) -> dict[str, ModeQuantity]:
        """Quantities, by name, that are damped natural frequencies or damping ratios."""
        return {
            name: quantity
            for name, quantity in self._asked.items()
            if isinstance(quantity, DampingRatio)
            or (isinstance(quantity, NaturalFrequency) and quantity.which != UNDAMPED)
        }

    @cached_property
    def _responses(self) -> dict[str, tuple[ResponseQuantity, ParametricResponse]]:
        """Quantities, by name, that are transfer functions above 0 Hz, with their parametric responses."""
        return {
            name: (
                quantity,
                parametric_response(
                    self.evaluator.model,
                    quantity.output,
                    quantity.input,
                    quantity.frequencies,
                    list(self.evaluator.names),
                    driven_by=quantity.excitation,
                ),
            )
            for name, quantity in self._asked.items()
            if isinstance(quantity, ResponseQuantity) and (quantity.frequencies > 0).all()
        }

    def _of_response(
        self, asked: tuple[ResponseQuantity, ParametricResponse], values: Mapping[str, float]
    ) -> FloatArray:
        quantity, response = asked
        try:
            evaluation = response.evaluation([values[name] for name in self.evaluator.names])
        except SolveError:
            return np.array([[np.nan]])
        return _part_derivatives(quantity.part, evaluation.values[:, 0, 0], evaluation.jacobian[:, 0, 0])


def _part_derivatives(part: str, y: ComplexArray, dy: ComplexArray) -> FloatArray:
    """Derivatives (n_f, n_p) of a part, such as the magnitude, of y (n_f,) from derivatives (n_f, n_p) of y."""
    if part in ("real", "imaginary"):
        return np.asarray(dy.real if part == "real" else dy.imag)
    # d(ln y) = dy/y: its real part is the relative change of the magnitude, its imaginary part that of the phase.
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = dy / y[:, None]
    if part == "phase":
        return np.asarray(relative.imag)
    return np.asarray(relative.real * (DECIBELS_PER_NEPER if part == "dB" else np.abs(y)[:, None]))


def _of_mode(quantity: ModeQuantity, eigenvalue: complex, moved: ModeSensitivities) -> FloatArray:
    """Derivatives (1, n_p) of a natural frequency in Hz or a damping ratio to n_p parameters.

    NaN where its mode is not among those with derivatives.
    """
    size = len(moved.parameters)
    if not np.isfinite(eigenvalue) or not len(moved.poles):
        return np.full((1, size), np.nan)
    # The pole tells the mode; numbers of modes change where frequencies cross.
    place = int(np.argmin(np.abs(moved.poles - eigenvalue)))
    if abs(moved.poles[place] - eigenvalue) > SAME_POLE * abs(eigenvalue):
        return np.full((1, size), np.nan)
    if isinstance(quantity, DampingRatio):
        return moved.damping_slopes[place : place + 1]
    if isinstance(quantity, NaturalFrequency) and quantity.which == "damped":
        # Damped: Im s/(2 pi).
        return np.asarray(moved.pole_slopes[place : place + 1].imag / (2 * np.pi))
    return moved.frequency_slopes[place : place + 1]


@dataclass(frozen=True, eq=False)
class DesignQuantities:
    """Function from designs to their quantities, values in all configurations side by side, like points of one curve.

    So a target holds in every configuration, a limit in all, and the objective is the worst of them.

    Attributes
    ----------
    evaluators : tuple of Evaluator
        One for each configuration.
    wanted : tuple of str
        Names of the quantities.
    """

    evaluators: tuple[Evaluator, ...]
    wanted: tuple[str, ...]

    def __call__(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n, n_configurations * n_points) in SI of each quantity, by its name, for n designs."""
        count = len(next(iter(values.values())))
        cases = [evaluator(_completed(evaluator, values, count), self.wanted) for evaluator in self.evaluators]
        return {name: np.concatenate([case[name].reshape(count, -1) for case in cases], axis=1) for name in self.wanted}

    def slopes(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """Exact derivatives (n_configurations * n_points, n_p) in SI of each quantity, by its name."""
        cases = [exact(values) for exact in self._exact]
        everywhere = [name for name in self.wanted if all(name in of_case for of_case in cases)]
        return {name: np.concatenate([of_case[name] for of_case in cases]) for name in everywhere}

    @cached_property
    def _exact(self) -> list[ExactSlopes]:
        return [ExactSlopes(evaluator, self.wanted) for evaluator in self.evaluators]

    def singly(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """Values (n_configurations * n_points,) in SI of each quantity, by its name, of one design by single models."""
        at = {name: np.array([value]) for name, value in values.items()}
        blocks = [VariantBlock(evaluator.model, at, evaluator.quantities, None) for evaluator in self.evaluators]
        return {name: np.concatenate([block.of(name)[0] for block in blocks]) for name in self.wanted}


def _completed(evaluator: Evaluator, values: Mapping[str, FloatArray], count: int) -> dict[str, FloatArray]:
    """Values (count,) in SI of all varied parameters, by name, those given, or else the model's own."""
    own = evaluator.model.parameters
    return {name: values[name] if name in values else np.full(count, own[name]) for name in evaluator.names}


# Curves over frequency of quantities that are largest magnitudes, whose values have kinks where peaks swap.


@dataclass(frozen=True, eq=False)
class KeptLevels:
    """Levels over frequency that are read back where an interrupted search has calculated them before.

    Attributes
    ----------
    levels : Levels
    evaluator : Evaluator
        Evaluator whose store keeps them.
    what : str
        Words for the quantity of the levels, part of their key.
    names : tuple of str
        Design parameters.
    """

    levels: Levels
    evaluator: Evaluator
    what: str
    names: tuple[str, ...]

    @property
    def precision(self) -> float:
        return self.levels.precision

    @property
    def frequencies(self) -> FloatArray:
        return self.levels.frequencies

    @property
    def of(self) -> tuple[str, str]:
        return self.levels.of

    @property
    def channel(self) -> Channel:
        return self.levels.channel

    def grid(self, values: FloatArray) -> FloatArray:
        return self._once("grid", values, [], lambda: self.levels.grid(values))

    def sizes_at(self, values: FloatArray, points: FloatArray) -> FloatArray:
        return self._once("levels", values, points, lambda: self.levels.sizes_at(values, points))

    def slopes(self, values: FloatArray, points: FloatArray) -> FloatArray:
        slopes = self._once("slopes", values, points, lambda: self.levels.slopes(values, points).ravel())
        return slopes.reshape(len(points), -1)

    def maxima(self, values: FloatArray) -> FloatArray:
        return self._once("maxima", values, [], lambda: self.levels.maxima(values))

    def shown(self, points: FloatArray) -> FloatArray:
        return self.levels.shown(points)

    def _once(
        self, asked: str, values: FloatArray, points: FloatArray | Sequence[float], work: Callable[[], FloatArray]
    ) -> FloatArray:
        at = dict(zip(self.names, map(float, values), strict=True))
        return self.evaluator.once(f"{asked} of {self.what} at {list(map(float, points))}", at, work)


def peak_curves(
    quantities: Sequence[str], names: tuple[str, ...], evaluators: tuple[Evaluator, ...]
) -> dict[str, KeptLevels]:
    """Curves over frequency, by quantity, in all configurations, of those that are largest magnitudes in a band.

    Their levels have exact derivatives to the parameters ``names``. Peaks over a measured input whose excitation is
    named, and peaks in bands from 0 Hz, have no curve.
    """
    curves = {}
    for name in quantities:
        parts = [part for evaluator in evaluators for part in _curve(evaluator, name, names)]
        # The worst configuration counts, so that a curve is needed in each of them.
        if len(parts) == len(evaluators):
            highest = max(part.band[1] for part in parts)
            what = f"{name} in {[evaluator.configuration for evaluator in evaluators]}"
            curves[name] = KeptLevels(WorstLevels(tuple(parts), highest), evaluators[0], what, names)
    return curves


def _curve(evaluator: Evaluator, name: str, names: tuple[str, ...]) -> Iterator[ReceptanceLevels]:
    """Yield the curve over frequency of a quantity in one configuration, if it has one."""
    peak, model = evaluator.quantities[name], evaluator.model
    if isinstance(peak, PeakMagnitude) and peak.excitation is None and peak.band[0] > 0:
        band = float(peak.band[0]), float(peak.band[1])
        yield ReceptanceLevels(parametric_response(model, peak.output, peak.input, list(band), list(names)), band)
