"""BenchMotion of a drivetrain that turns in a test: mean values, and the vibration that its excitations make."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polyfit

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.units import RPM
from torsionnet.bench.mean_motion import MeanMotion, MeanReadings, mean_readings
from torsionnet.bench.plan.plan import (
    COAST_DOWN_POINTS,
    BenchMotion,
    CoastDown,
    GivenSpeed,
    RunUp,
    SteadyPoints,
)
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.passage.passage_response import PassageResponse
from torsionnet.machinery.passage.passage_solution import passage_from
from torsionnet.machinery.passage.passage_torques import ExcitationCase
from torsionnet.model.channels import Sensor
from torsionnet.model.load.external_torques import reference_node
from torsionnet.signals.recording import FloatArray

# Speed over time of a drivetrain that coasts down, braked by the load of its model.

LEAST_DRAG = 1e-9
"""Least torque that brakes, over the largest along the speed: below it the speed would never fall."""


def coast_down(
    drivetrain: Drivetrain, reference: str, start: float, stop: float
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Times (n,) in s and speeds (n,) in rad/s of the reference shaft while the load brakes it, and notes.

    All inertias that turn with the reference store their energy, sum over nodes of J r^2 w^2/2 with the ratio r, and
    what the load absorbs at each speed takes it: dw/dt = -P(w)/(J w).

    Raises
    ------
    UsageError
        The load absorbs nothing at some speed on the way.
    """
    inertia = turning_inertia(drivetrain, reference)
    speeds = np.linspace(start, stop, COAST_DOWN_POINTS + 1)
    drag = np.array([absorbed_torque(drivetrain, reference, speed) for speed in speeds.tolist()])
    if (drag <= LEAST_DRAG * drag.max(initial=0.0)).any():
        raise UsageError(
            "the load of the model absorbs nothing at some of these speeds; give a time_constant", kind="missing-entry"
        )
    # J dw/dt = -T(w), so that dt = -J/T dw: the trapezoidal rule over speed.
    per_speed = inertia / drag
    steps = -np.diff(speeds) * (per_speed[1:] + per_speed[:-1]) / 2
    times = np.concatenate([[0.0], np.cumsum(steps)])
    note = f"braked by the load, {drag[0]:.4g} N*m at first, with {inertia:.4g} kg*m^2, both at {reference}"
    return times, speeds, (note,)


def turning_inertia(drivetrain: Drivetrain, reference: str) -> float:
    """Inertia in kg m^2 of all that turns with a node, as it is felt there."""
    laws = drivetrain.assembly.laws
    ratios: dict[str, float] = {}
    total = 0.0
    for law in laws:
        if not law.inertia:
            continue
        # The row turns with sum a r of its nodes' ratios r, and stores J (sum a r)^2 w^2/2.
        turning = 0.0
        for node, weight in law.row.items():
            if node not in ratios:
                ratios[node] = _ratio(drivetrain, node, reference)
            turning += float(weight) * ratios[node]
        total += float(law.inertia) * turning**2
    return total


def _ratio(drivetrain: Drivetrain, node: str, reference: str) -> float:
    try:
        return drivetrain.ratio_between(node, reference)
    except UsageError:
        return 0.0  # what turns by itself does not slow down with the shaft


def absorbed_torque(drivetrain: Drivetrain, reference: str, speed: float) -> float:
    """Torque in N m at a node, turning at a speed in rad/s, of what the load of the model absorbs there."""
    definition = drivetrain.definition
    own = reference_node(definition)
    scale = 1.0 if own == reference else abs(drivetrain.ratio_between(own, reference))
    torques = drivetrain.external_torques.at(speed * scale)
    # By its power a torque T at the ratio r is T r at the reference; what drives does not brake.
    ratios = {node: drivetrain.ratio_between(node, reference) for node in torques if node in drivetrain.nodes}
    return -sum(min(torques[node] * ratio, 0.0) for node, ratio in ratios.items())


# Vibration of the channels of a bench that turns, at any time: steady orders in closed form, or along a speed.

SPLINE_DEGREE = 5
"""Degree of the spline through the steps of a passage, 16 in a period of its highest order: it misses that order by
about 1e-5 of its amplitude."""
VALUES_PER_CHUNK = 2**16
"""Number of times at which all orders are summed together, which limits the memory."""


class Vibration(Protocol):
    """Vibration of channels about their mean values, at any time of a test."""

    def at(self, place: int, times: FloatArray, derivative: int = 0) -> FloatArray:
        """Vibration of a channel in SI units, or its derivative over time, at times in s, shape (n,)."""
        ...


