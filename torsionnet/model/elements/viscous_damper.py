"""Torsional vibration damper with a ring in a viscous film on a hub."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Nested, given_entries, one_at_most, superfluous
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.curves import Temperature
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness, ScaledStiffness
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Law, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.sheared_shapes import FilmGap
from torsionnet.model.element_base.stiffness_rows import TableEntry
from torsionnet.model.element_base.stiffness_table import StiffnessTable
from torsionnet.model.element_base.viscoelastic import Viscoelastic, temperature_faults

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
            return [Fault("a viscous_damper needs damping, a table, or silicone and gap", on_key=True)]
        if len(films) > 1:
            return one_at_most(self, *_FILMS, of="the film")
        if self.damping is None and self.stiffness != Number(0):
            return [superfluous(f"the {films[0]} gives the stiffness already", "stiffness")]
        if self.damping is not None and self.scale is not None:
            return [
                Fault(
                    "scale multiplies a table or a silicone, and there is none; leave it out", ("scale",), on_key=True
                )
            ]
        return [*self._measure_faults(), *self._silicone_faults()]

    def _silicone_faults(self) -> list[Fault]:
        if (self.silicone is None) != (self.gap is None):
            lacking = "gap, as {outer_diameter: ...}" if self.silicone is not None else "silicone, as {moduli: ...}"
            return [Fault(f"a film of silicone needs silicone and gap; here is no {lacking}", on_key=True)]
        if self.silicone is not None:
            return temperature_faults(self.silicone, self.temperature)
        if self.temperature is not None:
            return [
                Fault(
                    "nothing here depends on temperature; give silicone and gap, or leave it out",
                    ("temperature",),
                    on_key=True,
                )
            ]
        return []

    def _measure_faults(self) -> list[Fault]:
        if isinstance(self.damping, DampingMeasure) and self.damping.measure != "c" and self.stiffness == Number(0):
            return [Fault("a measure of damping needs a film with stiffness; give damping in N*m*s/rad", ("damping",))]
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
