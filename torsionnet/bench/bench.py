"""Virtual test bench: runs a test on a drivetrain and returns the record."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import ModelError, TorsionnetWarning, UsageError
from torsionnet.base.packages import NotebookResult
from torsionnet.base.table import Column, Table
from torsionnet.bench.exciter_torque import ExciterOutput, exciter_output
from torsionnet.bench.plan import Plan, ToothedWheel
from torsionnet.bench.plan.bench_checks import check_plan, sensor_of
from torsionnet.bench.plan.plan import Sensing
from torsionnet.bench.recorded_signal import recorded_signal
from torsionnet.bench.turning_motion import TurningMotion, turning_motions
from torsionnet.bench.turning_test import TurningTest, true_record, turning_test, turning_wheels
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.between_samples import Between
from torsionnet.model.channels import Sensor
from torsionnet.motion.simulate import read_notes
from torsionnet.signals.excitation.excitation import Excitation
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.rotation.pulse_channel import PULSE_TIMES


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
        found = {name: sensor_of(name, self.plan, self.drivetrain.definition) for name in self.plan.channels}
        return {name: sensor for name, sensor in found.items() if sensor is not None}

    def configured(self, name: str = "", /, **overrides: Any) -> Bench:
        """Copy of the bench with the drivetrain in another configuration, or with other parameter values.

        Numbers of excitations may be given, too, as ``engine.misfire_share.4``.
        """
        excitations = {one for one in overrides if one.partition(".")[0] in self.drivetrain.definition.excitations}
        numbers = {one: float(overrides.pop(one)) for one in excitations}
        changed = self.drivetrain.configured(name, **overrides) if name or overrides else self.drivetrain
        return replace(self, drivetrain=changed.with_excitation_numbers(numbers) if numbers else changed)

    @cached_property
    def exciter_output(self) -> ExciterOutput:
        """Set-point and torque of the exciter over time, N m."""
        return exciter_output(self._excitation, self.plan.exciter, self.plan.acquisition.rate)

    @property
    def _excitation(self) -> Excitation:
        if self.plan.excitation is None:
            raise UsageError("a bench with motion: has no exciter; the excitations of its model act")
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
            raise UsageError("this bench shakes; a bench with motion: turns")
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
        return {one.name: true_record(one, self.plan, wheels, self.drivetrain.title) for one in self.motions}

    @cached_property
    def truth(self) -> Recording:
        """Record of the torque, and of motion and torques at the sensors, without measurement errors.

        Of a bench that turns with the mean rotation instead of the torque of an exciter.
        """
        if self.plan.motion is not None:
            return _only(self.truths)
        mean = self._excitation.mean
        sensors = self.sensors
        moved = self.drivetrain.simulate(
            list(sensors.values()), {self.drive: self.exciter_output.torque - mean}, self.plan.acquisition.rate
        )
        torque = replace(moved[self.drive], values=self.exciter_output.torque)
        read = zip(sensors, moved.signals[1:], self._equilibrium(mean), strict=True)
        signals = (replace(signal, name=name, values=signal.values + rest) for name, signal, rest in read)
        return replace(moved, signals=(torque, *signals))

    def _equilibrium(self, mean: float) -> list[float]:
        """Static reading of every channel under the mean torque, in the unit of its sensor."""
        if not mean:
            return [0.0] * len(self.sensors)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", TorsionnetWarning)
            response = self.drivetrain.frequency_response(list(self.sensors.values()), self.drive, [0.0])
        static = response.values[0, :, 0]
        if not np.all(np.isfinite(static)):
            raise UsageError(
                f"a mean torque of {mean:g} N*m has no equilibrium: {self.drivetrain.title} is free to turn; lock it"
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
    raise UsageError(f"this test has {len(records)} records, {names}; take them from records() or truths")
