"""Virtual test bench: runs a test on a drivetrain and returns the record."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.bench.exciter_torque import ExciterOutput, exciter_output, quantised
from torsionnet.core.entries.spec import not_none
from torsionnet.core.errors import ModelError, TorsionnetWarning, UsageError
from torsionnet.core.notebook import NotebookResult
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.bench import Acquisition, Encoder, Plan, Transducer
from torsionnet.model.bench.bench_checks import check_plan, sensor_of
from torsionnet.model.channels import Sensor
from torsionnet.response.recording import FloatArray, Recording, Signal
from torsionnet.response.table import Column, Table

ANTI_ALIAS_ORDER = 4
"""Order of the Butterworth anti-alias filter of the analog channels."""


@dataclass(frozen=True, repr=False)
class Bench(NotebookResult):
    """Drivetrain with the plan of a test on it: excitation, exciter, channels and data acquisition.

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

    def table(self) -> Table:
        """Table of the channels: the sensor and quantity that each reads, and by what."""
        sensors = self.sensors
        rows = tuple(
            (name, sensors[name].quantity if name in sensors else "torque", part.kind)
            for name, part in self.plan.channels.items()
        )
        torque = f"{self.plan.excitation.kind} of {self.plan.excitation.length:g} s on {self.drive}"
        columns = (Column("channel"), Column("quantity"), Column("read by"))
        rate = f"{self.plan.acquisition.rate:g} Hz"
        return Table(self.title, columns, rows, (f"{torque}, recorded at {rate}",))

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
        found = {name: sensor_of(name, part, self.drivetrain.definition) for name, part in self.plan.channels.items()}
        return {name: sensor for name, sensor in found.items() if sensor is not None}

    def configured(self, name: str = "", /, **overrides: Any) -> Bench:
        """Copy of the bench with the drivetrain in another configuration, or with other parameter values."""
        return replace(self, drivetrain=self.drivetrain.configured(name, **overrides))

    @cached_property
    def exciter_output(self) -> ExciterOutput:
        """Set-point and torque of the exciter over time."""
        return exciter_output(self.plan.excitation, self.plan.exciter, self.plan.acquisition.rate)

    @cached_property
    def truth(self) -> Recording:
        """Record of the exciter's torque and of the motion and torques at the sensors, without measurement errors."""
        mean = self.plan.excitation.mean
        sensors = self.sensors
        moved = self.drivetrain.simulate(
            list(sensors.values()), {self.drive: self.exciter_output.torque - mean}, self.plan.acquisition.rate
        )
        torque = replace(moved[self.drive], values=self.exciter_output.torque)
        read = zip(sensors, moved.signals[1:], self._equilibrium(mean), strict=True)
        signals = (Signal(name, signal.quantity, signal.values + rest) for name, signal, rest in read)
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

        Parameters
        ----------
        seed : int, optional
            Seed of this run; default: that of the plan. Noise and the position of an encoder's steps follow from seed
            and configuration, so that two gears do not share them.
        """
        number = self.plan.seed if seed is None else seed
        begin = [number, *self.drivetrain.configuration.encode()]
        generators = np.random.default_rng(begin).spawn(len(self.plan.channels))
        set_point = Signal(f"{self.drive}_set", "torque", self.exciter_output.set_point)
        channels = tuple(
            recorded_signal(self.truth[name], part, self.plan.acquisition, rng)
            for (name, part), rng in zip(self.plan.channels.items(), generators, strict=True)
        )
        notes = (f"virtual test: {self.drivetrain.title}, {self._described}, seed {number}", *self.exciter_output.notes)
        return Recording((set_point, *channels), self.plan.acquisition.rate, title=self.drivetrain.title, notes=notes)

    @property
    def _described(self) -> str:
        excitation = self.plan.excitation
        mean = f" about {excitation.mean:g} N*m" if excitation.mean else ""
        return f"{excitation.kind} of {excitation.amplitude:g} N*m{mean}, {excitation.length:g} s"


def recorded_signal(
    truth: Signal, part: Transducer | Encoder, acquisition: Acquisition, rng: np.random.Generator
) -> Signal:
    """Signal that one channel records of a true signal, with the errors of its transducer or encoder."""
    late = replace(truth, values=_delayed(truth.values, part.delay * acquisition.rate))
    return _encoded(late, part, rng) if isinstance(part, Encoder) else _transduced(late, part, acquisition, rng)


def _encoded(truth: Signal, encoder: Encoder, rng: np.random.Generator) -> Signal:
    """Angle counted by an incremental encoder in whole steps, 0 at the first sample.

    The position of the shaft between two edges at the first sample is random.
    """
    step = 2 * np.pi / encoder.steps
    place = rng.random()
    counts = np.floor((truth.values - truth.values[0]) / step + place)
    way = "in quadrature" if encoder.quadrature else "one step each"
    note = f"encoder of {encoder.lines} lines, {way}: steps of {np.degrees(step):.6g} deg"
    return replace(truth, values=step * counts, notes=(*truth.notes, note))


def _transduced(truth: Signal, part: Transducer, acquisition: Acquisition, rng: np.random.Generator) -> Signal:
    """Signal of a transducer: gain, noise, offset, anti-alias filter, range and quantisation applied."""
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
            values = quantised(values, 2 * limit / 2**acquisition.bits)
    return replace(truth, values=values, notes=tuple(notes))


def _filtered(values: FloatArray, acquisition: Acquisition) -> FloatArray:
    """Values behind the anti-alias low-pass, which has settled at the first value; delayed as in a real one."""
    from scipy.signal import butter, sosfilt, sosfilt_zi

    sections = butter(ANTI_ALIAS_ORDER, not_none(acquisition.anti_alias), fs=acquisition.rate, output="sos")
    settled = sosfilt_zi(sections) * values[0]
    return np.asarray(sosfilt(sections, values, zi=settled)[0])


def _delayed(values: FloatArray, samples: float) -> FloatArray:
    """Values delayed by a number of samples, whole or not, by cubic interpolation; the first value before the start."""
    if samples == 0:
        return values
    from scipy.interpolate import CubicSpline

    places = np.arange(len(values)) - samples
    return np.asarray(
        np.where(places > 0, CubicSpline(np.arange(len(values)), values)(np.maximum(places, 0)), values[0])
    )
