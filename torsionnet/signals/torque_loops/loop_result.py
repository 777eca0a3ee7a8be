"""Loops of torque over twist with their stages, friction and loss, as results."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.notes import NoteOrText
from torsionnet.base.packages import SavedResult, drawn, imported
from torsionnet.base.result_rows import NUMBERS, Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.signals.recording import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNITS = {
    "stiffness": "N*m/rad", "begins": "rad", "friction": "N*m", "free play": "rad", "torque offset": "N*m",
    "amplitude": "rad", "secant stiffness k_s": "N*m/rad", "loss of a cycle D": "J", "loss factor eta_s": "",
    "storage stiffness k'": "N*m/rad", "loss stiffness k''": "N*m/rad", "loss factor eta_1": "",
    "drift of a cycle": "N*m",
}  # fmt: skip
"""SI unit of each quantity of a loop, by its words in tables."""


@dataclass(frozen=True)
class LoopValue:
    """Mean of a quantity over the cycles of a loop in SI units, with the half width of its 95 % interval.

    Attributes
    ----------
    value : float
    half_width : float or None
        None where a single cycle tells no scatter.
    """

    value: float
    half_width: float | None = None

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the 95 % interval of a quantity of a loop in SI units; infinite where its scatter is not known."""
        half = math.inf if self.half_width is None else self.half_width
        return self.value - half, self.value + half


@dataclass(frozen=True)
class LoopStage:
    """Stage of a loop: a straight piece of the spring line on one side, with its friction.

    Attributes
    ----------
    side : {"drive", "coast", "both"}
        Positive or negative twist; both: mean of the two.
    number : int
        1 for the stage next to zero twist, or next to free play.
    stiffness : LoopValue
        N m/rad.
    begins : LoopValue or None
        Twist in rad, without sign, at which the stage begins; None for the first stage.
    friction : LoopValue
        Half of the distance of the branches, N m.
    """

    side: Annotated[str, Out(schema={"enum": ["drive", "coast", "both"]})]
    number: int
    stiffness: Annotated[LoopValue, Out(json="stiffness_Nm_per_rad")]
    begins: Annotated[LoopValue | None, Out(json="begins_rad")]
    friction: Annotated[LoopValue, Out(json="friction_Nm")]


@dataclass(frozen=True, eq=False)
class TorqueLoop:
    """Loop of torque over twist, run through by cycles that repeat each other, SI units.

    The loss factor eta_s belongs to the secant stiffness, D/(pi k_s a^2), eta_1 to the first harmonic, k''/k'. They
    are different numbers for the same loop.

    Attributes
    ----------
    cycles : int
        Number of cycles behind the intervals; the one before them, running in, is left out.
    frequency : float
        Hz.
    speed : float or None
        Mean speed in rad/s where a channel has it.
    mean_torque, mean_twist : float
    amplitude : LoopValue
        Half of highest less lowest twist, rad.
    stages : tuple of LoopStage
    friction : LoopValue
        Half of the distance of the branches over the whole loop, N m.
    free_play : LoopValue or None
        Whole width of the piece without stiffness, rad.
    torque_offset : LoopValue or None
        Torque of the spring line at zero twist, N m; None where the loop does not pass it.
    secant_stiffness : LoopValue
        k_s from tip to tip, friction counted, N m/rad.
    loss : LoopValue
        D, J.
    eta_s : LoopValue
    storage_stiffness, loss_stiffness : LoopValue
        k' and k'' of the first harmonic, N m/rad.
    eta_1 : LoopValue
    drift : LoopValue
        Rise of the torque from a cycle to the next at the same twist, N m.
    twist, upper, lower, spring_line : (n,) array
        Mean branches and fitted line over a common grid of twists: rad, N m.
    bends : bool
        Whether the spring line bends all along, so that straight stages only stand for it.
    crossing : LoopValue
        Twist behind a reversal in which the torque crosses from a branch to the other, rad.
    relaxation : LoopValue or None
        Torque lost while the twist is held at its highest, N m; None where it is not held.
    """

    cycles: int
    frequency: Annotated[float, Out(json="frequency_Hz")]
    speed: Annotated[float | None, Out(json="speed_rad_per_s")]
    mean_torque: Annotated[float, Out(json="mean_torque_Nm")]
    mean_twist: Annotated[float, Out(json="mean_twist_rad")]
    amplitude: Annotated[LoopValue, Out(json="amplitude_rad")]
    stages: tuple[LoopStage, ...]
    friction: Annotated[LoopValue, Out(json="friction_Nm")]
    free_play: Annotated[LoopValue | None, Out(json="free_play_rad")]
    torque_offset: Annotated[LoopValue | None, Out(json="torque_offset_Nm")]
    secant_stiffness: Annotated[LoopValue, Out(json="secant_stiffness_Nm_per_rad")]
    loss: Annotated[LoopValue, Out(json="loss_J")]
    eta_s: LoopValue
    storage_stiffness: Annotated[LoopValue, Out(json="storage_stiffness_Nm_per_rad")]
    loss_stiffness: Annotated[LoopValue, Out(json="loss_stiffness_Nm_per_rad")]
    eta_1: LoopValue
    drift: Annotated[LoopValue, Out(json="drift_Nm")]
    twist: Annotated[FloatArray, Out(json="twist_rad", schema=NUMBERS)]
    upper: Annotated[FloatArray, Out(json="upper_Nm", schema=NUMBERS)]
    lower: Annotated[FloatArray, Out(json="lower_Nm", schema=NUMBERS)]
    spring_line: Annotated[FloatArray, Out(json="spring_line_Nm", schema=NUMBERS)]
    bends: bool = False
    crossing: Annotated[LoopValue, Out(json="crossing_rad")] = LoopValue(0.0)
    relaxation: Annotated[LoopValue | None, Out(json="relaxation_Nm")] = None

    def side(self, name: str) -> tuple[LoopStage, ...]:
        """Stages of a side of a loop: drive, coast, or both for the mean of the two; empty where there is none."""
        return tuple(stage for stage in self.stages if stage.side == name)

    def quantities(self) -> Iterator[tuple[str, str, LoopValue]]:
        """Quantities of a loop with side and stage, and the words in ``UNITS``."""
        for stage in self.stages:
            where = f"{stage.side}, stage {stage.number}"
            yield where, "stiffness", stage.stiffness
            if stage.begins is not None:
                yield where, "begins", stage.begins
            yield where, "friction", stage.friction
        whole = {
            "free play": self.free_play, "torque offset": self.torque_offset, "friction": self.friction,
            "amplitude": self.amplitude, "secant stiffness k_s": self.secant_stiffness,
            "loss of a cycle D": self.loss, "loss factor eta_s": self.eta_s,
            "storage stiffness k'": self.storage_stiffness, "loss stiffness k''": self.loss_stiffness,
            "loss factor eta_1": self.eta_1, "drift of a cycle": self.drift,
        }  # fmt: skip
        yield from (("whole loop", name, value) for name, value in whole.items() if value is not None)


