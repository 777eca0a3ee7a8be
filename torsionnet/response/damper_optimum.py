"""What a search for the best damper found: values, the level they leave, and how the level depends on them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.core.units import expected_unit
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.frequency_response import Channel, FloatArray
from torsionnet.response.table import Column, Table

EQUAL = 1e-3
"""Peaks that differ by less than this share hold an optimum together."""
AT_BOUND = 1e-4
"""Of the range: this near to a bound is at it."""
INDIFFERENT = 1.01
"""A level that varies by less over the whole range does not depend on a parameter."""


@dataclass(frozen=True)
class DesignParameter:
    """A value that was sought: where it began, its limits, what was found; SI."""

    name: str
    unit: str
    start: float
    lower: float
    upper: float
    value: float

    @property
    def is_damping(self) -> bool:
        return self.unit == expected_unit("damping")

    @property
    def bound(self) -> str:
        """The bound it is at: ``lower``, ``upper``, or nothing inside."""
        near = AT_BOUND * (self.upper - self.lower)
        if self.value - self.lower <= min(near, AT_BOUND * max(abs(self.value), abs(self.lower))):
            return "lower"
        return "upper" if self.upper - self.value <= near else ""


@dataclass(frozen=True)
class LevelPeak:
    """A maximum over frequency (Hz) or speed (r/min)."""

    point: float
    level: float


@dataclass(frozen=True)
class FixedPoint:
    """A frequency in Hz at which the level hardly depends on the damping; ``spread``: largest over smallest, less 1."""

    point: float
    level: float
    spread: float


@dataclass(frozen=True, eq=False)
class LevelCurve:
    """Levels (n,) over frequencies in Hz or speeds in r/min (n,) for one set of values."""

    label: str
    points: FloatArray
    levels: FloatArray


@dataclass(frozen=True, eq=False)
class DamperOptimum:
    """The values that make the largest level smallest.

    Attributes
    ----------
    channel : Channel
        What is made small: an amplitude per unit of torque, or the half range of all orders.
    of : str
        What points are, with their unit: ``("frequency", "Hz")`` or ``("speed of fly", "r/min")``.
    parameters : tuple of DesignParameter
    before, after : LevelPeak
        The largest level as given, and with the values found.
    peaks : tuple of LevelPeak
        The maxima that hold the optimum, equal but for 0.1 %.
    effects : mapping
        Parameter -> its values over its range and the largest level for each, the others at their optimum, (n, 2).
    curves : tuple of LevelCurve
        As given, with the values found, and without and with endless damping where damping was sought.
    fixed_points : tuple of FixedPoint
        Where all films meet; none where the rest of the drivetrain is damped, or over speed.
    """

    channel: Channel
    of: tuple[str, str]
    parameters: tuple[DesignParameter, ...]
    before: LevelPeak
    after: LevelPeak
    peaks: tuple[LevelPeak, ...]
    effects: Mapping[str, FloatArray]
    curves: tuple[LevelCurve, ...]
    fixed_points: tuple[FixedPoint, ...]
    title: str = ""

    @property
    def values(self) -> dict[str, float]:
        """Value by parameter, SI; :meth:`torsionnet.Drivetrain.configured` takes them."""
        return {one.name: one.value for one in self.parameters}

    def words(self) -> tuple[str, ...]:
        """What the result is worth."""
        found = [*(self._about(one) for one in self.parameters), self._held_by()]
        if self.fixed_points:
            where = " and ".join(f"{one.point:.5g}" for one in self.fixed_points)
            text = f"whatever the damping, the level at {where} {self.of[1]} is the same"
            only = all(one.is_damping for one in self.parameters)
            reached = self.fixed_points[0].level >= self.after.level * (1 - EQUAL)
            found.append(f"{text}: none has a smaller maximum" if only and reached else text)
        return tuple(found)

    def _about(self, one: DesignParameter) -> str:
        levels = self.effects[one.name][:, 1]
        if levels.max() < INDIFFERENT * levels.min():
            return f"the maximum hardly depends on {one.name}: by {levels.max() / levels.min() - 1:.2g} of itself"
        if one.bound:
            return f"{one.name} is at its {one.bound} bound; beyond it the maximum may be smaller still"
        valleys = _inner_minima(levels)
        more = f"; its curve has {len(valleys)} minima, this is the lowest" if len(valleys) > 1 else ""
        return f"{one.name} is an optimum inside its bounds{more}"

    def _held_by(self) -> str:
        where = " and ".join(f"{peak.point:.5g}" for peak in self.peaks)
        return f"the maximum is at {where} {self.of[1]}" + (", equally high" if len(self.peaks) > 1 else "")

    def table(self, conventions: Conventions = SI) -> Table:
        """Values, then the largest level before and after, with where it is."""
        scale, unit = conventions.scale(self.channel.unit), conventions.unit(self.channel.unit)
        rows: list[tuple[object, ...]] = [
            (one.name, one.unit, one.start, one.value, one.lower, one.upper) for one in self.parameters
        ]
        rows.append(
            (f"largest {self.channel.name}", unit, self.before.level * scale, self.after.level * scale, None, None)
        )
        rows.append((f"at {self.of[0]}", self.of[1], self.before.point, self.after.point, None, None))
        names = ("", "unit", "as given", "optimum", "lower bound", "upper bound")
        return Table(f"{self.title}: best damper", tuple(map(Column, names)), tuple(rows), self.words())

    def effect_table(self, conventions: Conventions = SI) -> Table:
        """The largest level over the values of every parameter."""
        scale = conventions.scale(self.channel.unit)
        columns = (
            Column("parameter"),
            Column("value"),
            Column(f"largest {self.channel.name}", conventions.unit(self.channel.unit)),
        )
        rows = tuple(
            (name, value, level * scale) for name, effect in self.effects.items() for value, level in effect.tolist()
        )
        return Table(f"{self.title}: best damper", columns, rows, self.words())


def _inner_minima(levels: FloatArray) -> list[int]:
    rises, falls = levels[1:-1] < levels[:-2], levels[1:-1] <= levels[2:]
    return (np.flatnonzero(rises & falls) + 1).tolist()
