"""Critical speeds, crossings of excitation orders with natural frequencies, their margins and generalised forces."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated, ClassVar

from torsionnet.base.conventions import COUNTING_NOTE, NO_VIBRATION
from torsionnet.base.entries.spec import Schema
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import screen_text
from torsionnet.base.packages import SavedResult
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table, result_table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import Channel
from torsionnet.linear.modes.mode_pairs import VibrationMode
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.vector_sums import StarDiagram
from torsionnet.machinery.verdicts.margin_rules import MarginRule

NEGLIGIBLE_FORCE = 1e-9
"""Generalised force, relative to that of one cylinder, below which tables show 0: what rounding leaves of a sum of
zero."""
SAME_MODE_DISTANCE = 0.02
"""Relative difference of natural frequencies up to which modes of two conditions count as the same mode."""
OVERDAMPED_NOTE = "undamped modes that damping leaves no vibration are counted behind all others"
UNDAMPED_ALONE = "damping leaves none of these a vibration; they are numbered as without damping"
"""Text of the note below tables of modes on how overdamped modes are counted."""
EXCITED: Schema = {"type": ["boolean", "null"], "description": "null where nothing says what acts"}
"""JSON Schema of the flag whether a mode is excited, null where no torques are known."""


@dataclass(frozen=True)
class SpeedPeak:
    """Largest amplitude (SI) of one order of an output near a critical speed, and the speed in rad/s where it occurs.

    ``speed`` in rad/s of the reference shaft, ``amplitude`` a peak value in SI units.
    """

    output: str
    speed: Annotated[float, Out(json="rad_per_s")]
    amplitude: float


@dataclass(frozen=True)
class StarVector:
    """Complex vector of a star diagram, without unit, with the names of the cylinder and of the node it acts on."""

    label: str
    node: str
    vector: complex


@dataclass(frozen=True, eq=False)
class ModeWithShape(VibrationMode):
    """Vibration mode with its shape as complex angles by node, without unit, 1 at the node that moves most."""

    shape_by_node: Annotated[Mapping[str, complex], Out(json="shape")]


@dataclass(frozen=True)
class CriticalSpeed:
    """Crossing of an excitation order or fixed frequency with one mode, with its margin and generalised force (N m).

    A line may cross a mode at several speeds; where it comes nearer than a rule permits and does not cross it, this is
    the place where it is nearest, and has no speeds.

    Attributes
    ----------
    mode : VibrationMode
    excitation : str
    order : float
        Order of the shaft of the excitation; 0 for a fixed frequency.
    ratio : Fraction
        Revolutions of that shaft per revolution of the reference shaft.
    fixed : float
        Part of the frequency in Hz that does not depend on speed: the line excites at order * speed + fixed.
    margin : float
        Least distance of a natural frequency (undamped, or ``|lambda|/2pi``) from the excitation frequency at the same
        speed, over the operating range, as a share of the excitation frequency; 0 where the two meet in it.
    required : float or None
        Margin required by the rule; None where it covers nothing.
    generalised_force : float
        ``|sum_n phi_n T_n|`` in N m at the critical speed, for the shape with its largest angle 1; nan where no torque
        is given.
    relative_force : float
        Generalised force over that of one cylinder at the largest amplitude.
    star : StarDiagram or None
    excited : bool or None
        Whether the mode is excited; None where the torques are not known.
    excited_in : tuple of str
        Other conditions (configurations) that excite the mode.
    case : str
        Case with the largest generalised force where several are examined, such as a misfire of each cylinder.
    peaks : tuple of SpeedPeak
    modal_inertia : float
        ``sum_n J_n |phi_n|^2`` in kg m^2, for the shape with its largest angle 1; nan where no torque is given.
    undamped_speed, natural_speed, damped_speed : float
        Speed in rad/s of the reference shaft at which the line meets the undamped frequency, ``|lambda|/2pi`` and
        ``Im lambda/2pi``; nan where it does not.
    nearest_speed : float
        Speed in rad/s of the operating range that has the margin; nan where all have.
    leaps : bool
        Whether the mode leaps over the line there, as a stiffness that changes in steps makes it do.
    force_by_case : tuple of (str, float)
        Name of each case and its generalised force in N m.
    """

    SHOWN: ClassVar = (
        "mode.number", "excitation", "order", "fixed", "of_reference", "undamped_speed", "natural_speed",
        "damped_speed", "margin", "nearest_speed", "required", "generalised_force", "relative_force", "excited",
        "excited_in", "peaks", "star_vectors",
    )  # fmt: skip

    mode: VibrationMode
    excitation: str
    order: float
    ratio: Fraction
    fixed: Annotated[float, Out(json="fixed_Hz")]
    margin: float
    required: float | None = None
    generalised_force: Annotated[float, Out(json="generalised_force_Nm")] = math.nan
    relative_force: float = math.nan
    star: StarDiagram | None = None
    excited: Annotated[bool | None, Out(schema=EXCITED)] = None
    excited_in: tuple[str, ...] = ()
    case: str = ""
    peaks: tuple[SpeedPeak, ...] = ()
    modal_inertia: float = math.nan
    undamped_speed: Annotated[float, Out(json="undamped_rad_per_s")] = math.nan
    natural_speed: Annotated[float, Out(json="natural_rad_per_s")] = math.nan
    damped_speed: Annotated[float, Out(json="damped_rad_per_s")] = math.nan
    nearest_speed: Annotated[float, Out(json="margin_at_rad_per_s")] = math.nan
    leaps: bool = False
    force_by_case: tuple[tuple[str, float], ...] = ()

    def in_case(self, case: str) -> CriticalSpeed:
        """Critical speed with the generalised force of one case, such as a misfire of one cylinder, by its name.

        The critical speed itself, with the force of its worst case, where no force of that case is known.
        """
        force = dict(self.force_by_case).get(case)
        return self if force is None else replace(self, generalised_force=force, case=case)

    @property
    def of_reference(self) -> float:
        """Order of a critical speed in vibrations per revolution of the reference shaft."""
        return self.order * float(self.ratio)

    @property
    def star_vectors(self) -> Annotated[tuple[StarVector, ...], Out(json="star")]:
        """Vectors of the star diagram of a critical speed, one for each cylinder; none without a diagram."""
        star = self.star
        if star is None:
            return ()
        return tuple(map(StarVector, star.labels, star.nodes, star.vectors.tolist()))

    @property
    def equilibrium_amplitude(self) -> float:
        """Equilibrium amplitude in rad of a mode excited by one order, at the node that moves most.

        The twist of the mode if the order acted at rest.

        Generalised force over modal inertia and square of the undamped natural frequency,
        ``Q / (omega^2 sum_n J_n |phi_n|^2)``; nan where no torque is given or the mode exists with damping only.

        References
        ----------
        W. Ker Wilson, Practical Solution of Torsional Vibration Problems, vol. 2, 3rd ed., 1963, "equilibrium
        amplitude"; E. J. Nestorides, A Handbook on Torsional Vibration, 1958, "equilibrium amplitude".

        Examples
        --------
        >>> import torsionnet as tn
        >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
        ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
        >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["500 rpm", "700 rpm"]},
        ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
        >>> angle = fan.critical_speeds().of(1, 2).equilibrium_amplitude  # 10 N m/(1.5 kg m^2 * 1.5e4 rad^2/s^2)
        >>> round(1e3 * angle, 4)
        0.4444
        """
        # Modal stiffness omega^2 sum_n J_n |phi_n|^2, by which the generalised force is the deflection at rest.
        stiffness = self.modal_inertia * (2 * math.pi * self.mode.undamped_frequency) ** 2
        return self.generalised_force / stiffness if stiffness else math.nan

    @property
    def resonant_amplitude(self) -> float:
        """Resonant amplitude in rad of a mode excited by one order, at the node that moves most.

        Equilibrium amplitude times ``1/(2 zeta)``.

        An estimate by one mode alone, without the deflections of the others; infinite without damping.
        """
        return self.equilibrium_amplitude * self.mode.amplification

    @property
    def first_speed(self) -> float:
        """Speed in rad/s at which the line meets the natural, else the undamped frequency, else is nearest to them."""
        speeds = (self.natural_speed, self.undamped_speed, self.nearest_speed)
        return next((speed for speed in speeds if math.isfinite(speed)), math.inf)

    @property
    def own_speed(self) -> float:
        """Critical speed in rad/s of the shaft that bears the excitation, nan where there is none.

        By the natural frequency, of a mode that damping leaves no vibration by the undamped one.
        """
        overdamped = math.isnan(self.mode.natural_frequency)
        return (self.undamped_speed if overdamped else self.natural_speed) * float(self.ratio)

    @property
    def passes(self) -> bool | None:
        """Whether the separation margin of a critical speed is at least what the rule requires, if it requires one.

        None where the rule requires none.
        """
        return None if self.required is None else self.margin >= self.required

    @property
    def remark(self) -> str:
        """Text of the remark on a critical speed in tables, such as 'not excited in this condition', empty if none."""
        said = [self.mode.remark] if self.mode.remark else []
        if self.excited is False:
            elsewhere = phrase("not excited, but in {conditions}", conditions=", ".join(self.excited_in))
            said.append(elsewhere if self.excited_in else phrase("not excited in this condition"))
        elif self.case:
            said.append(self.case)
        if self.leaps:
            said.append(phrase("the mode leaps over the line"))
        elif math.isfinite(self.nearest_speed) and not any(
            map(math.isfinite, (self.undamped_speed, self.natural_speed, self.damped_speed))
        ):
            nearest = screen_text(self.nearest_speed * RPM, 5)
            said.append(phrase("no crossing: nearest at {speed} rpm", speed=nearest))
        return joined("; ", said) if said else ""

    @property
    def line(self) -> str:
        """Order or fixed frequency of the excitation at a critical speed as a text, such as '4.5' or '100 Hz'."""
        if not self.order:
            return f"{self.fixed:g} Hz"
        return f"{self.order:g}" + (f" {self.fixed:+g} Hz" if self.fixed else "")


@dataclass(frozen=True, eq=False, repr=False)
class CriticalSpeeds(SavedResult):
    """Critical speeds in and near an operating range (rad/s), for one condition (configuration) of a model.

    Attributes
    ----------
    reference : str
        Node whose speeds are given.
    speed_range : (float, float)
        Operating range in rad/s.
    modes : tuple of VibrationMode
    crossings : tuple of CriticalSpeed
        Sorted by mode, then by excitation, order and speed: several where a line crosses a mode at several speeds.
    lines : tuple of OrderLine
        Orders and fixed frequencies examined.
    nodes : tuple of str
        Node of each entry of the mode shapes.
    outputs : tuple of Channel
        Outputs whose peaks were searched.
    rule : MarginRule or None
    title, condition : str
    notes : tuple of str

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["500 rpm", "700 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> critical = fan.critical_speeds(margin="api684").of(1, 2)
    >>> round(critical.undamped_speed * 30 / 3.14159265), critical.margin, critical.passes  # 19.49 Hz at order 2
    (585, 0.0, False)
    """

    picture: ClassVar[str] = "interference_diagram"
    SHOWN: ClassVar = (
        "title", "condition", "reference", "speed_range", "margin_rule", "modes_with_shapes", "crossings",
    )  # fmt: skip

    reference: Annotated[str, Out(json="speed_of")]
    speed_range: Annotated[tuple[float, float], Out(json="speed_range_rad_per_s")]
    modes: tuple[VibrationMode, ...]
    crossings: tuple[CriticalSpeed, ...]
    lines: tuple[OrderLine, ...]
    nodes: tuple[str, ...]
    outputs: tuple[Channel, ...] = ()
    rule: MarginRule | None = None
    title: str = ""
    condition: Annotated[str, Out(json="configuration")] = ""
    notes: tuple[str, ...] = ()

    def of(self, mode: int, order: float, excitation: str | None = None, *, near: float | None = None) -> CriticalSpeed:
        """Critical speed (:class:`CriticalSpeed`) at which a mode, by its number, meets an excitation order.

        Where it does at several speeds, the one nearest to the speed ``near`` in rad/s.

        Raises
        ------
        UsageError
            There is no such crossing, or several excitations or speeds have it and none is named.
        """
        self.mode(mode)
        crossings = [
            crossing
            for crossing in self.crossings
            if crossing.mode.number == mode
            and math.isclose(crossing.order, order)
            and (excitation is None or crossing.excitation == excitation)
        ]
        if len(crossings) == 1:
            return crossings[0]
        names = list(dict.fromkeys(crossing.excitation for crossing in crossings))
        if len(names) > 1:
            raise UsageError(f"{', '.join(names)} have order {order:g}; say which excitation", kind="ambiguous-name")
        if crossings and near is not None:
            return min(crossings, key=lambda crossing: abs(crossing.first_speed - near))
        if crossings:
            if len({crossing.fixed for crossing in crossings}) > 1:
                raise UsageError(
                    f"mode {mode} is near {', '.join(crossing.line for crossing in crossings)}; choose among crossings",
                    kind="unknown-order",
                )
            places = " and ".join(screen_text(crossing.first_speed * RPM, 5) for crossing in crossings)
            raise UsageError(
                f"mode {mode} meets order {order:g} at {places} rpm; say which with near=, in rad/s",
                kind="ambiguous-name",
            )
        known = dict.fromkeys(crossing.line for crossing in self.crossings if crossing.mode.number == mode)
        raise UsageError(
            f"mode {mode} meets no order {order:g} in or near the operating range; "
            f"it meets {', '.join(known) or 'none'}",
            kind="unknown-order",
        )

    def mode(self, mode: int) -> VibrationMode:
        """Vibration mode of the drivetrain by its number, counted from 1 without rigid bodies.

        Raises
        ------
        UsageError
            There is no mode of this number.
        """
        for vibration in self.modes:
            if vibration.number == mode:
                return vibration
        known = (
            f"there are {len(self.modes)}, counted from 1 without rigid bodies"
            if self.modes
            else "nothing vibrates here"
        )
        raise UsageError(f"there is no mode {mode}; {known}", kind="unknown-mode")

    def in_conditions(self, others: Sequence[CriticalSpeeds]) -> CriticalSpeeds:
        """Copy of the critical speeds, each with names of other conditions that excite its mode (``excited_in``)."""
        return replace(
            self,
            crossings=tuple(
                replace(crossing, excited_in=tuple(other.condition for other in others if _excites(other, crossing)))
                for crossing in self.crossings
            ),
        )

    def table(self) -> Table:
        """Table of critical speeds in rpm, a row per crossing, with peaks, margin in % and generalised force in N m."""
        geared = any(crossing.order and crossing.ratio != 1 for crossing in self.crossings)
        columns = [
            Column("mode"),
            Column("excitation"),
            Column("order"),
            Column("undamped", "rpm", 5),
            Column("|lambda| /2pi", "rpm", 5),
        ]
        columns += [Column("on its shaft", "rpm", 5)] if geared else []
        for channel in self.outputs:
            columns += [Column(f"peak of {channel.name} at", "rpm", 5), Column("with", channel.unit, 4)]
        columns += [Column("margin", "%", 3, 1)]
        columns += [Column("rule")] if self.rule else []
        columns += [Column("generalised force", "N*m", 4), Column("amplifi- cation", "", 3), Column("remark")]
        rows = tuple(self._row(crossing, geared=geared) for crossing in self.crossings)
        return Table(f"{self.title}: critical speeds", tuple(columns), rows, self._notes())

    def _row(self, speed: CriticalSpeed, *, geared: bool) -> tuple[object, ...]:
        cells: list[object] = [speed.mode.number, speed.excitation, speed.line]
        cells += [speed.undamped_speed * RPM, speed.natural_speed * RPM]
        cells += [speed.own_speed * RPM] if geared else []
        by_output = {peak.output: peak for peak in speed.peaks}
        for channel in self.outputs:
            peak = by_output.get(channel.name)
            cells += [None, None] if peak is None else [peak.speed * RPM, peak.amplitude]
        cells.append(100 * speed.margin)
        if self.rule:
            cells.append(
                None if speed.required is None else "kept" if speed.passes else f"under {100 * speed.required:g} %"
            )
        force = 0.0 if speed.relative_force < NEGLIGIBLE_FORCE else speed.generalised_force
        return (*cells, force, speed.mode.amplification, speed.remark)

    def _notes(self) -> tuple[str, ...]:
        low, high = (speed * RPM for speed in self.speed_range)
        notes = [
            phrase(
                "speeds of {node}; operating range {low} to {high} rpm",
                node=self.reference,
                low=screen_text(low, 6),
                high=screen_text(high, 6),
            ),
            "margin: least distance of both natural frequencies from the line over the range; 0 where they meet there",
            "generalised force: torques of all cylinders summed on the shape with their phases, largest angle 1 rad",
        ]
        return (*notes, *([f"margins: {self.rule}"] if self.rule else []), *self.notes)

    def notebook_tables(self) -> tuple[Table, ...]:
        """Tables of the vibration modes and of the critical speeds, as a notebook shows them."""
        return self.mode_table(), self.table()

    def mode_table(self) -> Table:
        """Table with a row per vibration mode, frequencies in Hz with and without damping, and damping ratio."""
        vibrating = [math.isfinite(mode.natural_frequency) for mode in self.modes]
        first = COUNTING_NOTE if any(vibrating) else UNDAMPED_ALONE if vibrating else NO_VIBRATION
        notes = (first, *([OVERDAMPED_NOTE] if any(vibrating) and not all(vibrating) else []))
        return result_table(f"{self.title}: natural frequencies", self.modes, VibrationMode, notes=notes)

    @property
    def modes_with_shapes(self) -> Annotated[tuple[ModeWithShape, ...], Out(json="modes")]:
        """Vibration modes, each with its shape by node."""
        return tuple(ModeWithShape(**vars(mode), shape_by_node=self.shape(mode.number)) for mode in self.modes)

    @property
    def margin_rule(self) -> str | None:
        """Text of the rule for separation margins, None without one."""
        return str(self.rule) if self.rule else None

    def shape(self, mode: int) -> Mapping[str, complex]:
        """Complex angles by node of the mode of a number, without unit, 1 at the node that moves most."""
        return dict(zip(self.nodes, self.mode(mode).shape.tolist(), strict=True))


def _excites(other: CriticalSpeeds, speed: CriticalSpeed) -> bool:
    """Whether another condition excites the mode of a critical speed by the same order of the same excitation."""
    for crossing in other.crossings:
        same = (crossing.excitation, crossing.order, crossing.fixed) == (speed.excitation, speed.order, speed.fixed)
        if same and crossing.excited and _is_same_mode(crossing.mode, speed.mode):
            return True
    return False


def _is_same_mode(mode: VibrationMode, other: VibrationMode) -> bool:
    pairs = ((getattr(mode, name), getattr(other, name)) for name in ("undamped_frequency", "natural_frequency"))
    return any(abs(first - second) <= SAME_MODE_DISTANCE * second for first, second in pairs)
