"""Viscoelastic materials, as rubber and silicone, by shear moduli over frequency and temperature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import NumberTable, RowColumn, Value
from torsionnet.base.entries.spec import Json, Schema, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number, Rows
from torsionnet.model.element_base.curves import LookupCurve, Temperature
from torsionnet.model.element_base.sampled_stiffness import SampledStiffness

Moduli = tuple[tuple[float, float, float], ...]
"""Type of rows of frequency in Hz, and of storage and loss modulus in Pa."""


@dataclass(frozen=True, eq=False, repr=False)
class ModulusRows(NumberTable[Moduli]):
    """Entry for rows [frequency, storage modulus G', loss modulus G''], stored in Hz and Pa."""

    columns: tuple[RowColumn, ...] = (
        RowColumn("frequency", "frequency", negative=False, zero=False),
        RowColumn("storage modulus", "shear modulus", negative=False, zero=False),
        RowColumn("loss modulus", "shear modulus", negative=False, zero=False),
    )

    def coerce(self, raw: object) -> Moduli:
        return tuple((float(f.value), float(G_1.value), float(G_2.value)) for f, G_1, G_2 in self.rows(raw))

    def plain(self, value: Any) -> Json:
        return [list(row) for row in value]

    def schema(self) -> Schema:
        return {**super().schema(), "description": f"{self.description} [Hz, Pa, Pa]"}


@dataclass(frozen=True, kw_only=True)
class Viscoelastic(Declared):
    """A material by G' + j G'' over frequency at one temperature, shifted to others along the axis of frequency.

    Time-temperature superposition: G*(f, T) = G*(a_T f, T_0), with log10 a_T = -C1 (T - T_0)/(C2 + T - T_0) (M. L.
    Williams, R. F. Landel, J. D. Ferry, J. Am. Chem. Soc. 77 (1955) 3701-3707), or with a_T from a table, interpolated
    in its logarithm. The change of the moduli with density and absolute temperature is left out.

    Examples
    --------
    >>> rubber = Viscoelastic(moduli=[[1, "1 MPa", "0.1 MPa"]], reference_temperature="20 degC", C1=8.86, C2="101.6 K")
    >>> round(math.log10(rubber.shift_factor(293.15 + 50)), 4)
    -2.9222
    """

    kind: ClassVar[str] = "material"
    article: ClassVar[str] = "a material"
    form: ClassVar[str] = (
        "{moduli: [[1 Hz, 1 MPa, 0.1 MPa], ...], reference_temperature: 20 degC, C1: 8.86, C2: 101.6 K}"
    )

    moduli: Moduli = entry(ModulusRows("rows [frequency, G', G''] at the reference temperature"))
    reference_temperature: Expression | None = entry(
        Temperature("T_0, where the moduli were measured", "temperature", "T_0"), None
    )
    C1: float | None = entry(Value("first constant of Williams, Landel and Ferry", "1", exclusive=True), None)
    C2: float | None = entry(
        Value("their second constant, a difference of temperatures", "temperature", exclusive=True), None
    )
    shift: Rows = entry(
        LookupCurve("instead: shift factor a_T", "temperature", exclusive=True, shown="{0 degC: 80, 20 degC: 1}"),
        None,
    )

    def contradictions(self) -> list[Fault]:
        if self.shift and (self.C1 is not None or self.C2 is not None):
            return [Fault("a_T is given by C1 and C2, or by a table, not both", ("shift",), on_key=True)]
        if (self.C1 is None) != (self.C2 is None):
            return [Fault("C1 and C2 are given together; universal values are C1: 8.86, C2: 101.6 K", on_key=True)]
        if self.C1 is not None and self.reference_temperature is None:
            return [Fault("C1 and C2 need reference_temperature, where a_T is 1", ("C1",), on_key=True)]
        if self.reference_temperature is not None and self.reference_temperature.names:
            return [Fault("expected a number with unit; a material has no parameters", ("reference_temperature",))]
        return []

    @property
    def is_shifted(self) -> bool:
        """Whether the material states how its moduli change with temperature."""
        return bool(self.shift) or self.C1 is not None

    @property
    def _reference(self) -> float:
        """Reference temperature T_0 of the material in kelvin."""
        return float(not_none(self.reference_temperature).evaluate({}))

    def temperature_fault(self, temperature: float) -> str | None:
        """Message if the material's moduli are not known at a temperature in K, else None."""
        if self.shift:
            first, last = (self.shift[place][0] for place in (0, -1))
            beyond = not float(first.value) - 1e-9 <= temperature <= float(last.value) + 1e-9
            return f"the shift of the material is known from {first} to {last}" if beyond else None
        if not self.is_shifted:
            return "the material does not say how its moduli change with temperature; give C1 and C2, or shift"
        if not_none(self.C2) + temperature - self._reference <= 0:
            return "so far below the reference temperature the equation of Williams, Landel and Ferry has no value"
        return None

    def shift_factor(self, temperature: float) -> float:
        """Dimensionless factor a_T by which a temperature in kelvin shifts the frequencies of the moduli."""
        if not self.is_shifted:
            return 1.0
        if not self.shift:
            apart = temperature - self._reference
            return float(10 ** (-not_none(self.C1) * apart / (not_none(self.C2) + apart)))
        import numpy as np

        keys, logs = zip(*((float(key.value), math.log(one.value)) for key, one in self.shift), strict=True)
        return math.exp(float(np.interp(temperature, keys, logs)))

    def stiffness(self, shape: float, temperature: float | None, *, viscous: bool = False) -> SampledStiffness:
        """Dynamic stiffness in N m/rad of a shape with k = ``shape`` G, ``shape`` in m^3, at a temperature in kelvin.

        None is the reference. The loss is that of a solid, or of a ``viscous`` fluid.
        """
        shift = 1.0 if temperature is None else self.shift_factor(temperature)
        return SampledStiffness.of(
            *zip(*((f / shift, shape * storage, shape * loss) for f, storage, loss in self.moduli), strict=True),
            viscous=viscous,
        )


def temperature_faults(material: Viscoelastic, temperature: Expression | None) -> list[Fault]:
    """Faults of the entry ``temperature`` if the moduli of the material are not known there."""
    if temperature is None:
        return []
    if not isinstance(temperature, Number):
        text = f'"{temperature}" is an expression of parameters; the temperature of a material is a number'
        return [Fault(text, ("temperature",))]
    reason = material.temperature_fault(float(temperature.value))
    return [Fault(reason, ("temperature",))] if reason else []
