"""Mean angle of rotation of a shaft, without its vibration, from its angle over whole cycles.

Over a whole cycle the vibration of a shaft in steady running has no mean. With theta the angle read and t_k the ends
of its cycles, the mean angle phi is the smooth curve that has the same integral over each cycle as theta:
S, the spline through theta(t_k), and the derivative of the spline through the sums of the integrals of theta - S.
It is exact for steady running and for sweeps that a polynomial describes over a few cycles; what is slower than a
cycle (a governor that hunts) belongs to the mean rotation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import Note, NoteOrText
from torsionnet.signals.pulses import repaired_pulses
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.resampling import Recordings, blocks_in_order
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel_rotation import WheelRotation

# Ends of the cycles of a turning shaft, and the integrals of its angle over them.

KEPT_POINTS = 32
"""Points kept from one block to the next, so that its spline is as good at the seam as inside: the influence of an end
falls by 0.27 a point."""
SECANT_STEPS = 5
"""Steps of Newton's method to the end of a cycle, from the point beside it."""


@dataclass(frozen=True, eq=False)
class Cycles:
    """Cycles of a turning shaft.

    Attributes
    ----------
    ends : (n + 1,) array
        Times at which they begin, and the last one ends, s.
    angles : (n + 1,) array
        Angle read at these times, rad.
    integrals : (n,) array
        Integral of the angle since the begin of a cycle over its time, rad s.
    """

    ends: FloatArray
    angles: FloatArray
    integrals: FloatArray


def cycles_of(read: Iterator[tuple[FloatArray, FloatArray]], turn: float, name: str) -> Cycles:
    """Cycles of ``turn`` rad each from blocks of times in s and angles in rad, one after the other.

    Raises
    ------
    UsageError
        The shaft turns backwards.
    """
    times, angles = np.empty(0), np.empty(0)
    ends: list[float] = []
    at_ends: list[float] = []
    sums: list[float] = []
    first: float | None = None
    for more_times, more_angles in read:
        times, angles = np.concatenate([times, more_times]), np.concatenate([angles, more_angles])
        if len(times) < 2 * KEPT_POINTS:
            continue
        first = angles[0] if first is None else first
        used = _take(times, angles, len(times) - KEPT_POINTS, turn, first, (ends, at_ends, sums), name)
        times, angles = times[used:], angles[used:]
    if len(times) > 3:
        first = angles[0] if first is None else first
        _take(times, angles, len(times), turn, first, (ends, at_ends, sums), name)
    return Cycles(np.array(ends), np.array(at_ends), np.array(sums))


def _take(
    times: FloatArray, angles: FloatArray, count: int, turn: float, first: float,
    into: tuple[list[float], list[float], list[float]], name: str,
) -> int:  # fmt: skip
    """Append the cycles that end within the first ``count`` points; return how many points are no longer needed."""
    from scipy.interpolate import CubicSpline

    if angles[-1] <= angles[0]:
        raise UsageError(
            f"{name}: the angle falls: the shaft turns backwards there; say that the wheel is reversed",
            kind="turning-back",
        )
    ends, at_ends, sums = into
    # Vibration may turn the angle back for a while: a cycle ends where its mark is passed for the first time.
    highest = np.maximum.accumulate(angles[:count])
    begin = len(ends)
    last = int(np.floor((highest[-1] - first) / turn * (1 + 1e-12)))
    marks = first + turn * np.arange(begin, last + 1)
    if not len(marks):
        return 0
    spline = CubicSpline(times, angles)
    at = times[np.searchsorted(highest, marks - 1e-9 * turn).clip(0, count - 1)]
    # Newton's steps to theta(t) = mark, from the first point at or beyond it.
    for _ in range(SECANT_STEPS):
        at = np.clip(at - (spline(at) - marks) / spline(at, 1), times[0], times[-1])
    values = spline(at)
    integral = spline.antiderivative()
    if begin:
        at, values = np.concatenate([[ends[-1]], at]), np.concatenate([[at_ends[-1]], values])
    # Integral of the angle beyond that at a cycle's beginning: what repeats with the cycle adds a constant.
    whole = np.diff(integral(at)) - values[:-1] * np.diff(at)
    fresh = slice(1, None) if begin else slice(None)
    ends.extend(at[fresh].tolist())
    at_ends.extend(values[fresh].tolist())
    sums.extend(whole.tolist())
    return max(int(np.searchsorted(times, ends[-1])) - KEPT_POINTS, 0)


SPLINE_DEGREE = 5
"""Degree of the spline through the ends of cycles: a sweep whose acceleration changes over a cycle is followed, and
noise of single cycles is not yet amplified."""
NEWTON_STEPS = 4
"""Steps of Newton's method from a time interpolated between ends of cycles; each doubles the digits, and a sweep leaves
1e-3 at the first guess."""
FEWEST_CYCLES = 2
"""Least number of whole cycles from which a mean angle of rotation is made."""
READ_TOGETHER = 100_000
"""Pulses whose angle is read together, which limits the memory."""


