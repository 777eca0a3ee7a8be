"""Corrections of loops of torque over twist, for inertia, drift and steps, and remarks on what spoils them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.phrases import phrase
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.torque_loops.cycles import ALIKE, Cycle, cycle_at, even_bounds, rising_of, smooth_twist
from torsionnet.signals.torque_loops.joined_lines import JoinedLines, fitted, with_breaks
from torsionnet.signals.torque_loops.loop_numbers import (
    LoopRecord,
    crossing_of,
    cycle_numbers,
    flat_piece,
    line_numbers,
    pooled_branches,
)
from torsionnet.signals.torque_loops.loop_result import LoopStage, LoopValue, TorqueLoop

# Remarks on what spoils loops of torque over twist: what was corrected, and what was not.

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


# Corrections of loops of torque over twist: inertia of the moving side, drift of the meter, steps of the encoder.

INERTIA = Value("an inertia between torque meter and component", "inertia", exclusive=True)
STEP = Value("a step of the twist", "angle", exclusive=True)
HARMONICS = 3
"""Harmonics of a sine that its acceleration is taken from."""
SINE = 0.02
"""Largest part of a twist, as a share of its root mean square, that its first harmonics leave of a sine."""
STEP_BREAK = 3.0
"""Change of slope at a break over the deviation by steps from which it is no work of the steps."""
SHIFTS = 8
"""Number of places of the steps of an encoder with which a loop is evaluated again."""
STANDING = 0.2
"""Smallest share of samples that repeat the one before, of an encoder whose steps are seen."""
EVEN = 0.01
"""Largest deviation of the distances between these values from whole steps."""


def is_sine(record: LoopRecord, cycles: Sequence[Cycle]) -> bool:
    """Whether the twist of a run of cycles is a sine, rather than a triangle."""
    places, _ = rising_of(cycles)
    columns, _ = _harmonics(record, cycles)
    twist = record.twist[places] - record.twist[places].mean()
    left = twist - columns @ np.linalg.lstsq(columns, twist, rcond=None)[0]
    noise = np.hypot(SINE * twist.std(), 2 * record.twist_noise)
    return bool(left.std() < noise)


def _harmonics(record: LoopRecord, cycles: Sequence[Cycle]) -> tuple[FloatArray, FloatArray]:
    """Sines and cosines of the first harmonics over the samples of a run, and their second derivatives."""
    places, _ = rising_of(cycles)
    bounds = even_bounds(cycles, record.time)
    omega = 2 * np.pi * len(cycles) / (bounds[-1] - bounds[0])
    angle = omega * (record.time[places] - bounds[0])
    columns = [part(n * angle) for n in range(1, HARMONICS + 1) for part in (np.cos, np.sin)]
    # The second derivative of sin(n omega t) is -(n omega)^2 sin(n omega t).
    square = [-((n * omega) ** 2) for n in range(1, HARMONICS + 1) for _ in range(2)]
    matrix = np.stack([np.ones_like(angle), *columns], axis=1)
    return matrix, matrix * np.r_[0.0, square]


def without_inertia(record: LoopRecord, cycles: Sequence[Cycle], inertia: float) -> LoopRecord:
    """Record without the torque J gamma'' of a moving inertia in kg m^2 in a run of cycles, whose twist is a sine.

    A meter on the far side of the inertia reads S + M + J gamma''. A sine at omega has lost J omega^2 of its stiffness.
    """
    places, _ = rising_of(cycles)
    columns, bent = _harmonics(record, cycles)
    sizes = np.linalg.lstsq(columns, record.twist[places], rcond=None)[0]
    torque = record.torque.copy()
    torque[places] -= inertia * (bent @ sizes)
    return replace(record, torque=torque)


def without_drift(record: LoopRecord, cycles: Sequence[Cycle], lines: Sequence[JoinedLines]) -> LoopRecord:
    """Record in which every cycle is rid of the straight line that its torque drifts along from cycle to cycle."""
    levels = np.array([line.level for line in lines])
    # From the same twist a cycle apart: the mean of both neighbours, at the ends of one.
    rates = np.gradient(levels) if len(levels) > 1 else np.zeros(1)
    torque = record.torque.copy()
    for cycle, rate in zip(cycles, rates.tolist(), strict=True):
        share = np.arange(cycle.last - cycle.first) / (cycle.last - cycle.first)
        torque[cycle.first : cycle.last] -= rate * (share - 0.5)
    return replace(record, torque=torque)


def encoder_step(twist: FloatArray) -> float:
    """Step of the encoder in rad that a twist (n,) shows, which stands still in between; 0: none is seen.

    >>> round(encoder_step(np.round(np.sin(np.arange(900) / 90) / 0.05) * 0.05), 6)
    0.05
    """
    values = np.unique(np.round(twist / np.ptp(twist), 9)) * np.ptp(twist)
    if len(values) < 3 or np.mean(np.diff(twist) == 0) < STANDING:
        return 0.0
    gaps = np.diff(values)
    step = float(np.median(gaps))
    steps = gaps / step
    return step if np.abs(steps - np.round(steps)).max() < EVEN and steps.min() > 0.5 else 0.0


def stepped_loops(
    record: LoopRecord, cycle: Cycle, lines: JoinedLines, step: float
) -> Iterator[tuple[LoopRecord, Cycle]]:
    """Loops of a cycle along joined lines without noise, seen without steps, then by an encoder with a step in rad.

    Steps repeat every cycle, so that cycles agree with each other and are wrong. Here they lie at several places.
    """
    places, sense = rising_of([cycle])
    top, last = cycle.top - cycle.first, len(places) - 1
    smooth = smooth_twist(record.twist, cycle)
    smooth_record = replace(record, time=record.time[places], twist=smooth, torque=lines.loop(smooth, sense))
    shifts = np.arange(SHIFTS) / SHIFTS * step
    stepped = [smooth, *(np.round((smooth + shift) / step) * step - shift for shift in shifts)]
    for twist in stepped:
        yield replace(smooth_record, twist=twist), cycle_at(twist, 0, top, last)


def step_deviations(record: LoopRecord, cycle: Cycle, each: Sequence[JoinedLines], step: float) -> dict[str, float]:
    """Deviation of each number of a loop by steps of the encoder in rad, root mean square over places of the steps.

    ``each``: lines of all cycles of the run, of which ``cycle`` is the first.
    """
    lines, flat = each[0], flat_piece(each)
    true, *others = (_numbers(seen, own, lines, flat) for seen, own in stepped_loops(record, cycle, lines, step))
    return {
        name: float(np.sqrt(np.mean([(again.get(name, value) - value) ** 2 for again in others])))
        for name, value in true.items()
    }


def _numbers(record: LoopRecord, cycle: Cycle, lines: JoinedLines, flat: int | None) -> dict[str, float]:
    samples = record.branches([cycle])
    begin, end = float(record.time[0]), float(2 * record.time[-1] - record.time[-2])
    numbers = line_numbers(fitted(lines, samples)[0], samples, flat) | cycle_numbers(record, cycle, begin, end)
    return {**numbers, "crossing": crossing_of(record, cycle, lines)}


def without_stepped_breaks(record: LoopRecord, cycles: Sequence[Cycle], lines: JoinedLines, step: float) -> JoinedLines:
    """Joined lines without the breaks that steps of the encoder in rad may make, the least certain first."""
    pooled = pooled_branches(record, cycles)
    while len(lines.breaks):
        seen = [stepped.branches([own]) for stepped, own in stepped_loops(record, cycles[0], lines, step)]
        slopes = np.array([fitted(lines, samples)[0].slopes for samples in seen])
        spread = np.sqrt(np.mean((slopes[1:] - slopes[0]) ** 2, axis=0))
        surely = np.abs(np.diff(lines.slopes)) / np.maximum(np.hypot(spread[:-1], spread[1:]), 1e-300)
        if surely.min() >= STEP_BREAK:
            break
        breaks = np.delete(lines.breaks, int(surely.argmin()))
        lines, _ = with_breaks(breaks, pooled, lines.slopes[lines.piece(pooled.twist)])
    return lines
