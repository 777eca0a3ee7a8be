"""Plan of a bench test, with its excitation or motion, exciter, channels and data acquisition."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

from torsionnet.base.entries.composite import Listed, Named, Nested, Typed
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.scalars import NumberTable, RowColumn, Value
from torsionnet.base.entries.spec import MODEL_NAME, Count, Flag, Text, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Rows
from torsionnet.bench.plan.parts import (
    Acquisition,
    Encoder,
    Exciter,
    RecordingSystem,
    StrainGauge,
    ToothedWheel,
    Transducer,
)
from torsionnet.machinery.excitations.speed_range import SPEED
from torsionnet.model.channels import RecordedName
from torsionnet.model.configurations import ConfigurationName
from torsionnet.model.element_base.element_entries import NodeText
from torsionnet.model.operating_point import ExcitationName
from torsionnet.signals.excitation import (
    BurstRandom,
    Excitation,
    LinearChirp,
    LoadCycles,
    LogarithmicSweep,
    Multisine,
    SteppedSine,
)

# Entries of the motion of a bench that turns: steady points, run-up, run-down, coast-down, or a speed over time.

COAST_DOWN_POINTS = 400
"""Number of points of an exponential fall of speed, straight between them: over three time constants the speed is then
right to 1e-5 of it."""


@dataclass(frozen=True, eq=False, repr=False)
class SpeedOverTime(NumberTable[Rows]):
    """Entry of rows ``[[0 s, 300 rpm], [60 s, 750 rpm]]``: a speed over time, straight between the rows."""

    columns: tuple[RowColumn, ...] = (
        RowColumn("time", "time"),
        RowColumn("speed", "speed", negative=False, zero=False),
    )
    fewest: int = 2

    def coerce(self, raw: object) -> Rows:
        return self.rows(raw)


@dataclass(frozen=True, kw_only=True)
class BenchMotion(Declared):
    """Base of the motions of a drivetrain in a test, with the entries that all of them have.

    Attributes
    ----------
    speed_of : str
        Node whose speed it is; by default that of the model's ``speeds:``.
    start_angle : float
        Angle of the reference shaft at the beginning, rad; 0 is where the orders of the model have their phases.
    without : tuple of str
        Excitations of the model that are off.
    outside_speeds : bool
        Whether speeds outside those of the model are meant.
    """

    speed_of: str = entry(NodeText("node whose speed it is; by default that of speeds:"), "")
    start_angle: float = entry(
        Value("angle of the reference shaft at the beginning; 0 is where phases of orders are counted from", "angle",
              lower=None), 0.0
    )  # fmt: skip
    without: tuple[str, ...] = entry(
        Listed(
            "excitations of the model that are off", ExcitationName("the name of an excitation"), form="a list of names"
        ),
        (),
    )
    outside_speeds: bool = entry(Flag("whether speeds outside those of the model are meant"), False)

    @property
    def extremes(self) -> tuple[float, float]:
        """Lowest and highest speed of the reference shaft, rad/s."""
        raise NotImplementedError

    @property
    def described(self) -> str:
        """Text that says what the motion is, with speeds in rpm."""
        low, high = (speed * 30 / math.pi for speed in self.extremes)
        return f"{self.kind}, {low:g} to {high:g} rpm"


@dataclass(frozen=True, kw_only=True)
class SteadyPoints(BenchMotion):
    """Steady speeds, each held for a while and recorded by itself; the time between them is left out.

    Examples
    --------
    >>> points = SteadyPoints(speeds=["600 rpm", "900 rpm"], duration="20 s")
    >>> points.described
    'steady points, 600 to 900 rpm'
    """

    kind: ClassVar[str] = "steady points"

    speeds: tuple[float, ...] = entry(Listed("speeds of the points", SPEED, form="a list of speeds"))
    duration: float = entry(Value("time recorded at each", "time", exclusive=True))

    def contradictions(self) -> list[Fault]:
        if not self.speeds:
            return [Fault("give at least one speed", ("speeds",), kind="missing-entry")]
        if len(set(self.speeds)) < len(self.speeds):
            return [
                Fault(
                    "a speed is given twice, which would give two records of one name",
                    ("speeds",),
                    kind="repeated-name",
                )
            ]
        return []

    @property
    def extremes(self) -> tuple[float, float]:
        return min(self.speeds), max(self.speeds)


@dataclass(frozen=True, kw_only=True)
class RunUp(BenchMotion):
    """A speed that rises straight over time.

    Examples
    --------
    >>> run = RunUp(start="300 rpm", stop="750 rpm", rate="10 rpm/s")
    >>> round(run.length, 9)
    45.0
    """

    kind: ClassVar[str] = "run-up"
    rises: ClassVar[bool] = True

    start: float = entry(SPEED)
    stop: float = entry(SPEED)
    duration: float | None = entry(Value("time from start to stop", "time", exclusive=True), None)
    rate: float | None = entry(Value("instead: change of the speed", "acceleration", exclusive=True), None)

    def contradictions(self) -> list[Fault]:
        faults = []
        if (self.duration is None) == (self.rate is None):
            text = f"a {self.kind} takes a duration or has a rate; here is {'both' if self.rate else 'neither'}"
            kind = "contradicting-entries" if self.rate else "missing-entry"
            faults.append(Fault(text, ("rate",) if self.rate else (), on_key=True, kind=kind))
        if self.start == self.stop or (self.start < self.stop) != self.rises:
            text = f"a {self.kind} goes to a {'higher' if self.rises else 'lower'} speed"
            faults.append(
                Fault(
                    f"{text}; from {_rpm(self.start)} to {_rpm(self.stop)} is none",
                    ("stop",),
                    kind="contradicting-values",
                )
            )
        return faults

    @property
    def length(self) -> float:
        """Time from start to stop, s."""
        return self.duration or abs(self.stop - self.start) / not_none(self.rate)

    @property
    def extremes(self) -> tuple[float, float]:
        return min(self.start, self.stop), max(self.start, self.stop)


@dataclass(frozen=True, kw_only=True)
class RunDown(RunUp):
    """A speed that falls straight over time.

    Examples
    --------
    >>> RunDown(start="750 rpm", stop="300 rpm", duration="60 s").length
    60.0
    """

    kind: ClassVar[str] = "run-down"
    rises: ClassVar[bool] = False


@dataclass(frozen=True, kw_only=True)
class CoastDown(BenchMotion):
    """A speed that falls by itself: with a time constant, or by the drag of the model's load.

    Without a time constant the torque that the load absorbs at each speed brakes all inertias that turn with the
    reference shaft. An engine that runs out without injection is a configuration with ``gas_off`` or ``misfire`` of all
    its cylinders; what does not act at all stands in ``without``.

    Examples
    --------
    >>> coast = CoastDown(start="1500 rpm", stop="300 rpm", time_constant="20 s")
    >>> times, speeds = coast.fall()
    >>> round(times[-1], 4), round(speeds[-1], 4)
    (32.1888, 31.4159)
    """

    kind: ClassVar[str] = "coast-down"

    start: float = entry(SPEED)
    stop: float = entry(SPEED)
    time_constant: float | None = entry(
        Value("time in which the speed falls to 1/e; without it the load of the model brakes", "time", exclusive=True),
        None,
    )

    def contradictions(self) -> list[Fault]:
        if self.start > self.stop:
            return []
        text = f"a coast-down goes to a lower speed; from {_rpm(self.start)} to {_rpm(self.stop)} is none"
        return [Fault(text, ("stop",), kind="contradicting-values")]

    @property
    def extremes(self) -> tuple[float, float]:
        return self.stop, self.start

    def fall(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times in s and speeds in rad/s of the fall with the given time constant, both of one length."""
        tau = not_none(self.time_constant)
        # Omega = Omega_0 exp(-t/tau), so that the stop is reached after tau ln(Omega_0/Omega).
        length = tau * math.log(self.start / self.stop)
        times = [length * place / COAST_DOWN_POINTS for place in range(COAST_DOWN_POINTS + 1)]
        return tuple(times), tuple(self.start * math.exp(-time / tau) for time in times)


