"""Belts and chains, loops over wheels that are rigid or have elastic spans."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Constraint, Law, Part, Values, make_row
from torsionnet.model.element_base.quantity_table import ListOf, TableByNode

# Base of belts and chains, a loop over wheels that is rigid or has elastic spans.

Ends = Sequence[tuple[str, Any]]

SPANS = ListOf(
    "stiffness of each span, from each wheel to the next and from the last to the first",
    PhysicalQuantity("stiffness of a span", "linear stiffness", "k", exclusive=True),
    "a list of stiffnesses, as [300 kN/m, 250 kN/m]",
)
LENGTHS = ListOf(
    "free lengths of the spans in the same order, for axial_stiffness",
    PhysicalQuantity("length of a span", "length", "L", exclusive=True),
    "a list of lengths, as [0.4 m, 0.3 m]",
)
LEVERS = ListOf(
    "by how much the spans before and after the tensioner's wheel get longer per radian of the arm",
    PhysicalQuantity("lever of the tensioner", "length", "a", lower=None),
    "two lengths [before, after], as [60 mm, 45 mm]",
    2,
)


@dataclass(frozen=True, eq=False, repr=False)
class LoopDrive(Element):
    """Base class of belt and chain drives, with the wheels in the order in which the loop runs."""

    glyph: ClassVar[str] = "belt"
    sign: ClassVar[str] = "positive when the first wheel drives the loop in the positive sense"
    wheels_field: ClassVar[str] = ""
    """Name of the entry with the radii or teeth of the wheels by node, in the class of a drive."""

    stiffness: tuple[Expression, ...] = entry(SPANS, None, kw_only=True)
    axial_stiffness: Expression | None = entry(
        PhysicalQuantity("instead: force per strain E A, with the lengths", "force", "EA", exclusive=True),
        None,
        kw_only=True,
    )
    lengths: tuple[Expression, ...] = entry(LENGTHS, None, kw_only=True)
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("damping of each span, referred to the first wheel, or a measure", "damping", "c"),
        None,
        kw_only=True,
    )
    pretension: Expression | None = entry(
        PhysicalQuantity("force in the spans at rest; the model holds while none gets slack", "force", "F_0"),
        None,
        kw_only=True,
    )
    tensioner: str | None = entry(
        NodeName("the node of the wheel on a tensioner arm", allow_ground=False), None, kw_only=True
    )
    arm: str | None = entry(
        NodeName("the node of that arm, which turns about its pivot", allow_ground=False), None, kw_only=True
    )
    levers: tuple[Expression, ...] = entry(LEVERS, None, kw_only=True)
    housing: str | None = entry(NodeName("the node that carries the bearings, if it moves"), None, kw_only=True)

    @property
    def wheels(self) -> tuple[str, ...]:
        """Names of the wheels' nodes in the order in which the loop runs over them."""
        return tuple(node for node, _ in getattr(self, self.wheels_field))

    @property
    def ports(self) -> dict[str, str]:
        more = {name: getattr(self, name) for name in ("arm", "housing") if getattr(self, name) is not None}
        return {f"wheel_{number}": node for number, node in enumerate(self.wheels, 1)} | more

    def contradictions(self) -> list[Fault]:
        others = [node for node in (self.arm, self.housing) if node is not None]
        if len({*self.wheels, *others}) < len(self.wheels) + len(others):
            return [Fault("wheels, arm and housing must be on different nodes", (self.wheels_field,), kind="same-node")]
        return [*self._span_faults(), *self._tensioner_faults()]

    def _span_faults(self) -> list[Fault]:
        if self.stiffness and self.axial_stiffness is not None:
            return [
                Fault(
                    "give stiffness of the spans or axial_stiffness and lengths, not both",
                    ("axial_stiffness",),
                    kind="contradicting-entries",
                )
            ]
        if (self.axial_stiffness is None) == bool(self.lengths):
            field = "lengths" if self.lengths else "axial_stiffness"
            return [
                Fault(
                    f"{field} is given alone; axial_stiffness and lengths of the spans are given together",
                    (field,),
                    kind="missing-entry",
                )
            ]
        field = "stiffness" if self.stiffness else "lengths"
        given, count = len(getattr(self, field)), len(self.wheels)
        if given and given != count:
            text = f"{count} wheels have {count} spans, from each to the next and from the last to the first; here are"
            return [Fault(f"{text} {given}", (field,), kind="wrong-count")]
        if self.damping is not None and not given:
            return [Fault("rigid spans have no damping; give them a stiffness too", ("damping",), kind="missing-entry")]
        return []

    def _tensioner_faults(self) -> list[Fault]:
        given = [name for name in ("tensioner", "arm", "levers") if getattr(self, name)]
        if not given:
            return []
        if len(given) < 3:
            return [
                Fault(
                    "a tensioner has three entries: tensioner (the node of its wheel), arm and levers",
                    (given[0],),
                    kind="missing-entry",
                )
            ]
        if self.tensioner not in self.wheels:
            text = f"the tensioner is on one of the wheels: {', '.join(self.wheels)}"
            return [Fault(text, ("tensioner",), kind="unknown-node")]
        if len(self.levers) != 2 or not (self.stiffness or self.lengths):
            return [
                Fault("a tensioner has two levers, [before, after], and elastic spans", ("levers",), kind="wrong-count")
            ]
        return []

    def radius_ratios(self, value: Values) -> dict[str, Any]:
        """Radius of each wheel over that of the first wheel, by node; negative where it turns in the other sense."""
        raise NotImplementedError

    def first_radius(self, value: Values) -> Any:
        """Radius in m of the first wheel of the belt or chain drive."""
        raise NotImplementedError

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        radius_ratios, count = self.radius_ratios(value), len(self.wheels)
        if not self.stiffness and not self.lengths:
            # A rigid loop runs with one speed: r_1 theta_1 = r_i theta_i on every wheel.
            first = self.wheels[0]
            return tuple(Constraint(self._row([(first, 1), (node, -radius_ratios[node])])) for node in self.wheels[1:])
        radius = self.first_radius(value)
        parts = []
        for place, stiffness in enumerate(self._span_stiffnesses(value)):
            wheel, other = self.wheels[place], self.wheels[(place + 1) % count]
            # gamma is what a span gets shorter, over r_1: by its two wheels, and by the arm of a tensioner.
            row = self._row(
                [
                    (wheel, radius_ratios[wheel]),
                    (other, -radius_ratios[other]),
                    *self._by_arm(wheel, other, radius, value),
                ]
            )
            # A change of length r_1 gamma at a lever r_1 makes k in N/m a stiffness k r_1^2 in N m/rad.
            referred = stiffness * radius**2
            parts.append(Law(row, stiffness=referred, damping=viscous(self.damping, referred, value)))
        return tuple(parts)

    def _span_stiffnesses(self, value: Values) -> list[Any]:
        if self.stiffness:
            return [value(stiffness) for stiffness in self.stiffness]
        return [value(self.axial_stiffness) / value(length) for length in self.lengths]

    def _by_arm(self, wheel: str, other: str, radius: Any, value: Values) -> list[tuple[str, Any]]:
        """Arm node, and coefficient by which the tensioner arm shortens a span over the first wheel's radius."""
        levers = zip((other, wheel), self.levers, strict=False)
        return [(not_none(self.arm), -value(lever) / radius) for end, lever in levers if end == self.tensioner]

    def _row(self, ends: Ends) -> Any:
        """Row of weights of the given ends relative to the housing, which carries wheels and arm."""
        carried = [] if self.housing is None else [(self.housing, -sum(coefficient for _, coefficient in ends))]
        return make_row([*ends, *carried])


