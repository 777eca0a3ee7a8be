"""Torques, and scales of torques, that act on a plant over time, as straight lines and waves between their breaks."""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.balanced_state import BalancedState
from torsionnet.model.element_base.laws import MotionLaw, Values
from torsionnet.model.operating_point import torque_place
from torsionnet.model.speeds import mean_speeds
from torsionnet.motion.scenarios.time_history import SAMPLE_SLACK, TimeHistory
from torsionnet.motion.smooth_laws import Scale
from torsionnet.motion.torque_courses import torque_courses
from torsionnet.signals.recording import Signal, is_rate

KINK = 1e-12
"""Share of the largest torque by which three samples may miss a straight line through rounding."""


@dataclass(frozen=True, eq=False)
class DrivingWave:
    """Term Re(A exp(s (t - t_0))) of one entry of u in a stretch that begins at t_0."""

    entry: int
    amplitude: complex
    exponent: complex


@dataclass(frozen=True, eq=False)
class Stretch:
    """Values of all entries of u from ``start`` to ``end`` in s: straight lines and waves without a break.

    ``values`` and ``slopes`` (n_u,) are those of the straight lines at the start.
    """

    start: float
    end: float
    values: FloatArray
    slopes: FloatArray
    waves: tuple[DrivingWave, ...] = ()

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Values (n_u, n), and their rates of change, at times (n,) in s."""
        passed = times - self.start
        values = self.values[:, None] + self.slopes[:, None] * passed
        slopes = np.repeat(self.slopes[:, None], len(passed), axis=1)
        for source in self.waves:
            wave = source.amplitude * np.exp(source.exponent * passed)
            values[source.entry] += wave.real
            slopes[source.entry] += (source.exponent * wave).real
        return values, slopes


@dataclass(frozen=True, eq=False)
class Driving:
    """Entries of u over time, each given by samples (n,), straight between them, or by a history.

    ``rate`` is that of the samples in Hz and ``n`` their number.
    """

    entries: tuple[FloatArray | TimeHistory, ...]
    rate: float
    n: int

    @property
    def duration(self) -> float:
        """Time in s from the first to the last sample."""
        return (self.n - 1) / self.rate

    @property
    def first(self) -> FloatArray:
        """Values (n_u,) at the first sample."""
        return np.array([_value(entry, 0.0) for entry in self.entries])

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times in s within the duration at which a piece of a history begins."""
        starts = {
            self._at_sample(at) for entry in self.entries if not isinstance(entry, np.ndarray) for at in entry.breaks
        }
        return tuple(sorted(start for start in starts if 0 < start < self.duration))

    def _at_sample(self, time: float) -> float:
        """Time in s, or that of the sample that it hits but for rounding."""
        number = round(time * self.rate)
        return number / self.rate if abs(time * self.rate - number) < SAMPLE_SLACK else time

    def straight(self, start: float, end: float) -> Stretch:
        """Stretch between two times in s with no break between them; samples give nothing to it."""
        values, slopes, waves = np.zeros(len(self.entries)), np.zeros(len(self.entries)), []
        for entry, course in enumerate(self.entries):
            if isinstance(course, np.ndarray):
                continue
            piece = course.piece_at(start + SAMPLE_SLACK / self.rate).begun(start)
            values[entry], slopes[entry] = piece.value, piece.slope
            waves += [DrivingWave(entry, wave.amplitude, wave.exponent) for wave in piece.waves]
        return Stretch(start, end, values, slopes, tuple(waves))

    def sampled(self, times: FloatArray) -> FloatArray:
        """Values (n_u, n_t) at times in s of the entries given by samples, 0 of the others."""
        values = np.zeros((len(self.entries), len(times)))
        places = times * self.rate
        for entry, course in enumerate(self.entries):
            if isinstance(course, np.ndarray):
                values[entry] = np.interp(places, np.arange(self.n), course)
        return values

    def stretches(self) -> tuple[Stretch, ...]:
        """Stretches in which no entry has a break or a corner, from the first to the last sample."""
        cuts = sorted({0.0, self.duration, *self.breaks, *self._corners()})
        if len(cuts) == 1:
            return ()
        at = self.sampled(np.array(cuts))
        stretches = []
        # Lines and waves of histories, and the straight lines between samples as chords.
        for place, (start, end) in enumerate(pairwise(cuts)):
            line = self.straight(start, end)
            slopes = (at[:, place + 1] - at[:, place]) / (end - start)
            stretches.append(Stretch(start, end, line.values + at[:, place], line.slopes + slopes, line.waves))
        return tuple(stretches)

    def _corners(self) -> set[float]:
        """Times in s of samples at which straight lines between samples meet at an angle."""
        corners: set[float] = set()
        for course in self.entries:
            if isinstance(course, np.ndarray) and len(course) > 2:
                bent = np.abs(course[2:] - 2 * course[1:-1] + course[:-2]) > KINK * np.abs(course).max()
                corners.update(((np.flatnonzero(bent) + 1) / self.rate).tolist())
        return corners


