"""Throw of a crankshaft: its inertia with that of its cylinder, and the stiffness to the next one."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

from torsionnet.base.entries.composite import superfluous
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import Law, Part, Values, difference, make_row

_SECTIONS = ("journal_diameter", "journal_length", "pin_diameter", "pin_length", "web_width", "web_thickness")
_BORES = {"journal_bore": "journal_diameter", "pin_bore": "pin_diameter"}
HALF, EIGHTH = Fraction(1, 2), Fraction(1, 8)


@register
@dataclass(frozen=True, eq=False, repr=False)
class CrankThrow(Element):
    """Throw of a crankshaft, from the middle of it to the middle of the next one.

    The inertia is at the first node: that of the throw itself, of a mass m_r that turns with the pin (the big end) and
    of the masses m_o that move with the piston, averaged over a revolution:

        J + r^2 (m_r + m_o (1/2 + lambda^2/8)),    lambda = r/l,

    r the radius of the crank and l the length of the connecting rod; terms of lambda^4 are left out. The stiffness to
    the next throw is given, or is that of one journal, one pin and two webs, each as a beam that its bearings leave
    free: the torque twists journal and pin and bends the webs in their plane,

        1/k = L_j/(G I_j) + L_p/(G I_p) + 2 r/(E I_w),
        I = pi (D^4 - d^4)/32,    I_w = h b^3/12,

    with the width b and the thickness h of the web. Journal and pin twist some way into the webs: add that to their
    lengths. Bearings without play make a real crankshaft stiffer, so that measured values come first.

    Examples
    --------
    >>> throw = CrankThrow("cyl1", nodes=("c1", "c2"), inertia="0.03 kg*m^2", crank_radius="60 mm",
    ...     rod_length="210 mm", reciprocating_mass="1.6 kg", rotating_mass="1.2 kg", stiffness="1.1 MN*m/rad")
    >>> elastic, turning = throw.parts(Values({}))
    >>> float(elastic.stiffness), round(float(turning.inertia), 6)
    (1100000.0, 0.037259)
    """

    kind: ClassVar[str] = "crank_throw"
    glyph: ClassVar[str] = "crank"

    nodes: tuple[str, str] = entry(
        NodePair("the throw, where its inertia is, and the next station; twist is first minus second")
    )
    inertia: Expression = entry(PhysicalQuantity("inertia of journal, webs, pin and counterweights", "inertia", "J"))
    stiffness: Expression | None = entry(
        PhysicalQuantity("stiffness to the next station", "stiffness", "k", exclusive=True), None
    )
    crank_radius: Expression | None = entry(
        PhysicalQuantity("radius of the crank, half the stroke", "length", "r"), None
    )
    rotating_mass: Expression = entry(PhysicalQuantity("mass that turns with the pin", "mass", "m_r"), 0)
    reciprocating_mass: Expression = entry(PhysicalQuantity("mass that moves with the piston", "mass", "m_o"), 0)
    rod_length: Expression | None = entry(
        PhysicalQuantity("length of the connecting rod; none: very long", "length", "l", exclusive=True), None
    )
    journal_diameter: Expression | None = entry(
        PhysicalQuantity("for the stiffness instead: diameter of the journal", "length", "D_j", exclusive=True), None
    )
    journal_length: Expression | None = entry(
        PhysicalQuantity("length of the journal that twists", "length", "L_j"), None
    )
    pin_diameter: Expression | None = entry(
        PhysicalQuantity("diameter of the pin", "length", "D_p", exclusive=True), None
    )
    pin_length: Expression | None = entry(PhysicalQuantity("length of the pin that twists", "length", "L_p"), None)
    web_width: Expression | None = entry(
        PhysicalQuantity("width of the web, across the crank", "length", "b", exclusive=True), None
    )
    web_thickness: Expression | None = entry(
        PhysicalQuantity("thickness of the web, along the shaft", "length", "h", exclusive=True), None
    )
    journal_bore: Expression = entry(PhysicalQuantity("bore of the journal", "length", "d_j"), 0)
    pin_bore: Expression = entry(PhysicalQuantity("bore of the pin", "length", "d_p"), 0)
    shear_modulus: Expression = entry(
        PhysicalQuantity("shear modulus", "shear modulus", "G", exclusive=True), "79.3 GPa"
    )
    elastic_modulus: Expression = entry(
        PhysicalQuantity("modulus of elasticity", "pressure", "E", exclusive=True), "206 GPa"
    )
    damping: Expression | DampingMeasure = entry(DampingQuantity("viscous damping in its twist", "damping", "c"), 0)
    cylinder_damping: Expression = entry(
        PhysicalQuantity("damping of the cylinder, against the engine block as ground", "damping", "c_z"), 0
    )

    def contradictions(self) -> list[Fault]:
        return [*self._mass_faults(), *self._stiffness_faults(), *self._bore_faults()]

    def _mass_faults(self) -> list[Fault]:
        if self.crank_radius is not None:
            if not (isinstance(self.rod_length, Number) and isinstance(self.crank_radius, Number)):
                return []
            # A crank turns through only with l > r.
            if self.rod_length.value > self.crank_radius.value:
                return []
            return [
                Fault(
                    "the connecting rod must be longer than the radius of the crank",
                    ("rod_length",),
                    kind="contradicting-values",
                )
            ]
        masses = [name for name in ("rotating_mass", "reciprocating_mass") if getattr(self, name) != Number(0)]
        needing = [*masses, *(["rod_length"] if self.rod_length is not None else [])]
        return [Fault(f"{name} needs the crank_radius", (name,), on_key=True, kind="missing-entry") for name in needing]

    def _stiffness_faults(self) -> list[Fault]:
        given = [name for name in _SECTIONS if getattr(self, name) is not None]
        if self.stiffness is not None:
            given += [name for name in _BORES if getattr(self, name) != Number(0)]
            return [superfluous("the stiffness is given", name) for name in given]
        missing = [name for name in (*_SECTIONS, "crank_radius") if getattr(self, name) is None]
        if not missing:
            return []
        return [
            Fault(
                f"a throw needs its stiffness, or, to calculate it, {', '.join(missing)}",
                on_key=True,
                kind="missing-entry",
            )
        ]

    def _bore_faults(self) -> list[Fault]:
        faults = []
        for bore, diameter in _BORES.items():
            inner, outer = getattr(self, bore), getattr(self, diameter)
            if isinstance(inner, Number) and isinstance(outer, Number) and inner.value >= outer.value:
                faults.append(Fault("the bore must be smaller than the diameter", (bore,), kind="contradicting-values"))
        return faults

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        stiffness = self._stiffness(value)
        twisted = Law(difference(*self.nodes), stiffness=stiffness, damping=viscous(self.damping, stiffness, value))
        turning = make_row([(self.nodes[0], 1)])
        # On ground, at a clamped end, no inertia turns.
        if not turning:
            return (twisted,)
        return (twisted, Law(turning, inertia=self._inertia(value), damping=value(self.cylinder_damping)))

    def _inertia(self, value: Values) -> Any:
        own = value(self.inertia)
        if self.crank_radius is None:
            return own
        number, square = value.algebra.number, value(self.crank_radius) ** 2
        # Mean over a revolution of what the piston adds, m_o r^2 (1/2 + lambda^2/8); a very long rod has lambda = 0.
        share = number(HALF)
        if self.rod_length is not None:
            share = share + number(EIGHTH) * square / value(self.rod_length) ** 2
        return own + square * (value(self.rotating_mass) + value(self.reciprocating_mass) * share)

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness is not None:
            return value(self.stiffness)
        # Journal and pin twist in series, L/(G I) each with I = pi (D^4 - d^4)/32.
        twist: Any = 0
        for part in ("journal", "pin"):
            diameter, bore, length = (value(getattr(self, f"{part}_{of}")) for of in ("diameter", "bore", "length"))
            twist = twist + 32 * length / (value(self.shear_modulus) * value.algebra.pi * (diameter**4 - bore**4))
        # Two webs bend in their plane: 2 r/(E I_w), with I_w = h b^3/12.
        web = value(self.elastic_modulus) * value(self.web_thickness) * value(self.web_width) ** 3 / 12
        return 1 / (twist + 2 * value(self.crank_radius) / web)
