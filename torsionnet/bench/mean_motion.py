"""Mean rotation of the reference shaft of a bench: its angle, speed and acceleration over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.channels import Sensor
from torsionnet.model.load.external_torques import reference_node
from torsionnet.signals.recording import FloatArray


@dataclass(frozen=True, eq=False)
class MeanMotion:
    """Mean rotation of a shaft whose speed runs straight between points.

    Attributes
    ----------
    times : (n,) array
        s, from 0.
    speeds : (n,) array
        rad/s at these times.
    start_angle : float
        Angle at time 0, rad.

    Examples
    --------
    >>> run = MeanMotion(np.array([0.0, 2.0]), np.array([10.0, 20.0]))
    >>> run.angle(np.array([0.0, 1.0, 2.0])).tolist(), run.speed(np.array([1.0])).tolist()
    ([0.0, 12.5, 30.0], [15.0])
    """

    times: FloatArray
    speeds: FloatArray
    start_angle: float = 0.0

    @property
    def length(self) -> float:
        """Time from the first to the last point, s."""
        return float(self.times[-1])

    @cached_property
    def _angles(self) -> FloatArray:
        # Trapezoids are exact, as the speed is straight between points.
        turned = np.diff(self.times) * (self.speeds[1:] + self.speeds[:-1]) / 2
        return np.concatenate([[self.start_angle], self.start_angle + np.cumsum(turned)])

    def angle(self, times: FloatArray) -> FloatArray:
        """Angles in rad at times in s between first and last point, shape (n,)."""
        place = self._place(times)
        # From the point before: alpha + Omega t + Omega' t^2/2.
        since = times - self.times[place]
        return np.asarray(self._angles[place] + since * (self.speeds[place] + self.acceleration(times) * since / 2))

    def speed(self, times: FloatArray) -> FloatArray:
        """Speeds in rad/s at times in s, shape (n,)."""
        return np.interp(times, self.times, self.speeds)

    def acceleration(self, times: FloatArray) -> FloatArray:
        """Accelerations in rad/s^2 at times in s, shape (n,); where two stretches meet, that of the later one."""
        return np.asarray((np.diff(self.speeds) / np.diff(self.times))[self._place(times)])

    def _place(self, times: FloatArray) -> FloatArray:
        return np.asarray(np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2))


# Mean values of the channels of a bench that turns: rotation with a ratio, and mean torques over speed.

ROTATION = ("angle", "velocity", "acceleration")
"""Quantities of which the mean value is that of the mean rotation times a ratio."""


@dataclass(frozen=True, eq=False)
class MeanReadings:
    """Mean values of the sensors of a bench over the speed of its reference shaft.

    Attributes
    ----------
    quantities : tuple of str
    ratios : (n_sensors,) array
        Turns of what a motion channel reads per turn of the reference shaft; 0 of other channels.
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s, rising.
    values : (n_speeds, n_sensors) array
        Mean torques, twists and stresses, SI; 0 of channels that read a motion.
    notes : tuple of str
    """

    quantities: tuple[str, ...]
    ratios: FloatArray
    speeds: FloatArray
    values: FloatArray
    notes: tuple[NoteOrText, ...] = ()

    def at(self, place: int, mean: MeanMotion, times: FloatArray) -> FloatArray:
        """Mean values of a channel in SI units at times in s, shape (n,)."""
        quantity, ratio = self.quantities[place], self.ratios[place]
        if quantity == "angle":
            return np.asarray(ratio * mean.angle(times))
        if quantity == "velocity":
            return np.asarray(ratio * mean.speed(times))
        if quantity == "acceleration":
            return np.asarray(ratio * mean.acceleration(times))
        return np.interp(mean.speed(times), self.speeds, self.values[:, place])

    def drifts(self, line: FloatArray) -> FloatArray:
        """Drift (2, n_sensors), at time 0 and per s in SI, where the reference's angle drifts by the line (2,)."""
        angle = self.ratios * np.array([quantity == "angle" for quantity in self.quantities])
        velocity = self.ratios * np.array([quantity == "velocity" for quantity in self.quantities])
        return np.array([angle * line[0] + velocity * line[1], angle * line[1]])


def mean_readings(
    drivetrain: Drivetrain, reference: str, sensors: Sequence[Sensor], speeds: Sequence[float]
) -> MeanReadings:
    """Mean values of channels at speeds of the reference shaft in rad/s; 0, with a note, where the model has none."""
    quantities = tuple(sensor.quantity for sensor in sensors)
    ratios = np.array([ratio_of(drivetrain, sensor, reference) for sensor in sensors])
    at = np.unique(np.asarray(speeds, dtype=float))
    values = np.zeros((len(at), len(sensors)))
    notes: list[str] = []
    # Angles and speeds follow the speed of the shaft by their ratio; torques and stresses have means of their own.
    carried = [place for place, quantity in enumerate(quantities) if quantity not in ROTATION]
    if carried:
        asked = [sensor for place, sensor in enumerate(sensors) if place in carried]
        values[:, carried], notes = _mean_values(drivetrain, reference, asked, at)
    return MeanReadings(quantities, ratios, at, values, tuple(notes))


def ratio_of(drivetrain: Drivetrain, sensor: Sensor, reference: str) -> float:
    """Turns of what a motion sensor reads per turn of the reference shaft; 0 of a sensor on an element."""
    if sensor.quantity not in ROTATION:
        return 0.0
    turning = sum(weight * drivetrain.ratio_between(node, reference) for node, weight in sensor.row.items())
    if sensor.referred_to is not None:
        # Referred to another shaft a motion counts by the ratio of both.
        shaft, own = (drivetrain.ratio_between(node, reference) for node in (sensor.referred_to, sensor.of))
        turning *= abs(shaft / own)
    return float(turning)


def _mean_values(
    drivetrain: Drivetrain, reference: str, sensors: Sequence[Sensor], speeds: FloatArray
) -> tuple[FloatArray, list[str]]:
    """Mean values (n_speeds, n_sensors) in SI units at speeds in rad/s of the reference, and notes."""
    definition = drivetrain.definition
    if definition.load is None:
        try:
            mean = drivetrain.mean_response(list(sensors))
        except UsageError as error:
            return np.zeros((len(speeds), len(sensors))), [f"mean torques are 0: {error}"]
        note = "mean torques are those of the operating point at every speed"
        return np.repeat(mean.values, len(speeds), axis=0), [note]
    own = reference_node(definition)
    scale = 1.0 if own == reference else abs(drivetrain.ratio_between(own, reference))
    # One speed without mean values refuses them all: then each for itself, so that the others keep theirs.
    try:
        return np.asarray(drivetrain.mean_response(list(sensors), speeds * scale).values), []
    except UsageError:
        pass
    values, unknown = np.zeros((len(speeds), len(sensors))), {}
    for place, speed in enumerate(speeds.tolist()):
        try:
            values[place] = drivetrain.mean_response(list(sensors), [speed * scale]).values[0]
        except UsageError as error:
            unknown[speed] = str(error)
    rpm = [speed * RPM for speed in unknown]
    text = f"mean torques are 0 at {len(rpm)} speeds from {min(rpm):g} to {max(rpm):g} rpm"
    return values, [f"{text}: {next(iter(unknown.values()))}"]