def _value(entry: FloatArray | TimeHistory, time: float) -> float:
    return (
        float(entry[0]) if isinstance(entry, np.ndarray) else float(entry.piece_at(time).values_at(np.array([time]))[0])
    )


# Torques and scales of a simulation from what a caller gives: lists at samples, or histories and a duration.

Torque: TypeAlias = ArrayLike | Signal | TimeHistory

MOST_SAMPLES = 20_000_000
"""Most samples of a duration, some hundred MB for each output."""


def require_request(inputs: Mapping[str, Torque], rate: float, duration: float | None) -> None:
    """Require a rate in Hz and, if given, a duration in s that fit each other and the lists of torques.

    Raises
    ------
    UsageError
        No rate or duration, too many samples, or lists of another length.
    """
    if not (isinstance(rate, int | float | np.number) and is_rate(float(rate))):
        raise UsageError(f"the sampling rate must be a positive number of Hz, got {rate}", kind="out-of-range")
    if duration is None:
        return
    if not (isinstance(duration, int | float | np.number) and math.isfinite(duration) and duration >= 0):
        raise UsageError(
            f"the duration must be a number of seconds that is not below zero, got {duration}", kind="out-of-range"
        )
    if duration * rate > MOST_SAMPLES:
        text = f"{duration:g} s at {rate:g} Hz are more than {MOST_SAMPLES} samples"
        raise UsageError(f"{text}; give a lower rate or a shorter duration", kind="too-large")
    listed = [torque.values if isinstance(torque, Signal) else torque for torque in inputs.values()]
    lengths = {len(np.atleast_1d(values)) for values in listed if not isinstance(values, TimeHistory)}
    _one_length({*lengths, sample_count(duration, rate)})


def sample_count(duration: float, rate: float) -> int:
    """Number of samples at a rate in Hz within a duration in s, with those at its beginning and at its end."""
    return int(np.floor(duration * rate + SAMPLE_SLACK)) + 1


def driving_of(
    inputs: Mapping[str, Torque], rate: float, duration: float | None, scales: Mapping[Scale, TimeHistory]
) -> tuple[Driving, FloatArray]:
    """Torques and scales over time, and the torques (n_in, n) at the samples.

    Raises
    ------
    UsageError
        Unlike lengths, numbers that are not finite, or histories without a duration.
    """
    listed = {name: torque for name, torque in inputs.items() if not isinstance(torque, TimeHistory)}
    arrays = dict(zip(listed, torque_courses(listed).samples, strict=True)) if listed or not inputs else {}
    lengths = {len(values) for values in arrays.values()}
    if duration is not None:
        lengths.add(sample_count(duration, rate))
    n = _one_length(lengths)
    entries = [arrays.get(name, torque) for name, torque in inputs.items()]
    driving = Driving((*entries, *scales.values()), rate, n)
    torques = np.array([course.samples(rate, n) if isinstance(course, TimeHistory) else course for course in entries])
    if not np.isfinite(torques).all():
        raise UsageError("the torques of a simulation are finite numbers in N m", kind="not-finite")
    return driving, torques


def _one_length(lengths: set[int]) -> int:
    if not lengths:
        raise UsageError("torques as histories have no end: give the duration in s", kind="missing-entry")
    if len(lengths) > 1:
        text = " and ".join(map(str, sorted(lengths)))
        raise UsageError(
            f"the torques have {text} samples; give lists of one length, that of the duration", kind="wrong-count"
        )
    (n,) = lengths
    return n


# Torques that go on acting as a motion starts at an operating point, and notes on those that stay as they are.

