"""Friction clutch: closed, open, or slipping by its torque over slip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_at_most
from torsionnet.base.entries.scalars import PhysicalQuantity, RowColumn
from torsionnet.base.entries.spec import OneOf, Spec, entry, not_none
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression, Number, Rows, outside_message, slope_at
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.curves import Characteristic, with_curve_ranges
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair, shown
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
from torsionnet.model.element_base.spring_stages import numbers_of
from torsionnet.model.motion_laws.piece_curve import PieceCurve, clutch_curve

_SLIP = RowColumn("slip speed", "speed")


@register
@dataclass(frozen=True, eq=False, repr=False)
class Clutch(Element):
    """A friction clutch between two shafts, with the torsion springs of its disc if they are given.

    Closed, its friction faces turn as one; open, they pass on drag alone. Slipping, they pass on a torque T(n) of the
    slip n = omega_first - omega_disc, and small vibrations feel its slope c = dT/dn at ``slip_speed``: T is a table, or
    the friction coefficient mu(n) times the torque T_1 at a coefficient of one (clamp force times mean radius times
    number of faces). Straight lines join the rows; at a row the piece above it counts; rows from slip 0 on hold both
    ways, T(-n) = -T(n). Where friction falls with slip, c is negative: the clutch feeds vibrations (judder), and a mode
    is unstable that has less damping otherwise (A. Crowther, N. Zhang, D. K. Liu, J. K. Jeyakumaran, Analysis and
    simulation of clutch engagement judder and stick-slip in automotive powertrain systems, Proc. IMechE D 218, 2004).
    With a stiffness, the springs stand between the faces and the second node; ``NAME.disc`` is the node of the disc.

    T(n) is its law of motion in time: where the slip comes to an end the faces stick, while the torque that equilibrium
    asks for is at most T(0), or ``stick``, the torque at which they break away; with ``friction`` that is at T_1 of the
    file, and follows the clamp force. A scenario may give T_1 over time, as ``clamp``. Without ``slip_speed`` linear
    results take the slip at the operating point; the clutch sticks, as a closed one, unless that lets it slip.

    Examples
    --------
    >>> clutch = Clutch("clutch", nodes=("engine", "gearbox"), state="slipping", slip_speed="5 rad/s",
    ...     torque=[["0 rad/s", "200 N*m"], ["10 rad/s", "190 N*m"], ["30 rad/s", "185 N*m"]])
    >>> clutch.parts(Values({}))[0].damping
    Fraction(-1, 1)
    """

    kind: ClassVar[str] = "clutch"
    glyph: ClassVar[str] = "coupling"
    may_feed: ClassVar[bool] = True
    working_point: ClassVar[tuple[str, ...]] = ("slip_speed",)
    when_stuck: ClassVar[str] = "give slip_speed, or an operating point at which it slips"

    nodes: tuple[str, str] = entry(
        NodePair("the two nodes it connects, the driving one first; twist is first minus second")
    )
    state: str = entry(OneOf("what its friction faces do", ("closed", "open", "slipping")), "closed")
    slip_speed: Expression | None = entry(
        PhysicalQuantity(
            "slipping: speed of the first node minus that of the disc; default: that of the operating point",
            "speed",
            "n",
            None,
            nonzero=True,
        ),
        None,
    )
    torque: Rows | None = entry(
        Characteristic("slipping: rows [slip speed, torque]", (_SLIP, RowColumn("torque", "torque"))), None
    )
    friction: Rows | None = entry(
        Characteristic("slipping, instead: rows [slip speed, friction coefficient]", (_SLIP, RowColumn("coefficient"))),
        None,
    )
    clamp_torque: Expression | None = entry(
        PhysicalQuantity("torque at a friction coefficient of one", "torque", "T_1", exclusive=True), None
    )
    stick: Expression | None = entry(
        PhysicalQuantity(
            "greatest torque while it sticks; default: that at slip zero", "torque", "T_s", exclusive=True
        ),
        None,
    )
    drag: Expression = entry(PhysicalQuantity("viscous drag when open", "damping", "c_d"), 0)
    stiffness: Expression | None = entry(
        PhysicalQuantity("stiffness of the springs of the disc; none: rigid", "stiffness", "k", exclusive=True), None
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("viscous damping in parallel to the springs", "damping", "c"), None
    )
    first_inertia: Expression = entry(PhysicalQuantity("inertia on the first node, as a cover", "inertia", "J_1"), 0)
    disc_inertia: Expression = entry(PhysicalQuantity("inertia of the disc with its facings", "inertia", "J_d"), 0)

    def contradictions(self) -> list[Fault]:
        faults = _friction_faults(self)
        if self.damping is not None and self.stiffness is None:
            faults.append(
                Fault(
                    "a rigid disc has no damping; give its springs a stiffness too", ("damping",), kind="missing-entry"
                )
            )
        if self.state == "slipping" and not faults:
            faults += _slip_faults(self)
            if self.stick is not None and not faults and self._table[0][0].value < 0:
                text = "rows through negative slips hold as they are, without sticking; begin them at slip 0"
                faults.append(Fault(text, ("stick",), on_key=True, kind="unfit-curve"))
        return faults

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension of every expression in the clutch's entries.

        While it slips, the slip speed has to lie within its table.
        """
        ranges = {"slip_speed": (self._table, 1)} if self.state == "slipping" else {}
        yield from with_curve_ranges(super().expressions(), ranges)

    @property
    def _table(self) -> Rows:
        return not_none(self.friction if self.torque is None else self.torque)

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return () if self.stiffness is None else (f"{self.name}.disc",)

    @property
    def disc(self) -> str:
        """Name of the node of the friction disc."""
        return self.internal_nodes[0] if self.stiffness is not None else self.nodes[1]

    def twist(self, value: Values) -> Row:
        del value
        return difference(*self.nodes)

    @property
    def has_motion_laws(self) -> bool:
        return self.state == "slipping" and _reaches_rest(self._table)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        if self.has_motion_laws and not self.has_own_working_point:
            return self.tangent_parts(value)
        return (self._faces(value), *self._disc_and_bodies(value))

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        if not self.has_motion_laws:
            return self.parts(value)
        row = difference(self.nodes[0], self.disc)
        stick: Any = None if self.stick is None else value(self.stick)
        if self.friction is None:
            faces = MotionLaw(row, self._curve(value, stick))
        else:
            # The curve is mu over slip, scaled by the clamp torque; stick, a torque, is divided by it.
            clamp = value(self.clamp_torque)
            curve = self._curve(value, None if stick is None else stick / clamp)
            faces = MotionLaw(row, curve, scale=clamp, scaled_by="clamp")
        return (faces, *self._disc_and_bodies(value))

    def _curve(self, value: Values, stick: Any) -> PieceCurve:
        return clutch_curve(numbers_of(self._table, value), stick).entered(value.algebra.number)

    def value_faults(self, value: Values) -> list[Fault]:
        """Fault of faces that stick below the torque with which they begin to slip."""
        if self.stick is None or self.state != "slipping":
            return []
        # A coefficient mu at slip 0 is the torque mu times the clamp torque.
        slipping = value(self._table[0][1]) * (1 if self.friction is None else value(self.clamp_torque))
        if not value(self.stick) < slipping:
            return []
        text = f"a clutch holds at least the torque with which it slips, {float(slipping):g} N*m"
        return [
            Fault(f"{text}; here only {shown(self.stick, value(self.stick))}", ("stick",), kind="contradicting-values")
        ]

    def _disc_and_bodies(self, value: Values) -> list[Law]:
        first, second = self.nodes
        parts: list[Law] = []
        # The springs of the disc lie behind the friction faces, between disc and second shaft.
        if self.stiffness is not None:
            stiffness = value(self.stiffness)
            damping = viscous(self.damping, stiffness, value)
            parts.append(Law(difference(self.disc, second), stiffness=stiffness, damping=damping))
        for node, inertia in ((first, self.first_inertia), (self.disc, self.disc_inertia)):
            body = Law(make_row([(node, 1)]), inertia=value(inertia))
            parts += [body] if body.acts and node != GROUND else []
        return parts

    def _faces(self, value: Values) -> Part:
        row = difference(self.nodes[0], self.disc)
        if self.state == "closed":
            return Constraint(row)
        return Law(row, damping=value(self.drag) if self.state == "open" else self._slope(value))

    def _slope(self, value: Values) -> Any:
        table, slip = self._table, value(self.slip_speed)
        slope = value(Number(slope_at(table, -slip if slip < 0 and table[0][0].value >= 0 else slip)))
        return slope if self.torque is not None else slope * value(self.clamp_torque)


