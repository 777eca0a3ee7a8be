"""A vibration absorber tuned to a natural frequency, as an element type of torsionnet."""

from dataclasses import dataclass

from torsionnet.extend import (
    DampingQuantity,
    Element,
    Expression,
    Law,
    NodeName,
    Part,
    PhysicalQuantity,
    Values,
    difference,
    entry,
    make_row,
    register,
    viscous,
)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Absorber(Element):
    """A ring on a spring, given by its inertia and the frequency at which it swings while the hub is held fast.

    Its stiffness is k = J (2 pi f)^2 (J. P. Den Hartog, Mechanical Vibrations, 4th ed., chapter 3).

    Examples
    --------
    >>> ring = Absorber("ring", node="hub", inertia="0.02 kg*m^2", frequency="25 Hz")
    >>> round(ring.parts(Values({}))[0].stiffness, 3)
    493.48
    """

    kind = "absorber"
    glyph = "damper"
    sign = "positive when the drivetrain drives the hub in the positive sense"

    node: str = entry(NodeName("the node of the hub", allow_ground=False))
    inertia: Expression = entry(PhysicalQuantity("inertia of the ring", "inertia", "J", exclusive=True))
    frequency: Expression = entry(PhysicalQuantity("its frequency, hub held fast", "frequency", "f", exclusive=True))
    damping: Expression | None = entry(DampingQuantity("damping between ring and hub", "damping", "c"), None)

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        """Name of the node of the ring."""
        return (f"{self.name}.ring",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        """Laws of the layer and of the ring."""
        (ring,) = self.internal_nodes
        inertia = value(self.inertia)
        stiffness = inertia * (2 * value.algebra.pi * value(self.frequency)) ** 2
        layer = Law(difference(self.node, ring), stiffness=stiffness, damping=viscous(self.damping, stiffness, value))
        return (layer, Law(make_row([(ring, 1)]), inertia=inertia))