@dataclass(frozen=True, eq=False)
class MeanRotation:
    """Mean angle of rotation of a shaft over time, between the ends of its first and its last whole cycle.

    Attributes
    ----------
    cycle : int
        Revolutions of a cycle.
    ends : (n + 1,) array
        Times of the ends of the cycles, s.
    angles : (n + 1,) array
        Mean angle at these times, rad.
    name : str
        Channel or wheel it was read from.
    notes : tuple of str or Note
    """

    cycle: int
    ends: FloatArray
    angles: FloatArray
    name: str
    notes: tuple[NoteOrText, ...] = ()
    _parts: tuple[Any, ...] = field(repr=False, default=())

    def angle(self, times: FloatArray) -> FloatArray:
        """Mean angle of rotation in rad at times in s, shape (n,)."""
        return np.asarray(sum(part(times) for part in self._parts))

    def speed(self, times: FloatArray) -> FloatArray:
        """Mean speed of rotation in rad/s at times in s, shape (n,)."""
        return np.asarray(sum(part(times, 1) for part in self._parts))

    def times_at(self, angles: FloatArray) -> FloatArray:
        """Times in s at which the mean angle of rotation in rad is reached, shape (n,)."""
        times = np.interp(angles, self.angles, self.ends)
        for _ in range(NEWTON_STEPS):
            times = times - (self.angle(times) - angles) / self.speed(times)
        return np.asarray(times)


def mean_rotation(
    source: WheelRotation | PulseChannel | Recordings, name: str = "", *, cycle: int = 2, per_turn: float = 1
) -> MeanRotation:
    """Mean angle of rotation of a shaft over time, without its vibration.

    Parameters
    ----------
    source : WheelRotation, PulseChannel, Recording or blocks of one
        The rotation of a wheel; pulses that come ``per_turn`` times in a turn; or a record with a channel of the
        angle (rad) or the speed (rad/s) of the shaft. Blocks are read one after the other.
    name : str, optional
        Channel of the record.
    cycle : int, optional
        Revolutions of a cycle, whose vibration has no mean: 2 of a four-stroke engine, so that half orders have none.
    per_turn : float, optional
        Pulses in a turn of the shaft.

    Raises
    ------
    UsageError
        The record has fewer than two whole cycles, the channel is neither angle nor speed, its angle jumps back, pulses
        cannot be repaired, or the shaft turns backwards.

    Examples
    --------
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> time = np.arange(10_001) / 1000
    >>> angle = 60 * time + 0.1 * np.cos(3 * 60 * time)
    >>> mean = mean_rotation(Recording((Signal("a", "angle", angle),), sampling_rate=1000), "a")
    >>> mean.speed(np.array([5.0])).round(4), (mean.angle(np.array([5.0])) - 300).round(6) + 0
    (array([60.]), array([0.]))
    """
    remarks: tuple[str, ...] = ()
    read: Iterator[tuple[FloatArray, FloatArray]]
    if isinstance(source, PulseChannel):
        label = source.name
        try:
            pulses = repaired_pulses(source.times)
        except UsageError as error:
            raise UsageError(f"{label}: {error}", kind=error.kind) from None
        read, remarks = iter([(pulses.times, np.asarray(2 * np.pi / per_turn * pulses.numbers, float))]), pulses.remarks
    elif isinstance(source, WheelRotation):
        read, label = _of_wheel(source), source.name
    else:
        read, label = _of_channel(source, name), name
    rotation = mean_of_cycles(cycles_of(read, 2 * np.pi * cycle, label), cycle, label)
    return replace(rotation, notes=(*rotation.notes, *(Note(remark, channel=label) for remark in remarks)))


def mean_of_cycles(cycles: Cycles, cycle: int, name: str) -> MeanRotation:
    """Mean angle of rotation in rad over time from the ends and the integrals of its cycles."""
    from scipy.interpolate import make_interp_spline

    count = len(cycles.integrals)
    if count < FEWEST_CYCLES:
        raise UsageError(
            f"{name}: {count} whole cycles of {cycle} revolutions; orders need {FEWEST_CYCLES} or more: record longer",
            kind="too-short",
        )
    degree = _odd_degree(count + 1)
    through = make_interp_spline(cycles.ends, cycles.angles, k=degree)
    # The ends of cycles carry vibration still: a second spline corrects the first to the integrals over the cycles.
    rest = cycles.integrals - _integrals(through, cycles.ends, cycles.angles)
    sums = make_interp_spline(cycles.ends, np.concatenate([[0.0], np.cumsum(rest)]), k=degree)
    parts = (through, sums.derivative())
    angles = through(cycles.ends) + parts[1](cycles.ends)
    if not (np.diff(angles) > 0).all():
        raise UsageError(
            f"{name}: the mean angle of rotation does not rise throughout; cut the record there", kind="turning-back"
        )
    said = f"orders over the mean angle of rotation, that of {name} with its vibration taken out over {cycle} turns"
    return MeanRotation(cycle, cycles.ends, np.asarray(angles), name, (said,), parts)


