"""Synchronous machine about its load angle: magnetic stiffness and damping between rotor and stator field."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_at_most, superfluous
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import Count, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
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
from torsionnet.model.motion_laws.load_angle_curve import LoadAngleCurve

_AT_A_PULL_OUT_TORQUE = ("torque", "load_angle", "reluctance_torque", "pole_pairs")


@register
@dataclass(frozen=True, eq=False, repr=False)
class SynchronousMachine(Element):
    """A synchronous motor or generator on a line of fixed frequency: a spring and a damper to its turning field.

    At the load angle delta (electrical, p times the mechanical one of p pole pairs) it has the torque
    T = T_e sin(delta) + T_r sin(2 delta), with T_e = 3 U E/(Omega X_d) of phase voltages U and E, reactance X_d and
    speed Omega, and T_r = 3 U^2 (1/X_q - 1/X_d)/(2 Omega) of salient poles. Small changes of the mechanical angle feel
    k = p dT/ddelta = p (T_e cos(delta) + 2 T_r cos(2 delta)); without saliency k = p sqrt(T_e^2 - T^2). The damper
    winding acts as c. Angles are against the steadily turning field, which stands for ground, or for the housing if
    that gives way. For swings against an excitation that cannot follow, take transient values.

    With a pull-out torque, T(p gamma) is its law of motion in time, over the twist gamma of the rotor against the
    field. Linear results take ``torque`` or ``load_angle``, or the unloaded machine, unless an operating point is asked
    for.

    Examples
    --------
    >>> motor = SynchronousMachine("motor", node="rotor", inertia="60 kg*m^2", pole_pairs=2,
    ...     pull_out_torque="50 kN*m", torque="30 kN*m", damping="800 N*m*s/rad")
    >>> field, rotor = motor.parts(Values({}))
    >>> float(field.stiffness), float(rotor.inertia)
    (80000.0, 60.0)
    """

    kind: ClassVar[str] = "synchronous_machine"
    glyph: ClassVar[str] = "machine"
    sign: ClassVar[str] = "positive when the drivetrain drives the rotor in the positive sense"
    working_point: ClassVar[tuple[str, ...]] = ("torque", "load_angle")

    node: str = entry(NodeName("the node of the rotor", allow_ground=False))
    stiffness: Expression | None = entry(
        PhysicalQuantity("magnetic stiffness over the mechanical angle", "stiffness", "k", exclusive=True), None
    )
    pull_out_torque: Expression | None = entry(
        PhysicalQuantity("instead: torque T_e of the field at 90 degrees", "torque", "T_e", exclusive=True), None
    )
    pole_pairs: int | None = entry(Count("electrical periods of a revolution", 1, 10_000), None)
    torque: Expression | None = entry(PhysicalQuantity("mean torque it gives or takes, a size", "torque", "T"), None)
    load_angle: Expression | None = entry(
        PhysicalQuantity("instead: load angle, electrical, a size", "angle", "delta"), None
    )
    reluctance_torque: Expression | None = entry(PhysicalQuantity("torque T_r of salient poles", "torque", "T_r"), None)
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("damping of the damper winding, over the mechanical speed", "damping", "c"), 0
    )
    inertia: Expression = entry(PhysicalQuantity("inertia of the rotor", "inertia", "J"), 0)
    housing: str = entry(NodeName("the node of the stator"), "ground")

    def contradictions(self) -> list[Fault]:
        if self.node == self.housing:
            return [Fault("rotor and stator are on one node; give two different nodes", ("housing",))]
        if self.stiffness is not None:
            given = ("pull_out_torque", *_AT_A_PULL_OUT_TORQUE)
            also = [name for name in given if getattr(self, name) is not None]
            return [superfluous("the stiffness is given", name) for name in also]
        if self.pull_out_torque is None:
            return [Fault("a synchronous machine needs its magnetic stiffness, or its pull_out_torque", on_key=True)]
        if self.pole_pairs is None:
            return [Fault("the stiffness at a load angle needs the pole pairs: pole_pairs: 2", on_key=True)]
        return self._load_faults()

    def _load_faults(self) -> list[Fault]:
        if self.load_angle is None:
            if self.reluctance_torque is not None:
                text = "salient poles need the load angle: load_angle: 25 deg"
                return [Fault(text, ("reluctance_torque",), on_key=True)]
            return self._torque_faults()
        if self.torque is not None:
            return one_at_most(self, "load_angle", "torque")
        if not isinstance(self.load_angle, Number):
            text = "the load angle is a number, as 25 deg: expressions have no cosine; give torque with parameters"
            return [Fault(text, ("load_angle",))]
        if self.reluctance_torque is None and self.load_angle.evaluate({}) >= math.pi / 2:
            return [
                Fault(
                    "a synchronous machine falls out of step at 90 deg and more; give a smaller load_angle",
                    ("load_angle",),
                )
            ]
        return []

    def _torque_faults(self) -> list[Fault]:
        torque, most = self.torque, self.pull_out_torque
        if isinstance(torque, Number) and isinstance(most, Number) and torque.value >= most.value:
            return [Fault(f"the machine falls out of step at its pull-out torque {most}; reduce torque", ("torque",))]
        return []

    @property
    def has_motion_laws(self) -> bool:
        return self.pull_out_torque is not None

    @property
    def has_own_working_point(self) -> bool:
        """Whether the machine works at a load angle, which is zero if the entries say nothing."""
        return True

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self._parts_about(self._stiffness(value), value)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts of the machine for small motion about a twist against the field; by default about its own load."""
        if not states or not self.has_motion_laws:
            return self._parts_about(self._stiffness(value), value)
        return self._parts_about(self._curve(value).slopes(states[0])[0], value)

    def _parts_about(self, stiffness: Any, value: Values) -> tuple[Part, ...]:
        damping = viscous(self.damping, stiffness, value)
        field = Law(difference(self.node, self.housing), damping=damping, stiffness=stiffness)
        return (field, *self._rotor(value))

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        if not self.has_motion_laws:
            return self.parts(value)
        row = difference(self.node, self.housing)
        winding = Law(row, damping=viscous(self.damping, self._stiffness(value), value))
        return (MotionLaw(row, self._curve(value)), *([winding] if winding.acts else []), *self._rotor(value))

    def _rotor(self, value: Values) -> tuple[Law, ...]:
        rotor = Law(make_row([(self.node, 1)]), inertia=value(self.inertia))
        return (rotor,) if rotor.acts else ()

    def _curve(self, value: Values) -> LoadAngleCurve:
        saliency = 0 if self.reluctance_torque is None else value(self.reluctance_torque)
        return LoadAngleCurve(value(self.pull_out_torque), saliency, value(scalar(self.pole_pairs)))

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """No rows of mean speeds, because the rotor turns with the field and not with the housing."""
        del value
        return ()

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness is not None:
            return value(self.stiffness)
        pairs, field = value(scalar(self.pole_pairs)), value(self.pull_out_torque)
        if self.load_angle is None:
            torque = 0 if self.torque is None else value(self.torque)
            return pairs * value.root(field**2 - torque**2, "the torque must not be above the pull-out torque")
        once, twice = (value.algebra.number(_cosine(n * self.load_angle.evaluate({}))) for n in (1, 2))
        saliency = 0 if self.reluctance_torque is None else value(self.reluctance_torque)
        return pairs * (field * once + 2 * saliency * twice)


def _cosine(angle: Any) -> Fraction:
    return Fraction(math.cos(angle))
