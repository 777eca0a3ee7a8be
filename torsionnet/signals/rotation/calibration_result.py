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
from torsionnet.base.packages import NotebookResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pitch_order import ABOVE, CALCULATED, PitchOrder
from torsionnet.signals.rotation.wheel import WheelPattern

# The calibration of a wheel as plain data, for JSON.


@dataclass(frozen=True, eq=False)
class PitchOrderRecord:
    """Whole order of a wheel's pitch pattern as ``torsionnet calibrate-wheel --json`` prints it, amplitudes in rad."""

    order: int
    amplitude: Annotated[complex, Out(json="amplitude_rad")]
    half_width: Annotated[float, Out(json="half_width_rad")]
    resolved: bool
    by: str
    gain: float | None
    change: Annotated[float, Out(json="vibration_changes_by_rad")]
    scatter: Annotated[float, Out(json="scatter_rad")]
    why: Annotated[str, Out(json="why_not_resolved")]


@dataclass(frozen=True, eq=False)
class CalibrationRecord:
    """Calibrated wheel as ``torsionnet calibrate-wheel --json`` prints it, with angles in rad."""

    name: str
    teeth: int
    missing: Annotated[int, Out(json="missing_teeth")]
    first: Annotated[str, Out(json="first_tooth")]
    lowest: Annotated[float, Out(json="lowest_speed_rpm")]
    highest: Annotated[float, Out(json="highest_speed_rpm")]
    windows: int
    revolutions: Annotated[int, Out(json="revolutions_of_a_window")]
    angle: Annotated[float | None, Out(json="angle_between_pickups_rad")]
    angle_half_width: Annotated[float | None, Out(json="angle_half_width_rad")]
    positions: Annotated[FloatArray, Out(json="positions_rad")]
    half_widths: Annotated[FloatArray, Out(json="half_widths_rad")]
    orders: tuple[PitchOrderRecord, ...]
    notes: tuple[NoteOrText, ...]


MOST_LISTED = 12
"""Orders that a note lists at most, so that it stays short."""


@dataclass(frozen=True, eq=False, repr=False)
class WheelCalibration(NotebookResult):
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
    angle_half_width : float
        Half width of its 95 % interval, rad.
    source : str
        Origin of calculated orders.
    known : bool
        Whether tooth 0 is the same in every record of the wheel.
    remarks : tuple of str
        Repairs of pulses, and how records were aligned.
    """

    picture: ClassVar[str] = "wheel_pattern"

    pattern: WheelPattern
    orders: tuple[PitchOrder, ...]
    speeds: tuple[float, float]
    windows: int
    revolutions: int
    angle: float | None = None
    angle_half_width: float = 0.0
    source: str = ""
    known: bool = True
    remarks: tuple[NoteOrText, ...] = ()

    @property
    def title(self) -> str:
        """Title of a calibration's table, with the number of teeth."""
        return f"Pitch pattern of {self.pattern.name or 'the wheel'}, {self.pattern.teeth} teeth"

    @property
    def notes(self) -> tuple[NoteOrText, ...]:
        """Notes on speeds, methods, what is unresolved and why, as sentences."""
        low, high = (speed * RPM for speed in self.speeds)
        notes = [f"{self.windows} windows of {self.revolutions} revolutions at {low:.4g} to {high:.4g} rpm"]
        if self.angle is not None:
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

    def record(self) -> CalibrationRecord:
        """Calibrated wheel as plain data for JSON, angles in rad."""
        pattern = self.pattern
        return CalibrationRecord(
            name=pattern.name,
            teeth=pattern.teeth,
            missing=pattern.missing,
            first=pattern.first,
            lowest=self.speeds[0] * RPM,
            highest=self.speeds[1] * RPM,
            windows=self.windows,
            revolutions=self.revolutions,
            angle=self.angle,
            angle_half_width=None if self.angle is None else self.angle_half_width,
            positions=pattern.positions,
            half_widths=pattern.half_widths,
            orders=tuple(
                PitchOrderRecord(
                    row.order,
                    row.value,
                    row.half_width,
                    row.resolved,
                    row.by,
                    row.gain,
                    row.change,
                    row.scatter,
                    row.why,
                )
                for row in self.orders
            ),
            notes=self.notes,
        )


def _amount(row: PitchOrder) -> str:
    return f"{row.order} ({np.degrees(abs(row.value)):.2g} degrees)"


# Angles that a calibration of a wheel takes, with their units, for the command line and files.

PICKUP_ANGLE = Value(
    "angle from the first to the second pickup in the sense of rotation", "angle", exclusive=True, below=2 * math.pi
)
ZERO_ANGLE = Value("angle of the reference shaft at tooth 0", "angle", lower=None)
TICK = Value("time of one count of the counter", "time", exclusive=True)
