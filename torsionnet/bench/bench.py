"""Virtual test bench: runs a test on a drivetrain and returns the record."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import ModelError, TorsionnetWarning, UsageError
from torsionnet.base.packages import NotebookResult
from torsionnet.base.table import Column, Table
from torsionnet.bench.plan import Acquisition, Plan, RecordingSystem, StrainGauge, ToothedWheel, Transducer
from torsionnet.bench.plan.bench_checks import check_plan, sensor_of
from torsionnet.bench.plan.plan import Sensing
from torsionnet.bench.recorded_signal import ExciterOutput, drop_out_spans, exciter_output, recorded_signal, shunt_span
from torsionnet.bench.turning_motion import TurningMotion, turning_motions
from torsionnet.bench.wheel_turning import GeneratorFor, TrueFault, TurningWheel, counted_pulses, true_places
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.between_samples import Between
from torsionnet.model.channels import Sensor
from torsionnet.motion.motion_plant import has_laws_of_motion, over_time
from torsionnet.motion.simulate import read_notes
from torsionnet.signals.excitation import Excitation
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PULSE_TIMES, PulseChannel
from torsionnet.signals.rotation.wheel import WheelPattern

# Test on a bench that turns: its records, the truth behind them, and the faults put into them.

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
    truths = {motion.name: true_record(motion, plan, wheels, drivetrain.title) for motion in motions}
    return TurningTest(
        records,
        truths,
        {name: wheel.pattern for name, wheel in wheels.items() if len(wheel.places) > 1},
        numbers,
        faults,
    )


def turning_wheels(plan: Plan) -> dict[str, TurningWheel]:
    """Wheels of a plan by the channels of their pickups, each with the places of its teeth that the seed makes."""
    wheels: dict[str, TurningWheel] = {}
    pickups = {name: part for name, part in plan.channels.items() if isinstance(part, ToothedWheel)}
    for name, part in sorted(
        pickups.items(), key=lambda pickup: bool(pickup[1].wheel)
    ):  # wheels before further pickups
        if part.wheel:
            wheels[name] = replace(wheels[part.wheel], channel=name, pickup_angle=part.pickup_angle)
            continue
        places = true_places(name, part, _generators([plan.seed], name))
        wheels[name] = TurningWheel(name, name, part, part.pickup_angle, places)
    return {name: wheels[name] for name in pickups}


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
    pulses = tuple(PulseChannel(name, wheel.passages(motion)[0]) for name, wheel in wheels.items())
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
        pulses = tuple(
            channel for name in self.wheels if name in self.system.channels for channel in self._pulses(name)
        )
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
            self._timed_faults(name)

    def _timed_faults(self, name: str) -> None:
        """Faults of a sampled channel that have a time: drop-outs and the calibration by a shunt."""
        part, count = self.plan.channels[name], len(self.times)
        if isinstance(part, StrainGauge) and part.shunt is not None and count:
            span = shunt_span(part, count, self.acquisition)
            at = float(self.times[min(span.start, count - 1)])
            self.faults.append(TrueFault(name, "shunt calibration", at, float(part.shunt.value.value)))
        if isinstance(part, Transducer) and part.drop_outs is not None:
            rate = self.acquisition.rate
            # Spawned as in the recorded signal, so that these are the drop-outs of the record.
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
            # The index is neither lost nor doubled.
            part = pickup if called == name else replace(pickup, missing_pulses=0.0, double_pulses=0.0)
            counted = counted_pulses(called, times, teeth, part, _generators(self.begin, called), self._shown)
            self.numbers[called] = counted.numbers
            self.faults += counted.faults
            yield counted.channel

    def _shown(self, times: FloatArray) -> FloatArray:
        """Times in s on the clock of the system, of times of the test."""
        return np.asarray((times - self.system.offset) * (1 + self.system.drift))


@dataclass(frozen=True, repr=False)
class Bench(NotebookResult):
    """Drivetrain with the plan of a test on it: excitation or motion, channels and data acquisition.

    Raises
    ------
    ModelError
        The plan names inputs or sensors that the model does not have, or units do not fit.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.bench.plan import Acquisition, Encoder, Plan, Transducer
    >>> plan = Plan(
    ...     excitation=tn.signals.LinearChirp(start=1, stop=20, duration=10, amplitude=15),
    ...     channels={"T_T": Transducer(noise="0.23 N*m"), "theta_1": Encoder(lines=1024, quadrature=True)},
    ...     acquisition=Acquisition(rate="2 kHz"),
    ... )
    >>> Bench(tn.load("dmf_rig"), plan).run()
    <Recording T_M_set, T_T, theta_1: 20000 samples at 2000 Hz, 10 s>
    """

    drivetrain: Drivetrain
    plan: Plan

    def __post_init__(self) -> None:
        faults = check_plan(self.plan, self.drivetrain.definition, values=self.drivetrain.exact_values)
        if faults:
            raise ModelError(faults, f"the bench of {self.drivetrain.title}")

    def table(self) -> Table:
        """Table of the channels: the sensor and quantity that each reads, and by what."""
        sensors = self.sensors
        rows = tuple((name, _quantity(part, sensors.get(name)), part.kind) for name, part in self.plan.channels.items())
        columns = (Column("channel"), Column("quantity"), Column("read by"))
        rate = f"{self.plan.acquisition.rate:g} Hz"
        return Table(self.title, columns, rows, (f"{self._what}, recorded at {rate}",))

    @property
    def _what(self) -> str:
        if self.plan.motion is not None:
            return self.plan.motion.described
        excitation = not_none(self.plan.excitation)
        return f"{excitation.kind} of {excitation.length:g} s on {self.drive}"

    @property
    def title(self) -> str:
        """Name of the drivetrain, and that this is a bench with it."""
        return f"{self.drivetrain.title}: bench"

    @property
    def drive(self) -> str:
        """Name of the model's input on which the exciter's torque acts."""
        return self.plan.drive or next(
            name for name, channel in self.drivetrain.inputs.items() if channel.quantity == "torque"
        )

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        """Sensor of the model that each channel reads, by the name of the channel."""
        sensors = {name: sensor_of(name, self.plan, self.drivetrain.definition) for name in self.plan.channels}
        return {name: sensor for name, sensor in sensors.items() if sensor is not None}

    def configured(self, name: str = "", /, **overrides: Any) -> Bench:
        """Copy of the bench with the drivetrain in another configuration, or with other parameter values.

        Numbers of excitations may be given, too, as ``engine.misfire_share.4``.
        """
        excitations = {
            override for override in overrides if override.partition(".")[0] in self.drivetrain.definition.excitations
        }
        numbers = {override: float(overrides.pop(override)) for override in excitations}
        changed = self.drivetrain.configured(name, **overrides) if name or overrides else self.drivetrain
        return replace(self, drivetrain=changed.with_excitation_numbers(numbers) if numbers else changed)

    @cached_property
    def exciter_output(self) -> ExciterOutput:
        """Set-point and torque of the exciter over time, N m."""
        return exciter_output(self._excitation, self.plan.exciter, self.plan.acquisition.rate)

    @property
    def _excitation(self) -> Excitation:
        if self.plan.excitation is None:
            raise UsageError(
                "a bench with motion: has no exciter; the excitations of its model act", kind="not-applicable"
            )
        return self.plan.excitation

    @cached_property
    def motions(self) -> tuple[TurningMotion, ...]:
        """Motions of a bench that turns: one for each steady point, one along a speed; empty of one that shakes."""
        if self.plan.motion is None:
            return ()
        turned = {name: sensor for name, sensor in self.sensors.items() if not _is_further(self.plan.channels[name])}
        return turning_motions(self.drivetrain, self.plan.motion, turned)

    def turned(self, seed: int | None = None) -> TurningTest:
        """Records of a test that turns, the truth behind them, and the faults put into them.

        Parameters
        ----------
        seed : int, optional
            Of noise, lost pulses and all else that is random but the wheels, whose teeth follow from the seed of the
            plan; default: that one.
        """
        if self.plan.motion is None:
            raise UsageError("this bench shakes; a bench with motion: turns", kind="not-applicable")
        number = self.plan.seed if seed is None else seed
        return turning_test(self.drivetrain, self.plan, self.motions, number, self._what)

    def records(self, seed: int | None = None) -> Mapping[str, Recording]:
        """Records of the test by name: of steady points and of further recording systems; one alone has no name."""
        return {"": self.run(seed)} if self.plan.motion is None else self.turned(seed).records

    @property
    def truths(self) -> Mapping[str, Recording]:
        """Records without errors of measurement by name, one for each steady point; one alone has no name."""
        if self.plan.motion is None:
            return {"": self.truth}
        wheels = turning_wheels(self.plan)
        return {motion.name: true_record(motion, self.plan, wheels, self.drivetrain.title) for motion in self.motions}

    @cached_property
    def truth(self) -> Recording:
        """Record of the torque, and of motion and torques at the sensors, without measurement errors.

        Of a bench that turns with the mean rotation instead of the torque of an exciter.
        """
        if self.plan.motion is not None:
            return _only(self.truths)
        mean = self._excitation.mean
        sensors = self.sensors
        if self._in_full:
            moved = self.drivetrain.simulate(
                list(sensors.values()), {self.drive: self.exciter_output.torque}, self.plan.acquisition.rate,
                initial_state="operating_point",
            )  # fmt: skip
            named = (replace(signal, name=name) for signal, name in zip(moved.signals[1:], sensors, strict=True))
            return replace(moved, signals=(moved[self.drive], *named))
        # Motion about the equilibrium under the mean torque, whose static readings are added afterwards.
        moved = self.drivetrain.simulate(
            list(sensors.values()), {self.drive: self.exciter_output.torque - mean}, self.plan.acquisition.rate
        )
        torque = replace(moved[self.drive], values=self.exciter_output.torque)
        read = zip(sensors, moved.signals[1:], self._equilibrium(mean), strict=True)
        signals = (replace(signal, name=name, values=signal.values + rest) for name, signal, rest in read)
        return replace(moved, signals=(torque, *signals))

    @property
    def _in_full(self) -> bool:
        """Whether the motion about the equilibrium is not that from rest, by a law of motion or what it remembers."""
        laws = has_laws_of_motion(self.drivetrain) and self._excitation.mean != 0
        return laws or over_time(self.drivetrain) is not self.drivetrain

    def _equilibrium(self, mean: float) -> list[float]:
        """Static reading of every channel under the mean torque, in the unit of its sensor."""
        if not mean:
            return [0.0] * len(self.sensors)
        # Static reading: H(0) times the mean torque.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", TorsionnetWarning)
            response = self.drivetrain.frequency_response(list(self.sensors.values()), self.drive, [0.0])
        static = response.values[0, :, 0]
        if not np.all(np.isfinite(static)):
            raise UsageError(
                f"a mean torque of {mean:g} N*m has no equilibrium: {self.drivetrain.title} is free to turn; lock it",
                kind="unbalanced-torques",
            )
        return [float(value.real) * mean for value in static]

    def run(self, seed: int | None = None) -> Recording:
        """Record of the test: the set-point, named after the input with ``_set``, and every channel.

        Of a bench that turns, its only record: several steady points or systems give one each, :meth:`records`.

        Parameters
        ----------
        seed : int, optional
            Seed of this run; default: that of the plan. Noise and the position of an encoder's steps follow from seed
            and configuration, so that two gears do not share them.
        """
        if self.plan.motion is not None:
            return _only(self.records(seed))
        number = self.plan.seed if seed is None else seed
        begin = [number, *self.drivetrain.configuration.encode()]
        generators = np.random.default_rng(begin).spawn(len(self.plan.channels))
        # An exciter with a lag follows a set-point that is held; one without has its torque, which runs straight.
        between: Between = "held" if self.plan.exciter.bandwidth else "straight"
        set_point = Signal(f"{self.drive}_set", "torque", self.exciter_output.set_point, between=between)
        channels = tuple(
            recorded_signal(self.truth[name], part, self.plan.acquisition, rng)
            for (name, part), rng in zip(self.plan.channels.items(), generators, strict=True)
            if not isinstance(part, ToothedWheel)
        )
        rate, title = self.plan.acquisition.rate, self.drivetrain.title
        first = f"virtual test: {title}, {self._described}, seed {number}"
        notes = (first, *self.exciter_output.notes, *read_notes(self.drivetrain, rate))
        return Recording((set_point, *channels), rate, title=title, notes=notes)

    @property
    def _described(self) -> str:
        excitation = self._excitation
        mean = f" about {excitation.mean:g} N*m" if excitation.mean else ""
        return f"{excitation.kind} of {excitation.amplitude:g} N*m{mean}, {excitation.length:g} s"


def _quantity(part: Sensing, sensor: Sensor | None) -> str:
    if isinstance(part, ToothedWheel):
        return PULSE_TIMES
    return sensor.quantity if sensor else "torque"


def _is_further(part: Sensing) -> bool:
    """Whether a channel is a further pickup on the wheel of another channel."""
    return isinstance(part, ToothedWheel) and bool(part.wheel)


def _only(records: Mapping[str, Recording]) -> Recording:
    """The one record of a test, or UsageError that names the records there are."""
    if len(records) == 1:
        return next(iter(records.values()))
    names = ", ".join(name or "that of the first system" for name in records)
    raise UsageError(
        f"this test has {len(records)} records, {names}; take them from records() or truths", kind="wrong-count"
    )
