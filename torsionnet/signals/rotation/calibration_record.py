"""The calibration of a wheel as plain data, for JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import Out
from torsionnet.signals.recording import FloatArray


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
