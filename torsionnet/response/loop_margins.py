"""How far a controlled drivetrain is from becoming unstable: the loop opened at a controller, and its margins."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.table import Column, Table


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
        Whether no mode grows; the margins of a drivetrain that is not stable say how far it is from becoming so.
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
        """The margins with the frequencies at which they are met."""
        rows = (
            ("gain may grow by the factor", self.gain_increase.value, "1", self.gain_increase.frequency),
            ("gain may fall to the factor", self.gain_decrease.value, "1", self.gain_decrease.frequency),
            ("phase margin", self.phase.value, "deg", self.phase.frequency),
            ("delay margin", 1e3 * self.delay.value, "ms", self.delay.frequency),
            ("smallest |1 + L|", self.modulus.value, "1", self.modulus.frequency),
        )
        note = "the drivetrain is stable" if self.stable else "the drivetrain is unstable: no margin is kept"
        columns = (Column("margin"), Column("value"), Column("unit"), Column("at", "Hz"))
        shown = tuple(tuple(None if cell != cell else cell for cell in row) for row in rows)
        return Table(f"{self.title}: loop opened at {self.controller}", columns, shown, (note,))
