"""A drivetrain on a test bench: run the test, get the record."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.bench.exciting import Delivered, deliver, rounded
from torsionnet.core.entries.spec import present
from torsionnet.core.errors import ModelError, TorsionnetWarning, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.bench import Acquisition, Encoder, Plan, Transducer
from torsionnet.model.bench.bench_checks import check_plan, sensor_of
from torsionnet.model.channels import Sensor
from torsionnet.response.recording import FloatArray, Recording, Signal

ORDER = 4
"""Of the anti-alias filter in the analog channels."""
PAD_CYCLES = 20
"""Cycles of its cut-off before the record for which the filter has seen the first value."""


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


def sensed(truth: Signal, part: Transducer | Encoder, acquisition: Acquisition, rng: np.random.Generator) -> Signal:
    """What one channel records of a true signal."""
    late = replace(truth, values=_delayed(truth.values, part.delay * acquisition.rate))
    return _encoded(late, part, rng) if isinstance(part, Encoder) else _transduced(late, part, acquisition, rng)


def _encoded(truth: Signal, encoder: Encoder, rng: np.random.Generator) -> Signal:
    """Whole steps of an incremental encoder whose count is 0 at the first sample.

    Where between two edges the shaft stands then is a matter of chance.
    """
    step = 2 * np.pi / encoder.steps
    place = rng.random()
    counts = np.floor((truth.values - truth.values[0]) / step + place)
    way = "in quadrature" if encoder.quadrature else "one step each"
    note = f"encoder of {encoder.lines} lines, {way}: steps of {np.degrees(step):.6g} deg"
    return replace(truth, values=step * counts, notes=(*truth.notes, note))


def _transduced(truth: Signal, part: Transducer, acquisition: Acquisition, rng: np.random.Generator) -> Signal:
    """Gain, noise, offset, anti-alias filter, range and analog input of a transducer."""
    values, notes = part.gain * truth.values, list(truth.notes)
    if part.noise is not None:
        values = values + float(part.noise.value) * rng.standard_normal(len(values))
    if part.offset is not None:
        values = values + float(part.offset.value)
    if acquisition.anti_alias is not None:
        values = _filtered(values, acquisition)
    if part.range is not None:
        limit = float(part.range.value)
        clipped = int(np.count_nonzero(np.abs(values) > limit))
        if clipped:
            notes.append(f"warning: {truth.name} clipped at its range of {limit:g} {truth.unit} in {clipped} samples")
        values = np.clip(values, -limit, limit)
        if acquisition.bits is not None:
            values = rounded(values, 2 * limit / 2**acquisition.bits)
    return replace(truth, values=values, notes=tuple(notes))


def _filtered(values: FloatArray, acquisition: Acquisition) -> FloatArray:
    """Low-pass in front of the analog input, settled at the first value; it delays, as the real one does."""
    from scipy.signal import butter, sosfilt, sosfilt_zi

    sections = butter(ORDER, present(acquisition.anti_alias), fs=acquisition.rate, output="sos")
    settled = sosfilt_zi(sections) * values[0]
    return np.asarray(sosfilt(sections, values, zi=settled)[0])


def _delayed(values: FloatArray, samples: float) -> FloatArray:
    """Values later by a number of samples, whole or not, that begins at rest; cubic between samples."""
    if samples == 0:
        return values
    from scipy.interpolate import CubicSpline

    places = np.arange(len(values)) - samples
    return np.asarray(
        np.where(places > 0, CubicSpline(np.arange(len(values)), values)(np.maximum(places, 0)), values[0])
    )
