"""Test on a bench that turns: its records, the truth behind them, and the faults put into them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.bench.gauge_chain import drop_out_spans, shunt_span
from torsionnet.bench.plan import Acquisition, Plan, RecordingSystem, StrainGauge, ToothedWheel, Transducer
from torsionnet.bench.pulse_faults import counted_pulses
from torsionnet.bench.recorded_signal import recorded_signal
from torsionnet.bench.true_fault import TrueFault
from torsionnet.bench.turning_motion import TurningMotion
from torsionnet.bench.wheel_turning import GeneratorFor, TurningWheel, true_places
from torsionnet.drivetrain import Drivetrain
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel_pattern import WheelPattern

FIRST_SYSTEM = RecordingSystem(channels=())
"""System that records all channels that no other one does, on the clock of the test."""
INDEX = "_index"
"""End of the name of the channel that holds a wheel's pulse per turn."""
MEAN_ANGLE, MEAN_SPEED = "mean_angle", "mean_speed"
"""Names of the true mean angle and mean speed of the reference shaft in a record of the truth."""
ANGLE = "_angle"
"""End of the name of the signal that holds the true angle of a wheel's node: the name alone is that of its pulses."""


@dataclass(frozen=True, eq=False)
class TurningTest:
    """Records of a virtual test on a drivetrain that turns, with the truth behind them.

    Attributes
    ----------
    records : mapping of str to Recording
        Records by name: of a steady point, of a further recording system, or of both; empty for the only one.
    truths : mapping of str to Recording
        For each motion the true signals on the clock of the test, with the mean angle and speed of the reference shaft
        and the times at which all teeth that there are pass the pickups.
    patterns : mapping of str to WheelPattern
        True places of the teeth by channel, of wheels with two teeth or more.
    numbers : mapping of str to (mapping of str to (n,) int array)
        By record and channel the true number of the tooth of each recorded pulse, counted on from turn to turn.
    faults : mapping of str to tuple of TrueFault
        Faults by record.
    """

    records: Mapping[str, Recording]
    truths: Mapping[str, Recording]
    patterns: Mapping[str, WheelPattern]
    numbers: Mapping[str, Mapping[str, NDArray[np.intp]]]
    faults: Mapping[str, tuple[TrueFault, ...]]


def turning_test(
    drivetrain: Drivetrain, plan: Plan, motions: Sequence[TurningMotion], seed: int, described: str
) -> TurningTest:
    """Test of a plan with a motion; ``seed`` decides all that is random but the wheels, which the plan's seed makes."""
    wheels = turning_wheels(plan)
    records: dict[str, Recording] = {}
    numbers: dict[str, Mapping[str, NDArray[np.intp]]] = {}
    faults: dict[str, tuple[TrueFault, ...]] = {}
    begin = [seed, *drivetrain.configuration.encode()]
    for motion in motions:
        notes = (f"virtual test: {drivetrain.title}, {described}, seed {seed}", *motion.notes)
        for name, system in _systems(plan).items():
            run = _Run(plan, motion, system, wheels, [*begin, *motion.name.encode()])
            record = replace(run.record(), title=drivetrain.title, notes=notes)
            if not record.signals and not record.pulses:
                continue
            called = "_".join(filter(None, (motion.name, name)))
            records[called], numbers[called], faults[called] = record, run.numbers, tuple(run.faults)
    truths = {one.name: true_record(one, plan, wheels, drivetrain.title) for one in motions}
    return TurningTest(
        records, truths, {name: one.pattern for name, one in wheels.items() if len(one.places) > 1}, numbers, faults
    )


def turning_wheels(plan: Plan) -> dict[str, TurningWheel]:
    """Wheels of a plan by the channels of their pickups, each with the places of its teeth that the seed makes."""
    found: dict[str, TurningWheel] = {}
    pickups = {name: part for name, part in plan.channels.items() if isinstance(part, ToothedWheel)}
    for name, part in sorted(pickups.items(), key=lambda one: bool(one[1].wheel)):  # wheels before further pickups
        if part.wheel:
            found[name] = replace(found[part.wheel], channel=name, pickup_angle=part.pickup_angle)
            continue
        places = true_places(name, part, _generators([plan.seed], name))
        found[name] = TurningWheel(name, name, part, part.pickup_angle, places)
    return {name: found[name] for name in pickups}


