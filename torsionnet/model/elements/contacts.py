"""Clearance and dry friction between two nodes, contacts whose laws have steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity, RowColumn
from torsionnet.base.entries.spec import entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair, shown
from torsionnet.model.element_base.laws import GROUND, Law, MotionLaw, Part, Row, Values, WholePart, difference
from torsionnet.model.element_base.spring_stages import (
    ExpressionRows,
    QuantityRows,
    has_names,
    numbers_of,
    row_order_faults,
)
from torsionnet.model.motion_laws.piece_curve import PieceCurve, clearance_curve, friction_curve, slip_curve

# Clearance between two nodes, with contact on either side that pushes but never pulls.


@register
@dataclass(frozen=True, eq=False, repr=False)
class Clearance(Element):
    r"""A clearance, as of splines, claws or teeth: no torque while -gap/2 < gamma < gap/2, contact beyond.

    The law of motion at a penetration d > 0 is T = max(0, k d + c d'), with d = gamma - gap/2 and d' = gamma' on the
    positive side; the negative side is its mirror image. Contact pushes and never pulls: where k d + c d' is below
    zero the bodies part though d > 0.

    Linear results take the slope at the operating point: k and c in contact, nothing in the gap, where the two sides
    move freely against each other. Without an operating point gamma is 0.

    Examples
    --------
    >>> from torsionnet.base.expressions import FLOAT
    >>> mesh = Clearance("mesh", nodes=("a", "b"), gap="0.2 rad", stiffness="100 N*m/rad", damping="1 N*m*s/rad")
    >>> (law,) = mesh.whole_parts(Values({}, FLOAT))
    >>> [round(law.torque(*state), 9) for state in ((0.05, 0), (0.3, 0), (0.3, -5), (0.3, -50), (-0.3, 0))]
    [0.0, 20.0, 15.0, 0.0, -20.0]
    """

    kind: ClassVar[str] = "clearance"
    glyph: ClassVar[str] = "clearance"

    nodes: tuple[str, str] = entry(
        NodePair("the two nodes it connects, one may be ground; twist is the angle of the first minus the second")
    )
    gap: Expression = entry(
        PhysicalQuantity("whole free angle, from one contact to the other", "angle", "b", exclusive=True)
    )
    stiffness: Expression = entry(PhysicalQuantity("stiffness in contact", "stiffness", "k", exclusive=True))
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("viscous damping in contact, or a damping measure at a frequency", "damping", "c"), 0
    )

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self.tangent_parts(value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        stiffness = value(self.stiffness)
        damping = viscous(self.damping, stiffness, value)
        return (MotionLaw(difference(*self.nodes), clearance_curve(value(self.gap), stiffness, damping)),)


# Dry friction between two nodes, rigid while it sticks or behind a spring.

SLIP_COLUMN = RowColumn("slip speed", "speed", negative=False)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Friction(Element):
    r"""Dry friction, as of seals, bearings, brakes and friction rings: T sgn(gamma') while it slips.

    The torque T is constant (Coulomb), or follows rows over the slip speed \|gamma'\|, joined by straight lines. While
    it sticks, gamma' = 0 and the torque is what equilibrium asks for, up to the torque ``stick``, T_s, by default that
    at slip zero.

    With a ``stiffness`` k it is a Jenkins element: the friction stands behind a spring, k (gamma - gamma_s), whose
    other end ``NAME.slider`` has no inertia and slides on the second node.

    Linear results take it as stuck unless the operating point lets it slip: a rigid connection, or the spring k.
    Slipping, they have the slope dT/dgamma' at the slip, which is 0 for a constant torque and below zero where the
    torque falls: then it feeds vibrations (stick-slip, squeal).

    Examples
    --------
    >>> rub = Friction("rub", nodes=("shaft", "ground"), torque="20 N*m", stick="30 N*m")
    >>> (law,) = rub.whole_parts(Values({}))
    >>> [int(law.torque(0, slip)) for slip in (-3, 0.1, 3)], rub.parts(Values({}))
    ([-20, 20, 20], (Constraint(row={'shaft': 1}),))
    """

    kind: ClassVar[str] = "friction"
    glyph: ClassVar[str] = "friction"
    may_feed: ClassVar[bool] = True
    when_stuck: ClassVar[str] = (
        "give stiffness, of what yields before it slips, or an operating point at which it slips"
    )

    nodes: tuple[str, str] = entry(
        NodePair("the two nodes it connects, one may be ground; twist is the angle of the first minus the second")
    )
    torque: Expression | None = entry(PhysicalQuantity("torque while it slips", "torque", "T", exclusive=True), None)
    stick: Expression | None = entry(
        PhysicalQuantity(
            "greatest torque while it sticks; default: that at slip zero", "torque", "T_s", exclusive=True
        ),
        None,
    )
    torque_over_slip: ExpressionRows | None = entry(
        QuantityRows(
            "instead of torque: rows [slip speed, torque] from slip zero on, which hold both ways",
            (SLIP_COLUMN, RowColumn("torque", "torque", negative=False)),
        ),
        None,
    )
    stiffness: Expression | None = entry(
        PhysicalQuantity("stiffness of a spring before the friction; none: rigid", "stiffness", "k", exclusive=True),
        None,
    )

    def contradictions(self) -> list[Fault]:
        faults = one_exactly(self, "torque", "torque_over_slip")
        rows, stick = self.torque_over_slip or (), self.stick
        given = rows if self.torque is None else ((self.torque,),)
        if not has_names(rows):
            faults += _row_faults(rows, Values({}))
        if faults or stick is None or has_names(((stick,), *given)):
            return faults
        return self._stick_faults(Values({}))

    def value_faults(self, value: Values) -> list[Fault]:
        return _row_faults(self.torque_over_slip or (), value) + self._stick_faults(value)

    def _stick_faults(self, value: Values) -> list[Fault]:
        """Fault of a torque that sticks below the one with which the friction begins to slip."""
        slipping = self.torque if self.torque is not None else not_none(self.torque_over_slip)[0][1]
        if self.stick is None or not value(self.stick) < value(slipping):
            return []
        held, moving = shown(self.stick, value(self.stick)), shown(slipping, value(slipping))
        text = f"friction holds at least the torque with which it slips, {moving}; here only {held}"
        return [Fault(text, ("stick",), kind="contradicting-values")]

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return () if self.stiffness is None else (f"{self.name}.slider",)

    def twist(self, value: Values) -> Row:
        del value
        return difference(*self.nodes)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self.tangent_parts(value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        first, second = self.nodes
        if self.stiffness is None:
            return (MotionLaw(difference(first, second), self._curve(value)),)
        (slider,) = self.internal_nodes
        spring = Law(difference(first, slider), stiffness=value(self.stiffness))
        return (spring, MotionLaw(difference(slider, second), self._curve(value)))

    def _curve(self, value: Values) -> PieceCurve:
        stick: Any = None if self.stick is None else value(self.stick)
        if self.torque is None:
            curve = slip_curve(numbers_of(not_none(self.torque_over_slip), value), stick)
            return curve.entered(value.algebra.number)
        torque = value(self.torque)
        return friction_curve(torque, torque if stick is None else stick)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Rows of mean speeds: those of friction that sticks, none to ground, which a shaft rubs on while it turns."""
        return () if GROUND in self.nodes else super().mean_speed_rows(value)

    @property
    def reads_off(self) -> bool:
        return False  # where its rows are read follows from equilibrium, not from an entry

    @property
    def referral_fault(self) -> str | None:
        return None


def _row_faults(rows: ExpressionRows, value: Values) -> list[Fault]:
    """Faults of rows [slip speed, torque] that do not rise, do not begin at slip zero, or have no torque there."""
    if not rows:
        return []
    name = "torque_over_slip"
    faults = [fault.under(name) for fault in row_order_faults(SLIP_COLUMN, rows, value)]
    slip, torque = rows[0]
    if value(slip) > 0:
        faults.append(Fault("the rows begin at slip 0, where it sticks", (name, 0, 0), kind="unfit-curve"))
    if value(torque) == 0:
        text = "friction has a torque at slip 0; what grows from 0 with the slip alone is a damper"
        faults.append(Fault(text, (name, 0, 1), kind="unfit-curve"))
    return faults
