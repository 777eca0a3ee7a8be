"""Calculated orders of the angle of a wheel, by which a calibration tells vibration from the wheel's pitch pattern."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray

SPEED_MARGIN = 0.01
"""Share by which a speed of a test may lie beyond the calculated ones, as that of a governed engine wanders."""


@dataclass(frozen=True, eq=False)
class CalculatedOrders:
    """Response of the reference shaft's angle at the wheel in rad, known or but for complex factors.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s, rising.
    orders : (n_orders,) array
        Per revolution of the reference shaft, rising.
    known : (n_orders, n_speeds) complex array
        Peak amplitudes that are known, rad: the response to inertia torques, which masses and lengths decide.
    shapes : (n_parts, n_orders, n_speeds) complex array
        Responses whose size and phase the test decides, one factor for each part, order and load: to gas torques.
    zero : float
        Angle of the reference shaft at tooth 0, rad, in the convention of the amplitudes: 0 where top dead centre of
        the first cylinder and tooth 0 pass together.
    source : str
        Model and what acts in it.

    Raises
    ------
    UsageError
        Shapes that do not fit, or speeds that do not rise.
    """

    speeds: FloatArray
    orders: FloatArray
    known: ComplexArray
    shapes: ComplexArray
    zero: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        shape = (len(self.orders), len(self.speeds))
        if self.known.shape != shape or self.shapes.shape[1:] != shape or self.shapes.ndim != 3:
            raise UsageError(f"calculated orders have a value for each of {shape[0]} orders and {shape[1]} speeds")
        if len(self.speeds) > 1 and not (np.diff(self.speeds) > 0).all():
            raise UsageError("the speeds of calculated orders have to rise")

    def place(self, order: float) -> int | None:
        """Index of an order of the reference shaft, None where it was not calculated."""
        near = np.flatnonzero(np.abs(self.orders - order) < 1e-6)
        return int(near[0]) if len(near) else None

    def at(self, order: float, speeds: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Known amplitudes (n,) and shapes (n, n_parts) of an order in rad at speeds in rad/s, by cubic splines.

        Raises
        ------
        UsageError
            A speed lies beyond those calculated, or the order was not calculated.
        """
        place = self.place(order)
        if place is None:
            raise UsageError(f"order {order:g} was not calculated")
        low, high = self.speeds[0] * (1 - SPEED_MARGIN), self.speeds[-1] * (1 + SPEED_MARGIN)
        if speeds.min() < low or speeds.max() > high:
            raise UsageError(
                f"the test turns at {speeds.min() * RPM:.4g} to {speeds.max() * RPM:.4g} rpm, but orders were "
                f"calculated for {self.speeds[0] * RPM:.4g} to {self.speeds[-1] * RPM:.4g} rpm"
            )
        turning = np.exp(1j * order * self.zero)
        both = np.vstack([self.known[place], self.shapes[:, place]]) * turning
        found = self._between(both, np.clip(speeds, self.speeds[0], self.speeds[-1]))
        return found[0], found[1:].T

    def _between(self, values: ComplexArray, speeds: FloatArray) -> ComplexArray:
        if len(self.speeds) < 2:
            return np.repeat(values[:, :1], len(speeds), axis=1)
        from scipy.interpolate import make_interp_spline

        degree = 3 if len(self.speeds) > 3 else 1
        return np.asarray(make_interp_spline(self.speeds, values, k=degree, axis=1)(speeds))
