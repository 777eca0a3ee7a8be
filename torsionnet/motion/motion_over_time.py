"""Motion over time of a drivetrain with laws of motion, as solvers return it."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.signals.energy_balance import AnyBalance
from torsionnet.signals.motion_event import MotionEvent


@dataclass(frozen=True, eq=False)
class MotionOverTime:
    """Readings (n_out, n) in SI units at samples, events and energies of a motion."""

    values: FloatArray
    events: tuple[MotionEvent, ...]
    energy: AnyBalance