@dataclass(frozen=True, eq=False, repr=False)
class TorqueLoops(SavedResult):
    """Loops of torque over twist of a record, one for each mean torque, amplitude and speed that it stays at.

    Attributes
    ----------
    loops : tuple of TorqueLoop
    torque, twist : str
        Channels; of two angles "A-B".
    title : str
    notes : tuple of str or Note
        Corrections made, and what spoils the loops and is not corrected.
    """

    loops: tuple[TorqueLoop, ...]
    torque: str
    twist: str
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()

    SHOWN: ClassVar = ("title", "torque", "twist", "notes", "loops")

    def figure(self, **look: Any) -> Figure:
        """Figure of the loops with their branches, spring lines and breaks.

        ``look``: ``conventions``, ``title``, ``ax``.
        """
        figure: Figure = imported("torsionnet.plot.signal_plots:torque_loops")(self, **look)
        return figure

    def _picture(self) -> str:
        return drawn(lambda _: self.figure())

    def table(self, conventions: Conventions = SI) -> Table:
        """Table with a row for each quantity of each loop, with its 95 % interval; angles in the unit asked for."""
        columns = (
            Column("loop"), Column("mean torque", "N*m", 4), Column("amplitude", conventions.unit("rad"), 4),
            Column("speed", "rpm", 4), Column("where"), Column("quantity"), Column("value", digits=6),
            Column("+-", digits=2), Column("unit"),
        )  # fmt: skip
        rows: list[tuple[object, ...]] = []
        for number, loop in enumerate(self.loops, 1):
            rpm = None if loop.speed is None else loop.speed * RPM
            point = (number, loop.mean_torque, loop.amplitude.value * conventions.scale("rad"), rpm)
            for where, name, value in loop.quantities():
                unit = UNITS[name]
                scale = conventions.scale(unit) if unit == "rad" else 1.0
                half = None if value.half_width is None else value.half_width * scale
                shown = conventions.unit(unit) if unit == "rad" else unit
                rows.append((*point, where, name, value.value * scale, half, shown))
        counts = ", ".join(f"{loop.cycles} at {loop.frequency:.4g} Hz" for loop in self.loops)
        head = f"{self.title}: {self.torque} over {self.twist}" if self.title else f"{self.torque} over {self.twist}"
        return Table(head, columns, tuple(rows), (f"cycles of the loops: {counts}", *map(str, self.notes)))
