"""Flexible couplings and springs with losses, by makers' sheets, by measured dynamic stiffness, or by a loss factor."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Nested, Typed
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import Count, Spec, entry, not_none
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression, Number, Rows, interpolate_in_algebra
from torsionnet.model.damping import DampingMeasure, DampingQuantity, LossFactor, loss_factor
from torsionnet.model.element_base.curves import LookupCurve, Temperature, is_share, with_curve_ranges
from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness, ScaledStiffness
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import GROUND, Law, Part, Values, difference, make_row
from torsionnet.model.element_base.round_section import section_faults
from torsionnet.model.element_base.stiffness_table import StiffnessTable, TableEntry, stiffness_from_curves
from torsionnet.model.element_base.viscoelastic import (
    RUBBER_SHAPES,
    ShearedShape,
    Viscoelastic,
    coupling_faults,
    given_curves,
)
from torsionnet.model.elements.masses_and_springs import INNER_DIAMETER, NODE_PAIR_DESCRIPTION, OUTER_DIAMETER

# Flexible coupling: dynamic stiffness and damping as makers' sheets give them, or of rubber from its material.

_CURVE_OVER_TORQUE = "{0.25: 0.9, 1: 1.6}, of T_KN, or {2 kN*m: 0.9, 8 kN*m: 1.6}"
"""Example of a coupling's factor over torque, for messages."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class FlexibleCoupling(Element):
    r"""A flexible coupling by its maker's sheet, at a working point; or by the material of its rubber.

    The dynamic stiffness is k = k_0 S_T(T) S_A(T_W) S_t(t) n_p/n_s: k_0 as given or read off its curve over the mean
    torque T, factors over T, over the vibratory torque T_W and over the temperature t of the rubber, and n_s groups in
    series of n_p couplings in parallel. The damping is a loss factor, k (1 + j eta S_d(t)); the relative damping of
    the sheets is psi = 2 pi eta, written {psi: 0.9}; or a viscous damping c of one coupling. Curves are straight
    between their rows; over torque these are torques, or shares of T_KN. What is read off may be a parameter, so that
    the coupling follows the mean torque (``by: mean_torque``). Curves over frequency multiply k and replace eta.

    Of a material, k (1 + j eta) = S (G' + j G'') with the factor S of a disc in shear, pi (r_o^4 - r_i^4)/(2 t), or of
    a bush, 4 pi L/(1/r_i^2 - 1/r_o^2), at f by time-temperature superposition; ``scale`` multiplies it, for rubber of
    another hardness, or in a fit.

    Terms as in DIN 740-2 (1986) and ISO 14691 (2008).

    Examples
    --------
    >>> rubber = FlexibleCoupling("rubber", nodes=("engine", "gearbox"), T_KN="20 kN*m", torque="12 kN*m",
    ...     stiffness_over_torque={0.25: "90 kN*m/rad", 0.5: "120 kN*m/rad", 1: "240 kN*m/rad"},
    ...     temperature="60 degC", temperature_factor={"30 degC": 1, "90 degC": 0.6}, loss_factor={"psi": 0.9})
    >>> (law,) = rubber.parts(Values({}))
    >>> float(law.stiffness), round(law.loss_factor, 4)
    (115200.0, 0.1432)
    """

    kind: ClassVar[str] = "flexible_coupling"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair("the two halves; twist is the angle of the first minus the second"))
    stiffness: Expression | None = entry(
        PhysicalQuantity("dynamic stiffness of one coupling", "stiffness", "k_0"), None
    )
    stiffness_over_torque: Rows = entry(
        LookupCurve(
            "instead: dynamic stiffness over mean torque",
            "torque",
            "stiffness",
            exclusive=True,
            shown="{0.25: 90 kN*m/rad, 1: 240 kN*m/rad}, of T_KN",
        ),
        None,
    )
    loss_factor: Expression | DampingMeasure | None = entry(
        LossFactor("loss factor, or another measure as {psi: 0.9}", "1", "eta"), None
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("instead: viscous damping of one coupling", "damping", "c"), None
    )
    T_KN: Expression | None = entry(
        PhysicalQuantity("nominal torque, of which rows are shares", "torque", "T_KN", exclusive=True), None
    )
    torque: Expression | None = entry(PhysicalQuantity("mean torque at the working point", "torque", "T"), None)
    vibratory_torque: Expression | None = entry(
        PhysicalQuantity("amplitude at the working point", "torque", "T_W"), None
    )
    temperature: Expression | None = entry(
        Temperature("temperature of the rubber", "temperature", "t", exclusive=True), None
    )
    torque_factor: Rows = entry(
        LookupCurve("S_T, k over k_0", "torque", exclusive=True, shown=_CURVE_OVER_TORQUE), None
    )
    amplitude_factor: Rows = entry(
        LookupCurve("S_A, k over k_0", "torque", exclusive=True, shown=_CURVE_OVER_TORQUE), None
    )
    temperature_factor: Rows = entry(LookupCurve("S_t, k over k_0", "temperature", exclusive=True), None)
    damping_temperature_factor: Rows = entry(
        LookupCurve("S_d, of the loss factor", "temperature", exclusive=True), None
    )
    frequency_factor: Rows = entry(
        LookupCurve("k over k_0", "frequency", exclusive=True, shown="{1 Hz: 1, 100 Hz: 1.3}"), None
    )
    loss_over_frequency: Rows = entry(
        LookupCurve("loss factor", "frequency", exclusive=True, shown="{1 Hz: 0.15, 100 Hz: 0.2}"), None
    )
    material: Viscoelastic | None = entry(Nested("rubber: its moduli", lambda: Viscoelastic, "viscoelastic"), None)
    geometry: ShearedShape | None = entry(
        Typed("rubber: its shape", lambda: RUBBER_SHAPES, "shape", "rubber_shape"), None
    )
    scale: Expression | None = entry(
        PhysicalQuantity("factor on the moduli of the material", "1", "F", exclusive=True), None
    )
    in_series: int = entry(Count("n_s, groups in series", 1, 100), 1)
    in_parallel: int = entry(Count("n_p, couplings in parallel in each group", 1, 100), 1)
    first_inertia: Expression = entry(PhysicalQuantity("inertia that turns with the first node", "inertia", "J_1"), 0)
    second_inertia: Expression = entry(PhysicalQuantity("inertia that turns with the second node", "inertia", "J_2"), 0)

    def contradictions(self) -> list[Fault]:
        return coupling_faults(self)

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension of every expression in the coupling's entries.

        Operating values have to lie within the curves that are read at them.
        """
        curves = {
            operating: (rows, self._share_of(rows))
            for name, operating in given_curves(self)
            if (rows := self._rows(name))
        }
        yield from with_curve_ranges(super().expressions(), curves)

    def _rows(self, name: str) -> Rows:
        rows: Rows = getattr(self, name)
        return rows if not is_share(rows[0][0]) or isinstance(self.T_KN, Number) else ()

    def _share_of(self, rows: Rows) -> Any:
        return not_none(self.T_KN).evaluate({}) if is_share(rows[0][0]) else 1

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        sides = zip(self.nodes, (self.first_inertia, self.second_inertia), strict=True)
        masses = [Law(make_row([(node, 1)]), inertia=value(inertia)) for node, inertia in sides if node != GROUND]
        return (self._law(value), *(law for law in masses if law.acts))

    def _law(self, value: Values) -> Law:
        row = difference(*self.nodes)
        # Of n couplings in parallel and m in series: k and c count n/m times.
        groups = value(scalar(self.in_parallel)) / value(scalar(self.in_series))
        if self.material is not None or self.frequency_factor or self.loss_over_frequency:
            c = 0 if self.damping is None else value(scalar(self.damping))
            return Law(row, damping=c * groups, table=self._over_frequency(groups, value))
        stiffness = self._stiffness(value)
        damping = viscous(self.damping, stiffness, value) * groups
        return Law(row, damping=damping, stiffness=stiffness * groups, loss_factor=self._loss_factor(value))

    def _over_frequency(self, groups: Any, value: Values) -> DynamicStiffness:
        """Dynamic stiffness of the coupling over frequency in N m/rad.

        A table of numbers, times the stiffness that parameters may change.
        """
        if self.material is not None:
            temperature = None if self.temperature is None else float(self.temperature.evaluate({}))
            # k(f) = shape times G(f), the shape in m^3 by the geometry.
            base = self.material.stiffness(not_none(self.geometry).factor, temperature)
            return ScaledStiffness(base, groups if self.scale is None else groups * value(self.scale))
        # Curves of a stiffness 1: the factor k keeps its derivatives to parameters.
        eta = float(self._loss_factor(Values({})))
        base = stiffness_from_curves(1.0, self.frequency_factor, self.loss_over_frequency, eta)
        return ScaledStiffness(base, groups * self._stiffness(value))

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness_over_torque:
            stiffness = self._read(self.stiffness_over_torque, self.torque, value)
        else:
            stiffness = value(self.stiffness)
        # Each curve of a maker's sheet gives a factor at its own operating value, and the factors multiply.
        for rows, operating in (
            (self.torque_factor, self.torque),
            (self.amplitude_factor, self.vibratory_torque),
            (self.temperature_factor, self.temperature),
        ):
            if rows:
                stiffness = stiffness * self._read(rows, operating, value)
        return stiffness

    def _loss_factor(self, value: Values) -> Any:
        eta = loss_factor(self.loss_factor, value.parameters, value.algebra)
        if self.damping_temperature_factor:
            eta = eta * self._read(self.damping_temperature_factor, self.temperature, value)
        return eta

    def _read(self, rows: Rows, operating: Expression | None, value: Values) -> Any:
        at = value(operating) / value(self.T_KN) if is_share(rows[0][0]) else value(operating)
        return interpolate_in_algebra(rows, at, value.algebra)


# Coupling by its measured dynamic stiffness.


@register
@dataclass(frozen=True, eq=False, repr=False)
class TabulatedSpring(Element):
    """A coupling known by its measured dynamic stiffness k(f) + j omega c(f), interpolated linearly between the rows.

    Examples
    --------
    >>> bush = TabulatedSpring("bush", nodes=("a", "b"), table=[[1, 400, 2], ["20 Hz", "0.5 kN*m/rad", 1.2]])
    >>> bush.table.stiffness
    (400.0, 500.0)
    """

    kind: ClassVar[str] = "tabulated_spring"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    table: StiffnessTable = entry(TableEntry("rows [frequency in Hz, stiffness in N*m/rad, damping in N*m*s/rad]"))

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Law(difference(*self.nodes), table=self.table),)


# Spring with losses that do not depend on frequency.


@register
@dataclass(frozen=True, eq=False, repr=False)
class HystereticSpring(Element):
    """A spring with rate-independent losses: torque k (1 + j eta) gamma at positive frequency.

    The loss per cycle, pi eta k gamma^2, does not depend on frequency. The law holds in the frequency domain only; in
    the limit of zero frequency its phase lag stays.

    Examples
    --------
    >>> rubber = HystereticSpring("rubber", nodes=("a", "b"), stiffness=460, loss_factor=0.3)
    >>> rubber.ports
    {'first': 'a', 'second': 'b'}
    """

    kind: ClassVar[str] = "hysteretic_spring"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    stiffness: Expression = entry(PhysicalQuantity("torsional stiffness, the real part", "stiffness", "k"))
    loss_factor: Expression | DampingMeasure = entry(
        LossFactor("loss factor, or another frequency-free damping measure", "1", "eta")
    )
    damping: Expression | DampingMeasure = entry(DampingQuantity("viscous damping in parallel", "damping", "c"), 0)
    outer_diameter: Expression | None = entry(OUTER_DIAMETER, None)
    inner_diameter: Expression = entry(INNER_DIAMETER, 0)

    def contradictions(self) -> list[Fault]:
        return section_faults(self)

    @property
    def diameters(self) -> tuple[Expression, Expression] | None:
        return None if self.outer_diameter is None else (self.outer_diameter, self.inner_diameter)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        stiffness = value(self.stiffness)
        eta = loss_factor(self.loss_factor, value.parameters, value.algebra)
        damping = viscous(self.damping, stiffness, value)
        return (Law(difference(*self.nodes), damping=damping, stiffness=stiffness, loss_factor=eta),)
