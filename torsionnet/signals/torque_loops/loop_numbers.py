"""Numbers of a loop out of its samples: stages, free play and friction, secant, loss and first harmonic.

Every cycle is evaluated alone, and intervals are those of the mean over cycles, by Student's distribution. Residuals
of all samples would tell too little: a drifting meter moves all samples of a cycle together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from torsionnet.signals.recording import FloatArray
from torsionnet.signals.torque_loops.cycles import (
    END_SHARE,
    FEWEST,
    Cycle,
    end_value,
    even_bounds,
    noise_of,
    rising_of,
    smooth_twist,
)
from torsionnet.signals.torque_loops.joined_lines import JoinedLines, LoopSamples, fitted, joined_lines, with_breaks
from torsionnet.signals.torque_loops.loop_result import LoopStage, LoopValue, TorqueLoop

AT_REVERSAL = 0.02
"""Share of the swing next to a reversal that the branches leave out, as the torque turns from stick to slip there."""
AT_BREAK = 0.03
"""Share of the amplitude on either side of a break that the friction torque of a stage leaves out."""
FREE = 0.01
"""Largest stiffness of free play over that of the piece behind it."""
DOUBT = 4.0
"""Most by which the interval of a slope may widen the stiffness of free play, as a multiple of it."""
SAME_SLOPE = 0.03
"""Smallest change of slope, as a share of the larger, that makes a stage."""
REPEATED = 0.99
"""Confidence with which the change of slope of a stage repeats from cycle to cycle, where at least three tell."""
TIES = 1e-9
"""Noise of a signal that shows none, as a share of its range."""
BEHIND = 0.04
"""Share of the swing behind a reversal in which the torque is looked at as it crosses to the other branch."""
NEXT = 4
"""Samples at a reversal whose distance is that within which a torque jumps."""
HELD, LONG_HELD = 0.005, 0.1
"""Shares of the swing from the highest twist within which it is held, and of a cycle for which it is held at least: a
sine stays there for a twentieth."""
ONE_FRICTION = 0.25
"""Spread of the friction torques of pieces over the largest below which they may be one."""
GRID = 201
"""Number of twists of the common grid of both branches."""
CONFIDENCE = 0.95


@dataclass(frozen=True, eq=False)
class LoopRecord:
    """Torque in N m and twist in rad over time in s, each (n,), with the noise of both."""

    time: FloatArray
    torque: FloatArray
    twist: FloatArray
    torque_noise: float
    twist_noise: float

    @classmethod
    def of(cls, time: FloatArray, torque: FloatArray, twist: FloatArray) -> LoopRecord:
        """Record with noise read from its samples."""
        noises = (max(noise_of(signal), TIES * float(np.ptp(signal))) for signal in (torque, twist))
        return cls(time, torque, twist, *noises)

    def branches(self, cycles: Sequence[Cycle]) -> LoopSamples:
        """Samples of a run of cycles away from their reversals."""
        places, sense = rising_of(cycles)
        twist = self.twist[places]
        low, high = float(np.mean([cycle.low for cycle in cycles])), float(np.mean([cycle.high for cycle in cycles]))
        away = AT_REVERSAL * (high - low)
        # Chosen without the noise: samples that noise puts beyond a threshold make steep flanks steeper.
        smooth = np.concatenate([smooth_twist(self.twist, cycle) for cycle in cycles])
        inside = (smooth > low + away) & (smooth < high - away)
        samples = LoopSamples(twist, self.torque[places], sense, self.twist_noise, self.torque_noise)
        return samples.chosen(inside)


def student_quantile(freedom: int, confidence: float = CONFIDENCE) -> float:
    """Quantile of Student's distribution for the half width of an interval.

    >>> round(student_quantile(4), 3)
    2.776
    """
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + confidence / 2))


def pooled_branches(record: LoopRecord, cycles: Sequence[Cycle]) -> LoopSamples:
    """Samples of all cycles of a run, each without its mean torque: else the drift between them is noise."""
    parts = [_without_mean(record.branches([cycle])) for cycle in cycles]
    twist, torque, sense = (
        np.concatenate(column)
        for column in zip(*((part.twist, part.torque, part.sense) for part in parts), strict=True)
    )
    return LoopSamples(twist, torque, sense, record.twist_noise, record.torque_noise)


def _without_mean(samples: LoopSamples) -> LoopSamples:
    return replace(samples, torque=samples.torque - samples.torque.mean())


def common_lines(record: LoopRecord, cycles: Sequence[Cycle]) -> tuple[JoinedLines, bool]:
    """Joined lines of all cycles of a run, with the breaks that each of them repeats, and whether the line bends on.

    Noise that wanders makes breaks in single cycles, which an F test over all samples takes for true.
    """
    parts = [_without_mean(record.branches([cycle])) for cycle in cycles]
    pooled = pooled_branches(record, cycles)
    lines, bends = joined_lines(pooled, len(cycles))
    while len(lines.breaks):
        # The break that single cycles repeat least, by size and by Student's test, goes, until all are repeated.
        each = [fitted(lines, samples)[0] for samples in parts]
        changes = np.array([np.diff(joined.slopes) for joined in each])
        weak = np.abs(changes.mean(axis=0)) / np.maximum(np.abs(lines.slopes[:-1]), np.abs(lines.slopes[1:]))
        surely = np.full(len(weak), np.inf)
        if len(parts) > 2:
            scatter = changes.std(axis=0, ddof=1) / np.sqrt(len(parts)) * student_quantile(len(parts) - 1, REPEATED)
            surely = np.abs(changes.mean(axis=0)) / np.maximum(scatter, 1e-300)
        worst = np.minimum(weak / SAME_SLOPE, surely)
        if worst.min() >= 1:
            break
        steepness = lines.slopes[lines.piece(pooled.twist)]
        kept, _ = with_breaks(np.delete(lines.breaks, int(worst.argmin())), pooled, steepness)
        lines, bends = fitted(kept, pooled)[0], False
    return lines, bends


def line_numbers(lines: JoinedLines, samples: LoopSamples, flat: int | None) -> dict[str, float]:
    """Stages, free play, friction and torque offset of joined lines, by names as "drive 2 stiffness", SI units.

    Samples give the friction torque of a piece: the mean distance of both branches, breaks left out. ``flat`` is the
    number of the piece that is free play.
    """
    low, high = float(samples.twist.min()), float(samples.twist.max())
    ends = np.r_[low, lines.breaks, high]
    has_zero = low < 0 < high
    above, below = _home_pieces(lines, flat, AT_BREAK * (high - low) / 2)
    numbers: dict[str, float] = {}
    if flat is not None:
        numbers["free play"] = float(lines.breaks[flat] - lines.breaks[flat - 1])
    if has_zero:
        numbers["torque offset"] = float(lines.torque(np.zeros(1))[0])
    friction = _friction(lines, samples, AT_BREAK * (high - low) / 2, ends)
    last = len(lines.slopes)
    sides = {"drive": range(above, last), "coast": range(below, -1, -1)}
    if not has_zero:
        sides.pop("coast" if low + high > 0 else "drive")
    for side, pieces in sides.items():
        for number, piece in enumerate(pieces, 1):
            name = f"{side} {number}"
            numbers[f"{name} stiffness"] = float(lines.slopes[piece])
            numbers[f"{name} friction"] = float(friction[piece])
            if number > 1 or flat is not None:  # behind free play the first one as well
                numbers[f"{name} begins"] = abs(float(ends[piece] if side == "drive" else ends[piece + 1]))
    # Over the whole loop each piece counts by its samples; of one friction also by how well they tell the torque there.
    weights = np.bincount(lines.piece(samples.twist), minlength=last).astype(float)
    if np.ptp(friction) < ONE_FRICTION * np.abs(friction).max():
        weights /= samples.torque_noise**2 + (lines.slopes * samples.twist_noise) ** 2
    numbers["friction"] = float(friction @ weights / weights.sum())
    return _with_both(numbers)


def _home_pieces(lines: JoinedLines, flat: int | None, near: float) -> tuple[int, int]:
    """Pieces from which stages count up and down: those beside free play or a break at zero twist, or the one there."""
    if flat is not None:
        return flat + 1, flat - 1
    for place, at in enumerate(lines.breaks.tolist()):
        if abs(at) < near:
            return place + 1, place
    home = int(lines.piece(np.zeros(1))[0])
    return home, home


def flat_piece(each: Sequence[JoinedLines]) -> int | None:
    """Piece between two others without stiffness, free play, by the lines of all cycles of a run.

    Noise of the torque tilts a short piece: it is flat where its mean slope over the cycles may be that of free play,
    and is known to a few of it.
    """
    slopes = np.array([joined.slopes for joined in each])
    mean, doubt = slopes.mean(axis=0), np.zeros(slopes.shape[1])
    if len(each) > 1:
        # 95 % interval of the mean slope: Student's quantile times the standard deviation over sqrt(n).
        doubt = student_quantile(len(each) - 1) * slopes.std(axis=0, ddof=1) / np.sqrt(len(each))
    for piece in range(1, len(mean) - 1):
        free = FREE * min(mean[piece - 1], mean[piece + 1])
        if abs(mean[piece]) < free + min(doubt[piece], DOUBT * free):
            return piece
    return None


def _friction(lines: JoinedLines, samples: LoopSamples, away: float, ends: FloatArray) -> FloatArray:
    """Friction torque of each piece in N m: half of the distance of branches, away from breaks, or that fitted."""
    twist = samples.twist
    friction = lines.friction.copy()
    # Steep pieces: the friction torque is fitted by distance in both channels, torque alone is biased by twist noise.
    if np.abs(lines.slopes).max() * samples.twist_noise > samples.torque_noise:
        return friction
    rest = samples.torque - lines.torque(twist)
    for piece, (low, high) in enumerate(pairwise(ends)):
        inside = (twist > low + away * (piece > 0)) & (twist < high - away * (piece < len(friction) - 1))
        up, down = (rest[inside & (samples.sense == sense)] for sense in (1.0, -1.0))
        if len(up) and len(down):
            friction[piece] = (up.mean() - down.mean()) / 2
    return friction


def _with_both(numbers: dict[str, float]) -> dict[str, float]:
    """Numbers with the means of drive and coast, where both have as many stages."""
    sides = {side: [name[6:] for name in numbers if name.startswith(side)] for side in ("drive", "coast")}
    if not sides["drive"] or sides["drive"] != sides["coast"]:
        return numbers
    both = {name: (numbers[f"drive {name}"] + numbers[f"coast {name}"]) / 2 for name in sides["drive"]}
    return {**numbers, **{f"both {name}": value for name, value in both.items()}}


def cycle_numbers(record: LoopRecord, cycle: Cycle, begin: float, end: float) -> dict[str, float]:
    """Numbers of a cycle as a whole, by name, SI units: amplitude, secant, loss, first harmonic."""
    inside = slice(cycle.first, cycle.last + 1)
    twist, torque = record.twist[inside], record.torque[inside]
    reach = min(max(FEWEST, int(END_SHARE * (cycle.last - cycle.first))), (cycle.top - cycle.first) // 2)
    away = max(1, reach // 5)  # the reversal is known to a few samples
    # At a tip the torque is that at the end of the branch that leads there; behind it the friction turns.
    top, low = (end_value(record.torque[at - 2 * reach : at - away], beyond=away + 1) for at in (cycle.top, cycle.last))
    amplitude = cycle.swing / 2
    secant = (top - low) / (2 * amplitude)
    closed = np.r_[twist, twist[0]], np.r_[torque, torque[0]]
    loss = float(np.trapezoid(closed[1], closed[0]))
    count = cycle.last - cycle.first
    times = begin + (end - begin) * np.arange(count) / count
    turn = np.exp(-2j * np.pi * np.arange(count) / count)
    torques, twists = (np.interp(times, record.time, values) for values in (record.torque, record.twist))
    harmonic = complex((torques @ turn) / (twists @ turn))
    return {
        "amplitude": amplitude,
        "mean twist": float(twists.mean()),
        "mean torque": float(torques.mean()),
        "secant": secant,
        "loss": loss,
        "eta_s": loss / (np.pi * secant * amplitude**2),
        "storage": harmonic.real,
        "loss stiffness": harmonic.imag,
        "eta_1": harmonic.imag / harmonic.real,
    }


def run_numbers(
    record: LoopRecord, cycles: Sequence[Cycle], lines: JoinedLines
) -> tuple[list[dict[str, float]], list[JoinedLines]]:
    """Numbers of each cycle of a run by name, and its joined lines."""
    bounds = even_bounds(cycles, record.time)
    parts = [record.branches([cycle]) for cycle in cycles]
    each = [fitted(replace(lines, level=lines.level + float(samples.torque.mean())), samples)[0] for samples in parts]
    flat = flat_piece(each)
    numbers = [
        {**line_numbers(mine, samples, flat), **cycle_numbers(record, cycle, begin, end)}
        for mine, samples, cycle, (begin, end) in zip(each, parts, cycles, pairwise(bounds.tolist()), strict=True)
    ]
    return numbers, each


def drift_of(lines: Sequence[JoinedLines]) -> LoopValue:
    """Rise of the torque from a cycle to the next at the same twist in N m, by the levels of their lines."""
    levels = np.array([joined.level for joined in lines])
    return mean_value(np.diff(levels), 0.0) if len(levels) > 1 else LoopValue(0.0)


def mean_value(values: FloatArray, further: float) -> LoopValue:
    """Mean over cycles with its interval, to which a standard deviation that all cycles share is added."""
    count = len(values)
    if count < 2:
        return LoopValue(float(values[0]))
    half = student_quantile(count - 1) * float(values.std(ddof=1)) / np.sqrt(count)
    return LoopValue(float(values.mean()), float(np.hypot(half, student_quantile(10**6) * further)))


def loop_of(
    record: LoopRecord,
    cycles: Sequence[Cycle],
    speed: float | None,
    further: Mapping[str, float],
    of_cycles: tuple[list[dict[str, float]], list[JoinedLines], bool],
) -> TorqueLoop:
    """Loop of a run of cycles from the numbers and lines of each; ``further``: deviations that all cycles share."""
    numbers, lines, bends = of_cycles
    names = [name for name in numbers[0] if all(name in by_name for by_name in numbers)]
    value = {
        name: mean_value(np.array([by_name[name] for by_name in numbers]), further.get(name, 0.0)) for name in names
    }
    breaks = np.mean([joined.breaks for joined in lines], axis=0)
    grid, upper, lower = mean_branches(record, cycles, breaks)
    crossings = [crossing_of(record, *each) for each in zip(cycles, lines, strict=True)]
    bounds = even_bounds(cycles, record.time)
    return TorqueLoop(
        cycles=len(cycles),
        frequency=len(cycles) / float(bounds[-1] - bounds[0]),
        speed=speed,
        mean_torque=value["mean torque"].value,
        mean_twist=value["mean twist"].value,
        amplitude=value["amplitude"],
        stages=_stages(value),
        friction=value["friction"],
        free_play=value.get("free play"),
        torque_offset=value.get("torque offset"),
        secant_stiffness=value["secant"],
        loss=value["loss"],
        eta_s=value["eta_s"],
        storage_stiffness=value["storage"],
        loss_stiffness=value["loss stiffness"],
        eta_1=value["eta_1"],
        drift=drift_of(lines),
        twist=grid,
        upper=upper,
        lower=lower,
        spring_line=np.asarray(np.mean([joined.torque(grid) for joined in lines], axis=0)),
        crossing=mean_value(np.array(crossings), further.get("crossing", 0.0)),
        relaxation=_relaxation(record, cycles),
        bends=bends,
    )


def crossing_of(record: LoopRecord, cycle: Cycle, lines: JoinedLines) -> float:
    """Twist behind a reversal of a cycle in which the torque crosses to the other branch, by the area between, rad.

    A torque that jumps crosses within the distance of two samples, which is taken off; of one that crosses over many
    samples the area is right.
    """
    lengths, steps = [], []
    for at, sense, tip in ((cycle.first, 1.0, cycle.low), (cycle.top, -1.0, cycle.high)):
        smooth = sense * (record.twist[at : at + (cycle.last - cycle.first) // 4] - tip)
        near = np.arange(at, at + max(2, int(np.argmax(smooth > BEHIND * cycle.swing))))
        twist, torque = record.twist[near], record.torque[near]
        friction = lines.friction[lines.piece(twist)]
        past = np.maximum(sense * (twist - tip), 0.0)
        left = sense * (lines.torque(twist) - torque) + friction  # 2 M at the reversal, 0 behind it
        steps.append(float(np.diff(past[:NEXT]).mean()))  # there, as a sine turns slowly
        lengths.append(float(np.trapezoid(left, past)) / max(float(friction[0]), record.torque_noise))
    length, step = float(np.mean(lengths)), float(np.mean(steps))
    return length - (step if length <= step else step**2 / length)


def _relaxation(record: LoopRecord, cycles: Sequence[Cycle]) -> LoopValue | None:
    """Torque lost while the twist is held at its highest, N m; None where it is not held."""
    losses = []
    for cycle in cycles:
        near = np.flatnonzero(np.abs(record.twist[cycle.first : cycle.last] - cycle.high) < HELD * cycle.swing)
        if len(near) < LONG_HELD * (cycle.last - cycle.first):
            return None
        torque = record.torque[cycle.first + near]
        fifth = max(1, len(near) // 5)
        losses.append(torque[fifth : 2 * fifth].mean() - torque[-fifth:].mean())
    return mean_value(np.array(losses), 0.0)


def _stages(value: Mapping[str, LoopValue]) -> tuple[LoopStage, ...]:
    stages = []
    for name in value:
        side, _, rest = name.partition(" ")
        number, _, what = rest.partition(" ")
        if what == "stiffness" and number.isdigit():
            own = f"{side} {number}"
            stages.append(
                LoopStage(side, int(number), value[name], value.get(f"{own} begins"), value[f"{own} friction"])
            )
    return tuple(stages)


def mean_branches(
    record: LoopRecord, cycles: Sequence[Cycle], breaks: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Common grid of twists in rad, breaks in it, and the mean torques in N m of rising and falling branches there."""
    samples = record.branches(cycles)
    ends = float(samples.twist.min()), float(samples.twist.max())
    grid = np.union1d(np.linspace(*ends, GRID), breaks[(breaks > ends[0]) & (breaks < ends[1])])
    branches = []
    for sense in (1.0, -1.0):
        mine = samples.sense == sense
        order = np.argsort(samples.twist[mine], kind="stable")
        twist, torque = samples.twist[mine][order], samples.torque[mine][order]
        # Means of as many neighbours as there are cycles: one of each.
        width = min(len(cycles), len(twist))
        weights = np.ones(width) / width
        branches.append(np.interp(grid, np.convolve(twist, weights, "valid"), np.convolve(torque, weights, "valid")))
    return grid, branches[0], branches[1]
