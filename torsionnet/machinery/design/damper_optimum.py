"""Result of the search for the damper values with which the largest vibration level of an output is smallest."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import expected_unit
from torsionnet.linear.frequency_response import Channel, FloatArray

EQUAL_PEAK_DIFFERENCE = 1e-3
"""Relative difference up to which peaks of vibration count as equally high, so that all of them determine the optimal
damper."""
AT_BOUND_SHARE = 1e-4
"""Distance of a design parameter from a bound, as a share of its range, up to which it counts as at the bound."""
INDIFFERENT_LEVEL_RATIO = 1.01
"""Ratio of largest to smallest vibration level over a design parameter's range below which the parameter hardly
matters."""


@dataclass(frozen=True)
class DesignParameter:
    """Design parameter of a damper with start value, bounds and optimal value, in SI units.

    Attributes
    ----------
    name, unit : str
    start, lower, upper, value : float
        As given, bounds, and the optimum.
    values, largest : (n,) arrays
        Values over the range, and the largest vibration level for each, the other parameters at their optimum.
    """

    SHOWN: ClassVar = ("name", "unit", "start", "lower", "upper", "value", "bound", "values", "largest")

    name: str
    unit: str
    start: float
    lower: float
    upper: float
    value: float
    values: FloatArray = field(default_factory=lambda: np.empty(0), compare=False)
    largest: FloatArray = field(default_factory=lambda: np.empty(0), compare=False)

    @property
    def is_damping(self) -> bool:
        """Whether a design parameter of a damper is a viscous damping."""
        return self.unit == expected_unit("damping")

    @property
    def bound(self) -> Annotated[str | None, Out(json="at_bound")]:
        """Name of the bound that an optimal design value is at, ``lower`` or ``upper``; None inside the bounds."""
        near = AT_BOUND_SHARE * (self.upper - self.lower)
        if self.value - self.lower <= min(near, AT_BOUND_SHARE * max(abs(self.value), abs(self.lower))):
            return "lower"
        return "upper" if self.upper - self.value <= near else None


@dataclass(frozen=True)
class LevelPeak:
    """Local maximum of an output's vibration level in its SI unit, and its frequency (Hz) or speed (r/min)."""

    point: Annotated[float, Out(json="at")]
    level: float


@dataclass(frozen=True)
class FixedPoint:
    """Frequency in Hz at which the vibration level (SI) is nearly the same for every damping, and that level.

    ``spread`` is the largest level over the smallest minus 1.
    """

    point: Annotated[float, Out(json="at")]
    level: float
    spread: float