# Belt drive over two pulleys or more.


@register
@dataclass(frozen=True, eq=False, repr=False)
class Belt(LoopDrive):
    """A belt over two pulleys or more, rigid or with elastic spans, and with a tensioner arm if wanted.

    The belt runs over the pulleys in the order given and back to the first. A span from pulley i to j of stiffness
    k = E A / L, in N/m, gets shorter by r_i theta_i - r_j theta_j: row (r_i theta_i - r_j theta_j) / r_1 with the
    stiffness k r_1^2, so that its torque is that on the first pulley. Two pulleys have two spans in parallel, as a gear
    of ratio r_2 / r_1 whose teeth have (k_1 + k_2) r_1^2. A rigid belt is a rigid gear. A radius is negative where the
    back of the belt runs over the pulley, which then turns in the other sense. An arm that turns by phi makes the spans
    before and after its pulley longer by a phi, each with its own lever a = l cos(beta): l is the length of the arm,
    beta the angle between span and way of the pulley's centre. Inertia and spring of the arm are elements of their own
    on its node. Slip and creep are left out (R. S. Beikmann, N. C. Perkins, A. G. Ulsoy, Free vibration of serpentine
    belt drive systems, J. Vib. Acoust. 118, 1996, with the rotations of the pulleys alone).

    Examples
    --------
    >>> belt = Belt("belt", pulleys={"crank": "70 mm", "pump": "35 mm"}, stiffness=["300 kN/m", "200 kN/m"])
    >>> [float(law.stiffness) for law in belt.parts(Values({}))]
    [1470.0, 980.0]
    """

    kind: ClassVar[str] = "belt"
    wheels_field: ClassVar[str] = "pulleys"

    pulleys: tuple[tuple[str, Expression], ...] = entry(
        TableByNode(
            "radius by node in the order of the run, negative where the back of the belt drives",
            PhysicalQuantity("radius to the middle of the belt", "length", "r", None, nonzero=True, usual=(1e-4, 5)),
            "radii by node, as {crank: 80 mm, pump: 60 mm}",
            names=("a", "b"),
        )
    )

    def radius_ratios(self, value: Values) -> dict[str, Any]:
        first = self.first_radius(value)
        return {node: value(radius) / first for node, radius in self.pulleys}

    def first_radius(self, value: Values) -> Any:
        return value(self.pulleys[0][1])