def _odd_degree(count: int) -> int:
    degree = min(SPLINE_DEGREE, count - 1)
    return degree - (degree % 2 == 0)


def _integrals(spline: Any, ends: FloatArray, angles: FloatArray) -> FloatArray:
    """Integral of spline - angle at the begin over each interval, exact for its degree."""
    # Three points of Gauss are exact up to degree five.
    places, weights = np.polynomial.legendre.leggauss(3)
    half, middle = np.diff(ends) / 2, (ends[1:] + ends[:-1]) / 2
    values = spline(middle[:, None] + half[:, None] * places) - angles[:-1, None]
    return np.asarray(half * (values @ weights))


def _of_wheel(rotation: WheelRotation) -> Iterator[tuple[FloatArray, FloatArray]]:
    for begin in range(0, len(rotation.times), READ_TOGETHER):
        times = rotation.times[begin : begin + READ_TOGETHER]
        yield times, rotation.angle(times)


def _of_channel(recordings: Recordings, name: str) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Times and angles of a channel, block by block; a speed is integrated."""
    turned, last = 0.0, None
    whole: Iterable[Any] = blocks_in_order(recordings)
    for number, (block, continued) in enumerate(whole):
        if number and not continued:
            raise UsageError(
                f"{name}: the blocks do not follow one another: track each record by itself", kind="unlike-results"
            )
        signal = block[name]
        if signal.quantity == "angle":
            back = np.flatnonzero(np.diff(signal.values) < -np.pi)
            if len(back):
                raise UsageError(
                    f"{name} jumps back by {-np.degrees(np.diff(signal.values)[back[0]]):.4g} deg at "
                    f"{block.time[back[0]]:.6g} s, as an angle that begins again each turn: count it on, or name a "
                    "channel of the speed",
                    kind="wrapped-count",
                )
            yield block.time, signal.values
            continue
        if signal.quantity != "velocity":
            raise UsageError(
                f"{name} is {signal.quantity or 'of no known quantity'}, and the rotation needs an angle or a speed of "
                f"the shaft: say --quantity {name}=velocity, with its unit, or name another channel",
                kind="unfit-channel",
            )
        # Trapezoidal rule, from the last sample of the block before on.
        values = signal.values if last is None else np.concatenate([[last], signal.values])
        steps = 0.5 * (values[1:] + values[:-1]) / block.sampling_rate
        angles = turned + np.cumsum(np.concatenate([[0.0] if last is None else [], steps]))
        turned, last = float(angles[-1]), float(signal.values[-1])
        yield block.time, angles


# Reference of phases: the angle of rotation is 0 at the top dead centre of a cylinder, or at a pulse.

LARGEST_SPREAD = np.radians(10)
"""Standard deviation of the angles at which pulses come above which they do not come once in each turn: play and
vibration of a shaft stay below it."""
FIRST_PULSE = "the tooth of the first pulse"
"""Name of tooth 0 of a wheel that has no mark, in the words of its rotation."""
CLOSEST_CAM = np.radians(5)
"""Angle between the cam's pulse and the mark up to which their order is left to chance: a cam turns with play."""


@dataclass(frozen=True)
class PhaseReference:
    """Angle of the reference shaft at which phases count from 0.

    Attributes
    ----------
    angle : float
        Mean angle of rotation at which it is 0, rad.
    words : str
        Where that is, in words; empty where it is only the begin of the record.
    turn_known : bool
        Whether it is known which turn of a cycle of several begins there. Else the sign of half orders is not known,
        and their phase is withheld.
    notes : tuple of str

    Examples
    --------
    >>> PhaseReference(0.5, "top dead centre of cylinder 1").turn_known
    True
    """

    angle: float = 0.0
    words: str = ""
    turn_known: bool = True
    notes: tuple[str, ...] = ()