@dataclass(frozen=True, eq=False)
class SteadyVibration:
    """Steady vibration: a sum of orders and of fixed frequencies, exact at every time.

    Attributes
    ----------
    mean : MeanMotion
        Rotation at constant speed.
    relative : (n_lines,) array
        Vibrations per revolution of the reference shaft.
    fixed : (n_lines,) array
        Angular frequencies that come on top, rad/s.
    values : (n_lines, n_sensors) complex array
        Peak amplitudes, SI.
    """

    mean: MeanMotion
    relative: FloatArray
    fixed: FloatArray
    values: ComplexArray

    def at(self, place: int, times: FloatArray, derivative: int = 0) -> FloatArray:
        """Vibration of a channel in SI units, or its derivative over time, at times in s, shape (n,)."""
        # A line turns at nu Omega + omega_0, and j times that is the factor of each derivative.
        rates = self.relative * self.mean.speeds[0] + self.fixed
        amplitudes = self.values[:, place] * (1j * rates) ** derivative
        vibration = np.empty(len(times))
        for part in _chunks(len(times)):
            at = times[part]
            turning = np.outer(self.mean.angle(at), self.relative) + np.outer(at, self.fixed)
            vibration[part] = (np.exp(1j * turning) @ amplitudes).real
        return vibration


@dataclass(frozen=True, eq=False)
class PassageVibration:
    """Vibration along a speed over time, by a spline through the steps of a passage.

    ``drift`` is what the angle of each channel drifts from the mean rotation, (2, n_sensors): at time 0 in its unit,
    and per s.
    """

    run: PassageResponse
    drift: FloatArray

    @cached_property
    def _splines(self) -> list[Any]:
        from scipy.interpolate import make_interp_spline

        times = self.run.times
        # What the angle drifts from the mean rotation is no vibration.
        line = self.drift[0] + np.outer(times, self.drift[1])
        return [
            make_interp_spline(times, column, k=SPLINE_DEGREE)
            for column in (self.run.values[:, : line.shape[1]] - line).T
        ]

    def at(self, place: int, times: FloatArray, derivative: int = 0) -> FloatArray:
        """Vibration of a channel in SI units, or its derivative over time, at times in s, shape (n,)."""
        return np.asarray(self._splines[place](times, nu=derivative))


def _chunks(count: int) -> Iterator[slice]:
    yield from (slice(begin, begin + VALUES_PER_CHUNK) for begin in range(0, count, VALUES_PER_CHUNK))


Sensors: TypeAlias = Mapping[str, Sensor]
"""Sensor that each channel reads, by the name of the channel."""
MEAN_SPEEDS = 61
"""Number of speeds at which mean values along a speed over time are calculated: those of a propeller, with the square
of the speed, are then right to 1e-4 of the largest."""
ENGINES_IN_PHASE = "engines with an unknown angle between them are in phase"
"""Note where a bench has several engines that no coupling holds at an angle."""


@dataclass(frozen=True, eq=False)
class TurningMotion:
    """BenchMotion of a drivetrain in one test, at any time.

    Attributes
    ----------
    name : str
        What the record of it is called among several, as ``900rpm`` of a steady point; empty of a single one.
    reference : str
        Node whose mean rotation it is.
    mean : MeanMotion
    channels : mapping of str to int
        Place of the sensor of each channel among the readings.
    readings : MeanReadings
        Mean values of the sensors.
    vibration : Vibration
    notes : tuple of str
    """

    name: str
    reference: str
    mean: MeanMotion
    channels: Mapping[str, int]
    readings: MeanReadings
    vibration: Vibration
    notes: tuple[NoteOrText, ...] = ()

    def quantity(self, channel: str) -> str:
        """Quantity that the sensor of a channel reads."""
        return self.readings.quantities[self.channels[channel]]

    def read(self, channel: str, times: FloatArray) -> FloatArray:
        """Values of a channel in SI units at times in s, shape (n,): mean value and vibration."""
        place = self.channels[channel]
        return np.asarray(self.readings.at(place, self.mean, times) + self.vibration.at(place, times))

    def rate(self, channel: str, times: FloatArray) -> FloatArray:
        """Speeds of the node of an angle channel in rad/s at times in s, shape (n,)."""
        place = self.channels[channel]
        turning = self.readings.ratios[place] * self.mean.speed(times)
        return np.asarray(turning + self.vibration.at(place, times, derivative=1))


def turning_motions(drivetrain: Drivetrain, motion: BenchMotion, sensors: Sensors) -> tuple[TurningMotion, ...]:
    """Motions of a test: one for each steady point, one of a run-up, run-down, coast-down or given speed."""
    reference = motion.speed_of or (drivetrain.definition.speeds.of if drivetrain.definition.speeds else "")
    acting = tuple(name for name in drivetrain.definition.excitations if name not in motion.without)
    each = list(dict.fromkeys(sensors.values()))
    channels = {name: each.index(sensor) for name, sensor in sensors.items()}
    if isinstance(motion, SteadyPoints):
        return _steady(drivetrain, motion, reference, acting, each, channels)
    return (_passage(drivetrain, motion, reference, acting, each, channels),)


