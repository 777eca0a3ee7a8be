"""Element types that the package does not have: any glyph with any ports, and springs and dashpots arranged otherwise."""

from dataclasses import dataclass
from fractions import Fraction

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.element_entries import NodeName, NodePair
from torsionnet.model.element_base.laws import difference, make_row
from torsionnet.model.elements import ELEMENT_TYPES, GROUND, Constraint, Element, Law

GLYPHS = sorted({cls.glyph for cls in ELEMENT_TYPES.values()} | {"", "a glyph nobody knows"})


@dataclass(frozen=True, eq=False, repr=False)
class OnePort(Element):
    """Inertia and damping at a node."""

    node: str = entry(NodeName("its node"))
    mass: Expression = entry(PhysicalQuantity("mass moment of inertia", "inertia", "J"), 2)

    def own_parts(self, value):
        return (Law(make_row([(self.node, 1)]), inertia=value(self.mass), damping=1),)


@dataclass(frozen=True, eq=False, repr=False)
class Absorber(Element):
    """A mass of its own on a spring and a dashpot, at a node."""

    node: str = entry(NodeName("its node"))
    mass: Expression = entry(PhysicalQuantity("mass moment of inertia", "inertia", "J"), 2)

    @property
    def internal_nodes(self):
        return (f"{self.name}.mass",)

    def own_parts(self, value):
        (inner,) = self.internal_nodes
        spring = Law(difference(self.node, inner), stiffness=300, damping=4)
        return (spring, Law(make_row([(inner, 1)]), inertia=value(self.mass)))


@dataclass(frozen=True, eq=False, repr=False)
class TwoPorts(Element):
    """Stiffness between two nodes."""

    nodes: tuple[str, str] = entry(NodePair("its nodes"))
    give: Expression = entry(PhysicalQuantity("stiffness", "stiffness", "k"), 300)

    def own_parts(self, value):
        return (Law(difference(*self.nodes), stiffness=value(self.give)),)


@dataclass(frozen=True, eq=False, repr=False)
class ThreePorts(Element):
    """Stiffness on the mean of two angles against a third."""

    left: str = entry(NodeName("one end"))
    right: str = entry(NodeName("other end"))
    middle: str = entry(NodeName("middle"))
    give: Expression = entry(PhysicalQuantity("stiffness", "stiffness", "k"), 300, kw_only=True)

    def own_parts(self, value):
        row = make_row([(self.left, 1), (self.right, 1), (self.middle, -2)])
        return (Law(row, stiffness=value(self.give)),)


@dataclass(frozen=True, eq=False, repr=False)
class FourPorts(ThreePorts):
    """One more."""

    fourth: str = entry(NodeName("fourth end"))
    other: Expression = entry(PhysicalQuantity("stiffness", "stiffness", "k"), 300, kw_only=True)

    def own_parts(self, value):
        return (*super().own_parts(value), Law(difference(self.left, self.fourth), stiffness=value(self.other)))


@dataclass(frozen=True, eq=False, repr=False)
class Maxwell(Element):
    """A spring and a dashpot in series."""

    glyph = "spring"
    nodes: tuple[str, str] = entry(NodePair("its nodes"))
    stiffness: Expression = entry(PhysicalQuantity("stiffness", "stiffness", "k"), 300)
    damping: Expression = entry(PhysicalQuantity("damping", "damping", "c"), 4)

    @property
    def internal_nodes(self):
        return (f"{self.name}.1",)

    def twist(self, value):
        del value
        return difference(*self.nodes)

    def own_parts(self, value):
        (inner,) = self.internal_nodes
        spring = Law(difference(self.nodes[0], inner), stiffness=value(self.stiffness))
        return (spring, Law(difference(inner, self.nodes[1]), damping=value(self.damping)))


@dataclass(frozen=True, eq=False, repr=False)
class Zener(Maxwell):
    """A spring beside a Maxwell element."""

    beside: Expression = entry(PhysicalQuantity("stiffness", "stiffness", "k"), 100)

    def own_parts(self, value):
        return (*super().own_parts(value), Law(difference(*self.nodes), stiffness=value(self.beside)))


