"""A drivetrain on a test bench: run the test, get the record."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.bench.exciting import Delivered, deliver
from torsionnet.bench.sensing import sensed
from torsionnet.core.errors import ModelError, TorsionnetWarning, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.bench import Plan
from torsionnet.model.bench.bench_checks import check_plan, sensor_of
from torsionnet.model.channels import Sensor
from torsionnet.response.recording import Recording, Signal


@dataclass(frozen=True)
class Bench:
    """A drivetrain and the test it is put to.

    Raises
    ------
    ModelError
        The plan names inputs or sensors that the model does not have, or units do not fit.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.model.bench import Acquisition, Encoder, Plan, Transducer
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
        faults = check_plan(self.plan, self.drivetrain.definition)
        if faults:
            raise ModelError(faults, f"the bench of {self.drivetrain.title}")

    @property
    def drive(self) -> str:
        """Name of the input on which the torque acts."""
        return self.plan.drive or next(
            name for name, channel in self.drivetrain.inputs.items() if channel.quantity == "torque"
        )

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        """What every channel measures."""
        found = {name: sensor_of(name, part, self.drivetrain.definition) for name, part in self.plan.channels.items()}
        return {name: sensor for name, sensor in found.items() if sensor is not None}

    def configured(self, name: str = "", /, **overrides: Any) -> Bench:
        """The same test on a drivetrain in another configuration, or with other parameter values."""
        return replace(self, drivetrain=self.drivetrain.configured(name, **overrides))

    @cached_property
    def delivered(self) -> Delivered:
        """Set-point and torque of the exciter."""
        return deliver(self.plan.excitation, self.plan.exciter, self.plan.acquisition.rate)

    @cached_property
    def truth(self) -> Recording:
        """Torque delivered and what the sensors stand on, without any error of measurement."""
        mean = self.plan.excitation.mean
        sensors = self.sensors
        moved = self.drivetrain.simulate(
            list(sensors.values()), {self.drive: self.delivered.torque - mean}, self.plan.acquisition.rate
        )
        torque = replace(moved[self.drive], values=self.delivered.torque)
        read = zip(sensors, moved.signals[1:], self._equilibrium(mean), strict=True)
        signals = (Signal(name, signal.quantity, signal.values + rest) for name, signal, rest in read)
        return replace(moved, signals=(torque, *signals))

    def _equilibrium(self, mean: float) -> list[float]:
        """Every reading under the mean torque."""
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
        """The record of the test: the set-point, named after the input with ``_set``, and every channel.

        Parameters
        ----------
        seed : int, optional
            Instead of the plan's, for another run of the same test. Noise and the place of an encoder's steps follow
            from it and from the configuration: two gears do not share them.
        """
        number = self.plan.seed if seed is None else seed
        begin = [number, *self.drivetrain.configuration.encode()]
        generators = np.random.default_rng(begin).spawn(len(self.plan.channels))
        set_point = Signal(f"{self.drive}_set", "torque", self.delivered.set_point)
        channels = tuple(
            sensed(self.truth[name], part, self.plan.acquisition, rng)
            for (name, part), rng in zip(self.plan.channels.items(), generators, strict=True)
        )
        notes = (f"virtual test: {self.drivetrain.title}, {self._described}, seed {number}", *self.delivered.notes)
        return Recording((set_point, *channels), self.plan.acquisition.rate, title=self.drivetrain.title, notes=notes)

    @property
    def _described(self) -> str:
        excitation = self.plan.excitation
        mean = f" about {excitation.mean:g} N*m" if excitation.mean else ""
        return f"{excitation.kind} of {excitation.amplitude:g} N*m{mean}, {excitation.length:g} s"
