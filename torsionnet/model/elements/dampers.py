"""Dampers and absorbers of torsional vibration: viscous film, rubber, leaf or sleeve springs, pendulums."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Nested, given_entries, one_at_most, one_exactly, superfluous
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import Count, OneOf, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression, Number, Rows
from torsionnet.model.damping import DampingMeasure, DampingQuantity, LossFactor, loss_factor
from torsionnet.model.element_base.curves import LookupCurve, Temperature
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness, ScaledStiffness
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Law, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.stiffness_table import StiffnessTable, TableEntry, stiffness_from_curves
from torsionnet.model.element_base.viscoelastic import FilmGap, Viscoelastic, temperature_faults

# Torsional vibration damper with a ring in a viscous film on a hub.

_FILMS = ("damping", "table", "silicone")


@register
@dataclass(frozen=True, eq=False, repr=False)
class ViscousDamper(Element):
    """A viscous torsional damper (Houde damper) on a shaft: a free ring in a film of silicone oil, in a hub.

    The ring, of inertia J_r, is dragged along by the film: J_r d2theta_r/dt2 = T_f, with T_f = c dgamma/dt + k gamma
    and gamma = theta - theta_r; the torque it takes from the shaft is J_h d2theta/dt2 + T_f. A film without stiffness
    (untuned) has its best damping on a mass on a spring, J and K, at c = 2 zeta J_r sqrt(K/J) with
    zeta = 1/sqrt(2 (1 + mu) (2 + mu)) and mu = J_r/J, J with the hub; then theta is at most (2 + mu)/mu times what the
    torque amplitude would turn the spring at rest (J. P. Den Hartog, Mechanical Vibrations, 4th ed., chapter 3).
    Silicone oils are stiff, too, and both values change with frequency and temperature: c and k are constants, or a
    table over frequency that holds at one temperature, or S (G' + j G'') of the silicone in the gaps round the ring at
    the temperature of the film, by time-temperature superposition, with S = pi (r_o^4 - r_i^4)/h_a + 2 pi b r_o^3/h_o
    + 2 pi b r_i^3/h_i; ``scale`` multiplies either, for an oil of another viscosity, or in a fit.

    Examples
    --------
    >>> damper = ViscousDamper("damper", node="nose", ring_inertia="0.12 kg*m^2", damping="60 N*m*s/rad")
    >>> damper.internal_nodes
    ('damper.ring',)
    >>> silicone = {"moduli": [[1, 3e3, 9e3], [100, "60 kPa", "70 kPa"]], "reference_temperature": "25 degC",
    ...     "shift": {"25 degC": 1, "75 degC": 0.4}}
    >>> warm = ViscousDamper("damper", node="nose", ring_inertia=2, silicone=silicone, temperature="75 degC",
    ...     gap={"outer_diameter": "400 mm", "inner_diameter": "250 mm", "axial_gap": "0.5 mm"})
    >>> [round(f, 3) for f in warm.parts(Values({}))[0].table.frequencies]
    [2.5, 250.0]
    """

    kind: ClassVar[str] = "viscous_damper"
    glyph: ClassVar[str] = "damper"
    sign: ClassVar[str] = "positive when the drivetrain drives the hub in the positive sense"

    node: str = entry(NodeName("the node its hub turns with", allow_ground=False))
    ring_inertia: Expression = entry(PhysicalQuantity("inertia of the ring", "inertia", "J_r", exclusive=True))
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("viscous damping of the film, or a measure of its damping", "damping", "c"), None
    )
    stiffness: Expression = entry(PhysicalQuantity("stiffness of the film", "stiffness", "k"), 0)
    hub_inertia: Expression = entry(PhysicalQuantity("inertia of hub and casing", "inertia", "J_h"), 0)
    table: StiffnessTable | None = entry(
        TableEntry("instead: rows [frequency in Hz, stiffness in N*m/rad, damping in N*m*s/rad] of the film"), None
    )
    silicone: Viscoelastic | None = entry(
        Nested("instead: moduli of the silicone", lambda: Viscoelastic, "viscoelastic"), None
    )
    gap: FilmGap | None = entry(Nested("its gaps round the ring", lambda: FilmGap, "film_gap"), None)
    scale: Expression | None = entry(
        PhysicalQuantity("factor on the table or on the moduli", "1", "F", exclusive=True), None
    )
    temperature: Expression | None = entry(
        Temperature("temperature of the silicone", "temperature", "t", exclusive=True), None
    )

    def contradictions(self) -> list[Fault]:
        films = given_entries(self, *_FILMS)
        if not films:
            return [
                Fault("a viscous_damper needs damping, a table, or silicone and gap", on_key=True, kind="missing-entry")
            ]
        if len(films) > 1:
            return one_at_most(self, *_FILMS, of="the film")
        if self.damping is None and self.stiffness != Number(0):
            return [superfluous(f"the {films[0]} gives the stiffness already", "stiffness")]
        if self.damping is not None and self.scale is not None:
            return [
                Fault(
                    "scale multiplies a table or a silicone, and there is none; leave it out",
                    ("scale",),
                    on_key=True,
                    kind="needless-entry",
                )
            ]
        return [*self._measure_faults(), *self._silicone_faults()]

    def _silicone_faults(self) -> list[Fault]:
        if (self.silicone is None) != (self.gap is None):
            lacking = "gap, as {outer_diameter: ...}" if self.silicone is not None else "silicone, as {moduli: ...}"
            return [
                Fault(
                    f"a film of silicone needs silicone and gap; here is no {lacking}",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        if self.silicone is not None:
            return temperature_faults(self.silicone, self.temperature)
        if self.temperature is not None:
            return [
                Fault(
                    "nothing here depends on temperature; give silicone and gap, or leave it out",
                    ("temperature",),
                    on_key=True,
                    kind="needless-entry",
                )
            ]
        return []

    def _measure_faults(self) -> list[Fault]:
        if isinstance(self.damping, DampingMeasure) and self.damping.measure != "c" and self.stiffness == Number(0):
            return [
                Fault(
                    "a measure of damping needs a film with stiffness; give damping in N*m*s/rad",
                    ("damping",),
                    kind="missing-entry",
                )
            ]
        return []

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.ring",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (ring,) = self.internal_nodes
        hub = Law(make_row([(self.node, 1)]), inertia=value(self.hub_inertia))
        return (
            self._film(ring, value),
            Law(make_row([(ring, 1)]), inertia=value(self.ring_inertia)),
            *([hub] if hub.acts else []),
        )

    def _film(self, ring: str, value: Values) -> Law:
        row = difference(self.node, ring)
        if self.table is not None:
            return Law(row, table=self._scaled(self.table, value))
        if self.silicone is not None:
            temperature = None if self.temperature is None else float(self.temperature.evaluate({}))
            # kappa is the complex modulus times the shape of the gap in m^3; the loss of a fluid counts as c omega.
            film = self.silicone.stiffness(not_none(self.gap).factor, temperature, viscous=True)
            return Law(row, table=self._scaled(film, value))
        stiffness = value(self.stiffness)
        return Law(row, damping=viscous(self.damping, stiffness, value), stiffness=stiffness)

    def _scaled(self, film: DynamicStiffness, value: Values) -> DynamicStiffness:
        return film if self.scale is None else ScaledStiffness(film, value(self.scale))

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Tuple of one row of node speeds, which ties the ring to the hub on average.

        On average both turn at one speed, whatever the film.
        """
        return (self.twist(value),)


# Tuned torsional damper: a ring on rubber on a hub.

_DAMPING = ("damping_ratio", "damping", "loss_factor")


@register
@dataclass(frozen=True, eq=False, repr=False)
class TunedDamper(Element):
    """A tuned torsional damper: a ring on an elastic and damping layer, mostly of rubber, on a hub.

    Its spring k is given, or by the natural frequency f_r of the ring on the hub held fast, k = J_r (2 pi f_r)^2. Its
    damping is a loss factor, k (1 + j eta), which suits rubber; or viscous, c itself or by the damping ratio of the
    ring on the hub held fast, c = 2 zeta sqrt(k J_r). On a mass on a spring, J with the hub and K, mu = J_r/J, the best
    viscous damper has f_r = sqrt(K/J)/(2 pi (1 + mu)) and zeta = sqrt(3 mu/(8 (1 + mu))); then theta is about
    sqrt(1 + 2/mu) times what the torque amplitude would turn the spring at rest (J. P. Den Hartog, Mechanical
    Vibrations, 4th ed., chapter 3).

    Examples
    --------
    >>> from math import pi, sqrt
    >>> J, K, mu = 2.0, 8e4, 0.1
    >>> best = TunedDamper("damper", node="nose", ring_inertia=mu * J,
    ...     natural_frequency=sqrt(K / J) / (1 + mu) / (2 * pi), damping_ratio=sqrt(3 * mu / (8 * (1 + mu))))
    >>> layer, ring = best.parts(Values({}))
    >>> round(layer.stiffness, 3), round(layer.damping, 6)
    (6611.57, 13.428163)
    """

    kind: ClassVar[str] = "tuned_damper"
    glyph: ClassVar[str] = "damper"
    sign: ClassVar[str] = "positive when the drivetrain drives the hub in the positive sense"

    node: str = entry(NodeName("the node its hub turns with", allow_ground=False))
    ring_inertia: Expression = entry(PhysicalQuantity("inertia of the ring", "inertia", "J_r", exclusive=True))
    stiffness: Expression | None = entry(
        PhysicalQuantity("stiffness of the layer", "stiffness", "k", exclusive=True), None
    )
    natural_frequency: Expression | None = entry(
        PhysicalQuantity("instead: natural frequency of the ring, hub held fast", "frequency", "f_r", exclusive=True),
        None,
    )
    loss_factor: Expression | DampingMeasure | None = entry(
        LossFactor("loss factor of the layer, or another measure of it", "1", "eta"), None
    )
    damping_ratio: Expression | None = entry(
        PhysicalQuantity("instead: damping ratio of the ring, hub held fast", "1", "zeta"), None
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("instead: viscous damping, or a measure at a frequency", "damping", "c"), None
    )
    hub_inertia: Expression = entry(PhysicalQuantity("inertia of the hub", "inertia", "J_h"), 0)

    def contradictions(self) -> list[Fault]:
        return one_exactly(self, "stiffness", "natural_frequency") + one_at_most(self, *_DAMPING, of="the damping")

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.ring",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (ring,) = self.internal_nodes
        inertia, stiffness = value(self.ring_inertia), self._stiffness(value)
        damping = viscous(self.damping, stiffness, value)
        if self.damping_ratio is not None:
            # zeta is that of the ring alone on its layer: c = 2 zeta sqrt(k J_r).
            damping = 2 * value(self.damping_ratio) * value.root(stiffness * inertia, "k J_r must not be negative")
        eta = loss_factor(self.loss_factor, value.parameters, value.algebra)
        layer = Law(difference(self.node, ring), damping=damping, stiffness=stiffness, loss_factor=eta)
        hub = Law(make_row([(self.node, 1)]), inertia=value(self.hub_inertia))
        return (layer, Law(make_row([(ring, 1)]), inertia=inertia), *([hub] if hub.acts else []))

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness is not None:
            return value(self.stiffness)
        return value(self.ring_inertia) * (2 * value.algebra.pi * value(self.natural_frequency)) ** 2


# Torsional damper of leaf or sleeve springs between an inner star and an outer ring, with oil between them.


@register
@dataclass(frozen=True, eq=False, repr=False)
class SpringDamper(Element):
    """A torsional vibration damper of steel springs and oil: an inner star on the shaft, an outer ring on leaf springs.

    Springs k and oil act between star and ring. The oil that the springs displace through gaps damps with c; it is a
    constant, or a measure at a frequency, as {eta: 0.4, at: 25 Hz}. Makers state the hydrodynamic damping by
    eta(f) = c omega/k, the undimensioned damping factor, and the dynamic stiffness by k(f) over that at rest; both
    over frequency make the law k(f) (1 + j eta(f)), between the rows by powers of the frequency.

    Examples
    --------
    >>> damper = SpringDamper("damper", node="nose", ring_inertia="180 kg*m^2", stiffness="2.4 MN*m/rad",
    ...     loss_over_frequency={"10 Hz": 0.3, "40 Hz": 0.6}, stiffness_over_frequency={"10 Hz": 1.1, "40 Hz": 1.3})
    >>> import numpy as np
    >>> damper.parts(Values({}))[0].table.kappa(2 * np.pi * np.array([10.0, 40.0])).round()
    array([2640000. +792000.j, 3120000.+1872000.j])
    """

    kind: ClassVar[str] = "spring_damper"
    glyph: ClassVar[str] = "damper"
    sign: ClassVar[str] = "positive when the drivetrain drives the inner star in the positive sense"

    node: str = entry(NodeName("the node its inner star turns with", allow_ground=False))
    ring_inertia: Expression = entry(PhysicalQuantity("inertia of the outer ring", "inertia", "J_r", exclusive=True))
    stiffness: Expression = entry(PhysicalQuantity("stiffness of the springs", "stiffness", "k", exclusive=True))
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("damping by the oil, or a measure at a frequency", "damping", "c"), None
    )
    loss_over_frequency: Rows = entry(
        LookupCurve("instead: c omega/k", "frequency", exclusive=True, shown="{10 Hz: 0.3, 40 Hz: 0.6}"),
        None,
    )
    stiffness_over_frequency: Rows = entry(
        LookupCurve("k(f) over the stiffness", "frequency", exclusive=True, shown="{10 Hz: 1.1, 40 Hz: 1.3}"), None
    )
    hub_inertia: Expression = entry(PhysicalQuantity("inertia of the inner star", "inertia", "J_h"), 0)

    def contradictions(self) -> list[Fault]:
        if self.loss_over_frequency and self.damping is not None:
            return [
                Fault(
                    "the damping is given, or over frequency, not both",
                    ("damping",),
                    on_key=True,
                    kind="contradicting-entries",
                )
            ]
        if self.stiffness_over_frequency and not self.loss_over_frequency:
            text = "a stiffness over frequency needs the damping over frequency, too: loss_over_frequency"
            return [Fault(text, ("stiffness_over_frequency",), on_key=True, kind="missing-entry")]
        return []

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.ring",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (ring,) = self.internal_nodes
        hub = Law(make_row([(self.node, 1)]), inertia=value(self.hub_inertia))
        inertia = Law(make_row([(ring, 1)]), inertia=value(self.ring_inertia))
        return (self._springs(ring, value), inertia, *([hub] if hub.acts else []))

    def _springs(self, ring: str, value: Values) -> Law:
        row = difference(self.node, ring)
        if self.loss_over_frequency:
            # Curves of a stiffness 1: the factor k keeps its derivatives to parameters.
            table = stiffness_from_curves(1.0, self.stiffness_over_frequency, self.loss_over_frequency, viscous=True)
            return Law(row, table=ScaledStiffness(table, value(self.stiffness)))
        stiffness = value(self.stiffness)
        return Law(row, damping=viscous(self.damping, stiffness, value), stiffness=stiffness)


