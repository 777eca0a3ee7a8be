"""Final drive: pinion and crown wheel with the differential."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName, Teeth
from torsionnet.model.element_base.laws import Constraint, Law, Part, Values, difference, make_row


@register
@dataclass(frozen=True, eq=False, repr=False)
class FinalDrive(Element):
    """Pinion and crown wheel, and the differential whose cage the crown wheel is bolted to.

    Mesh row theta_pinion - tau theta_cage (+ (tau - 1) theta_housing) with tau = omega_pinion / omega_cage: held at
    zero, or by the stiffness of the teeth. Differential: 2 theta_cage = theta_left + theta_right; locked, all three
    turn as one; limited-slip, a damping c_s resists theta_left - theta_right besides, as a viscous coupling does, or
    plates whose torque rises with the difference of speeds (for small vibrations; one whose plates stick is locked).
    The cage is the node ``NAME.cage``, or one with a name of its own where a second pinion meshes with the crown wheel.
    The equations are those of ``gear`` and ``differential``.

    Examples
    --------
    >>> axle = FinalDrive("axle", pinion="out", left="l", right="r", ratio=3.45, cage_inertia="0.03 kg*m^2")
    >>> axle.internal_nodes, len(axle.parts(Values({})))
    (('axle.cage',), 3)
    """

    kind: ClassVar[str] = "final_drive"
    glyph: ClassVar[str] = "differential"
    sign: ClassVar[str] = "positive when it drives from the pinion into the final drive"

    pinion: str = entry(NodeName("the node of the pinion", allow_ground=False))
    left: str = entry(NodeName("the node of the left output"))
    right: str = entry(NodeName("the node of the right output"))
    ratio: Expression | None = entry(
        PhysicalQuantity("speed of the pinion over speed of the cage", "1", "tau", None, nonzero=True), None
    )
    teeth: tuple[int, int] | None = entry(
        Teeth("teeth counts [pinion, crown wheel]; one negative: opposite senses"), None
    )
    cage: str | None = entry(NodeName("a node for the cage, where another element meshes with it"), None)
    differential: str = entry(OneOf("what the differential does", ("open", "locked", "limited-slip")), "open")
    slip_damping: Expression | None = entry(
        PhysicalQuantity("limited-slip: torque between the outputs per difference of their speeds", "damping", "c_s"),
        None,
    )
    pinion_inertia: Expression = entry(PhysicalQuantity("inertia of the pinion", "inertia", "J_p"), 0)
    cage_inertia: Expression = entry(PhysicalQuantity("inertia of crown wheel and cage", "inertia", "J_c"), 0)
    stiffness: Expression | None = entry(
        PhysicalQuantity("mesh stiffness referred to the pinion; none: rigid", "stiffness", "k", exclusive=True), None
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("mesh damping referred to the pinion", "damping", "c"), None
    )
    housing: str | None = entry(NodeName("the node of the housing, if it moves"), None)

    def contradictions(self) -> list[Fault]:
        faults = one_exactly(self, "ratio", "teeth")
        if self.damping is not None and self.stiffness is None:
            faults.append(Fault("a rigid mesh has no damping; give the mesh a stiffness too", ("damping",)))
        if (self.differential == "limited-slip") != (self.slip_damping is not None):
            field = "differential" if self.slip_damping is None else "slip_damping"
            faults.append(Fault("a limited-slip differential has a slip_damping, and no other has one", (field,)))
        nodes = [node for node in (self.pinion, self.left, self.right, self.cage, self.housing) if node is not None]
        if len(set(nodes)) < len(nodes):
            faults.append(Fault("pinion, outputs, cage and housing must be on different nodes", ("pinion",)))
        return faults

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return () if self.cage is not None else (f"{self.name}.cage",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        cage = self.cage if self.cage is not None else f"{self.name}.cage"
        inertias = ((self.pinion, self.pinion_inertia), (cage, self.cage_inertia))
        bodies = [Law(make_row([(node, 1)]), inertia=value(inertia)) for node, inertia in inertias]
        return (self._mesh(cage, value), *self._differential(cage, value), *(body for body in bodies if body.acts))

    def _mesh(self, cage: str, value: Values) -> Part:
        tau = value(self.ratio) if self.teeth is None else value(scalar(self.teeth[1])) / value(scalar(self.teeth[0]))
        housing = [] if self.housing is None else [(self.housing, tau - 1)]
        row = make_row([(self.pinion, 1), (cage, -tau), *housing])
        if self.stiffness is None:
            return Constraint(row)
        stiffness = value(self.stiffness)
        return Law(row, stiffness=stiffness, damping=viscous(self.damping, stiffness, value))

    def _differential(self, cage: str, value: Values) -> tuple[Part, ...]:
        if self.differential == "locked":
            return Constraint(difference(cage, self.left)), Constraint(difference(cage, self.right))
        planets = Constraint(make_row([(cage, 2), (self.left, -1), (self.right, -1)]))
        if self.differential == "open":
            return (planets,)
        return planets, Law(difference(self.left, self.right), damping=value(self.slip_damping))