def _friction_faults(clutch: Clutch) -> list[Fault]:
    both = one_at_most(clutch, "torque", "friction")
    if both:
        return both
    if (clutch.friction is None) != (clutch.clamp_torque is None):
        given = "friction" if clutch.friction is not None else "clamp_torque"
        return [
            Fault(
                "give friction and clamp_torque together; clamp_torque is the torque at a coefficient of 1",
                (given,),
                kind="missing-entry",
            )
        ]
    return []


def _slip_faults(clutch: Clutch) -> list[Fault]:
    """Faults of a slipping clutch that lacks its torque over slip, or whose slip speed is out of range."""
    table = clutch.torque if clutch.torque is not None else clutch.friction
    if table is None:
        text = "a slipping clutch needs its torque over slip: torque: [[0 rad/s, 200 N*m], [10 rad/s, 190 N*m]]"
        return [Fault(f"{text}, or friction and clamp_torque", ("state",), kind="missing-entry")]
    if clutch.slip_speed is None:
        return _rest_faults(clutch, table)
    if clutch.slip_speed == Number(0):
        text = "a slipping clutch has a slip_speed other than 0, as 5 rad/s; one that sticks is closed, or has none"
        return [Fault(text, ("slip_speed",), kind="contradicting-values")]
    if not isinstance(clutch.slip_speed, Number):
        return []
    # Rows from slip 0 on hold for both signs of the slip.
    slip = clutch.slip_speed.value if table[0][0].value < 0 else abs(clutch.slip_speed.value)
    text = outside_message(table, slip)
    return (
        [Fault(f"{text}; slip_speed is {float(slip):g} rad/s", ("slip_speed",), kind="contradicting-values")]
        if text
        else []
    )


def _reaches_rest(table: Rows) -> bool:
    """Whether a table says what the clutch does at slip 0: from there on, or through it."""
    (slip, torque, *_), last = table[0], table[-1][0]
    return bool(slip.value < 0 < last.value or (slip.value == 0 and torque.value >= 0))


def _rest_faults(clutch: Clutch, table: Rows) -> list[Fault]:
    """Faults of a table that does not say what a clutch without slip speed does when it sticks."""
    if _reaches_rest(table):
        return []
    name, what = ("torque", "torque") if clutch.torque is not None else ("friction", "coefficient")
    if table[0][0].value == 0:
        return [
            Fault(
                f"friction acts against the slip: the {what} at slip 0 must not be negative",
                (name, 0, 1),
                kind="unfit-curve",
            )
        ]
    text = f"a clutch that may stick needs its {what} at slip 0: begin the rows there, or give slip_speed, as 5 rad/s"
    return [Fault(text, (name, 0, 0), kind="unfit-curve")]