def true_record(motion: TurningMotion, plan: Plan, wheels: Mapping[str, TurningWheel], title: str) -> Recording:
    """Record of what is there, on the clock of the test: true signals, mean rotation, and passages of all teeth."""
    times = _samples(motion, plan.acquisition.rate, FIRST_SYSTEM)
    signals = [
        Signal(MEAN_ANGLE, "angle", motion.mean.angle(times), (f"of {motion.reference}",)),
        Signal(MEAN_SPEED, "velocity", motion.mean.speed(times), (f"of {motion.reference}",)),
    ]
    signals += [
        Signal(f"{name}{ANGLE}" if name in wheels else name, motion.quantity(name), motion.read(name, times))
        for name in motion.channels
    ]
    pulses = tuple(PulseChannel(name, one.passages(motion)[0]) for name, one in wheels.items())
    notes = (f"truth without errors of measurement; angle 0 of {motion.reference} is where phases are counted from",
             *motion.notes)  # fmt: skip
    return Recording(tuple(signals), plan.acquisition.rate, title=title, notes=notes, pulses=pulses)


def _systems(plan: Plan) -> dict[str, RecordingSystem]:
    elsewhere = {name for system in plan.systems.values() for name in system.channels}
    first = replace(FIRST_SYSTEM, channels=tuple(name for name in plan.channels if name not in elsewhere))
    return {"": first, **plan.systems}


def _samples(motion: TurningMotion, rate: float, system: RecordingSystem) -> FloatArray:
    """Times in s of the test at which a system samples, up to its end, shape (n,)."""
    step = 1 / (rate * (1 + system.drift))
    count = int((motion.mean.length - system.offset) / step * (1 + 1e-12))
    return np.asarray(system.offset + step * np.arange(max(count, 0)), dtype=float)


def _generators(begin: list[int], channel: str) -> GeneratorFor:
    return lambda fault: np.random.default_rng([*begin, *channel.encode(), 0, *fault.encode()])


class _Run:
    """Record of one system in one motion while it is made, with the faults put into it."""

    def __init__(
        self, plan: Plan, motion: TurningMotion, system: RecordingSystem, wheels: Mapping[str, TurningWheel],
        begin: list[int],
    ) -> None:  # fmt: skip
        self.plan, self.motion, self.system, self.wheels, self.begin = plan, motion, system, wheels, begin
        self.acquisition: Acquisition = replace(plan.acquisition, rate=system.rate or plan.acquisition.rate)
        self.times = _samples(motion, self.acquisition.rate, system)
        self.faults: list[TrueFault] = []
        self.numbers: dict[str, NDArray[np.intp]] = {}

    def record(self) -> Recording:
        """Record of the channels of the system, without title and notes."""
        signals = tuple(self._signals())
        pulses = tuple(one for name in self.wheels if name in self.system.channels for one in self._pulses(name))
        return Recording(signals, self.acquisition.rate, pulses=pulses)

    def _signals(self) -> Iterator[Signal]:
        for name in self.system.channels:
            part = self.plan.channels[name]
            if isinstance(part, ToothedWheel):
                continue
            late = np.maximum(self.times - part.delay, 0.0)  # before it began, the first value
            truth = Signal(name, self.motion.quantity(name), self.motion.read(name, late))
            noise = _generators(self.begin, name)("noise")
            yield recorded_signal(truth, replace(part, delay=0.0), self.acquisition, noise)
            self._tell(name)

    def _tell(self, name: str) -> None:
        """Faults of a sampled channel that have a time: drop-outs and the calibration by a shunt."""
        part, count = self.plan.channels[name], len(self.times)
        if isinstance(part, StrainGauge) and part.shunt is not None and count:
            span = shunt_span(part, count, self.acquisition)
            at = float(self.times[min(span.start, count - 1)])
            self.faults.append(TrueFault(name, "shunt calibration", at, float(part.shunt.value.value)))
        if isinstance(part, Transducer) and part.drop_outs is not None:
            rate = self.acquisition.rate
            _, own = _generators(self.begin, name)("noise").spawn(2)
            self.faults += [
                TrueFault(name, "drop-out", float(self.times[span.start]), (span.stop - span.start) / rate)
                for span in drop_out_spans(part, count, self.acquisition, own)
            ]  # fmt: skip

    def _pulses(self, name: str) -> Iterator[PulseChannel]:
        wheel, pickup = self.wheels[name], self.plan.channels[name]
        assert isinstance(pickup, ToothedWheel)
        passages = {name: wheel.passages(self.motion)}
        if pickup.index:
            index = wheel.index_passages(self.motion)
            passages[f"{name}{INDEX}"] = index, np.arange(len(index))
        for called, (times, teeth) in passages.items():
            part = pickup if called == name else replace(pickup, missing_pulses=0.0, double_pulses=0.0)
            counted = counted_pulses(called, times, teeth, part, _generators(self.begin, called), self._shown)
            self.numbers[called] = counted.numbers
            self.faults += counted.faults
            yield counted.channel

    def _shown(self, times: FloatArray) -> FloatArray:
        """Times in s on the clock of the system, of times of the test."""
        return np.asarray((times - self.system.offset) * (1 + self.system.drift))
