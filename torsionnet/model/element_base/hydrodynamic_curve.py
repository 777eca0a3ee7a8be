"""Torque curves of fluid couplings and torque converters over the speeds of pump and turbine."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from torsionnet.base.expressions import RATIONAL, Algebra, Rows, slope_at, value_at
from torsionnet.model.element_base.laws import END_SLACK, MotionState, TorqueCurve


@dataclass(frozen=True)
class Capacity:
    """Capacity C = T_p/omega_p^2 of a pump in N m s^2/rad^2 over the speed ratio nu.

    It is ``factor`` times the second column of rows over nu, or divided by the square of that column where the rows are
    K factors. Between rows the column is straight. Beyond them its last piece goes on; a K factor stays there.
    """

    rows: Rows
    factor: Any
    of_k_factor: bool = False
    algebra: Algebra = RATIONAL

    def at(self, ratio: Any) -> tuple[Any, Any]:
        """Capacity at a speed ratio, and its slope over the ratio."""
        if not self.of_k_factor:
            level, slope = value_at(self.rows, ratio), self.algebra.number(slope_at(self.rows, ratio))
            return self.factor * level, self.factor * slope
        first, last = self.rows[0][0].value, self.rows[-1][0].value
        if ratio < first or ratio > last:
            level = value_at(self.rows, first if ratio < first else last)
            return self.factor / level**2, 0 * self.factor
        level, slope = value_at(self.rows, ratio), self.algebra.number(slope_at(self.rows, ratio))
        return self.factor / level**2, -2 * self.factor * slope / level**3

    def ratios_at(self, capacity: float) -> Iterator[float]:
        """Speed ratios within the rows at which the pump has a capacity in N m s^2/rad^2, rising."""
        if self.of_k_factor:
            if capacity <= 0:
                return
            level = math.sqrt(float(self.factor) / capacity)
        else:
            level = capacity / float(self.factor)
        last: float | None = None
        points = [(float(row[0].value), float(row[1].value)) for row in self.rows]
        for (start, low), (end, high) in pairwise(points):
            slack = END_SLACK * max(abs(low), abs(high))
            if high == low or not min(low, high) - slack <= level <= max(low, high) + slack:
                continue
            ratio = start + min(max((level - low) / (high - low), 0.0), 1.0) * (end - start)
            if last is None or ratio - last > END_SLACK:
                yield ratio
            last = ratio


@dataclass(frozen=True)
class Gain:
    """Turbine torque over pump torque by rows over the speed ratio, straight between them."""

    rows: Rows
    algebra: Algebra = RATIONAL

    def at(self, ratio: Any) -> tuple[Any, Any]:
        """Torque ratio at a speed ratio, and its slope over the speed ratio."""
        return value_at(self.rows, ratio), self.algebra.number(slope_at(self.rows, ratio))


@dataclass(frozen=True)
class CouplingCurve(TorqueCurve):
    """Torque C(nu) omega_p^2 between pump and turbine over gamma' = omega_p - omega_t and, sensed, omega_p.

    nu = omega_t/omega_p; both speeds are against the housing. Where the pump turns backwards the torque has the other
    sign, and none where it stands.

    >>> from fractions import Fraction
    >>> from torsionnet.base.expressions import FLOAT, Number
    >>> rows = tuple((Number(nu), Number(torque)) for nu, torque in ((Fraction(9, 10), 900), (1, 0)))
    >>> curve = CouplingCurve(Capacity(rows, 1 / 150**2, algebra=FLOAT))
    >>> round(curve.torque(0, 4.5, 150.0), 9)
    270.0
    >>> [round(slope, 9) for slope in curve.slopes(MotionState(0, 4.5, (150.0,)))]
    [0, 60.0, 1.8]
    >>> [round(state.rate, 9) for state in curve.states_at(270, 150.0)]
    [4.5]
    """

    over = "rate"

    capacity: Capacity

    def ratio(self, rate: Any, pump: Any) -> Any:
        """Speed ratio at the rate of the row and the speed of the pump; 0 where the pump stands."""
        return (pump - rate) / pump if pump != 0 else 0 * pump

    def factor(self, ratio: Any) -> tuple[Any, Any]:
        """Torque over the square of the pump's speed at a speed ratio, and its slope over the ratio."""
        return self.capacity.at(ratio)

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del twist
        (pump,) = sensed
        return self.factor(self.ratio(rate, pump))[0] * pump * abs(pump)

    def energy(self, twist: Any) -> Any:
        return 0 * twist

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        (pump,) = state.sensed or (0.0,)
        ratio = self.ratio(state.rate, pump)
        level, slope = self.factor(ratio)
        by_turbine = abs(pump) * slope
        return 0, -by_turbine, abs(pump) * (2 * level - ratio * slope) + by_turbine

    def states_at(self, torque: Any, *sensed: float) -> tuple[MotionState, ...] | None:
        """States in which the coupling passes on a torque in N m at a speed of the pump in rad/s, by rising ratio.

        None where that speed is not given.
        """
        if not sensed or not sensed[0]:
            return None
        (pump,) = sensed
        ratios = self.capacity.ratios_at(float(torque) / (pump * abs(pump)))
        return tuple(MotionState(0.0, pump * (1 - ratio), (pump,)) for ratio in ratios)

    def tables(self) -> tuple[Rows, ...]:
        """Tables over the speed ratio that the curve follows."""
        return (self.capacity.rows,)

    def left(self, twist: float, rate: float = 0.0, *sensed: float) -> str:
        del twist
        if not sensed or not sensed[0]:
            return ""
        ratio = float(self.ratio(rate, sensed[0]))
        first, last = (
            pick(float(rows[place][0].value) for rows in self.tables()) for pick, place in ((max, 0), (min, -1))
        )
        if first - END_SLACK <= ratio <= last + END_SLACK:
            return ""
        return f"the table goes from speed ratio {first:.6g} to {last:.6g}, and the ratio is {ratio:.6g}; extend it"


@dataclass(frozen=True)
class StatorCurve(CouplingCurve):
    """Torque -(mu(nu) - 1) C(nu) omega_p^2 on the turbine of a converter, over omega_t and, sensed, omega_p.

    It is what the turbine has beyond the torque of the pump, by the torque ratio mu; the stator takes it to the
    housing.
    """

    gain: Gain

    def ratio(self, rate: Any, pump: Any) -> Any:
        return rate / pump if pump != 0 else 0 * pump

    def factor(self, ratio: Any) -> tuple[Any, Any]:
        capacity, slope = self.capacity.at(ratio)
        gain, rise = self.gain.at(ratio)
        return -(gain - 1) * capacity, -((gain - 1) * slope + rise * capacity)

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        (pump,) = state.sensed or (0.0,)
        ratio = self.ratio(state.rate, pump)
        level, slope = self.factor(ratio)
        return 0, abs(pump) * slope, abs(pump) * (2 * level - ratio * slope)

    def states_at(self, torque: Any, *sensed: float) -> tuple[MotionState, ...] | None:
        """None for every torque: that between pump and turbine tells the ratio, not what the stator adds."""
        del torque, sensed
        return None

    def tables(self) -> tuple[Rows, ...]:
        return (self.capacity.rows, self.gain.rows)
