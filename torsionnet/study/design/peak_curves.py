"""Curves over frequency of quantities that are largest magnitudes, whose values have kinks where peaks swap."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.frequency_response import Channel
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.machinery.design.levels import Levels, ReceptanceLevels
from torsionnet.machinery.design.worst_levels import WorstLevels
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.peak import PeakMagnitude


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

    def at(self, values: FloatArray, points: FloatArray) -> FloatArray:
        return self._once("levels", values, points, lambda: self.levels.at(values, points))

    def slopes(self, values: FloatArray, points: FloatArray) -> FloatArray:
        found = self._once("slopes", values, points, lambda: self.levels.slopes(values, points).ravel())
        return found.reshape(len(points), -1)

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
    found = {}
    for name in quantities:
        parts = [part for one in evaluators for part in _curve(one, name, names)]
        if len(parts) == len(evaluators):
            highest = max(part.band[1] for part in parts)
            what = f"{name} in {[one.configuration for one in evaluators]}"
            found[name] = KeptLevels(WorstLevels(tuple(parts), highest), evaluators[0], what, names)
    return found


def _curve(evaluator: Evaluator, name: str, names: tuple[str, ...]) -> Iterator[ReceptanceLevels]:
    """Yield the curve over frequency of a quantity in one configuration, if it has one."""
    peak, model = evaluator.quantities[name], evaluator.model
    if isinstance(peak, PeakMagnitude) and peak.excitation is None and peak.band[0] > 0:
        band = float(peak.band[0]), float(peak.band[1])
        yield ReceptanceLevels(parametric_response(model, peak.output, peak.input, list(band), list(names)), band)