# Chain drive, or a toothed belt, over two sprockets or more.


@register
@dataclass(frozen=True, eq=False, repr=False)
class ChainDrive(LoopDrive):
    """A chain, or a toothed belt, over two sprockets or more: ratios by counts of teeth, spans rigid or elastic.

    As for ``belt``, with radii r_i = z_i p / (2 pi) from the counts of teeth z_i and the pitch p; the ratios z_i / z_1
    are exact. The count is negative where the outside of the chain drives the sprocket. The polygon effect is left out.
    A chain has a tight span and one that sags: give the slack span its own, small stiffness.

    Examples
    --------
    >>> chain = ChainDrive("chain", sprockets={"crank": 21, "cam": 42})
    >>> chain.parts(Values({}))[0].row
    {'crank': 1, 'cam': Fraction(-2, 1)}
    """

    kind: ClassVar[str] = "chain_drive"
    wheels_field: ClassVar[str] = "sprockets"

    sprockets: tuple[tuple[str, Expression], ...] = entry(
        TableByNode(
            "teeth by node in the order of the run, negative where the outside of the chain drives",
            PhysicalQuantity("count of teeth", "1", "z", None, nonzero=True),
            "teeth by node, as {crank: 21, cam: 42}",
            names=("a", "b"),
        )
    )
    pitch: Expression | None = entry(
        PhysicalQuantity("pitch of the chain, for elastic spans", "length", "p", exclusive=True), None
    )

    def contradictions(self) -> list[Fault]:
        broken = [node for node, z in self.sprockets if isinstance(z, Number) and z.value != int(z.value)]
        faults = [
            Fault("a count of teeth is a whole number", ("sprockets", node), kind="not-a-number") for node in broken
        ]
        if self.pitch is None and (self.stiffness or self.lengths):
            faults.append(
                Fault(
                    "the stiffness of spans in N/m needs the pitch of the chain; give pitch, as 9.525 mm",
                    on_key=True,
                    kind="missing-entry",
                )
            )
        return [*faults, *super().contradictions()]

    def radius_ratios(self, value: Values) -> dict[str, Any]:
        first = value(self.sprockets[0][1])
        return {node: value(z) / first for node, z in self.sprockets}

    def first_radius(self, value: Values) -> Any:
        return value(self.sprockets[0][1]) * value(self.pitch) / (2 * value.algebra.pi)
