"""Induction machine on a line: its torque over speed, with the lag of its rotor currents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import (
    Constraint,
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
from torsionnet.model.motion_laws.kloss_curve import KlossCurve

_RATED = ("rated_torque", "rated_slip")
_ABOVE = "the rated torque must not be above the breakdown torque"


@register
@dataclass(frozen=True, eq=False, repr=False)
class InductionMachine(Element):
    """An induction motor or generator on a line of fixed frequency: by its slope a damper, with a spring in series.

    Its torque over slip is T = 2 T_k/(s/s_k + s_k/s) (Kloss), with the breakdown torque T_k at the breakdown slip s_k
    and s = 1 - omega/omega_s. Small changes of speed feel its slope,

        c = 2 T_k s_k (s_k^2 - s^2)/(omega_s (s^2 + s_k^2)^2),

    which is below zero beyond s_k: there it drives vibrations. The breakdown slip is given, or follows from the rated
    torque T_n at the rated slip s_n: s_k = s_n (m + sqrt(m^2 - 1)), m = T_k/T_n; the slip is then s_n if it is not
    given. Torque follows the slope with the time constant tau of the rotor currents, T + tau dT/dt = c domega: the
    dashpot c in series with the spring c/tau. With rotor resistance and leakage alone tau = 1/(2 pi f s_k).

    T(s) is its law of motion in time, over the absolute speed of the rotor, whose field turns in the positive sense;
    with a time constant its torque T_m follows as T_m + tau dT_m/dt = T(s), from zero where a simulation starts at
    rest, as after switching on, and else from T(s) of the start. Where neither slip nor rated values say about which
    slip it works, linear results take that of the operating point, and without one that of the unloaded machine, s = 0.
    A torque below T_k stands at two slips, s and s_k^2/s, of which the larger is unstable under a constant torque.

    Examples
    --------
    >>> motor = InductionMachine("motor", node="rotor", inertia="0.4 kg*m^2", synchronous_speed="1500 rpm",
    ...     breakdown_torque="400 N*m", breakdown_slip="10 %", slip=0, time_constant="30 ms")
    >>> spring, dashpot, rotor = motor.parts(Values({}))
    >>> round(float(dashpot.damping), 3), round(float(spring.stiffness), 1)
    (50.93, 1697.7)
    """

    kind: ClassVar[str] = "induction_machine"
    glyph: ClassVar[str] = "machine"
    sign: ClassVar[str] = "positive when the drivetrain drives the rotor in the positive sense"
    may_feed: ClassVar[bool] = True
    working_point: ClassVar[tuple[str, ...]] = ("slip", "rated_slip")

    node: str = entry(NodeName("the node of the rotor", allow_ground=False))
    synchronous_speed: Expression = entry(
        PhysicalQuantity("speed without slip, 2 pi f over the pole pairs", "speed", "omega_s", exclusive=True)
    )
    breakdown_torque: Expression = entry(PhysicalQuantity("largest torque", "torque", "T_k", exclusive=True))
    breakdown_slip: Expression | None = entry(
        PhysicalQuantity("slip of the largest torque", "1", "s_k", exclusive=True), None
    )
    slip: Expression | None = entry(
        PhysicalQuantity(
            "slip about which it works, negative as a generator; default: the rated one, or by the operating point",
            "1",
            "s_0",
            None,
        ),
        None,
    )
    rated_torque: Expression | None = entry(
        PhysicalQuantity("instead of the breakdown slip: rated torque", "torque", "T_n", exclusive=True), None
    )
    rated_slip: Expression | None = entry(
        PhysicalQuantity("slip at the rated torque", "1", "s_n", exclusive=True), None
    )
    time_constant: Expression | None = entry(
        PhysicalQuantity("time constant of its torque", "time", "tau", exclusive=True), None
    )
    inertia: Expression = entry(PhysicalQuantity("inertia of the rotor", "inertia", "J"), 0)
    housing: str = entry(NodeName("the node of the stator"), "ground")

    def contradictions(self) -> list[Fault]:
        if self.node == self.housing:
            return [Fault("rotor and stator are on one node; give two different nodes", ("housing",))]
        rated = [name for name in _RATED if getattr(self, name) is not None]
        if self.breakdown_slip is not None and rated:
            return [Fault("give breakdown_slip, or rated_torque and rated_slip, not both", (rated[0],), on_key=True)]
        if self.breakdown_slip is None and len(rated) < len(_RATED):
            return [Fault("the slope of its torque needs breakdown_slip, or rated_torque and rated_slip", on_key=True)]
        return [*self._rated_faults(), *self._lag_faults()]

    def _rated_faults(self) -> list[Fault]:
        rated, breakdown = self.rated_torque, self.breakdown_torque
        if isinstance(rated, Number) and isinstance(breakdown, Number) and rated.value > breakdown.value:
            return [Fault(f"{_ABOVE} {breakdown}", ("rated_torque",))]
        return []

    def _lag_faults(self) -> list[Fault]:
        breakdown, slip = self.breakdown_slip, self.slip
        if self.time_constant is None or not (isinstance(breakdown, Number) and isinstance(slip, Number)):
            return []
        if abs(slip.value) < breakdown.value:
            return []
        text = "a time constant belongs to a slip below the breakdown slip; beyond, leave it out: the slope alone acts"
        return [Fault(text, ("time_constant",))]

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return () if self.time_constant is None else (f"{self.name}.field",)

    def twist(self, value: Values) -> Row:
        del value
        return difference(self.node, self.housing)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        slip = self.rated_slip if self.slip is None else self.slip
        return self._parts_about(0 if slip is None else value(slip), value)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts of the machine for small motion about the speed of its rotor; by default without slip."""
        return self._parts_about(self._curve(value).slip(states[0].rate) if states else 0, value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        lag = 0 if self.time_constant is None else value(self.time_constant)
        law = MotionLaw(difference(self.node, self.housing), self._curve(value), lag=lag)
        held = [Constraint(difference(self.node, field)) for field in self.internal_nodes]
        return (law, *held, *self._rotor(value))

    def _rotor(self, value: Values) -> tuple[Law, ...]:
        rotor = Law(make_row([(self.node, 1)]), inertia=value(self.inertia))
        return (rotor,) if rotor.acts else ()

    def _parts_about(self, slip: Any, value: Values) -> tuple[Part, ...]:
        damping, own = self._curve(value).slope(slip), self._rotor(value)
        if self.time_constant is None:
            return (Law(difference(self.node, self.housing), damping=damping), *own)
        (field,) = self.internal_nodes
        spring = Law(difference(self.node, field), stiffness=damping / value(self.time_constant))
        return (spring, Law(difference(field, self.housing), damping=damping), *own)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Tuple of at most one row of node speeds, which couples rotor and inner node on average.

        Speeds are seen from the synchronous speed.
        """
        return () if self.time_constant is None else (self.parts(value)[0].row,)

    def _curve(self, value: Values) -> KlossCurve:
        return KlossCurve(value(self.breakdown_torque), self._breakdown_slip(value), value(self.synchronous_speed))

    def _breakdown_slip(self, value: Values) -> Any:
        if self.breakdown_slip is not None:
            return value(self.breakdown_slip)
        ratio = value(self.breakdown_torque) / value(self.rated_torque)
        return value(self.rated_slip) * (ratio + value.root(ratio**2 - 1, _ABOVE))