@dataclass(frozen=True, eq=False)
class LevelCurve:
    """Vibration level in SI (n,) over frequencies in Hz or speeds in r/min (n,) for one set of damper values."""

    label: str
    points: FloatArray
    levels: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class DamperOptimum(SavedResult):
    """Optimal damper, the values for which the largest vibration level is smallest.

    Attributes
    ----------
    channel : Channel
        Quantity that is minimised: an amplitude per unit of torque, or the half range of all orders.
    of : str
        Axis of the level and its unit: ``("frequency", "Hz")`` or ``("speed of fly", "r/min")``.
    parameters : tuple of DesignParameter
    before, after : LevelPeak
        Largest level with the values as given, and with the optimal values.
    peaks : tuple of LevelPeak
        Maxima that determine the optimum, equal within 0.1 %.
    curves : tuple of LevelCurve
        Curves with the values as given, with the optimum, and with zero and infinite damping if that is optimised.
    fixed_points : tuple of FixedPoint
        Points common to the curves of all dampings; none if the rest of the drivetrain is damped, or over speed.
    notes : tuple of str
        Where tables over frequency are read beyond their rows.
    configuration : str
    """

    picture: ClassVar[str] = "damper_design"
    SHOWN: ClassVar = (
        "title", "configuration", "output", "unit", "over", "parameters", "before", "after", "peaks", "fixed_points",
        "words",
    )  # fmt: skip

    channel: Channel
    of: tuple[str, str]
    parameters: tuple[DesignParameter, ...]
    before: LevelPeak
    after: LevelPeak
    peaks: tuple[LevelPeak, ...]
    curves: tuple[LevelCurve, ...]
    fixed_points: tuple[FixedPoint, ...]
    title: str = ""
    notes: tuple[str, ...] = ()
    configuration: str = ""

    @property
    def output(self) -> str:
        """Name of the output whose vibration level is smallest."""
        return self.channel.name

    @property
    def unit(self) -> str:
        """SI unit of the vibration level."""
        return self.channel.unit

    @property
    def over(self) -> str:
        """Axis of the vibration level with its unit, such as 'frequency Hz'."""
        return " ".join(self.of)

    @property
    def values(self) -> dict[str, float]:
        """Optimal values in SI by design parameter, as :meth:`torsionnet.Drivetrain.configured` takes them."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    @property
    def words(self) -> tuple[str, ...]:
        """Sentences on how far to trust the optimal damper, on parameters at bounds or without effect, and on peaks."""
        sentences = [*(self._about(parameter) for parameter in self.parameters), self._held_by()]
        if self.fixed_points:
            where = " and ".join(f"{point.point:.5g}" for point in self.fixed_points)
            text = f"whatever the damping, the level at {where} {self.of[1]} is the same"
            only = all(parameter.is_damping for parameter in self.parameters)
            reached = self.fixed_points[0].level >= self.after.level * (1 - EQUAL_PEAK_DIFFERENCE)
            sentences.append(f"{text}: none has a smaller maximum" if only and reached else text)
        return (*sentences, *self.notes)

    def _about(self, parameter: DesignParameter) -> str:
        levels = parameter.largest
        if levels.max() < INDIFFERENT_LEVEL_RATIO * levels.min():
            return f"the maximum hardly depends on {parameter.name}: by {levels.max() / levels.min() - 1:.2g} of itself"
        if parameter.bound:
            return f"{parameter.name} is at its {parameter.bound} bound; beyond it the maximum may be smaller still"
        valleys = _inner_minima(levels)
        more = f"; its curve has {len(valleys)} minima, this is the lowest" if len(valleys) > 1 else ""
        return f"{parameter.name} is an optimum inside its bounds{more}"

    def _held_by(self) -> str:
        where = " and ".join(f"{peak.point:.5g}" for peak in self.peaks)
        return f"the maximum is at {where} {self.of[1]}" + (", equally high" if len(self.peaks) > 1 else "")

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of a damper's given and optimal values, the largest vibration level with both, and where it occurs."""
        scale, unit = conventions.scale(self.channel.unit), conventions.unit(self.channel.unit)
        rows: list[tuple[object, ...]] = [
            (parameter.name, parameter.unit, parameter.start, parameter.value, parameter.lower, parameter.upper)
            for parameter in self.parameters
        ]
        rows.append(
            (f"largest {self.channel.name}", unit, self.before.level * scale, self.after.level * scale, None, None)
        )
        rows.append((f"at {self.of[0]}", self.of[1], self.before.point, self.after.point, None, None))
        names = ("", "unit", "as given", "optimum", "lower bound", "upper bound")
        return Table(f"{self.title}: best damper", tuple(map(Column, names)), tuple(rows), self.words)

    def effect_table(self, conventions: Conventions = SI) -> Table:
        """Table of the largest vibration level over each design parameter of a damper, the others at their optimum."""
        scale = conventions.scale(self.channel.unit)
        columns = (
            Column("parameter"),
            Column("value"),
            Column(f"largest {self.channel.name}", conventions.unit(self.channel.unit)),
        )
        rows = tuple(
            (parameter.name, value, level * scale)
            for parameter in self.parameters
            for value, level in zip(parameter.values.tolist(), parameter.largest.tolist(), strict=True)
        )
        return Table(f"{self.title}: best damper", columns, rows, self.words)


def _inner_minima(levels: FloatArray) -> list[int]:
    rises, falls = levels[1:-1] < levels[:-2], levels[1:-1] <= levels[2:]
    return (np.flatnonzero(rises & falls) + 1).tolist()