def phase_reference(
    mean: MeanRotation,
    wheel: WheelRotation | None = None,
    *,
    index: PulseChannel | None = None,
    cam: PulseChannel | None = None,
    offset: float = 0.0,
    place: str = "",
    wheel_has_mark: bool = True,
) -> PhaseReference:
    """Phase reference of a record from a mark on the shaft: tooth 0 of a wheel with a gap, or the pulse of an index.

    Parameters
    ----------
    mean : MeanRotation
    wheel : WheelRotation, optional
        The wheel that the mean rotation was read from; its angle at the pulses of index and cam counts, with the
        vibration that shifts them.
    index : PulseChannel, optional
        Pulses once in each turn; takes the place of tooth 0.
    cam : PulseChannel, optional
        Pulses once in each cycle; the first mark after it begins the cycle. Without index and without a gap it is the
        mark itself.
    offset : float, optional
        Angle of the reference shaft from the mark to where phases count from 0, rad.
    place : str, optional
        What is there, as ``"top dead centre of cylinder 1"``.
    wheel_has_mark : bool, optional
        False leaves out tooth 0 of the wheel, as where the cam's pulse alone is the mark.

    Raises
    ------
    UsageError
        No mark, pulses that do not come once in a turn or cycle, or a cam's pulse at the mark.
    """
    turn = 2 * np.pi
    whole = turn * mean.cycle
    gap = wheel_has_mark and wheel is not None and wheel.zero != FIRST_PULSE
    if index is None and cam is None and not gap:
        if offset or place:
            raise UsageError(
                f"{mean.name} has no mark that tells its angle from turn to turn: for phases name a channel of pulses "
                "once per turn (--phase CHANNEL) or per cycle (--cam CHANNEL), or take a wheel with a gap",
                kind="ambiguous-tooth",
            )
        return PhaseReference(float(mean.angles[0]), "")
    mark, said = 0.0, f"{wheel.zero} of {mean.name}" if wheel is not None else mean.name
    notes: list[str] = []
    if index is not None:
        mark, spread = _mean_angle(_angles_at(index, mean, wheel), turn, f"{index.name} as index")
        said, notes = (
            f"the pulse of {index.name}",
            [f"pulses of {index.name} lie within {np.degrees(spread):.2g} deg of their mean angle"],
        )
    known = mean.cycle == 1
    if cam is not None:
        at, spread = _mean_angle(_angles_at(cam, mean, wheel), whole, f"{cam.name} as cam pulse")
        notes.append(f"pulses of {cam.name} lie within {np.degrees(spread):.2g} deg of their mean angle")
        if index is None and not gap:
            mark, said = at, f"the pulse of {cam.name}"
        else:
            # The cam comes once in a cycle, the mark in each turn: that mark begins the cycle which follows the cam.
            after = (mark - at) % turn
            # Where both come nearly together, scatter decides which is first.
            if min(after, turn - after) < max(CLOSEST_CAM, 3 * spread):
                raise UsageError(
                    f"{cam.name} comes {np.degrees(min(after, turn - after)):.2g} degrees from {said}: which of the "
                    "two is first cannot be told; take another index, or shift one of them",
                    kind="ambiguous-tooth",
                )
            mark, said = at + after, f"{said}, the first after {cam.name}"
        known = True
    if not known:
        notes.append("which turn of the cycle begins there is not known: phases of half orders are withheld")
    shift = f"{np.degrees(offset):.6g} deg after {said}" if offset else said
    words = f"{place}, {shift}" if place else shift
    return PhaseReference(float(mark + offset), words, known, tuple(notes))


def _angles_at(pulses: PulseChannel, mean: MeanRotation, wheel: WheelRotation | None) -> FloatArray:
    times = pulses.times
    begin, end = mean.ends[0], mean.ends[-1]
    if wheel is not None:
        begin, end = max(begin, wheel.times[0]), min(end, wheel.times[-1])
    times = times[(times >= begin) & (times <= end)]
    if not len(times):
        raise UsageError(
            f"{pulses.name} has no pulse while {mean.name} turns: are both on one clock?", kind="lost-pulses"
        )
    return mean.angle(times) if wheel is None else wheel.angle(times)


def _mean_angle(angles: FloatArray, period: float, name: str) -> tuple[float, float]:
    """Mean and standard deviation in rad of the angles of pulses that come once in each period."""
    # Mean and deviation on the circle: of R = |mean exp(j phi)| the deviation is sqrt(-2 ln R).
    turning = np.exp(2j * np.pi * angles / period).mean()
    spread = float(np.sqrt(abs(2 * np.log(max(abs(turning), 1e-300)))) * period / (2 * np.pi))
    # As many pulses as periods, within a tenth.
    counted = len(angles) / max((angles[-1] - angles[0]) / period + 1, 1)
    if spread > LARGEST_SPREAD or not 0.9 < counted < 1.1:
        raise UsageError(
            f"{name}: its pulses come {counted:.3g} times in {np.degrees(period):.0f} degrees of the reference shaft, "
            f"within {np.degrees(spread):.2g} degrees, and should come once: name the channel of an index or cam pulse",
            kind="unfit-wheel",
        )
    return float(np.angle(turning) * period / (2 * np.pi)), spread
