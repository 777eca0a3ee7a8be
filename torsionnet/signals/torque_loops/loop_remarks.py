"""Remarks on what spoils loops of torque over twist: what was corrected, and what was not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.phrases import phrase
from torsionnet.signals.torque_loops.cycles import ALIKE
from torsionnet.signals.torque_loops.loop_numbers import LoopRecord
from torsionnet.signals.torque_loops.loop_result import LoopStage, LoopValue, TorqueLoop

TOLD = 0.005
"""Share of stiffness or friction from which an effect is told."""
UNIT_INERTIA, UNIT_DELAY = 0.01, 1e-3
"""Inertia in kg m^2 and delay in s for which effects are told that nobody has stated."""
HARMLESS_STEP = 3.0
"""Step of the twist as a torque over the noise of the torque up to which it does no harm."""
FASTER = 1.2
"""Smallest ratio of the frequencies of two loops that tell apart what depends on speed."""
BUILD_UP = 0.05
"""Share of the swing behind a reversal within which the friction torque has to be there."""
VISCOUS = 0.05
"""Part of the friction torque that follows the rate of a sine from which it is told."""
CROSSING = 0.002
"""Twist over the amplitude within which the torque may cross over without a word."""


@dataclass(frozen=True)
class Applied:
    """Corrections asked for: delay of the torque in s, inertia in kg m^2, drift, and step of the twist in rad."""

    delay: float = 0.0
    inertia: float = 0.0
    drift: bool = False
    step: float | None = None

    def notes(self) -> tuple[str, ...]:
        """Notes on the corrections asked for."""
        notes = []
        if self.delay:
            notes.append(phrase("torque moved {delay:g} ms to earlier times", delay=1e3 * self.delay))
        if self.inertia:
            text = "torque without that of {inertia:g} kg m^2 that move with the twist"
            notes.append(phrase(text, inertia=self.inertia))
        if self.drift:
            notes.append("torque without a straight line in each cycle, by the same twist a cycle apart")
        return tuple(notes)


def loop_remarks(
    loop: TorqueLoop, record: LoopRecord, applied: Applied, step: float, *, sine: bool
) -> list[NoteOrText]:
    """Remarks on a loop: effects of inertia, delay, drift, steps and what is elastic, as far as not corrected."""
    remarks = [
        *_motion(loop, applied, sine=sine),
        *_drift(loop, applied),
        *_remark_on_steps(loop, record, step),
        *_sides(loop),
    ]
    if loop.cycles < 3:
        text = "{count} cycles behind the intervals, of which the first is left out: record five or more"
        remarks.append(phrase(text, count=loop.cycles))
    if loop.bends:
        remarks.append(
            "the spring line bends all along: stages are straight pieces laid through it, not stages of springs; "
            "secant, loss and first harmonic hold"
        )
    relaxed, half = loop.relaxation, loop.loss.half_width
    if relaxed is not None and abs(relaxed.value) > max(
        relaxed.half_width or math.inf, TOLD * abs(loop.friction.value)
    ):
        remarks.append(
            phrase(
                "where the twist is held at its reversals the torque falls by {fall:.2g} N m: creep; run at two speeds",
                fall=relaxed.value,
            )
        )
    if half is not None and loop.loss.value <= half:
        remarks.append(
            warning(
                phrase(
                    "no loss is seen, {loss:.2g} +- {half:.2g} J a cycle: nothing slips at this swing, as the coils of "
                    "an arc spring below their depth, and the stiffness is that of what sticks; swing further",
                    loss=loop.loss.value,
                    half=half,
                )
            )
        )
    return remarks


def series_remarks(loops: Sequence[TorqueLoop]) -> list[NoteOrText]:
    """Remarks on loops whose torque crosses over slowly behind a reversal, which those of arc springs do by themselves.

    Something elastic stands in series with the friction.
    """
    remarks: list[NoteOrText] = []
    for loop in loops:
        share, crossing, wide = friction_build_up(loop), loop.crossing, _width_by_rate(loop)
        half = crossing.half_width
        if share > BUILD_UP:
            remarks.append(
                warning(
                    phrase(
                        "behind a reversal the torque needs {share:.2g} % of the swing to cross over: something "
                        "elastic in series with the friction, as a slider or an adapter between the sensors; measure "
                        "the twist at the component itself, or fit a slider",
                        share=100 * share,
                    )
                )
            )
        elif loop.loss.value > (loop.loss.half_width or 0.0) and wide > VISCOUS * loop.friction.value:
            remarks.append(
                phrase(
                    "the loop is wider in its middle, as by friction that grows with speed: over a sine c = "
                    "{damping:.2g} N m s/rad; run at two speeds",
                    damping=wide / (2 * np.pi * loop.frequency * loop.amplitude.value),
                )
            )
        elif not loop.bends and half is not None and crossing.value > half + CROSSING * loop.amplitude.value:
            # The component stands still until what is in series has crossed the 2 M to a branch that rises by k.
            stiffness = 2 * loop.friction.value / crossing.value + loop.storage_stiffness.value
            remarks.append(
                warning(
                    phrase(
                        "behind a reversal the torque needs {crossing:.2g} deg to cross over, as behind "
                        "{stiffness:.2g} N m/rad in series between the sensors, which make the component {share:.2g} % "
                        "too soft, or by friction behind a spring; or the torque comes late: run at two speeds",
                        crossing=np.degrees(crossing.value),
                        stiffness=stiffness,
                        share=100 * loop.storage_stiffness.value / stiffness,
                    )
                )
            )
    return remarks


def _width_by_rate(loop: TorqueLoop) -> float:
    """Part in N m of half the distance of the branches that follows the rate of a sine, c omega a sqrt(1 - x^2)."""
    x = (loop.twist - loop.mean_twist) / loop.amplitude.value
    columns = np.stack([np.ones_like(x), np.sqrt(np.maximum(1 - x**2, 0.0))], axis=1)
    return float(np.linalg.lstsq(columns, (loop.upper - loop.lower) / 2, rcond=None)[0][1])


def _motion(loop: TorqueLoop, applied: Applied, *, sine: bool) -> list[NoteOrText]:
    """Remarks on inertia and lateness at the frequency of a loop."""
    omega, remarks = 2 * np.pi * loop.frequency, list[NoteOrText]()
    if not sine:
        if applied.inertia:
            remarks.append(
                warning("the twist is no sine: the torque of the inertia acts at its corners only and is not taken out")
            )
        return remarks
    lost = UNIT_INERTIA * omega**2
    if not applied.inertia and lost > TOLD * loop.storage_stiffness.value:
        remarks.append(
            phrase(
                "inertia that moves between meter and component is not taken out: at {frequency:.3g} Hz each "
                "{inertia:g} kg m^2 lowers the stiffness by {lost:.3g} N m/rad",
                frequency=loop.frequency,
                inertia=UNIT_INERTIA,
                lost=lost,
            )
        )
    wide = loop.storage_stiffness.value * loop.amplitude.value * np.sin(omega * UNIT_DELAY)
    if not applied.delay and wide > TOLD * abs(loop.friction.value):
        remarks.append(
            phrase(
                "lateness of the torque is not taken out: at {frequency:.3g} Hz each {delay:g} ms narrows the loop, "
                "{wide:.3g} N m of the friction torque {friction:.3g} N m",
                frequency=loop.frequency,
                delay=1e3 * UNIT_DELAY,
                wide=wide,
                friction=loop.friction.value,
            )
        )
    return remarks


def _drift(loop: TorqueLoop, applied: Applied) -> list[NoteOrText]:
    """Remarks on the torque that drifts from cycle to cycle."""
    size, half = abs(loop.drift.value), loop.drift.half_width
    if applied.drift or half is None or size <= half:
        return []
    if size > abs(loop.friction.value):
        return [
            warning(
                phrase(
                    "the torque drifts by {drift:.3g} N m a cycle, more than the friction torque {friction:.3g} N m: "
                    "take the drift out, and let the meter warm up or run faster",
                    drift=loop.drift.value,
                    friction=loop.friction.value,
                )
            )
        ]
    text = "the torque drifts by {drift:.3g} N m a cycle: the torque offset means nothing beyond it"
    return [phrase(text, drift=loop.drift.value)]


def _remark_on_steps(loop: TorqueLoop, record: LoopRecord, step: float) -> list[NoteOrText]:
    """Remark on steps of the encoder."""
    steepest = max((stage.stiffness.value for stage in loop.stages), default=loop.secant_stiffness.value)
    over = step * steepest / record.torque_noise if step else 0.0
    if over <= HARMLESS_STEP:
        return []
    return [
        phrase(
            "steps of the twist of {step:.3g} deg are {over:.3g} times the noise of the torque and repeat every cycle: "
            "the intervals have a term from shifting them",
            step=np.degrees(step),
            over=over,
        )
    ]


def _sides(loop: TorqueLoop) -> list[NoteOrText]:
    """Remark on drive and coast that differ."""
    remarks: list[NoteOrText] = []
    for drive, coast in zip(loop.side("drive"), loop.side("coast"), strict=False):
        for name in ("stiffness", "begins", "friction"):
            text = _difference(drive, coast, name)
            remarks += [text] if text else []
    if loop.side("drive") and loop.side("coast") and len(loop.side("drive")) != len(loop.side("coast")):
        remarks.append("drive and coast have different numbers of stages")
    return remarks


def sides_differ(loop: TorqueLoop) -> bool:
    """Whether stages of drive and coast differ in number, stiffness or place, beyond their intervals."""
    drive, coast = loop.side("drive"), loop.side("coast")
    pairs = zip(drive, coast, strict=False)
    return len(drive) != len(coast) or any(
        _difference(one, other, name) for one, other in pairs for name in ("stiffness", "begins")
    )


def _difference(drive: LoopStage, coast: LoopStage, name: str) -> str:
    driving, coasting = getattr(drive, name), getattr(coast, name)
    if driving is None or coasting is None or driving.half_width is None or coasting.half_width is None:
        return ""
    apart = abs(driving.value - coasting.value)
    # Stages are many: only differences beyond both intervals together are told.
    if apart <= driving.half_width + coasting.half_width or apart <= TOLD * max(
        abs(driving.value), abs(coasting.value)
    ):
        return ""
    text = "stage {number}: {quantity} differs, {drive:.4g} in drive and {coast:.4g} in coast"
    return phrase(text, number=drive.number, quantity=phrase(name), drive=driving.value, coast=coasting.value)


def friction_build_up(loop: TorqueLoop) -> float:
    """Share of the swing behind a reversal until the distance of the branches is nine tenths of the friction torque."""
    width = (loop.upper - loop.lower) / 2
    low = np.argmax(width >= 0.9 * loop.friction.value)
    high = np.argmax(width[::-1] >= 0.9 * loop.friction.value)
    return float(max(low, high)) / len(width)


def speed_remarks(loops: Sequence[TorqueLoop]) -> list[NoteOrText]:
    """Remarks on loops of one swing that were run at two speeds: friction that grows or falls, and inertia.

    Friction that grows with speed is viscous, its slope over the speed of the twist the damping; a width that grows
    with slowness is creep. A stiffness that falls as the square of the frequency is that of a moving inertia.
    """
    remarks: list[NoteOrText] = []
    for slow, fast in combinations(sorted(loops, key=lambda loop: loop.frequency), 2):
        alike = abs(slow.amplitude.value - fast.amplitude.value) < ALIKE * fast.amplitude.value
        alike = alike and abs(slow.mean_twist - fast.mean_twist) < ALIKE * fast.amplitude.value
        if alike and fast.frequency > FASTER * slow.frequency:
            remarks += [*_rates(slow, fast), *_inertia(slow, fast)]
    return remarks


def _rates(slow: TorqueLoop, fast: TorqueLoop) -> list[str]:
    change = _surely(slow.friction, fast.friction)
    if not change:
        return []
    if change < 0:
        text = (
            "from {slow:.3g} to {fast:.3g} Hz the friction torque falls by {change:.3g} N m: "
            "what grows with slowness is creep"
        )
        return [phrase(text, slow=slow.frequency, fast=fast.frequency, change=-change)]
    # k'' = c omega + 4 M/(pi a), whatever the course of the twist.
    damping = (fast.loss_stiffness.value - slow.loss_stiffness.value) / (2 * np.pi * (fast.frequency - slow.frequency))
    text = (
        "from {slow:.3g} to {fast:.3g} Hz the friction torque grows by {change:.3g} N m: a part of it is viscous, "
        "c = {damping:.2g} N m s/rad"
    )
    return [phrase(text, slow=slow.frequency, fast=fast.frequency, change=change, damping=damping)]


def _inertia(slow: TorqueLoop, fast: TorqueLoop) -> list[str]:
    change = _surely(slow.storage_stiffness, fast.storage_stiffness)
    if change >= 0:
        return []
    # k' = k - J omega^2: its difference between two frequencies gives J.
    inertia = -change / (2 * np.pi) ** 2 / (fast.frequency**2 - slow.frequency**2)
    return [
        phrase(
            "from {slow:.3g} to {fast:.3g} Hz the stiffness k' falls by {change:.3g} N m/rad, as by an inertia of "
            "{inertia:.3g} kg m^2 that moves between meter and component",
            slow=slow.frequency,
            fast=fast.frequency,
            change=-change,
            inertia=inertia,
        )
    ]


def _surely(first: LoopValue, second: LoopValue) -> float:
    """Change from one value to another where it is larger than both intervals, else 0."""
    change = second.value - first.value
    sure = first.half_width is not None and second.half_width is not None
    return change if sure and abs(change) > (first.half_width or 0.0) + (second.half_width or 0.0) else 0.0
