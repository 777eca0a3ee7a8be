"""Measured and calculated amplitudes of one order at the same speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.linear.frequency_response import ComplexArray, FloatArray


@dataclass(frozen=True, eq=False)
class OrderPair:
    """Measured and calculated peak amplitudes of one order at the same speeds, SI units of the output.

    Attributes
    ----------
    order : float
        Vibrations per revolution of the reference shaft.
    speeds : (n,) array
        rad/s, rising.
    measured, calculated : (n,) complex array
        Where phases cannot be compared, amplitudes without an imaginary part.
    has_phase : bool
        Whether both have a phase.
    half_widths : (n,) array, optional
        Half width of the 95 % interval of a part; None or NaN where the test states none.
    curve_speeds : (m,) array
        All calculated speeds, rad/s, rising, which may lie closer.
    curve : (m,) complex array
        Calculated values at these.
    bound : bool
        Whether the calculated amplitude is an upper bound.
    swept : bool
        Whether the calculated values are those along the measured speed over time.
    """

    order: float
    speeds: FloatArray
    measured: ComplexArray
    calculated: ComplexArray
    has_phase: bool
    half_widths: FloatArray | None
    curve_speeds: FloatArray
    curve: ComplexArray
    bound: bool = False
    swept: bool = False

    @property
    def in_intervals(self) -> FloatArray:
        """Distance of measured from calculated values in half widths of the 95 % interval, shape (n,); NaN without one.

        Of complex values where phases are known, else of amplitudes. Of a true model 95 of 100 complex values lie
        within 1.25, amplitudes within 1.
        """
        if self.half_widths is None:
            return np.full(len(self.speeds), math.nan)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.abs(self.measured - self.calculated) / self.half_widths)

    def with_intervals(self) -> OrderPair | None:
        """Pair at the speeds at which the test states an interval above 0; None if it states none."""
        if self.half_widths is None:
            return None
        good = np.isfinite(self.half_widths) & (self.half_widths > 0)
        if not good.any():
            return None
        return replace(
            self,
            speeds=self.speeds[good],
            measured=self.measured[good],
            calculated=self.calculated[good],
            half_widths=self.half_widths[good],
        )