EQUAL = 1e-9
"""Share by which a scale at the operating point and one at the start may differ and count as the same."""


def acting_means(
    drivetrain: AssembledModel, replaced: Iterable[tuple[str, ...]] = (), *, in_full: bool = True
) -> dict[str, float]:
    """Mean torques in N m of the operating point by node that go on acting, those on ``replaced`` nodes left out.

    Where laws of motion act ``in_full``, those that a law on the node gives are left out too: a propeller whose torque
    follows the speed brakes once, also where the load states its torque.
    """
    tangents, others = drivetrain.definition.tangents, set(replaced)
    means = dict(drivetrain.mean_torques)
    # A torque between two nodes that is replaced has to go from both of them.
    for place, torque in drivetrain.definition.operating_point.torque.items() if not drivetrain.definition.load else ():
        nodes = torque_place(place).nodes
        if nodes in others and len(nodes) > 1:
            for node, sign in zip(nodes, (1, -1), strict=True):
                means[node] = means.get(node, 0.0) - sign * float(torque.evaluate(drivetrain.exact_values))
    means = {
        node: torque for node, torque in means.items() if torque and node in drivetrain.nodes and (node,) not in others
    }
    if not (means and in_full):
        return means
    try:
        state = None if tangents is None else tangents.state
    except ModelError:  # other torques may be in balance
        return means
    # Torques that a law of motion gives as well would act twice.
    stated = {*_taken_over(drivetrain, means, state), *(() if state is None else state.stated)}
    return {node: torque for node, torque in means.items() if node not in stated}


def _taken_over(drivetrain: AssembledModel, means: Mapping[str, float], state: BalancedState | None) -> Iterator[str]:
    """Yield nodes whose mean torque brakes as a law over their absolute speed does, whose working point it is."""
    speeds = given_speeds(drivetrain) if state is None else state.speeds
    value = Values(drivetrain.exact_values)
    for element in drivetrain.definition.switched_on:
        if not (element.has_motion_laws and element.has_own_working_point):
            continue
        for law in element.whole_parts(value):
            if not isinstance(law, MotionLaw) or len(law.row) != 1 or law.curve.over != "rate" or law.sensed:
                continue
            ((node, share),) = law.row.items()
            # A law's torque stands on the left side, a mean on the right: both brake where their signs differ.
            rate = float(share) * speeds.get(node, 0.0)
            if rate and node in means and float(law.torque(0.0, rate)) * float(share) * means[node] < 0:
                yield node


def held_load(drivetrain: AssembledModel, nodes: Container[str]) -> tuple[str, ...]:
    """Note that torques of the load on ``nodes``, which would follow the speed, stay as they are; or no note."""
    load = drivetrain.definition.load
    if load is None:
        return ()
    # Their slopes follow the speed also where they are linear.
    following = {getattr(part, "node", None) for part in drivetrain.definition.switched_on if part.has_motion_laws}
    held = [
        place
        for place, torque in load.by_place.items()
        if (torque.over_speed or torque.torque_exponent)
        and any(node in nodes for node in torque_place(place).nodes)
        and torque_place(place).of not in following
    ]
    text = "the torques of the load at {places} are held, whatever the speed"
    return (phrase(text, places=", ".join(held)),) if held else ()


def scale_notes(drivetrain: AssembledModel, scales: Mapping[Scale, TimeHistory]) -> Iterator[str]:
    """Yield a note on each scale of a torque that is another at the operating point than from the start on."""
    value = Values(drivetrain.exact_values)
    for (element, what), history in scales.items():
        for law in drivetrain.definition.elements[element].whole_parts(value):
            if isinstance(law, MotionLaw) and law.scaled_by == what:
                own, first = float(law.scale), history.first
                if abs(own - first) > EQUAL * max(abs(own), abs(first)):
                    text = (
                        "the {what} of {element} is {own:g} at the operating point and {first:g} from the start on, "
                        "in SI units"
                    )
                    yield phrase(text, what=what, element=element, own=own, first=first)


def given_speeds(drivetrain: AssembledModel) -> dict[str, float]:
    """Mean speed in rad/s by node that the operating point gives, empty where it gives none."""
    definition = drivetrain.definition
    return mean_speeds(definition, drivetrain.exact_values) if definition.operating_point.speed else {}