# Centrifugal pendulums on a shaft, tuned to an order.


@register
@dataclass(frozen=True, eq=False, repr=False)
class PendulumAbsorber(Element):
    r"""Pendulums in the centrifugal field of a shaft that turns at Omega: an absorber tuned to an order, at any speed.

    ``count`` masses m run on paths of radius r round points at R from the axis of the shaft. With theta the angle of
    the shaft and psi that of shaft and pendulum together, small motions at constant mean speed have the kinetic energy
    m (R dtheta/dt + r dpsi/dt)^2/2 and the restoring torque m R r Omega^2 (psi - theta). The mass swings at
    n = sqrt(R/r) periods a turn, and at that order its node stands still, whatever the speed and the inertia of the
    shaft. A mass hung at two points (bifilar) does not turn against the shaft; hung at one, it does, and its inertia J
    about its centre of mass makes n = sqrt(m R r/(m r^2 + J)).

    Circle, cycloid and epicycloid have the same law for small motions, r being the radius of curvature at the vertex.
    They differ in how the order follows the ``swing``, the length of path to one side over r: its square goes with
    1 - (1 - lambda^2 (1 + n^2)/n^2) swing^2/8, lambda 0 for a circle, 1 for a cycloid, n/sqrt(1 + n^2) for the
    epicycloid, which keeps its order (H. H. Denman, Tautochronic bifilar pendulum torsion absorbers for reciprocating
    engines, J. Sound Vib. 159 (1992) 251-277; here by harmonic balance to the square of the swing, of a shaft that
    turns evenly, n without J).

    Examples
    --------
    >>> pendulum = PendulumAbsorber("pendulum", node="crank", count=4, mass="0.4 kg", pivot_radius="80 mm",
    ...     path_radius="20 mm", speed="1500 rpm")
    >>> spring, masses, *_ = pendulum.parts(Values({}))
    >>> n = (spring.stiffness / masses.inertia) ** 0.5 / 0.02 / (1500 * 3.141592653589793 / 30)
    >>> round(n, 12)
    2.0
    """

    kind: ClassVar[str] = "pendulum_absorber"
    glyph: ClassVar[str] = "pendulum"
    sign: ClassVar[str] = "positive when the drivetrain drives the pendulums in the positive sense"

    node: str = entry(NodeName("the node it turns with", allow_ground=False))
    mass: Expression = entry(PhysicalQuantity("mass of one pendulum", "mass", "m", exclusive=True))
    pivot_radius: Expression = entry(
        PhysicalQuantity("from the axis of the shaft to the centre of the path", "length", "R", exclusive=True)
    )
    path_radius: Expression = entry(
        PhysicalQuantity("radius of the path of the centre of mass at its vertex", "length", "r", exclusive=True)
    )
    speed: Expression = entry(
        PhysicalQuantity("mean speed of the shaft, or a parameter that follows it", "speed", "Omega", exclusive=True)
    )
    count: int = entry(Count("how many pendulums, all alike and in phase", 1, 100), 1)
    own_inertia: Expression = entry(PhysicalQuantity("inertia of one mass about its centre of mass", "inertia", "J"), 0)
    suspension: str = entry(OneOf("whether the masses turn against the shaft", ("bifilar", "simple")), "bifilar")
    damping: Expression = entry(PhysicalQuantity("viscous damping between all masses and the shaft", "damping", "c"), 0)
    path: str = entry(OneOf("form of the path", ("circle", "cycloid", "epicycloid")), "circle")
    swing: Expression = entry(PhysicalQuantity("length of path to one side over r, as an angle", "angle", "alpha"), 0)

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.mass",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (mass,) = self.internal_nodes
        count = value(scalar(self.count))
        total, own = count * value(self.mass), count * value(self.own_inertia)
        outer, inner = value(self.pivot_radius), value(self.path_radius)
        # The centrifugal field draws the mass back with m R r Omega^2 (psi - theta); the swing changes its order.
        stiffness = total * outer * inner * value(self.speed) ** 2 * self._softening(outer / inner, value)
        field = Law(difference(self.node, mass), damping=value(self.damping), stiffness=stiffness)
        # m (R theta' + r psi')^2/2 is an inertia m on the row R theta + r psi: tuned to n^2 = R/r.
        carried = Law(make_row([(self.node, outer), (mass, inner)]), inertia=total)
        # A mass hung at one point turns with psi, so that J lowers n; hung at two it turns with the shaft.
        turning = Law(make_row([(mass if self.suspension == "simple" else self.node, 1)]), inertia=own)
        return (field, carried, *([turning] if turning.acts else []))

    def _softening(self, squared_order: Any, value: Values) -> Any:
        """Dimensionless factor on the squared order of the pendulum by its swing; 1 for small swings."""
        squared = value(self.swing) ** 2 / 8
        if self.path == "epicycloid":
            return 1
        return 1 - squared if self.path == "circle" else 1 + squared / squared_order
