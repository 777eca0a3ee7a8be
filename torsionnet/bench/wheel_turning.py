"""Toothed wheels of a bench as they are: their patterns, and when each tooth passes a pickup."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import UsageError
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.bench.plan import Plan
from torsionnet.bench.plan.parts import PitchErrors, RadialVibration, ToothedWheel
from torsionnet.bench.turning_motion import TurningMotion
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import WheelPattern

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
        # A displacement of the centre along the teeth, over the radius, looks like an angle.
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
        # A turn more at both ends, as errors of the teeth and vibration bring some into the test.
        numbers = np.arange(int(np.floor(first)) - teeth, int(np.ceil(last)) + teeth + 1)
        numbers = numbers[numbers % teeth < teeth - self.wheel.missing_teeth]
        # Tooth k of z passes when the wheel has turned by 2 pi k/z and the error of its place.
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
            raise UsageError(f"{text}; teeth would pass the pickup twice", kind="turning-back")
        inside = (wanted >= course[0]) & (wanted <= course[-1])
        wanted, numbers = wanted[inside], numbers[inside]
        # Newton's method for alpha(t) = alpha_k, from the course between the points of the grid.
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
    # Tooth k of z stands at 2 pi k/z and its error, which has to rise from tooth to tooth.
    if (np.diff(places) <= -pitch).any():
        raise UsageError(
            f"{channel}: errors of the pitch let teeth change places; make them smaller", kind="contradicting-values"
        )
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


# Fault that a bench put into a record, so that what is found can be compared with it.


@dataclass(frozen=True)
class TrueFault:
    """Fault of a channel of a virtual test: its kind, its time in s of the first clock, and its size.

    The size is the number of the tooth of a lost or double pulse, the length in s of a drop-out, and in SI of others.

    Examples
    --------
    >>> print(TrueFault("fly", "missing pulse", 1.25, 731))
    fly: missing pulse at 1.25 s, 731
    """

    channel: Annotated[str, Out("channel")]
    kind: Annotated[str, Out("fault")]
    time: Annotated[float, Out("time", "s", json="time_s")]
    size: Annotated[float, Out("size")]

    def __str__(self) -> str:
        return f"{self.channel}: {self.kind} at {self.time:.6g} s, {self.size:.6g}"


# Pulses of a wheel as a counter records them: lost and double ones, jitter, the clock and its tick.

NEAREST_DOUBLE, FARTHEST_DOUBLE = 0.1, 0.4
"""Place of a second pulse behind its tooth, as a share of the time to the next one: less than half of it, so that it
can be told from a tooth."""


@dataclass(frozen=True, eq=False)
class CountedPulses:
    """Pulses as recorded, and what is wrong with them.

    Attributes
    ----------
    channel : PulseChannel
    numbers : (n,) int array
        True number of the tooth of each pulse; a second pulse has that of its tooth.
    faults : tuple of TrueFault
    """

    channel: PulseChannel
    numbers: NDArray[np.intp]
    faults: tuple[TrueFault, ...]


def counted_pulses(
    name: str,
    times: FloatArray,
    numbers: NDArray[np.intp],
    pickup: ToothedWheel,
    generator: GeneratorFor,
    shown: Callable[[FloatArray], FloatArray],
) -> CountedPulses:
    """Pulses that a counter records of teeth that pass a pickup at times in s.

    ``shown`` gives the time on the clock of the system that records them, which begins at 0.
    """
    faults: list[TrueFault] = []
    late = times + pickup.jitter * generator("jitter").standard_normal(len(times)) if pickup.jitter else times
    kept = np.ones(len(times), dtype=bool)
    if pickup.missing_pulses:
        kept = generator("missing").random(len(times)) >= pickup.missing_pulses
        faults += [
            TrueFault(name, "missing pulse", float(times[at]), float(numbers[at])) for at in np.flatnonzero(~kept)
        ]
    stamps, teeth = late[kept], numbers[kept]
    if pickup.double_pulses and len(times) > 1:
        chance = generator("double")
        doubled = (chance.random(len(times)) < pickup.double_pulses) & kept
        share = chance.uniform(NEAREST_DOUBLE, FARTHEST_DOUBLE, len(times))
        # Time from tooth to tooth, also over the gap where several are missing; behind the last one as before it.
        pitches = np.diff(times) / np.diff(numbers)
        second = (late + share * np.append(pitches, pitches[-1]))[doubled]
        faults += [TrueFault(name, "double pulse", time, float(tooth))
                   for time, tooth in zip(second.tolist(), numbers[doubled].tolist(), strict=True)]  # fmt: skip
        stamps, teeth = np.concatenate([stamps, second]), np.concatenate([teeth, numbers[doubled]])
    # Jitter may change the order of pulses.
    order = np.argsort(stamps, kind="stable")
    stamps, teeth = shown(stamps[order]), teeth[order]
    # The clock of the system begins at 0, and nothing before is recorded.
    stamps, teeth = stamps[stamps >= 0], teeth[stamps >= 0]
    if pickup.tick:
        # A counter tells whole ticks.
        stamps = pickup.tick * np.floor(stamps / pickup.tick)
    apart = np.diff(stamps, prepend=-np.inf) > 0
    notes = [f"{len(stamps) - int(apart.sum())} pulses within one tick of the one before are not recorded"]
    channel = PulseChannel(name, stamps[apart], pickup.tick, () if apart.all() else tuple(notes))
    return CountedPulses(channel, teeth[apart], tuple(faults))


# Speeds of the wheels of a bench from their recorded pulses, to be drawn over time.


def with_wheel_speeds(record: Recording, plan: Plan) -> Recording:
    """Record with the speed of each node that carries a wheel, in rad/s from its pulses, in front of its signals.

    Speeds are averages over a turn of the wheel as the pulses count it, with lost and double ones; they are drawn, not
    analysed.
    """
    speeds = tuple(_speeds(record, plan))
    return replace(record, signals=(*speeds, *record.signals)) if speeds else record


def _speeds(record: Recording, plan: Plan) -> Iterator[Signal]:
    for channel in record.pulses:
        part = plan.channels.get(channel.name)
        if not isinstance(part, ToothedWheel) or part.wheel:
            continue
        teeth = (part.teeth or 1) - part.missing_teeth
        if teeth > 1 and len(channel) > teeth:
            times = record.time if record.signals else _grid(record)
            # The mean over a whole turn, in which errors of the pitch drop out, at the middle of the turn.
            middle = (channel.times[teeth:] + channel.times[:-teeth]) / 2
            turning = 2 * np.pi / (channel.times[teeth:] - channel.times[:-teeth]) / part.gearing
            yield Signal(channel.name, "velocity", np.interp(times, middle, turning))


def _grid(record: Recording) -> FloatArray:
    """Times in s at the sampling rate of a record without signals, up to its last pulse, shape (n,)."""
    last = max(float(pulses.times[-1]) for pulses in record.pulses if len(pulses))
    return np.arange(int(last * record.sampling_rate) + 1) / record.sampling_rate
