"""Corrections of loops of torque over twist: inertia of the moving side, drift of the meter, steps of the encoder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.torque_loops.cycles import Cycle, cycle_at, even_bounds, rising_of, smooth_twist
from torsionnet.signals.torque_loops.joined_lines import JoinedLines, fitted, with_breaks
from torsionnet.signals.torque_loops.loop_numbers import (
    LoopRecord,
    crossing_of,
    cycle_numbers,
    flat_piece,
    line_numbers,
    pooled_branches,
)

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
