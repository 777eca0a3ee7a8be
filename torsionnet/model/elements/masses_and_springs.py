"""Inertia, spring, damper and clamp, the elements of which a chain of masses is made."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar

from torsionnet.base.entries.composite import given_entries, one_at_most
from torsionnet.base.entries.scalars import PhysicalQuantity, RowColumn
from torsionnet.base.entries.spec import entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName, NodePair, shown
from torsionnet.model.element_base.laws import (
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
from torsionnet.model.element_base.spring_stages import (
    ExpressionRows,
    QuantityRows,
    SpringStages,
    has_names,
    numbers_of,
    row_order_faults,
)

if TYPE_CHECKING:
    from torsionnet.model.element_base.laws import TorqueCurve
    from torsionnet.model.element_base.spring_stage import SpringStage

NODE_PAIR_DESCRIPTION = "the two nodes it connects, one may be ground; twist is the angle of the first minus the second"
OUTER_DIAMETER = PhysicalQuantity(
    "outer diameter of the shaft that it stands for, where its stress is judged", "length", "D", exclusive=True
)
INNER_DIAMETER = PhysicalQuantity("inner diameter there", "length", "d")


TWIST_COLUMN = RowColumn("twist", "angle")
_WAYS = ("stiffness", "stages", "torque_over_twist")


@register
@dataclass(frozen=True, eq=False, repr=False)
class Inertia(Element):
    """A rigid rotating mass at a node: torque J d2theta/dt2.

    Examples
    --------
    >>> Inertia("flywheel", node="primary", inertia="0.6 kg*m^2 GD2").inertia.evaluate({})
    Fraction(3, 20)
    """

    kind: ClassVar[str] = "inertia"
    glyph: ClassVar[str] = "disc"
    sign: ClassVar[str] = "positive when the drivetrain accelerates the inertia in the positive sense"

    node: str = entry(NodeName("the node it turns with", allow_ground=False))
    inertia: Expression = entry(PhysicalQuantity("mass moment of inertia", "inertia", "J", usual=(1e-12, 1e10)))

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return (Law(make_row([(self.node, 1)]), inertia=value(self.inertia)),)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Spring(Element):
    r"""A torsion spring, with a viscous damper in parallel if wanted: torque k gamma + c dgamma/dt.

    Springs that are not linear have a law of motion T(gamma) instead of k gamma, of one of these forms:

    * ``cubic`` beside the stiffness: T = k gamma + k_3 gamma^3.
    * ``stages``, the same both ways: on stage i, T = T_i + k_i (gamma - gamma_i) from the end gamma_i of the stage
      before it, with T_i the torque there plus the ``preload`` P_i of the stage. That is the torque under which its
      springs are installed: at gamma_i the twist stands still until the torque exceeds that of the stage before by P_i.
    * ``torque_over_twist``, rows joined by straight lines. From zero on they hold both ways; rows through negative
      twists may differ, and may have a torque at zero twist.

    Linear results take the slope dT/dgamma at the operating point, without one that at rest without twist; at a corner
    that of the piece above it. Beyond the last row, or the end of the last stage, the torque is not known: results that
    reach there are refused.

    Examples
    --------
    >>> shaft = Spring("shaft", nodes=("a", "b"), stiffness="0.46 kN*m/rad", damping={"zeta": 0.02, "at": "8 Hz"})
    >>> float(shaft.stiffness.evaluate({}))
    460.0
    >>> disc = Spring("disc", nodes=("a", "b"), damping=1, stages=[
    ...     {"stiffness": "460 N*m/rad", "to": "0.12 rad"}, {"stiffness": "1500 N*m/rad"}])
    >>> from fractions import Fraction
    >>> law, damper = disc.whole_parts(Values({}))
    >>> float(law.torque(Fraction("0.2"), 0)), float(law.energy(Fraction("0.2"))), float(damper.damping)
    (175.2, 12.528, 1.0)
    """

    kind: ClassVar[str] = "spring"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    stiffness: Expression | None = entry(PhysicalQuantity("torsional stiffness", "stiffness", "k"), None)
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("viscous damping, or a damping measure at a frequency", "damping", "c"), 0
    )
    outer_diameter: Expression | None = entry(OUTER_DIAMETER, None)
    inner_diameter: Expression = entry(INNER_DIAMETER, 0)
    cubic: Expression | None = entry(
        PhysicalQuantity("torque over the cube of the twist, besides the stiffness", "cubic stiffness", "k_3", None),
        None,
    )
    stages: tuple[SpringStage, ...] = entry(
        SpringStages("instead: stages from zero torque on, each up to a torque or an angle"), None
    )
    torque_over_twist: ExpressionRows | None = entry(
        QuantityRows("instead: rows [twist, torque]", (TWIST_COLUMN, RowColumn("torque", "torque"))),
        None,
    )

    def contradictions(self) -> list[Fault]:
        faults = one_at_most(self, *_WAYS) if given_entries(self, *_WAYS) else [self._shapeless()]
        if self.diameters or self.inner_diameter != Number(0):  # those of the shaft that it stands for
            from torsionnet.model.element_base.round_section import section_faults

            faults += section_faults(self)
        if self.cubic is not None and self.stiffness is None:
            faults.append(
                Fault("cubic stands beside a stiffness, which may be 0", ("cubic",), on_key=True, kind="missing-entry")
            )
        elif self.cubic is not None and not has_names(((self.cubic, not_none(self.stiffness)),)):
            faults += self._cubic_faults(Values({}))
        rows = self.torque_over_twist
        return faults if rows is None or has_names(rows) else faults + _row_faults(rows, Values({}))

    def _shapeless(self) -> Fault:
        """Fault of a spring that gives none of the forms of its torque."""
        fault = self.missing("stiffness", self.name)
        return replace(fault, message=f"{fault.message}; or stages, or torque_over_twist")

    @property
    def diameters(self) -> tuple[Expression, Expression] | None:
        return None if self.outer_diameter is None else (self.outer_diameter, self.inner_diameter)

    @property
    def has_motion_laws(self) -> bool:
        return self.stiffness is None or self.cubic is not None

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        if self.has_motion_laws:
            return self.tangent_parts(value)
        stiffness = value(self.stiffness)
        return (Law(difference(*self.nodes), stiffness=stiffness, damping=viscous(self.damping, stiffness, value)),)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        if not self.has_motion_laws:
            return self.parts(value)
        row, curve = difference(*self.nodes), self._curve(value)
        # A measure of damping such as zeta refers to the stiffness at rest, dT/dgamma at gamma = 0.
        damping = viscous(self.damping, self._stiffness_at_rest(curve), value)
        return (MotionLaw(row, curve), *([Law(row, damping=damping)] if damping != 0 else []))

    def _curve(self, value: Values) -> TorqueCurve:
        # few springs have a law of motion, and commands on linear models start faster without
        if self.cubic is not None:
            from torsionnet.model.motion_laws.smooth_curves import CubicCurve

            return CubicCurve(value(self.stiffness), value(self.cubic))
        from torsionnet.model.motion_laws.piece_curve import stage_curve, twist_table_curve

        if self.stages:
            return stage_curve(self.stages, value)
        rows = numbers_of(not_none(self.torque_over_twist), value)
        return twist_table_curve(rows).entered(value.algebra.number)

    @staticmethod
    def _stiffness_at_rest(curve: TorqueCurve) -> Any:
        """Slope of the torque without twist, to which a measure of damping refers."""
        from torsionnet.model.element_base.laws import AT_REST

        return curve.slopes(AT_REST)[0]

    def value_faults(self, value: Values) -> list[Fault]:
        rows = self.torque_over_twist
        faults: list[Fault] = []
        if self.stages:
            from torsionnet.model.element_base.spring_stage import stage_faults

            faults += [fault.under("stages") for fault in stage_faults(self.stages, value)]
        faults += [] if self.cubic is None else self._cubic_faults(value)
        return faults if rows is None else faults + _row_faults(rows, value)

    def _cubic_faults(self, value: Values) -> list[Fault]:
        """Fault of a cubic spring that gives no torque against a small twist."""
        if self.cubic is None or self.stiffness is None or value(self.stiffness) > 0 or value(self.cubic) > 0:
            return []
        text = "without a stiffness a spring needs a cubic above 0, else it gives no torque against its twist"
        return [Fault(f"{text}; here {shown(self.cubic, value(self.cubic))}", ("cubic",), kind="negative-law")]

    @property
    def reads_off(self) -> bool:
        return False  # where its curve is read follows from equilibrium, not from an entry

    @property
    def referral_fault(self) -> str | None:
        return super().referral_fault if self.diameters is not None or self.stiffness is not None else None


def _row_faults(rows: ExpressionRows, value: Values) -> list[Fault]:
    """Faults of rows [twist, torque] that fall at rest, are all level, or do not reach zero twist."""
    name = "torque_over_twist"
    faults = [fault.under(name) for fault in row_order_faults(TWIST_COLUMN, rows, value)]
    numbers = numbers_of(rows, value)
    for at, ((low, high), (_, given)) in enumerate(zip(pairwise(numbers), pairwise(rows), strict=True), 1):
        # dT/dgamma below 0 about gamma = 0 would drive the drivetrain away from rest.
        if high[1] < low[1] and low[0] <= 0 <= high[0]:
            fall = f"from {shown(rows[at - 1][1], low[1])} to {shown(given[1], high[1])}"
            faults.append(
                Fault(
                    f"the torque of a spring does not fall with its twist at rest; here {fall}",
                    (name, at),
                    kind="negative-law",
                )
            )
    # Rows from twist 0 on are mirrored for negative twists; all others have to cover both signs.
    first, last = numbers[0], numbers[-1]
    if first[0] > 0 or last[0] < 0 or (first[0] < 0 and last[0] == 0):
        text = "rows begin at twist 0, and then hold both ways, or go from a negative to a positive twist"
        faults.append(Fault(text, (name, 0), kind="unfit-curve"))
    elif first[0] == 0 and first[1] < 0:
        text = "rows from twist 0 on hold both ways, so that the first torque must not be negative"
        faults.append(Fault(text, (name, 0, 1), kind="unfit-curve"))
    if not faults and len({torque for _, torque in numbers}) == 1:
        faults.append(Fault("the torque of a spring rises with its twist", (name, len(rows) - 1), kind="unfit-curve"))
    return faults


@register
@dataclass(frozen=True, eq=False, repr=False)
class Damper(Element):
    """A viscous damper: torque c dgamma/dt.

    Examples
    --------
    >>> Damper("bearing", nodes=("motor", "ground"), damping="0.3 N*m*s/rad").kind
    'damper'
    """

    kind: ClassVar[str] = "damper"
    glyph: ClassVar[str] = "damper"

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    damping: Expression = entry(PhysicalQuantity("viscous damping", "damping", "c"))

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return (Law(difference(*self.nodes), damping=value(self.damping)),)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Lock(Element):
    """A node clamped to ground; its torque is the reaction the ground has to take.

    Examples
    --------
    >>> Lock("brake", node="hub").ports
    {'node': 'hub'}
    """

    kind: ClassVar[str] = "lock"
    glyph: ClassVar[str] = "clamp"
    sign: ClassVar[str] = "positive when the drivetrain turns the clamp in the positive sense"

    node: str = entry(NodeName("the clamped node", allow_ground=False))

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Constraint(make_row([(self.node, 1)])),)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """No rows of mean speeds, because a clamp transmits no rotation; a rig locked for a test keeps its ratios."""
        del value
        return ()
