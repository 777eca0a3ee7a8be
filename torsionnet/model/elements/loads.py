"""Loads whose torque follows their speed: ship's propellers with their water, and loads of constant power."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_at_most
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import (
    Law,
    MotionLaw,
    MotionState,
    Part,
    Row,
    Values,
    WholePart,
    difference,
    make_row,
)
from torsionnet.model.motion_laws.smooth_curves import OpenWaterCurve, PowerCurve

# Ship's propeller: inertia with entrained water, and damping by the water.

_LAWS = {
    "archer": ("archer", "torque", "speed"),
    "exponent": ("exponent", "torque", "speed"),
    "torque_slope": ("torque_slope", "torque_coefficient", "advance_ratio", "torque", "speed"),
}
"""Names of the entries needed by each law of propeller damping, by the entry that selects the law."""
_NAMES = {"archer": "Archer", "exponent": "exponent", "torque_slope": "torque_slope"}
_PITCH = ("pitch_ratio", "design_pitch_ratio")
PITCH_RADIUS = Fraction(7, 10)
"""Radius over the tip radius at which the pitch of a propeller's blade is stated, as makers do."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class Propeller(Element):
    """A ship's propeller with entrained water and damping.

    The inertia in water is J (1 + w), w the share of entrained water, or J + J_w. The damping c acts between propeller
    and water, which stands for ground; it is given, or follows from the mean torque Q at the speed omega, both of the
    propeller, which may be parameters that follow the operating point:

    * by Archer c = a Q/n with Q in N m and n in r/min, so that c = a Q pi/(30 omega); the factor a is mostly taken as
      30 (S. Archer, Torsional vibration damping coefficients for marine propellers, Engineering, 1955);
    * as the slope of a torque that follows omega^m: c = m Q/omega;
    * as the slope of the open-water torque K_Q(J_a) rho D^5 (omega/2 pi)^2 while the ship keeps its speed, which moves
      the advance ratio J_a = 2 pi v/(omega D): c = (2 - J_a/K_Q dK_Q/dJ_a) Q/omega.

    The last two are laws of motion in time, over the absolute speed: with r the speed over omega, Q r^m, and
    Q ((1 - b) r^2 + b r) with b = J_a/K_Q dK_Q/dJ_a.

    Water is entrained by what moves across the blade. Where that is given for the design pitch p_d (pitch over
    diameter) and the blades stand at another pitch p, it is taken as the square of the sine of the pitch angle at 0.7
    of the radius: times p^2 (p_d^2 + x^2)/(p_d^2 (p^2 + x^2)), x = 0.7 pi. At zero pitch nothing is entrained.

    Examples
    --------
    >>> screw = Propeller("screw", node="prop", inertia="6200 kg*m^2", entrained_water="28 %",
    ...     archer=30, torque="188.7 kN*m", speed="151.8 rpm")
    >>> (law,) = screw.parts(Values({}))
    >>> float(law.inertia), round(float(law.damping))
    (7936.0, 37292)
    """

    kind: ClassVar[str] = "propeller"
    absorbs: ClassVar[bool] = True
    glyph: ClassVar[str] = "disc"
    sign: ClassVar[str] = "positive when the drivetrain drives the propeller in the positive sense"
    working_point: ClassVar[tuple[str, ...]] = ("speed",)

    node: str = entry(NodeName("the node it turns with", allow_ground=False))
    inertia: Expression = entry(PhysicalQuantity("mass moment of inertia in air", "inertia", "J", usual=(1e-12, 1e10)))
    entrained_water: Expression = entry(PhysicalQuantity("share that entrained water adds, as 25 %", "1", "w"), 0)
    entrained_inertia: Expression | None = entry(
        PhysicalQuantity("instead: inertia of entrained water", "inertia", "J_w"), None
    )
    pitch_ratio: Expression | None = entry(
        PhysicalQuantity("pitch over diameter at which the blades stand", "1", "p", None), None
    )
    design_pitch_ratio: Expression | None = entry(
        PhysicalQuantity("pitch over diameter for which entrained water is given", "1", "p_d", nonzero=True), None
    )
    damping: Expression | None = entry(PhysicalQuantity("damping by the water", "damping", "c"), None)
    archer: Expression | None = entry(PhysicalQuantity("instead: factor of Archer's formula, about 30", "1", "a"), None)
    exponent: Expression | None = entry(
        PhysicalQuantity("instead: exponent m of torque over speed, about 2", "1", "m"), None
    )
    torque_slope: Expression | None = entry(
        PhysicalQuantity("instead: slope dK_Q/dJ_a of the open-water torque, below zero", "1", "K_Qs", None), None
    )
    torque_coefficient: Expression | None = entry(
        PhysicalQuantity("open-water torque coefficient K_Q there", "1", "K_Q", exclusive=True), None
    )
    advance_ratio: Expression | None = entry(PhysicalQuantity("advance ratio at which it works", "1", "J_a"), None)
    torque: Expression | None = entry(PhysicalQuantity("mean torque, for the laws of damping", "torque", "Q"), None)
    speed: Expression | None = entry(
        PhysicalQuantity("speed of the propeller, for the laws of damping", "speed", "Omega", exclusive=True), None
    )

    def contradictions(self) -> list[Fault]:
        return [*self._damping_faults(), *self._water_faults()]

    def _damping_faults(self) -> list[Fault]:
        known = list(dict.fromkeys(name for names in _LAWS.values() for name in names))
        given = [name for name in known if getattr(self, name) is not None]
        laws = [name for name in given if name in _LAWS]
        if given and self.damping is not None:
            how = _NAMES[laws[0]] if laws else "its torque"
            return [
                Fault(
                    f"the damping is given or by {how}, not both",
                    ("damping",),
                    on_key=True,
                    kind="contradicting-entries",
                )
            ]
        if len(laws) > 1:
            return one_at_most(self, *laws, of="the damping")
        if not laws:
            wanted = " or ".join(_LAWS)
            return (
                [
                    Fault(
                        f"{given[0]} is needed only for a law of damping; give {wanted}, too",
                        (given[0],),
                        on_key=True,
                        kind="needless-entry",
                    )
                ]
                if given
                else []
            )
        needed = _LAWS[laws[0]]
        if len(given) < len(needed):
            missing = " and ".join(name for name in needed if name not in given)
            text = f"damping by {_NAMES[laws[0]]} needs {', '.join(needed[:-1])} and {needed[-1]}; here is no {missing}"
            return [Fault(text, on_key=True, kind="missing-entry")]
        return [
            Fault(
                f"{name} has no part in damping by {_NAMES[laws[0]]}; leave it out",
                (name,),
                on_key=True,
                kind="needless-entry",
            )
            for name in given
            if name not in needed
        ]

    def _water_faults(self) -> list[Fault]:
        faults = []
        if self.entrained_water != Number(0):
            faults += one_at_most(self, "entrained_water", "entrained_inertia")
        pitch = [name for name in _PITCH if getattr(self, name) is not None]
        if len(pitch) == 1:
            text = "entrained water at another pitch needs pitch_ratio and design_pitch_ratio"
            faults.append(Fault(text, (pitch[0],), on_key=True, kind="missing-entry"))
        return faults

    @property
    def has_motion_laws(self) -> bool:
        return self.exponent is not None or self.torque_slope is not None

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return (self._body(self._damping(value), value),)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Part of the propeller for small motion about a speed; by default about that of its entries."""
        if not states or not self.has_motion_laws:
            return (self._body(self._damping(value), value),)
        return (self._body(self._curve(value).slopes(states[0])[1], value),)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        if not self.has_motion_laws:
            return self.parts(value)
        return (MotionLaw(make_row([(self.node, 1)]), self._curve(value)), self._body(0, value))

    def _curve(self, value: Values) -> PowerCurve | OpenWaterCurve:
        torque, speed = value(self.torque), value(self.speed)
        if self.exponent is not None:
            return PowerCurve(torque, speed, value(self.exponent))
        return OpenWaterCurve(torque, speed, self._bend(value))

    def _bend(self, value: Values) -> Any:
        return value(self.advance_ratio) * value(self.torque_slope) / value(self.torque_coefficient)

    def _body(self, damping: Any, value: Values) -> Law:
        dry, entrained = value(self.inertia), self._at_pitch(value)
        # J (1 + w), or J + J_w, with the water's part at the pitch at which the blades stand.
        if self.entrained_inertia is None:
            inertia = dry * (1 + value(self.entrained_water) * entrained)
        else:
            inertia = dry + value(self.entrained_inertia) * entrained
        return Law(make_row([(self.node, 1)]), inertia=inertia, damping=damping)

    def _at_pitch(self, value: Values) -> Any:
        """Entrained inertia of the propeller at its pitch over that at the design pitch, dimensionless."""
        if self.pitch_ratio is None:
            return 1
        # Water goes with sin^2 of the pitch angle at 0.7 of the radius, p^2/(p^2 + x^2) with x = 0.7 pi.
        stands, design = value(self.pitch_ratio) ** 2, value(self.design_pitch_ratio) ** 2
        round_square = (value.algebra.number(PITCH_RADIUS) * value.algebra.pi) ** 2
        return stands * (design + round_square) / (design * (stands + round_square))

    def _damping(self, value: Values) -> Any:
        if self.archer is not None:
            # Archer: c = a Q/n, with n = 30 omega/pi in r/min.
            return value(self.archer) * value(self.torque) * value.algebra.pi / (30 * value(self.speed))
        if self.exponent is not None:
            # Q goes with omega^m, so that dQ/domega = m Q/omega.
            return value(self.exponent) * value(self.torque) / value(self.speed)
        if self.torque_slope is not None:
            # dQ/domega of K_Q(J_a) rho D^5 (omega/2 pi)^2 at constant ship speed, where J_a goes with 1/omega.
            return (2 - self._bend(value)) * value(self.torque) / value(self.speed)
        return 0 if self.damping is None else value(self.damping)


# Load of constant power, whose torque falls with its speed.


@register
@dataclass(frozen=True, eq=False, repr=False)
class ConstantPowerLoad(Element):
    """A load that takes the power P at any speed, as a generator behind a fast converter: negative damping.

    Its torque P/omega falls with the speed, so that small changes of speed are driven: dT/domega = -P/omega^2. A
    machine of negative power feeds a constant one in; that damps. The speed is that of the node against its housing,
    at which P is taken; it may be a parameter that follows the operating point.

    P/omega is its law of motion in time, over the absolute speed. Without ``speed`` linear results take the slope at
    the operating point; without one the load does nothing.

    Examples
    --------
    >>> load = ConstantPowerLoad("converter", node="rotor", power="2 MW", speed="100 rad/s")
    >>> (law,) = load.parts(Values({}))
    >>> float(law.damping)
    -200.0
    """

    kind: ClassVar[str] = "constant_power_load"
    glyph: ClassVar[str] = "load"
    sign: ClassVar[str] = "positive when the drivetrain drives the load in the positive sense"
    may_feed: ClassVar[bool] = True
    working_point: ClassVar[tuple[str, ...]] = ("speed",)

    node: str = entry(NodeName("the node it turns with", allow_ground=False))
    power: Expression = entry(PhysicalQuantity("power that it takes; negative: that it gives", "power", "P", None))
    speed: Expression | None = entry(
        PhysicalQuantity(
            "speed at which it takes it; default: that of the operating point", "speed", "Omega", exclusive=True
        ),
        None,
    )
    housing: str = entry(NodeName("the node that takes its torque"), "ground")

    def contradictions(self) -> list[Fault]:
        if self.node == self.housing:
            return [
                Fault(
                    "the load and its housing are on one node; give two different nodes", ("housing",), kind="same-node"
                )
            ]
        return []

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self._parts_about(None if self.speed is None else value(self.speed), value)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts of the load for small motion about a speed; at rest it does nothing."""
        return self._parts_about(states[0].rate if states and states[0].rate else None, value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        return (MotionLaw(difference(self.node, self.housing), PowerCurve(value(self.power), 1, -1)),)

    def _parts_about(self, speed: Any, value: Values) -> tuple[Part, ...]:
        damping = 0 if speed is None else -value(self.power) / speed**2
        return (Law(difference(self.node, self.housing), damping=damping),)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """No rows of mean speeds, because the load turns freely in its housing."""
        del value
        return ()
