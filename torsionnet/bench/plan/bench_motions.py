"""Entries of the motion of a bench that turns: steady points, run-up, run-down, coast-down, or a speed over time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import NumberTable, RowColumn, Value
from torsionnet.base.entries.spec import Flag, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Rows
from torsionnet.machinery.excitations.speed_range import SPEED
from torsionnet.model.element_base.element_entries import NodeText
from torsionnet.model.operating_point import ExcitationName

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
