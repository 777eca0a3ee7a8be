"""Loops of torque over twist of a record of a component bench."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.calculus import without_delays
from torsionnet.signals.decimation import check_processable
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.torque_loops.arc_loops import arc_loops
from torsionnet.signals.torque_loops.corrections import (
    encoder_step,
    is_sine,
    step_deviations,
    without_drift,
    without_inertia,
    without_stepped_breaks,
)
from torsionnet.signals.torque_loops.cycles import SMALLEST_SWING, Cycle, cut_cycles, noise_of, repeated_cycles
from torsionnet.signals.torque_loops.loop_numbers import LoopRecord, common_lines, loop_of, run_numbers
from torsionnet.signals.torque_loops.loop_remarks import Applied, loop_remarks, series_remarks, speed_remarks
from torsionnet.signals.torque_loops.loop_result import TorqueLoop, TorqueLoops

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
