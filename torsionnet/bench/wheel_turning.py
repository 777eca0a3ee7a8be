"""Toothed wheels of a bench as they are: their patterns, and when each tooth passes a pickup."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.bench.plan.toothed_wheel import PitchErrors, RadialVibration, ToothedWheel
from torsionnet.bench.turning_motion import TurningMotion
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.wheel_pattern import WheelPattern

POINTS_PER_TOOTH = 4
"""Number of points per tooth between which the first guess of the time of a passage is interpolated."""
FEWEST_POINTS = 256
"""Least number of such points per turn, as a wheel with one tooth turns unevenly within a pitch, too."""
TIME_TOLERANCE = 1e-12
"""Change of the time of a passage in s below which it is found: a tenth of the error that is stated."""
MOST_ITERATIONS = 20
"""Largest number of Newton steps; from the first guess three are enough."""
GeneratorFor = Callable[[str], np.random.Generator]
"""Random generator of one fault of a channel, by the word for it, so that no fault changes another."""


@dataclass(frozen=True, eq=False)
class TurningWheel:
    """Wheel of a channel with one of its pickups, and the pattern of its teeth.

    Attributes
    ----------
    channel : str
        Channel of the pickup.
    owner : str
        Channel whose node the wheel turns with, that of its first pickup.
    wheel : ToothedWheel
        Entries of the wheel itself.
    pickup_angle : float
        rad, in the sense of rotation.
    places : (teeth,) array
        By how much each tooth stands beyond its place, rad.
    """

    channel: str
    owner: str
    wheel: ToothedWheel
    pickup_angle: float
    places: FloatArray

    @property
    def pattern(self) -> WheelPattern:
        """True pattern of the wheel, in rad; of one tooth there is none."""
        missing = self.wheel.missing_teeth
        first = "the first after the gap" if missing else "the tooth at the mounting angle of the wheel"
        even = np.zeros(len(self.places))
        return WheelPattern(
            self.places, even, missing, self.channel, first, notes=(_described(self.wheel.pitch_errors),)
        )

    def angle(self, motion: TurningMotion, times: FloatArray) -> FloatArray:
        """Angle of the wheel as the pickup sees it, in rad at times in s, shape (n,); it rises as the wheel turns."""
        turned = self._factor(motion) * motion.read(self.owner, times)
        return np.asarray(turned + self.wheel.mounting - self.pickup_angle + self._apparent(motion, times)[0])

    def rate(self, motion: TurningMotion, times: FloatArray) -> FloatArray:
        """Rate of that angle in rad/s at times in s, shape (n,)."""
        turning = self._factor(motion) * motion.rate(self.owner, times)
        return np.asarray(turning + self._apparent(motion, times)[1])

    def _factor(self, motion: TurningMotion) -> float:
        ratio = motion.readings.ratios[motion.channels[self.owner]]
        return float(np.sign(ratio) * self.wheel.gearing)

    def _apparent(self, motion: TurningMotion, times: FloatArray) -> tuple[FloatArray | float, FloatArray | float]:
        """Rotation that the vibration of the centre looks like at the pickup, in rad, and its rate in rad/s."""
        radial = self.wheel.radial_vibration
        if radial is None:
            return 0.0, 0.0
        share = tangential_share(radial, self.pickup_angle) * radial.amplitude / not_none(self.wheel.radius)
        order, fixed = radial.order or 0.0, 2 * np.pi * (radial.frequency or 0.0)
        phase = order * motion.mean.angle(times) + fixed * times + radial.phase
        return share * np.cos(phase), -share * np.sin(phase) * (order * motion.mean.speed(times) + fixed)

    def passages(self, motion: TurningMotion) -> tuple[FloatArray, NDArray[np.intp]]:
        """Times in s at which teeth pass the pickup, (n,), and their numbers counted on from turn to turn, (n,).

        Teeth that the gap lacks are left out.

        Raises
        ------
        UsageError
            The wheel turns back within a vibration, so that teeth pass twice.
        """
        teeth = len(self.places)
        first, last = self.angle(motion, np.array([0.0, motion.mean.length])) * teeth / (2 * np.pi)
        numbers = np.arange(int(np.floor(first)) - teeth, int(np.ceil(last)) + teeth + 1)
        numbers = numbers[numbers % teeth < teeth - self.wheel.missing_teeth]
        wanted = 2 * np.pi * numbers / teeth + self.places[numbers % teeth]
        return self._times(motion, wanted, numbers)

    def index_passages(self, motion: TurningMotion) -> FloatArray:
        """Times in s at which the place of tooth 0 passes the pickup, without its error, shape (n,)."""
        first, last = self.angle(motion, np.array([0.0, motion.mean.length])) / (2 * np.pi)
        turns = np.arange(int(np.floor(first)) - 1, int(np.ceil(last)) + 2)
        return self._times(motion, np.asarray(2.0 * np.pi * turns), turns)[0]

    def _times(
        self, motion: TurningMotion, wanted: FloatArray, numbers: NDArray[np.intp]
    ) -> tuple[FloatArray, NDArray[np.intp]]:
        """Times in s at which the angle takes the values wanted in rad, within the test, and the numbers of those."""
        length = motion.mean.length
        ends = self.angle(motion, np.array([0.0, length]))
        points = max(POINTS_PER_TOOTH * len(numbers), int(FEWEST_POINTS * (ends[1] - ends[0]) / (2 * np.pi)), 16)
        grid = np.linspace(0.0, length, points + 1)
        course = self.angle(motion, grid)
        if (np.diff(course) <= 0).any():
            at = float(grid[int(np.argmax(np.diff(course) <= 0))])
            rpm = float(motion.mean.speed(np.array([at]))[0]) * RPM
            text = f"{self.channel}: the wheel turns back at {at:.4g} s, at a mean speed of {rpm:.4g} rpm"
            raise UsageError(f"{text}; teeth would pass the pickup twice")
        inside = (wanted >= course[0]) & (wanted <= course[-1])
        wanted, numbers = wanted[inside], numbers[inside]
        times = np.interp(wanted, course, grid)
        for _ in range(MOST_ITERATIONS):
            step = (self.angle(motion, times) - wanted) / self.rate(motion, times)
            times = np.clip(times - step, 0.0, length)
            if np.abs(step).max(initial=0.0) < TIME_TOLERANCE:
                break
        return times, numbers


def tangential_share(radial: RadialVibration, pickup_angle: float) -> float:
    """Share of a displacement of the centre along the motion of the teeth at a pickup, from -1 to 1.

    >>> side = RadialVibration(amplitude="0.1 mm", order=1, direction="90 deg")
    >>> round(tangential_share(side, 0.0), 6), round(tangential_share(side, np.pi), 6)
    (1.0, -1.0)
    """
    return float(np.cos(radial.direction - pickup_angle - np.pi / 2))


def true_places(channel: str, wheel: ToothedWheel, generator: GeneratorFor) -> FloatArray:
    """Angle in rad by which each tooth stands beyond its place, (teeth,), of mean 0 over the teeth that there are."""
    teeth, errors = not_none(wheel.teeth), wheel.pitch_errors
    pitch, tooth = 2 * np.pi / teeth, np.arange(teeth)
    there = tooth < teeth - wheel.missing_teeth
    places = np.zeros(teeth)
    if errors.normal:
        places += errors.normal * pitch * generator("normal").standard_normal(teeth)
    if errors.uniform:
        places += errors.uniform * pitch * generator("uniform").uniform(-1, 1, teeth)
    if errors.eccentricity:
        places += errors.eccentricity * np.cos(2 * np.pi * tooth / teeth + errors.eccentricity_phase)
    if errors.list:
        places += np.array(errors.list)
    if (np.diff(places) <= -pitch).any():
        raise UsageError(f"{channel}: errors of the pitch let teeth change places; make them smaller")
    places[there] -= places[there].mean()
    places[~there] = 0.0
    return places


def _described(errors: PitchErrors) -> str:
    given = [
        f"{100 * errors.normal:g} % of a pitch, normal" if errors.normal else "",
        f"+-{100 * errors.uniform:g} % of a pitch, uniform" if errors.uniform else "",
        f"{np.degrees(errors.eccentricity):.4g} deg once per turn" if errors.eccentricity else "",
        "given by a list" if errors.list else "",
    ]
    return f"true places of the teeth: {' and '.join(filter(None, given)) or 'even'}"