def _steady(
    drivetrain: Drivetrain,
    motion: SteadyPoints,
    reference: str,
    acting: Sequence[str],
    sensors: Sequence[Sensor],
    channels: Mapping[str, int],
) -> tuple[TurningMotion, ...]:
    readings = mean_readings(drivetrain, reference, sensors, motion.speeds)
    lines: Sequence[OrderLine] = ()
    values, notes = np.zeros((len(motion.speeds), 0, len(sensors)), dtype=complex), readings.notes
    if acting:
        run = drivetrain.order_response(
            list(sensors), speeds=list(motion.speeds), speed_of=reference, excitation=acting
        )
        lines, values, more = _one_case(run)
        values, notes = _by_speed(values, run, motion.speeds), (*notes, *more)
    # Angular frequency of a line: relative Omega + 2 pi f of its fixed part.
    relative = np.array([float(line.relative) for line in lines])
    fixed = 2 * math.pi * np.array([line.fixed for line in lines])
    motions = []
    for speed, amplitudes in zip(motion.speeds, values, strict=True):
        mean = MeanMotion(np.array([0.0, motion.duration]), np.array([speed, speed]), motion.start_angle)
        turning = np.abs(relative * speed + fixed) > 0  # what stands still is a mean value, not a vibration
        vibration = SteadyVibration(mean, relative[turning], fixed[turning], amplitudes[turning])
        name = f"{speed * RPM:.6g}rpm" if len(motion.speeds) > 1 else ""
        motions.append(TurningMotion(name, reference, mean, channels, readings, vibration, notes))
    return tuple(motions)


def _by_speed(values: ComplexArray, run: OrderResponse, speeds: Sequence[float]) -> ComplexArray:
    """Amplitudes in the order of the speeds given, as an order response sorts them."""
    return np.asarray([values[int(np.abs(run.speeds - speed).argmin())] for speed in speeds])


def _one_case(run: OrderResponse) -> tuple[Sequence[OrderLine], ComplexArray, tuple[str, ...]]:
    """Lines and amplitudes of one case of excitation, the one of largest vibration of the first channel, and notes."""
    if not isinstance(run, WorstResponse):
        return run.lines, run.values, ()
    case = ExcitationCase.worst(run)
    notes = [f"case of excitation, the worst of {run.outputs[0].name}: {case.words}"] if case.words else []
    notes += ["values that scatter have their rated value"] if run.scattered else []
    notes += [ENGINES_IN_PHASE] if run.angles else []
    chosen = run.case_responses[case.alternative or 0]
    return chosen.lines, chosen.values, tuple(notes)


def _passage(
    drivetrain: Drivetrain,
    motion: BenchMotion,
    reference: str,
    acting: Sequence[str],
    sensors: Sequence[Sensor],
    channels: Mapping[str, int],
) -> TurningMotion:
    times, speeds, notes = _course(drivetrain, motion, reference)
    mean = MeanMotion(times, speeds, motion.start_angle)
    readings = mean_readings(drivetrain, reference, sensors, _between(speeds))
    notes = (*notes, *map(str, readings.notes))
    if not acting:
        none = np.zeros(0)
        still = SteadyVibration(mean, none, none, np.zeros((0, len(sensors)), dtype=complex))
        return TurningMotion("", reference, mean, channels, readings, still, notes)
    # The angle of the reference itself tells how far a passage drifts from the given speed.
    own = Sensor("angle", reference)
    asked = [*sensors, *([own] if own not in sensors else [])]
    run = passage_from(motion.start_angle, drivetrain, asked, (times, speeds), reference, acting)
    drift = polyfit(run.times, run.values[:, asked.index(own)], 1)
    vibration = PassageVibration(run, readings.drifts(np.asarray(drift, dtype=float)))
    drifted = math.degrees(abs(drift[1]) * mean.length)
    notes = (*notes, *run.notes, f"drift of {reference} from its mean rotation left out: {drifted:.2g} deg in all")
    return TurningMotion("", reference, mean, channels, readings, vibration, notes)


def _course(
    drivetrain: Drivetrain, motion: BenchMotion, reference: str
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Times (n,) in s and speeds (n,) in rad/s of a motion between steady points, and notes."""
    if isinstance(motion, RunUp):
        return np.array([0.0, motion.length]), np.array([motion.start, motion.stop]), ()
    if isinstance(motion, CoastDown):
        if motion.time_constant is not None:
            times, speeds = motion.fall()
            return np.array(times), np.array(speeds), ()
        return coast_down(drivetrain, reference, motion.start, motion.stop)
    if isinstance(motion, GivenSpeed):
        at, run = motion.points
        return np.array(at), np.array(run), ()
    raise UsageError(f"no course is known of the motion {motion.kind}", kind="unknown-word")


def _between(speeds: FloatArray) -> tuple[float, ...]:
    """Speeds at which mean values are calculated, evenly from the lowest to the highest in rad/s."""
    return tuple(np.linspace(speeds.min(), speeds.max(), MEAN_SPEEDS).tolist())
