"""BenchMotion of a drivetrain that turns in a test: mean values, and the vibration that its excitations make."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polyfit

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.units import RPM
from torsionnet.bench.coast_down import coast_down
from torsionnet.bench.mean_motion import MeanMotion
from torsionnet.bench.mean_readings import MeanReadings, mean_readings
from torsionnet.bench.plan.bench_motions import BenchMotion, CoastDown, GivenSpeed, RunUp, SteadyPoints
from torsionnet.bench.shaft_vibration import PassageVibration, SteadyVibration, Vibration
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.passage.passage_solution import passage_from
from torsionnet.machinery.passage.passage_torques import ExcitationCase
from torsionnet.model.channels import Sensor
from torsionnet.signals.recording import FloatArray

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
            list(sensors), speeds=list(motion.speeds), speed_of=reference, excitations=acting
        )
        lines, values, more = _one_case(run)
        values, notes = _by_speed(values, run, motion.speeds), (*notes, *more)
    relative = np.array([float(line.relative) for line in lines])
    fixed = 2 * math.pi * np.array([line.fixed for line in lines])
    found = []
    for speed, amplitudes in zip(motion.speeds, values, strict=True):
        mean = MeanMotion(np.array([0.0, motion.duration]), np.array([speed, speed]), motion.start_angle)
        turning = np.abs(relative * speed + fixed) > 0  # what stands still is a mean value, not a vibration
        vibration = SteadyVibration(mean, relative[turning], fixed[turning], amplitudes[turning])
        name = f"{speed * RPM:.6g}rpm" if len(motion.speeds) > 1 else ""
        found.append(TurningMotion(name, reference, mean, channels, readings, vibration, notes))
    return tuple(found)


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
    one = run.case_responses[case.alternative or 0]
    return one.lines, one.values, tuple(notes)


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
    raise UsageError(f"no course is known of the motion {motion.kind}")


def _between(speeds: FloatArray) -> tuple[float, ...]:
    """Speeds at which mean values are calculated, evenly from the lowest to the highest in rad/s."""
    return tuple(np.linspace(speeds.min(), speeds.max(), MEAN_SPEEDS).tolist())
