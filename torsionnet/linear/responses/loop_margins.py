"""Stability margins of a controlled drivetrain, from the loop opened at a controller."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.packages import NotebookResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table

STABLE_NOTE = "the drivetrain is stable"
"""Text of the note below the table of stability margins of a stable drivetrain."""
UNSTABLE_NOTE = (
    "the closed loop is unstable, so these are no margins: they say where a pole would reach the imaginary axis"
)
"""Text of the note below the table of stability margins of an unstable drivetrain."""
_STABLE_ROWS = ("gain may grow by the factor", "gain may fall to the factor", "phase margin", "delay margin")
_UNSTABLE_ROWS = ("gain grown by the factor", "gain fallen to the factor", "phase lag added", "delay added")


@dataclass(frozen=True)
class Margin:
    """Gain (factor), phase (deg), delay (s) or modulus margin of a loop, and its frequency in Hz; nan for none."""

    value: float = math.nan
    frequency: Annotated[float, Out(json="frequency_Hz")] = math.nan


@dataclass(frozen=True)
class MarginsRecord:
    """Stability margins (deg, s) of one configuration, as ``torsionnet margins --json`` prints them."""

    title: str
    configuration: str
    controller: str
    stable: bool
    gain_increase: Margin
    gain_decrease: Margin
    phase: Annotated[Margin, Out(json="phase_deg")]
    delay: Annotated[Margin, Out(json="delay_s")]
    modulus: Margin


@dataclass(frozen=True, eq=False, repr=False)
class LoopMargins(NotebookResult):
    """Open loop L(j omega), without unit, at a controller's torque, all other loops closed, and its stability margins.

    The drivetrain with the loop closed has its poles where 1 + L(s) = 0: L is the torque of the controller, with the
    sign of negative feedback, in response to 1 N m applied in its place.

    Attributes
    ----------
    controller : str
    frequencies : (n,) array
        Frequencies, Hz.
    loop : (n,) complex array
        Open loop L at the frequencies.
    stable : bool
        Whether no mode grows. For an unstable drivetrain the values below are no margins: they say where a pole reaches
        the imaginary axis, which need not be the unstable one.
    gain_increase, gain_decrease : Margin
        Factors > 1 and < 1 of the gain of the controller at which a pole reaches the imaginary axis.
    phase : Margin
        Smallest phase margin in degrees: lag (lead if negative) that L may gain where its magnitude is 1.
    delay : Margin
        Additional delay in s at which a pole reaches the imaginary axis.
    modulus : Margin
        Smallest distance of L from -1.
    title : str
    """

    picture: ClassVar[str] = "nyquist"

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

    def record(self, configuration: str = "") -> MarginsRecord:
        """Stability margins of one configuration as plain data for JSON, phase in degrees, delay in s."""
        return MarginsRecord(
            self.title, configuration, self.controller, self.stable, self.gain_increase, self.gain_decrease,
            self.phase, self.delay, self.modulus,
        )  # fmt: skip

    def table(self) -> Table:
        """Table of stability margins of a loop, if unstable of changes to a pole on the axis, and frequencies in Hz."""
        names, what, note = (
            (_STABLE_ROWS, "margin", STABLE_NOTE)
            if self.stable
            else (_UNSTABLE_ROWS, "a pole reaches the axis with", UNSTABLE_NOTE)
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
