"""Loops of torque over twist of a record of a component bench, and the arc springs that several loops show.

Arc springs that loops at several amplitudes, mean torques and speeds show: k, mu psi, and m r^2/psi.

The secant stiffness and the loss of each loop follow from its amplitude, the torque at its top and the speed. While
coils are locked by friction both depend on the product k mu psi alone, and eta_s is 4/(3 pi): k and mu psi are told
apart only by a loop that moves all coils. The pressure m r^2 Omega^2/psi is told by loops at a speed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.phrases import phrase
from torsionnet.model.arc_spring.slow_loop import ArcSprings, SlowLoop, loop_from_top
from torsionnet.signals.calculus import without_delays
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import check_processable
from torsionnet.signals.torque_loops.cycles import SMALLEST_SWING, Cycle, cut_cycles, noise_of, repeated_cycles
from torsionnet.signals.torque_loops.loop_numbers import (
    LoopRecord,
    common_lines,
    loop_of,
    run_numbers,
    student_quantile,
)
from torsionnet.signals.torque_loops.loop_remarks import (
    Applied,
    encoder_step,
    is_sine,
    loop_remarks,
    series_remarks,
    speed_remarks,
    step_deviations,
    without_drift,
    without_inertia,
    without_stepped_breaks,
)
from torsionnet.signals.torque_loops.loop_result import LoopValue, TorqueLoop, TorqueLoops

# Arc springs that loops at several amplitudes, mean torques and speeds show: k, mu psi, and m r^2/psi.

ARC = 2.6
"""Arc angle in rad for which friction coefficients and masses are stated; loops only tell mu psi and m r^2/psi."""
RADIUS = 0.11
"""Radius in m for which masses are stated."""
USUAL_WINDING = 0.3
"""mu psi of greased springs on an arc of some 150 degrees, where loops do not tell it from k."""
USUAL_PRESSING = 0.004
"""m r^2/psi in kg m^2 of springs of passenger cars, where loops do not tell it."""
USUAL_SPREAD = (0.7, 1.1)
"""Standard deviations of ln mu psi and of ln m r^2/psi about what is usual: factors of two, and of three."""
MODEL_SHARE = 0.005
"""Share of stiffness and loss that the law itself may miss: springs are no continuum, speeds are never zero."""
ALIKE = 0.03
"""Largest root mean square of what the law misses of stiffness and loss, as a share, of loops of arc springs."""
TOLD_APART = 0.25
"""Largest standard deviation of ln k, or ln of the pressure, at which loops tell it."""
AT_END = 0.15
"""Share of the swing at the end of a branch through which a parabola is laid to find the torque at the tip."""


@dataclass(frozen=True)
class ArcLoops:
    """Arc springs that loops show, in SI units; values that loops do not tell have no interval.

    Attributes
    ----------
    stiffness, winding, pressing, product : LoopValue
        k in N m/rad, mu psi, m r^2/psi in kg m^2, and k mu psi in N m/rad.
    """

    stiffness: LoopValue
    winding: LoopValue
    pressing: LoopValue
    product: LoopValue

    def notes(self) -> tuple[str, ...]:
        """Notes that say what the loops show, and what they do not tell apart."""
        notes = [phrase("loops of arc springs: k mu psi is {product} N m/rad", product=_shown(self.product))]
        if self.winding.half_width is None:
            notes.append(
                phrase(
                    "the loops do not tell k from mu psi: with mu psi {winding:g} assumed k is "
                    "{stiffness:.4g} N m/rad; swing further, or about a lower torque",
                    winding=USUAL_WINDING,
                    stiffness=self.stiffness.value,
                )
            )
        else:
            text = "k is {stiffness} N m/rad and mu psi {winding}"
            notes.append(phrase(text, stiffness=_shown(self.stiffness), winding=_shown(self.winding)))
        if self.pressing.half_width is None:
            notes.append(
                "pressing by speed is not seen: run the loops at two speeds, and name the channel of the speed"
            )
        else:
            text = "m r^2/psi, by which speed presses the coils, is {pressing} kg m^2"
            notes.append(phrase(text, pressing=_shown(self.pressing)))
        return tuple(notes)


def _shown(value: LoopValue) -> str:
    return f"{value.value:.4g}" + ("" if value.half_width is None else f" +- {value.half_width:.2g}")


def arc_loops(loops: Sequence[TorqueLoop]) -> ArcLoops | None:
    """Arc springs that loops show, or None where they are no loops of arc springs.

    One law explains stiffness and loss of all loops of arc springs. They bend all along, which noise may hide in small
    swings, so that it is enough to see it in one of them.
    """
    from scipy.optimize import least_squares

    if not any(loop.bends for loop in loops) or any(abs(loop.mean_torque) <= 0 for loop in loops):
        return None
    cases = [_Case.of(loop) for loop in loops]
    speeds = any(case.speed for case in cases)
    usual = np.log([_product(cases[0]) / USUAL_WINDING, USUAL_WINDING, USUAL_PRESSING if speeds else 1e-12])
    free = 3 if speeds else 2

    def misses(values: FloatArray) -> FloatArray:
        # What loops do not tell stays near what is usual, and its spread there goes into all intervals.
        beside = (values[1:] - usual[1:free]) / np.array(USUAL_SPREAD)[: free - 1]
        return np.concatenate([*(case.misses(np.append(values, usual[free:])) for case in cases), beside])

    fit: Any = least_squares(misses, usual[:free], x_scale=0.1)
    logs = np.append(fit.x, usual[free:])
    if np.sqrt(np.mean(np.concatenate([case.shares(logs) for case in cases]) ** 2)) > ALIKE:
        return None
    freedom = max(1, 2 * len(cases) - 1)
    scatter = max(1.0, float(np.sqrt(2 * fit.cost / freedom))) * student_quantile(freedom)
    spread = np.linalg.pinv(fit.jac.T @ fit.jac)
    errors = np.append(np.sqrt(np.diag(spread)), np.zeros(3 - free))
    size = float(np.exp(logs[0] + logs[1]))
    product = LoopValue(size, size * scatter * float(np.sqrt(spread[:2, :2].sum())))
    is_told = errors[1] <= TOLD_APART
    if not is_told:
        logs[:2] = np.log([size / USUAL_WINDING, USUAL_WINDING])
    k, e, b = (
        LoopValue(float(np.exp(log)), float(np.exp(log) * scatter * error) if shown else None)
        for log, error, shown in zip(logs, errors, (is_told, is_told, errors[2] <= TOLD_APART), strict=True)
    )
    return ArcLoops(k, e, b if speeds else LoopValue(0.0), product)


def _product(case: _Case) -> float:
    """K mu psi of a loop whose coils are locked: k_s a = S (v - S/2) with S^2 = 2 k mu psi a and v^2 = u_t."""
    v = np.sqrt(max(case.top, 1e-12))
    root = v - np.sqrt(max(v**2 - 2 * case.secant * case.amplitude, 0.0))
    return float(max(root, 1e-9) ** 2 / (2 * case.amplitude))


@dataclass(frozen=True)
class _Case:
    """Numbers of a loop that arc springs have to explain, with standard deviations of both as shares."""

    amplitude: float
    top: float
    speed: float
    secant: float
    loss: float
    sure: tuple[float, float]

    @classmethod
    def of(cls, loop: TorqueLoop) -> _Case:
        sign = 1.0 if loop.mean_torque > 0 else -1.0
        # The rising branch ends at the top, the falling one of a coast loop.
        twist, branch = (loop.twist, loop.upper) if sign > 0 else (-loop.twist[::-1], -loop.lower[::-1])
        near = twist > twist[-1] - AT_END * (twist[-1] - twist[0])
        tip = (twist[0] + twist[-1]) / 2 + loop.amplitude.value  # branches leave out as much at either end
        top = float(np.polyval(np.polyfit(twist[near] - tip, branch[near], 2), 0.0))
        sure = [
            float(np.hypot(MODEL_SHARE, (quantity.half_width or 0.0) / (2 * quantity.value)))
            for quantity in (loop.secant_stiffness, loop.loss)
        ]
        return cls(
            loop.amplitude.value, top, loop.speed or 0.0, loop.secant_stiffness.value, loop.loss.value,
            (sure[0], sure[1]),
        )  # fmt: skip

    def _loop(self, logs: FloatArray) -> SlowLoop | None:
        k, e, b = np.exp(np.clip(logs, -40, 40)).tolist()
        springs = ArcSprings(k, ARC, e / ARC, b * ARC / RADIUS**2, RADIUS, self.speed)
        return loop_from_top(springs, self.amplitude, self.top)

    def shares(self, logs: FloatArray) -> FloatArray:
        """Deviations of secant stiffness and loss from those of the law, as shares."""
        loop = self._loop(logs)
        if loop is None:  # the flange leaves the springs
            return np.ones(2)
        return np.array([loop.secant_stiffness / self.secant - 1, loop.loss / self.loss - 1])

    def misses(self, logs: FloatArray) -> FloatArray:
        """Deviations over their standard deviations."""
        deviations: FloatArray = self.shares(logs) / np.array(self.sure)
        return deviations


# Loops of torque over twist of a record of a component bench.

FEWEST_CYCLES = 2
"""Fewest cycles that repeat each other: the first one is left out, running in."""


def loops(
    recording: Recording,
    torque: str,
    twist: str | tuple[str, str],
    *,
    speed_channel: str | None = None,
    delay: float = 0.0,
    inertia: float = 0.0,
    drift: bool = False,
    encoder_step: float | None = None,
) -> TorqueLoops:
    """Loops of torque over twist: stages, friction, free play, stiffness and loss, with intervals over cycles.

    Cycles are cut at the reversals of the twist. Those that follow each other and repeat make a loop, whose first
    cycle is left out. A torque is positive where it drives, with a positive twist.

    Parameters
    ----------
    recording : Recording
        Of a triangle or sine so slow that inertia is a correction.
    torque : str
        Channel of the torque.
    twist : str or (str, str)
        Channel of the twist, or those of the driving and the driven angle.
    speed_channel : str, optional
        Channel whose mean is the speed of a loop.
    delay : float, optional
        Time in s by which the torque comes late.
    inertia : float, optional
        Inertia in kg m^2 that moves between the meter and the component; its torque is taken out where the twist is a
        sine.
    drift : bool, optional
        Takes a straight line out of the torque of each cycle, by the same twist a cycle apart.
    encoder_step : float, optional
        Step of the twist in rad, which adds to the intervals; by default that which the record shows.

    Raises
    ------
    UsageError
        The twist does not reverse, or no two cycles repeat each other.

    Examples
    --------
    >>> import numpy as np
    >>> from torsionnet.signals.recording import Signal
    >>> time = np.arange(5000) / 1000
    >>> gamma = 0.1 * np.sin(2 * np.pi * time)
    >>> record = Recording((Signal("T", "torque", 500 * gamma + 3 * np.sign(np.cos(2 * np.pi * time))),
    ...     Signal("twist", "angle", gamma)), sampling_rate=1000)
    >>> (loop,) = loops(record, "T", "twist").loops
    >>> round(loop.side("both")[0].stiffness.value, 3), round(loop.friction.value, 3), round(loop.loss.value, 2)
    (500.0, 3.0, 1.2)
    """
    angles = (twist,) if isinstance(twist, str) else tuple(twist)
    chosen = recording.select([torque, *angles, *([speed_channel] if speed_channel else [])])
    check_processable(chosen)
    applied = Applied(delay, inertia, drift, encoder_step)
    remarked = list(_loops(without_delays(chosen, {torque: delay}), torque, angles, speed_channel, applied))
    every = tuple(loop for loop, _ in remarked)
    arcs = arc_loops(every)
    notes = [*(note for _, ours in remarked for note in ours), *speed_remarks(every)]
    if arcs is None:
        # What drifts beyond its friction crosses over nowhere.
        notes += series_remarks([loop for loop in every if drift or abs(loop.drift.value) <= abs(loop.friction.value)])
    else:
        notes += arcs.notes()
    return TorqueLoops(
        loops=every,
        torque=torque,
        twist="-".join(angles),
        title=recording.title,
        notes=(*applied.notes(), *_once(notes)),
    )


def _loops(
    record: Recording, torque: str, angles: Sequence[str], speed_channel: str | None, applied: Applied
) -> Iterator[tuple[TorqueLoop, list[NoteOrText]]]:
    """Loops of a record, each with its remarks."""
    twist = record[angles[0]].values - (record[angles[1]].values if len(angles) > 1 else 0.0)
    if record[torque].values.min() == record[torque].values.max():
        raise UsageError(f"{torque} is the same all the time: name the torque of the component", kind="unfit-channel")
    whole = LoopRecord.of(record.time, record[torque].values, twist)
    speeds = None if speed_channel is None else record[speed_channel].values
    for cycles in _runs(twist):
        yield _loop(whole, cycles, speeds, applied)


def _runs(twist: FloatArray) -> list[list[Cycle]]:
    """Runs of cycles that repeat each other, without the first cycle of each."""
    cycles = cut_cycles(twist, noise_of(twist))
    if not cycles:
        raise UsageError(
            "the twist does not go there and back again: a loop needs whole cycles, of which the first is left out; "
            "record a triangle or a sine of at least three cycles; of swings below "
            f"{SMALLEST_SWING:.0%} of the whole range, cut off the way to them",
            kind="no-reversal",
        )
    runs = [run for run in repeated_cycles(cycles) if len(run) >= FEWEST_CYCLES]
    if not runs:
        swings = ", ".join(f"{cycle.swing / 2:.3g}" for cycle in cycles[:6])
        raise UsageError(
            f"no two of {len(cycles)} cycles reverse at the same twists: amplitudes {swings} rad; "
            "hold each amplitude for at least three cycles",
            kind="no-reversal",
        )
    return [run[1:] for run in runs]


def _loop(
    record: LoopRecord, cycles: Sequence[Cycle], speeds: FloatArray | None, applied: Applied
) -> tuple[TorqueLoop, list[NoteOrText]]:
    """Loop of a run of cycles with the corrections asked for, and remarks on what else spoils it."""
    sine = is_sine(record, cycles)
    if applied.inertia and sine:
        record = without_inertia(record, cycles, applied.inertia)
    lines, bends = common_lines(record, cycles)
    step = encoder_step(record.twist) if applied.step is None else applied.step
    lines = without_stepped_breaks(record, cycles, lines, step) if step else lines
    numbers, each = run_numbers(record, cycles, lines)
    if applied.drift:
        record = without_drift(record, cycles, each)
        numbers, each = run_numbers(record, cycles, lines)
    further = step_deviations(record, cycles[0], each, step) if step else {}
    speed = None if speeds is None else float(speeds[cycles[0].first : cycles[-1].last].mean())
    loop = loop_of(record, cycles, speed, further, (numbers, each, bends))
    return loop, loop_remarks(loop, record, applied, step, sine=sine)


def _once(notes: Sequence[NoteOrText]) -> list[NoteOrText]:
    return list(dict.fromkeys(notes))
