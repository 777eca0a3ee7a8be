"""Rigid coupling (also a torque meter), gear stage, planetary set and differential."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import Count, Flag, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName, NodePair, Teeth
from torsionnet.model.element_base.laws import (
    GROUND,
    Constraint,
    Law,
    MotionLaw,
    Part,
    Row,
    Values,
    WholePart,
    difference,
    make_row,
)


@register
@dataclass(frozen=True, eq=False, repr=False)
class RigidCoupling(Element):
    """Two nodes that turn as one; the torque it carries is what a stiff torque meter reads.

    Examples
    --------
    >>> RigidCoupling("torque_meter", nodes=("motor", "primary")).nodes
    ('motor', 'primary')
    """

    kind: ClassVar[str] = "rigid_coupling"
    glyph: ClassVar[str] = "coupling"

    nodes: tuple[str, str] = entry(NodePair("the two nodes it joins; torque is positive from the first to the second"))

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Constraint(difference(*self.nodes)),)


MESH_STIFFNESS = PhysicalQuantity(
    "mesh stiffness referred to the first node; none: rigid", "stiffness", "k", exclusive=True
)
MESH_DAMPING = DampingQuantity("mesh damping referred to the first node", "damping", "c")


def _mesh_faults(element: Any) -> list[Fault]:
    if element.stiffness is not None:
        return []
    reasons = {
        "damping": "a rigid mesh has no damping; give the mesh a stiffness too",
        "backlash": "teeth with backlash meet with a stiffness; give the mesh a stiffness too",
    }
    return [
        Fault(text, (name,), kind="missing-entry")
        for name, text in reasons.items()
        if getattr(element, name) is not None
    ]


def _mesh(row: Row, element: Any, value: Values) -> WholePart:
    """Constraint on the row of a mesh of gears, or a law with stiffness and backlash of the teeth."""
    if element.stiffness is None:
        return Constraint(row)
    stiffness = value(element.stiffness)
    damping = viscous(element.damping, stiffness, value)
    if element.backlash is not None:
        from torsionnet.model.motion_laws.piece_curve import clearance_curve  # few gears have a backlash

        return MotionLaw(row, clearance_curve(value(element.backlash), stiffness, damping))
    return Law(row, stiffness=stiffness, damping=damping)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Gear(Element):
    """A gear stage of ratio tau = omega_first / omega_second = z_second / z_first, negative for opposite senses.

    Row gamma = theta_first - tau theta_second (+ (tau - 1) theta_housing): held at zero by a rigid mesh; a compliant
    one stores 1/2 k (theta_first - tau theta_second)^2.

    With a ``backlash`` b, the whole angle that the first shaft turns freely while the second is held, the compliant
    mesh has the law of motion of a clearance: no torque while -b/2 < gamma < b/2, and beyond it max(0, k d + c d') at
    the penetration d = gamma - b/2, with its mirror image on the other side. Linear results take k and c where the
    operating point presses the teeth together; without one the teeth stand free in their backlash.

    Examples
    --------
    >>> Gear("stage", nodes=("b", "c"), ratio=4.14).ratio_value({})
    Fraction(207, 50)
    >>> Gear("pinion", nodes=("b", "c"), teeth=(17, -61)).ratio_value({})
    Fraction(-61, 17)
    """

    kind: ClassVar[str] = "gear"
    glyph: ClassVar[str] = "gear"

    nodes: tuple[str, str] = entry(NodePair("the two shafts; the ratio is speed of the first over speed of the second"))
    ratio: Expression | None = entry(
        PhysicalQuantity("speed of the first node over speed of the second", "1", "tau", None, nonzero=True), None
    )
    teeth: tuple[int, int] | None = entry(
        Teeth("teeth counts [first, second], ratio = second/first; one negative: opposite senses"), None
    )
    stiffness: Expression | None = entry(MESH_STIFFNESS, None)
    damping: Expression | DampingMeasure | None = entry(MESH_DAMPING, None)
    housing: str | None = entry(NodeName("the node of the housing, if it moves"), None)
    backlash: Expression | None = entry(
        PhysicalQuantity("free angle of the first shaft with the second held; none: 0", "angle", "b", exclusive=True),
        None,
    )

    def contradictions(self) -> list[Fault]:
        faults = one_exactly(self, "ratio", "teeth") + _mesh_faults(self)
        if self.housing in self.nodes:
            faults.append(
                Fault(
                    "the housing must be on a node of its own, not on one of the two shafts",
                    ("housing",),
                    kind="same-node",
                )
            )
        if GROUND in self.nodes and self.housing is None:
            faults.append(
                Fault("a gear needs two shafts that turn; to hold a shaft use a lock", ("nodes",), kind="grounded-node")
            )
        return faults

    def _ratio(self, value: Values) -> Any:
        if self.teeth is None:
            return value(self.ratio)
        return value(scalar(self.teeth[1])) / value(scalar(self.teeth[0]))

    def ratio_value(self, parameters: dict[str, Any]) -> Any:
        """Ratio omega_first / omega_second of the gear stage for given parameter values."""
        return self._ratio(Values(parameters))

    @property
    def has_motion_laws(self) -> bool:
        return self.backlash is not None

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self.tangent_parts(value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        first, second = self.nodes
        tau = self._ratio(value)
        housing = [] if self.housing is None else [(self.housing, tau - 1)]
        return (_mesh(make_row([(first, 1), (second, -tau), *housing]), self, value),)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Planetary(Element):
    """A simple planetary set with z = z_ring / z_sun: row theta_sun + z theta_ring - (1 + z) theta_carrier.

    Held at zero when rigid; with a stiffness, the compliance of the meshes is lumped between the planets and the ring
    and referred to the sun. The planets roll on the sun: theta_planet = theta_carrier - 2 (theta_sun - theta_carrier) /
    (z - 1), so that their own inertia acts on that row and their mass, at the orbit radius, on the carrier. Any member
    may be on ``ground``. For meshes apart from each other build the set from gears with the carrier as housing. A
    ``backlash``, the whole free angle of the sun while ring and carrier are held, makes the compliant mesh a clearance
    on its row, as that of a gear.

    Examples
    --------
    >>> Planetary("set", sun="sun", ring="ground", carrier="out", teeth=(28, 62)).kind
    'planetary'
    """

    kind: ClassVar[str] = "planetary"
    glyph: ClassVar[str] = "planetary"
    sign: ClassVar[str] = "positive when it drives from the sun into the set"

    sun: str = entry(NodeName("the node of the sun"))
    ring: str = entry(NodeName("the node of the ring"))
    carrier: str = entry(NodeName("the node of the carrier"))
    ratio: Expression | None = entry(
        PhysicalQuantity("teeth of the ring over teeth of the sun", "1", "z", 1.0, exclusive=True), None
    )
    teeth: tuple[int, int] | None = entry(Teeth("teeth counts [sun, ring], both positive"), None)
    stiffness: Expression | None = entry(
        PhysicalQuantity("mesh stiffness referred to the sun; none: rigid", "stiffness", "k", exclusive=True), None
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("mesh damping referred to the sun", "damping", "c"), None
    )
    planets: int = entry(Count("how many planets", 1, 20), 3)
    planet_inertia: Expression = entry(
        PhysicalQuantity("inertia of one planet about its own axis", "inertia", "J_p"), 0
    )
    planet_mass: Expression = entry(PhysicalQuantity("mass of one planet", "mass", "m_p"), 0)
    orbit_radius: Expression = entry(
        PhysicalQuantity("radius on which the planets orbit", "length", "r_c", usual=(1e-3, 5)), 0
    )
    backlash: Expression | None = entry(
        PhysicalQuantity("free angle of the sun with the others held; none: 0", "angle", "b", exclusive=True), None
    )

    def contradictions(self) -> list[Fault]:
        faults = one_exactly(self, "ratio", "teeth") + _mesh_faults(self)
        if self.teeth is not None and not 0 < self.teeth[0] < self.teeth[1]:
            faults.append(
                Fault(
                    "a ring has more teeth than its sun, and both counts are positive",
                    ("teeth",),
                    kind="contradicting-values",
                )
            )
        if len({self.sun, self.ring, self.carrier}) < 3:
            faults.append(Fault("sun, ring and carrier must be on three different nodes", kind="same-node"))
        return faults

    @property
    def has_motion_laws(self) -> bool:
        return self.backlash is not None

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self.tangent_parts(value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        z = value(self.ratio) if self.teeth is None else value(scalar(self.teeth[1])) / value(scalar(self.teeth[0]))
        # Willis: theta_s + z theta_r = (1 + z) theta_c, with z = z_r/z_s.
        mesh = make_row([(self.sun, 1), (self.ring, z), (self.carrier, -(1 + z))])
        # A planet of z_s (z - 1)/2 teeth spins with theta_c - 2/(z - 1) (theta_s - theta_c).
        spin = make_row([(self.carrier, 1 + 2 / (z - 1)), (self.sun, -2 / (z - 1))])
        count = value(scalar(self.planets))
        # The centres of the planets go round with the carrier: n m R^2.
        orbiting = count * value(self.planet_mass) * value(self.orbit_radius) ** 2
        planets = (
            Law(spin, inertia=count * value(self.planet_inertia)),
            Law(make_row([(self.carrier, 1)]), inertia=orbiting),
        )
        return (_mesh(mesh, self, value), *(law for law in planets if law.acts))


@register
@dataclass(frozen=True, eq=False, repr=False)
class Differential(Element):
    """A differential: 2 theta_cage = theta_left + theta_right when open; locked, all three turn as one.

    Examples
    --------
    >>> len(Differential("axle", cage="cage", left="l", right="r", locked=True).parts(Values({})))
    2
    """

    kind: ClassVar[str] = "differential"
    glyph: ClassVar[str] = "differential"
    sign: ClassVar[str] = "positive when it drives from the cage into the differential"

    cage: str = entry(NodeName("the node of the cage"))
    left: str = entry(NodeName("the node of the left output"))
    right: str = entry(NodeName("the node of the right output"))
    locked: bool = entry(Flag("whether both outputs are locked to the cage"), False)

    def contradictions(self) -> list[Fault]:
        if len({self.cage, self.left, self.right}) == 3:
            return []
        return [Fault("cage, left and right must be on three different nodes", kind="same-node")]

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        del value
        if self.locked:
            return (Constraint(difference(self.cage, self.left)), Constraint(difference(self.cage, self.right)))
        return (Constraint(make_row([(self.cage, 2), (self.left, -1), (self.right, -1)])),)
