"""How far a controlled drivetrain is from becoming unstable: the loop opened at a controller, and its margins."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.table import Column, Table

STABLE = "the drivetrain is stable"
UNSTABLE = "the closed loop is unstable, so these are no margins: they say where a pole would reach the imaginary axis"
_KEPT = ("gain may grow by the factor", "gain may fall to the factor", "phase margin", "delay margin")
_LOST = ("gain grown by the factor", "gain fallen to the factor", "phase lag added", "delay added")


@dataclass(frozen=True)
class Margin:
    """A value at a frequency in Hz; nan where there is none."""

    value: float = math.nan
    frequency: float = math.nan


@dataclass(frozen=True, eq=False)
class LoopMargins:
    """The loop L(j omega) opened at the torque of a controller, all other loops closed, and its margins.

    The drivetrain with the loop closed has its poles where 1 + L(s) = 0, so that L is what would come back, with the
    sign of negative feedback, of one N m applied in the place of the controller.

    Attributes
    ----------
    controller : str
    frequencies : (n,) array
        Hz.
    loop : (n,) complex array
        L.
    stable : bool
        Whether no mode grows. Of a drivetrain that is not stable the values below are no margins: they say where a pole
        reaches the imaginary axis, which need not be the one that grows.
    gain_increase, gain_decrease : Margin
        Factors > 1 and < 1 of the gain of the controller at which a pole reaches the imaginary axis.
    phase : Margin
        Degrees that L may lag (lead, where negative) further, where its magnitude is one; the smallest.
    delay : Margin
        Further delay in s.
    modulus : Margin
        Smallest distance of L from -1.
    title : str
    """

    controller: str
    frequencies: NDArray[np.float64]
    loop: NDArray[np.complex128]
    stable: bool
    gain_increase: Margin
    gain_decrease: Margin
    phase: Margin
    delay: Margin
    modulus: Margin
    title: str = ""

    def table(self) -> Table:
        """The margins with the frequencies at which they are met; of an unstable loop, where a pole meets the axis."""
        names, what, note = (
            (_KEPT, "margin", STABLE) if self.stable else (_LOST, "a pole reaches the axis with", UNSTABLE)
        )
        rows = (
            (names[0], self.gain_increase.value, "1", self.gain_increase.frequency),
            (names[1], self.gain_decrease.value, "1", self.gain_decrease.frequency),
            (names[2], self.phase.value, "deg", self.phase.frequency),
            (names[3], 1e3 * self.delay.value, "ms", self.delay.frequency),
            ("smallest |1 + L|", self.modulus.value, "1", self.modulus.frequency),
        )
        columns = (Column(what), Column("value"), Column("unit"), Column("at", "Hz"))
        shown = tuple(tuple(None if cell != cell else cell for cell in row) for row in rows)
        title = f"{self.title}: loop opened at {self.controller}"
        return Table(title if self.stable else f"{title}, UNSTABLE when closed", columns, shown, (note,))