def with_glyph(cls, glyph):
    """A class of its own for the glyph."""
    return type(f"{cls.__name__}_{glyph}", (cls,), {"kind": f"made_up_{cls.__name__}", "glyph": glyph})


SHAPES = {
    "one port": lambda glyph: with_glyph(OnePort, glyph)("made", node="a"),
    "one port, mass of its own": lambda glyph: with_glyph(Absorber, glyph)("made", node="a"),
    "two ports": lambda glyph: with_glyph(TwoPorts, glyph)("made", nodes=("a", "b")),
    "to ground": lambda glyph: with_glyph(TwoPorts, glyph)("made", nodes=("a", GROUND)),
    "from ground": lambda glyph: with_glyph(TwoPorts, glyph)("made", nodes=(GROUND, "a")),
    "three ports": lambda glyph: with_glyph(ThreePorts, glyph)("made", "a", "b", "c"),
    "three, one on ground": lambda glyph: with_glyph(ThreePorts, glyph)("made", "a", "b", GROUND),
    "three on two nodes": lambda glyph: with_glyph(ThreePorts, glyph)("made", "a", "b", "b"),
    "four ports": lambda glyph: with_glyph(FourPorts, glyph)("made", "a", "b", "c", fourth="d"),
}


@dataclass(frozen=True, eq=False, repr=False)
class MadeUpInerter(TwoPorts):
    """Torque from a relative acceleration, with a spring and a dashpot."""

    def own_parts(self, value):
        return (Law(difference(*self.nodes), inertia=3, damping=2, stiffness=value(self.give)),)


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(ThreePorts):
    """Inertia, damping and stiffness on a weighted sum of three angles whose weights do not add up to zero."""

    def own_parts(self, value):
        row = make_row([(self.left, 2), (self.right, Fraction(-1, 2)), (self.middle, 3)])
        return (Law(row, inertia=Fraction(1, 5), damping=2, stiffness=value(self.give)),)


@dataclass(frozen=True, eq=False, repr=False)
class RigidMesh(ThreePorts):
    """The weighted sum of three angles is zero."""

    def own_parts(self, value):
        del value
        return (Constraint(make_row([(self.left, 2), (self.right, -2), (self.middle, 3)])),)


@dataclass(frozen=True, eq=False, repr=False)
class RigidPair(TwoPorts):
    """Two angles in a ratio."""

    def own_parts(self, value):
        del value
        return (Constraint(make_row([(self.nodes[0], 1), (self.nodes[1], Fraction(5, 2))])),)


def of_kind(cls, *nodes, **given):
    """An element ``e`` of a type with a kind of its own."""
    made = type(cls.__name__, (cls,), {"kind": f"made_up_{cls.__name__.lower()}", "glyph": ""})
    return made("e", **given) if given else made("e", *nodes)


EXPORTED = {
    "one port": of_kind(OnePort, node="a"),
    "one port, mass of its own": of_kind(Absorber, node="a"),
    "two ports": of_kind(TwoPorts, nodes=("a", "b")),
    "to ground": of_kind(TwoPorts, nodes=("a", GROUND)),
    "from ground": of_kind(TwoPorts, nodes=(GROUND, "a")),
    "three ports": of_kind(ThreePorts, "a", "b", "c"),
    "three, one on ground": of_kind(ThreePorts, "a", "b", GROUND),
    "in series": of_kind(Maxwell, nodes=("a", "b")),
    "in series, one beside": of_kind(Zener, nodes=("a", "b")),
    "inertia of a difference": of_kind(MadeUpInerter, nodes=("a", "b")),
    "all on three": of_kind(Mesh, "a", "b", "c"),
    "all on three, one on ground": of_kind(Mesh, "a", "b", GROUND),
    "rigid, three": of_kind(RigidMesh, "a", "b", "c"),
    "rigid, three, one on ground": of_kind(RigidMesh, "a", "b", GROUND),
    "rigid, two": of_kind(RigidPair, nodes=("a", "b")),
    "rigid, two, one on ground": of_kind(RigidPair, nodes=("a", GROUND)),
}
"""Elements that an export can only write by their laws and constraints."""
