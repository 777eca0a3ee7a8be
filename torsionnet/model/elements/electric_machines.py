"""Electric machines on a line: synchronous about the load angle, induction with the lag of rotor currents, per unit."""

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
from torsionnet.model.motion_laws.smooth_curves import KlossCurve, LoadAngleCurve

# Synchronous machine about its load angle: magnetic stiffness and damping between rotor and stator field.

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
            return [Fault("rotor and stator are on one node; give two different nodes", ("housing",), kind="same-node")]
        if self.stiffness is not None:
            given = ("pull_out_torque", *_AT_A_PULL_OUT_TORQUE)
            also = [name for name in given if getattr(self, name) is not None]
            return [superfluous("the stiffness is given", name) for name in also]
        if self.pull_out_torque is None:
            return [
                Fault(
                    "a synchronous machine needs its magnetic stiffness, or its pull_out_torque",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        if self.pole_pairs is None:
            return [
                Fault(
                    "the stiffness at a load angle needs the pole pairs: pole_pairs: 2",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        return self._load_faults()

    def _load_faults(self) -> list[Fault]:
        if self.load_angle is None:
            if self.reluctance_torque is not None:
                text = "salient poles need the load angle: load_angle: 25 deg"
                return [Fault(text, ("reluctance_torque",), on_key=True, kind="missing-entry")]
            return self._torque_faults()
        if self.torque is not None:
            return one_at_most(self, "load_angle", "torque")
        if not isinstance(self.load_angle, Number):
            text = "the load angle is a number, as 25 deg: expressions have no cosine; give torque with parameters"
            return [Fault(text, ("load_angle",), kind="expression-not-allowed")]
        if self.reluctance_torque is None and self.load_angle.evaluate({}) >= math.pi / 2:
            return [
                Fault(
                    "a synchronous machine falls out of step at 90 deg and more; give a smaller load_angle",
                    ("load_angle",),
                    kind="out-of-range",
                )
            ]
        return []

    def _torque_faults(self) -> list[Fault]:
        torque, most = self.torque, self.pull_out_torque
        if isinstance(torque, Number) and isinstance(most, Number) and torque.value >= most.value:
            return [
                Fault(
                    f"the machine falls out of step at its pull-out torque {most}; reduce torque",
                    ("torque",),
                    kind="out-of-range",
                )
            ]
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
            # sin(delta) = T/T_e, so that p T_e cos(delta) = p sqrt(T_e^2 - T^2).
            torque = 0 if self.torque is None else value(self.torque)
            return pairs * value.root(field**2 - torque**2, "the torque must not be above the pull-out torque")
        # k = p dT/ddelta = p (T_e cos(delta) + 2 T_r cos(2 delta)).
        once, twice = (value.algebra.number(_cosine(n * self.load_angle.evaluate({}))) for n in (1, 2))
        saliency = 0 if self.reluctance_torque is None else value(self.reluctance_torque)
        return pairs * (field * once + 2 * saliency * twice)


def _cosine(angle: Any) -> Fraction:
    return Fraction(math.cos(angle))


# Induction machine on a line: its torque over speed, with the lag of its rotor currents.

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
            return [Fault("rotor and stator are on one node; give two different nodes", ("housing",), kind="same-node")]
        rated = [name for name in _RATED if getattr(self, name) is not None]
        if self.breakdown_slip is not None and rated:
            return [
                Fault(
                    "give breakdown_slip, or rated_torque and rated_slip, not both",
                    (rated[0],),
                    on_key=True,
                    kind="contradicting-entries",
                )
            ]
        if self.breakdown_slip is None and len(rated) < len(_RATED):
            return [
                Fault(
                    "the slope of its torque needs breakdown_slip, or rated_torque and rated_slip",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        return [*self._rated_faults(), *self._lag_faults()]

    def _rated_faults(self) -> list[Fault]:
        rated, breakdown = self.rated_torque, self.breakdown_torque
        if isinstance(rated, Number) and isinstance(breakdown, Number) and rated.value > breakdown.value:
            return [Fault(f"{_ABOVE} {breakdown}", ("rated_torque",), kind="out-of-range")]
        return []

    def _lag_faults(self) -> list[Fault]:
        breakdown, slip = self.breakdown_slip, self.slip
        if self.time_constant is None or not (isinstance(breakdown, Number) and isinstance(slip, Number)):
            return []
        if abs(slip.value) < breakdown.value:
            return []
        # From s_k on the slope c is zero or below, and c/tau no stiffness.
        text = "a time constant belongs to a slip below the breakdown slip; beyond, leave it out: the slope alone acts"
        return [Fault(text, ("time_constant",), kind="needless-entry")]

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
        # T + tau dT/dt = c domega: the dashpot c in series with the spring c/tau.
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


# Synchronous generator on a grid, by its data in per unit.

_BEHIND_A_REACTANCE = ("emf", "grid_voltage", "reactance", "power")
POLE_PAIRS_RTOL = 0.01
"""Relative distance of the pole pairs from a whole number that is allowed, as line frequencies are rounded: 377 rad/s
for 60 Hz."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class GridGenerator(Element):
    """A synchronous generator on a grid, by inertia constant and coefficients in per unit, as in power system studies.

    With rated power S, speed omega and line frequency omega_0 = 2 pi f its mechanical values are

        J = 2 H S/omega^2,    k = K_s S omega_0/omega^2,    c = K_D S/omega^2,

    H the inertia constant, K_s the synchronising torque over the electrical angle and K_D the damping torque over the
    change of speed, both per unit. Alone on an infinite bus (the grid is ground) it swings at
    f_n = sqrt(K_s omega_0/(2 H))/(2 pi) with the damping ratio K_D/(2 sqrt(2 H K_s omega_0)) (P. Kundur, Power System
    Stability and Control, chapter 12). Instead of K_s: K_s = sqrt((E V/X)^2 - P^2), which is E V cos(delta)/X, of the
    voltage E behind the reactance X to a bus of voltage V at the power P, all per unit. It stays linear in time;
    a synchronous machine with its pull-out torque follows the sine of the load angle.

    Examples
    --------
    >>> generator = GridGenerator("generator", node="rotor", rated_power="555 MW", speed="3600 rpm",
    ...     grid_frequency="60 Hz", inertia_constant="3.5 s", synchronising_coefficient=0.757)
    >>> field, rotor = generator.parts(Values({}))
    >>> round((float(field.stiffness) / float(rotor.inertia)) ** 0.5 / 6.283185307, 4)
    1.0162
    """

    kind: ClassVar[str] = "grid_generator"
    glyph: ClassVar[str] = "machine"
    sign: ClassVar[str] = "positive when the drivetrain drives the rotor in the positive sense"
    working_point: ClassVar[tuple[str, ...]] = ("power",)

    node: str = entry(NodeName("the node of the rotor", allow_ground=False))
    rated_power: Expression = entry(PhysicalQuantity("power that is 1 per unit", "power", "S", exclusive=True))
    speed: Expression = entry(PhysicalQuantity("synchronous speed of the rotor", "speed", "Omega", exclusive=True))
    grid_frequency: Expression = entry(PhysicalQuantity("frequency of the line", "frequency", "f", exclusive=True))
    inertia_constant: Expression = entry(
        PhysicalQuantity("stored energy over rated power, of all masses that stand for it", "time", "H")
    )
    synchronising_coefficient: Expression | None = entry(
        PhysicalQuantity("synchronising torque per electrical rad, per unit", "1", "K_s", exclusive=True), None
    )
    emf: Expression | None = entry(
        PhysicalQuantity("instead: voltage behind the reactance, per unit", "1", "E", exclusive=True), None
    )
    grid_voltage: Expression | None = entry(
        PhysicalQuantity("voltage of the bus, per unit", "1", "V", exclusive=True), None
    )
    reactance: Expression | None = entry(
        PhysicalQuantity("reactance from E to V, per unit", "1", "X", exclusive=True), None
    )
    power: Expression | None = entry(PhysicalQuantity("power it gives, per unit", "1", "P"), None)
    damping_coefficient: Expression = entry(
        PhysicalQuantity("damping torque per change of speed, both per unit", "1", "K_D"), 0
    )
    grid: str = entry(NodeName("the grid: ground is an infinite bus; else a node that turns at its speed"), "ground")

    def contradictions(self) -> list[Fault]:
        if self.node == self.grid:
            return [Fault("generator and grid are on one node; give two different nodes", ("grid",), kind="same-node")]
        given = [name for name in _BEHIND_A_REACTANCE if getattr(self, name) is not None]
        if self.synchronising_coefficient is not None and given:
            return [superfluous("the synchronising coefficient is given", given[0])]
        if self.synchronising_coefficient is None and len(given) < len(_BEHIND_A_REACTANCE):
            wanted = " and ".join([", ".join(_BEHIND_A_REACTANCE[:-1]), _BEHIND_A_REACTANCE[-1]])
            return [
                Fault(
                    f"a generator on a grid needs synchronising_coefficient, or {wanted}",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        return [*self._speed_faults(), *self._power_faults()]

    def _speed_faults(self) -> list[Fault]:
        frequency, speed = self.grid_frequency, self.speed
        if not (isinstance(frequency, Number) and isinstance(speed, Number) and speed.value > 0):
            return []
        # p = 2 pi f/Omega has to be a whole number of pole pairs.
        pairs = 2 * math.pi * float(frequency.value) / float(speed.value)
        if pairs > 1 - POLE_PAIRS_RTOL and abs(pairs - round(pairs)) < POLE_PAIRS_RTOL * pairs:
            return []
        near = 60 * float(frequency.value) / max(round(pairs), 1)
        return [
            Fault(
                f"no synchronous speed at {frequency}; the nearest is {near:g} rpm",
                ("speed",),
                kind="contradicting-values",
            )
        ]

    def _power_faults(self) -> list[Fault]:
        data = [getattr(self, name) for name in _BEHIND_A_REACTANCE]
        if not all(isinstance(datum, Number) for datum in data):
            return []
        emf, voltage, reactance, power = (float(datum.value) for datum in data)
        # P = (E U/X) sin(delta) is largest at a load angle of 90 deg, where the machine falls out of step.
        if reactance <= 0 or power < emf * voltage / reactance:
            return []
        return [
            Fault(
                f"power must be below emf*grid_voltage/reactance = {emf * voltage / reactance:.4g} per unit",
                ("power",),
                kind="out-of-range",
            )
        ]

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        # The unit of torque is P/Omega: c = D P/Omega^2, and k = K p P/Omega with p = 2 pi f/Omega pole pairs.
        unit = value(self.rated_power) / value(self.speed) ** 2
        line = 2 * value.algebra.pi * value(self.grid_frequency)
        stiffness, damping = self._coefficient(value) * unit * line, value(self.damping_coefficient) * unit
        field = Law(difference(self.node, self.grid), damping=damping, stiffness=stiffness)
        # H is the kinetic energy at Omega over the rated power: J = 2 H P/Omega^2.
        return (field, Law(make_row([(self.node, 1)]), inertia=2 * value(self.inertia_constant) * unit))

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Tuple of at most one row of node speeds, which couples the rotor to the grid on average.

        Ground stands for the steadily turning field.
        """
        return () if self.grid == "ground" else (self.twist(value),)

    def _coefficient(self, value: Values) -> Any:
        if self.synchronising_coefficient is not None:
            return value(self.synchronising_coefficient)
        most = value(self.emf) * value(self.grid_voltage) / value(self.reactance)
        return value.root(most**2 - value(self.power) ** 2, "the power must not be above E V/X")