@dataclass(frozen=True, kw_only=True)
class GivenSpeed(BenchMotion):
    """A speed given over time by a table, straight between its rows.

    Examples
    --------
    >>> GivenSpeed(table=[["0 s", "300 rpm"], ["20 s", "700 rpm"], ["30 s", "600 rpm"]]).described
    'speed over time, 300 to 700 rpm'
    """

    kind: ClassVar[str] = "speed over time"

    table: Rows = entry(SpeedOverTime("rows of time and speed"))

    @property
    def points(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times in s from the first row on, and speeds in rad/s, both of one length."""
        first = float(self.table[0][0].value)
        return (
            tuple(float(time.value) - first for time, _ in self.table),
            tuple(float(speed.value) for _, speed in self.table),
        )

    @property
    def extremes(self) -> tuple[float, float]:
        speeds = self.points[1]
        return min(speeds), max(speeds)


def _rpm(speed: float) -> str:
    return f"{speed * 30 / math.pi:g} rpm"


MOTIONS: dict[str, type[BenchMotion]] = {cls.kind: cls for cls in (SteadyPoints, RunUp, RunDown, CoastDown, GivenSpeed)}
"""Class of each motion of a bench that turns, by the word in ``type:``."""


# Plan of a bench test, with its excitation, exciter, channels and data acquisition.

SWEEP = "{type: linear chirp, start: 0.1 Hz, stop: 80 Hz, duration: 100 s, amplitude: 15 N*m}"
"""Example of a bench's excitation, for the message that it is missing."""
CHANNELS = "{name of a sensor: {type: encoder, lines: 1024}, ...}"
"""Example of a bench's channels, for the message that they are missing."""
RUN_UP = "{type: run-up, start: 300 rpm, stop: 750 rpm, duration: 60 s}"
"""Example of a bench's motion, for the message that it is missing."""
_MOTION = Typed("how the drivetrain turns", lambda: MOTIONS, "motion", "bench_motion", shown=RUN_UP)
_SYSTEM = Nested("a further recording system", lambda: RecordingSystem, "bench_system")
_EXCITATION = Typed("what the torque is to be", lambda: EXCITATIONS, "excitation", "bench_excitation", shown=SWEEP)
_CHANNEL = Typed("a sensor and its errors", lambda: SENSORS, "sensor", "bench_channel")
_CHANNEL_NAME = RecordedName("a sensor, or a channel with a sensor of its own")
_EXCITER = Nested("the motor that shakes", lambda: Exciter, "bench_exciter")
_ACQUISITION = Nested("sampling of all channels", lambda: Acquisition, "bench_acquisition", shown="{rate: 10 kHz}")


EXCITATIONS: dict[str, type[Excitation]] = {
    cls.kind: cls for cls in (LinearChirp, LogarithmicSweep, SteppedSine, LoadCycles, Multisine, BurstRandom)
}
"""Class of each type of excitation on a bench, by the word in ``type:``."""
Sensing: TypeAlias = Transducer | Encoder | ToothedWheel
"""Type of the entries of a channel of a bench, by what it is read."""
SENSORS: dict[str, type[Sensing]] = {cls.kind: cls for cls in (Transducer, StrainGauge, Encoder, ToothedWheel)}
"""Class of each type of sensor on a bench, by the word in ``type:``."""


@dataclass(frozen=True, kw_only=True)
class Plan(Declared):
    """A test: what drives the drivetrain, what is measured, and how it is recorded.

    Attributes
    ----------
    excitation : Excitation, optional
        Set-point of the torque that shakes the drivetrain.
    motion : BenchMotion, optional
        Instead: how the drivetrain turns under the excitations of its model.
    channels : mapping of str to Transducer, StrainGauge, Encoder or ToothedWheel
        By the name of a sensor of the model, or of any other name with a ``sensor`` of its own.
    acquisition : Acquisition
    exciter : Exciter, optional
        By default delivers its set-point exactly.
    drive : str, optional
        Input of the model on which the torque acts; by default the only one there is.
    seed : int, optional
        Of noise and of the encoders' starting positions; the same seed gives the same record.
    systems : mapping of str to RecordingSystem
        Further recording systems by name, with the channels that they record.
    """

    kind: ClassVar[str] = "bench"
    article: ClassVar[str] = "a bench"
    form: ClassVar[str] = "the entries drive, excitation, motion, exciter, channels, acquisition, seed"

    drive: str = entry(RecordedName("input on which the torque acts, if there are several"), "")
    excitation: Excitation | None = entry(_EXCITATION, None)
    motion: BenchMotion | None = entry(_MOTION, None)
    exciter: Exciter = entry(_EXCITER, Exciter())
    channels: Mapping[str, Sensing] = entry(
        Named("what is recorded, by the name of a sensor", _CHANNEL, form=CHANNELS, fewest=1, keys=_CHANNEL_NAME)
    )
    acquisition: Acquisition = entry(_ACQUISITION)
    seed: int = entry(Count("the same seed gives the same record", lower=0, upper=2**32 - 1), 0)
    systems: Mapping[str, RecordingSystem] = entry(
        Named("further recording systems, by name", _SYSTEM, form="{telemetry: {channels: [T_int], drift: 50 ppm}}"),
        None,
    )

    def contradictions(self) -> list[Fault]:
        if self.excitation is None and self.motion is None:
            text = f"a bench needs excitation: {SWEEP}, which shakes, or motion: {RUN_UP}, which turns"
            return [Fault(text, on_key=True, kind="missing-entry", about="excitation")]
        if self.motion is None:
            return list(self._of_motion_only())
        faults = []
        if self.excitation is not None:
            faults.append(
                Fault(
                    "a bench shakes by excitation: or turns by motion:; leave one out",
                    ("motion",),
                    kind="contradicting-entries",
                )
            )
        if self.drive:
            faults.append(
                Fault(
                    "drive: belongs to excitation:; a bench that turns has none",
                    ("drive",),
                    on_key=True,
                    kind="needless-entry",
                )
            )
        return faults

    def _of_motion_only(self) -> Iterator[Fault]:
        for name, part in self.channels.items():
            if isinstance(part, ToothedWheel):
                yield Fault(
                    "a toothed wheel gives pulses where it turns; give motion:",
                    ("channels", name),
                    on_key=True,
                    kind="missing-entry",
                )
        if self.systems:
            yield Fault("systems: belong to a bench with motion:", ("systems",), on_key=True, kind="needless-entry")


# Bench file, which names a model and describes a test of it.

_PLAN = Nested("a virtual test: excitation, exciter, sensors, data acquisition", lambda: Plan, "bench")


@dataclass(frozen=True, kw_only=True)
class BenchFile(Declared):
    """A test bench that names its model."""

    kind: ClassVar[str] = "bench file"
    article: ClassVar[str] = "a bench file"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the test"), "")
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the test is"), "")
    model: str = entry(
        Text("name of a library model, or path of a model file from the folder of this file", MODEL_NAME)
    )
    configuration: str | None = entry(ConfigurationName("configuration in which the model is tested"), None)
    bench: Plan = entry(_PLAN)
