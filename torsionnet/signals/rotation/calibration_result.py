"""Result of the calibration of a toothed wheel: its pattern, and order by order what is known of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.scalars import Value
from torsionnet.base.errors import comma_list
from torsionnet.base.notes import NoteOrText
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.signals.rotation.pitch_order import ABOVE, CALCULATED, PitchOrder
from torsionnet.signals.rotation.wheel import WheelPattern

MOST_LISTED = 12
"""Orders that a note lists at most, so that it stays short."""


@dataclass(frozen=True, eq=False, repr=False)
class WheelCalibration(SavedResult):
    """Calibrated wheel with its pitch pattern in rad, and with what is known of each order.

    Attributes
    ----------
    pattern : WheelPattern
        Of all orders that are resolved.
    orders : tuple of PitchOrder
        All whole orders up to half the teeth.
    speeds : tuple of float
        Lowest and highest speed of the reference shaft, rad/s.
    windows : int
        Windows of whole revolutions that were used.
    revolutions : int
        Of a window.
    angle : float or None
        From the first to the second pickup as the pulses say it, rad.
    angle_half_width : float or None
        Half width of its 95 % interval, rad.
    source : str
        Origin of calculated orders.
    known : bool
        Whether tooth 0 is the same in every record of the wheel.
    remarks : tuple of str
        Repairs of pulses, and how records were aligned.
    """

    picture: ClassVar[str] = "wheel_pattern"
    SHOWN: ClassVar = (
        "pattern.name", "pattern.teeth", "pattern.missing", "pattern.first", "lowest_rpm", "highest_rpm", "windows",
        "revolutions", "angle", "angle_half_width", "pattern.positions", "pattern.half_widths", "orders", "notes",
    )  # fmt: skip

    pattern: WheelPattern
    orders: tuple[PitchOrder, ...]
    speeds: tuple[float, float]
    windows: int
    revolutions: Annotated[int, Out(json="revolutions_of_a_window")]
    angle: Annotated[float | None, Out(json="angle_between_pickups_rad")] = None
    angle_half_width: Annotated[float | None, Out(json="angle_half_width_rad")] = None
    source: str = ""
    known: bool = True
    remarks: tuple[NoteOrText, ...] = ()

    @property
    def title(self) -> str:
        """Title of a calibration's table, with the number of teeth."""
        return f"Pitch pattern of {self.pattern.name or 'the wheel'}, {self.pattern.teeth} teeth"

    @property
    def lowest_rpm(self) -> Annotated[float, Out(json="lowest_speed_rpm")]:
        """Lowest speed of the reference shaft in r/min."""
        return self.speeds[0] * RPM

    @property
    def highest_rpm(self) -> Annotated[float, Out(json="highest_speed_rpm")]:
        """Highest speed of the reference shaft in r/min."""
        return self.speeds[1] * RPM

    @property
    def notes(self) -> tuple[NoteOrText, ...]:
        """Notes on speeds, methods, what is unresolved and why, as sentences."""
        speeds = f"{self.lowest_rpm:.4g} to {self.highest_rpm:.4g} rpm"
        notes = [f"{self.windows} windows of {self.revolutions} revolutions at {speeds}"]
        if self.angle is not None and self.angle_half_width is not None:
            angle, half = np.degrees([self.angle, self.angle_half_width])
            notes.append(f"two pickups, {angle:.4f} +-{half:.2g} degrees apart by the pulses themselves")
        if any(row.by == CALCULATED for row in self.orders):
            notes.append(f"vibration in orders 'calculated orders' is that of {self.source or 'the calculation'}")
        above = [row.order for row in self.orders if row.by == ABOVE]
        if above:
            notes.append(f"orders {above[0]} to {above[-1]} count as pattern: no vibration is sought there")
        notes += self._unresolved_notes()
        notes.append(f"tooth 0 is {self.pattern.first}" if self.pattern.first else "")
        notes.append("a pattern touches whole orders of the wheel only; unresolved ones are left out of the positions")
        return (*filter(None, notes), *self.remarks)

    def _unresolved_notes(self) -> list[str]:
        reasons: dict[str, list[PitchOrder]] = {}
        for row in self.orders:
            if not row.resolved:
                reasons.setdefault(row.why, []).append(row)
        return [
            f"not resolved: order {comma_list([_amount(row) for row in rows], MOST_LISTED)}: {why}"
            for why, rows in reasons.items()
        ]

    def stored(self) -> WheelPattern:
        """Pattern of the calibrated wheel in rad with the notes that its file keeps."""
        return replace(self.pattern, notes=tuple(map(str, self.notes)))

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of the pitch pattern order by order, with amplitude, interval and method."""
        scale, unit = conventions.scale("rad"), conventions.unit("rad")
        columns = (
            Column("order"),
            Column("amplitude", unit, 4),
            Column("half_width", unit, 2),
            Column("phase", "deg", 4),
            Column("resolved"),
            Column("by"),
            Column("gain", "", 3),
        )
        return Table(
            self.title, columns, tuple(self._row(row, scale) for row in self.orders), tuple(map(str, self.notes))
        )

    def _row(self, row: PitchOrder, scale: float) -> tuple[Any, ...]:
        half = row.half_width * scale if math.isfinite(row.half_width) else None
        phase = float(np.degrees(np.angle(row.value)))
        resolved = "yes" if row.resolved else "no"
        return (row.order, abs(row.value) * scale, half, phase, resolved, row.by, row.gain)


def _amount(row: PitchOrder) -> str:
    return f"{row.order} ({np.degrees(abs(row.value)):.2g} degrees)"


# Angles that a calibration of a wheel takes, with their units, for the command line and files.

PICKUP_ANGLE = Value(
    "angle from the first to the second pickup in the sense of rotation", "angle", exclusive=True, below=2 * math.pi
)
ZERO_ANGLE = Value("angle of the reference shaft at tooth 0", "angle", lower=None)
TICK = Value("time of one count of the counter", "time", exclusive=True)
