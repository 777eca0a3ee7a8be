"""Remarks on what spoils loops of torque over twist: what was corrected, and what was not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.notes import NoteOrText, warning
from torsionnet.signals.torque_loops.loop_numbers import LoopRecord
from torsionnet.signals.torque_loops.loop_result import LoopStage, TorqueLoop

TOLD = 0.005
"""Share of stiffness or friction from which an effect is told."""
UNIT_INERTIA, UNIT_DELAY = 0.01, 1e-3
"""Inertia in kg m^2 and delay in s for which effects are told that nobody has stated."""
HARMLESS_STEP = 3.0
"""Step of the twist as a torque over the noise of the torque up to which it does no harm."""
BUILD_UP = 0.05
"""Share of the swing behind a reversal within which the friction torque has to be there."""


@dataclass(frozen=True)
class Applied:
    """Corrections asked for: delay of the torque in s, inertia in kg m^2, drift, and step of the twist in rad."""

    delay: float = 0.0
    inertia: float = 0.0
    drift: bool = False
    step: float | None = None

    def notes(self) -> tuple[str, ...]:
        """Notes on the corrections asked for."""
        found = []
        if self.delay:
            found.append(f"torque moved {1e3 * self.delay:g} ms to earlier times")
        if self.inertia:
            found.append(f"torque without that of {self.inertia:g} kg m^2 that move with the twist")
        if self.drift:
            found.append("torque without a straight line in each cycle, by the same twist a cycle apart")
        return tuple(found)


def loop_remarks(
    loop: TorqueLoop, record: LoopRecord, applied: Applied, step: float, *, sine: bool
) -> list[NoteOrText]:
    """Remarks on a loop: effects of inertia, delay, drift, steps and what is elastic, as far as not corrected."""
    found = [*_motion(loop, applied, sine=sine), *_drift(loop, applied), *_steps(loop, record, step), *_sides(loop)]
    if loop.cycles < 3:
        found.append(f"{loop.cycles} cycles behind the intervals, of which the first is left out: record five or more")
    if loop.bends:
        found.append(
            "the spring line bends all along: stages are straight pieces laid through it, not stages of springs; "
            "secant, loss and first harmonic hold"
        )
    share = friction_build_up(loop)
    if share > BUILD_UP:
        found.append(
            warning(
                f"behind a reversal the torque needs {100 * share:.2g} % of the swing to cross over: something elastic "
                "in series with the friction, as a slider or an adapter between the sensors; measure the twist at the "
                "component itself, or fit a slider"
            )
        )
    return found


def _motion(loop: TorqueLoop, applied: Applied, *, sine: bool) -> list[NoteOrText]:
    """Remarks on inertia and lateness at the frequency of a loop."""
    omega, found = 2 * np.pi * loop.frequency, list[NoteOrText]()
    if not sine:
        if applied.inertia:
            found.append(
                warning("the twist is no sine: the torque of the inertia acts at its corners only and is not taken out")
            )
        return found
    lost = UNIT_INERTIA * omega**2
    if not applied.inertia and lost > TOLD * loop.storage_stiffness.value:
        found.append(
            f"inertia that moves between meter and component is not taken out: at {loop.frequency:.3g} Hz each "
            f"{UNIT_INERTIA:g} kg m^2 lowers the stiffness by {lost:.3g} N m/rad"
        )
    wide = loop.storage_stiffness.value * loop.amplitude.value * np.sin(omega * UNIT_DELAY)
    if not applied.delay and wide > TOLD * abs(loop.friction.value):
        found.append(
            f"lateness of the torque is not taken out: at {loop.frequency:.3g} Hz each {1e3 * UNIT_DELAY:g} ms narrows "
            f"the loop, {wide:.3g} N m of the friction torque {loop.friction.value:.3g} N m"
        )
    return found


def _drift(loop: TorqueLoop, applied: Applied) -> list[NoteOrText]:
    """Remarks on the torque that drifts from cycle to cycle."""
    size, half = abs(loop.drift.value), loop.drift.half_width
    if applied.drift or half is None or size <= half:
        return []
    told = f"the torque drifts by {loop.drift.value:.3g} N m a cycle"
    if size > abs(loop.friction.value):
        return [
            warning(
                f"{told}, more than the friction torque {loop.friction.value:.3g} N m: take the drift out, and let the "
                "meter warm up or run faster"
            )
        ]
    return [f"{told}: the torque offset means nothing beyond it"]


def _steps(loop: TorqueLoop, record: LoopRecord, step: float) -> list[NoteOrText]:
    """Remark on steps of the encoder."""
    steepest = max((one.stiffness.value for one in loop.stages), default=loop.secant_stiffness.value)
    over = step * steepest / record.torque_noise if step else 0.0
    if over <= HARMLESS_STEP:
        return []
    return [
        f"steps of the twist of {np.degrees(step):.3g} deg are {over:.3g} times the noise of the torque and repeat "
        "every cycle: the intervals have a term from shifting them"
    ]


def _sides(loop: TorqueLoop) -> list[NoteOrText]:
    """Remark on drive and coast that differ."""
    found: list[NoteOrText] = []
    for drive, coast in zip(loop.side("drive"), loop.side("coast"), strict=False):
        for name in ("stiffness", "begins", "friction"):
            text = _difference(drive, coast, name)
            found += [text] if text else []
    if loop.side("drive") and loop.side("coast") and len(loop.side("drive")) != len(loop.side("coast")):
        found.append("drive and coast have different numbers of stages")
    return found


def _difference(drive: LoopStage, coast: LoopStage, name: str) -> str:
    one, other = getattr(drive, name), getattr(coast, name)
    if one is None or other is None or one.half_width is None or other.half_width is None:
        return ""
    apart = abs(one.value - other.value)
    # Stages are many: only differences beyond both intervals together are told.
    if apart <= one.half_width + other.half_width or apart <= TOLD * max(abs(one.value), abs(other.value)):
        return ""
    return f"stage {drive.number}: {name} differs, {one.value:.4g} in drive and {other.value:.4g} in coast"


def friction_build_up(loop: TorqueLoop) -> float:
    """Share of the swing behind a reversal until the distance of the branches is nine tenths of the friction torque."""
    width = (loop.upper - loop.lower) / 2
    low = np.argmax(width >= 0.9 * loop.friction.value)
    high = np.argmax(width[::-1] >= 0.9 * loop.friction.value)
    return float(max(low, high)) / len(width)
