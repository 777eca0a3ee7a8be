"""Viscoelastic materials, as rubber and silicone, by shear moduli over frequency and temperature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import given_entries, one_at_most, superfluous
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import NumberTable, RowColumn, Value
from torsionnet.base.entries.spec import Json, Schema, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import RATIONAL, Expression, Number, Rows
from torsionnet.model.damping import DampingMeasure, loss_factor
from torsionnet.model.element_base.curves import LookupCurve, Temperature, is_share
from torsionnet.model.element_base.stiffness_table import SampledStiffness

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
            return [
                Fault(
                    "a_T is given by C1 and C2, or by a table, not both",
                    ("shift",),
                    on_key=True,
                    kind="contradicting-entries",
                )
            ]
        if (self.C1 is None) != (self.C2 is None):
            return [
                Fault(
                    "C1 and C2 are given together; universal values are C1: 8.86, C2: 101.6 K",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        if self.C1 is not None and self.reference_temperature is None:
            return [
                Fault(
                    "C1 and C2 need reference_temperature, where a_T is 1", ("C1",), on_key=True, kind="missing-entry"
                )
            ]
        if self.reference_temperature is not None and self.reference_temperature.names:
            return [
                Fault(
                    "expected a number with unit; a material has no parameters",
                    ("reference_temperature",),
                    kind="expression-not-allowed",
                )
            ]
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
        # C2 + T - T_0 is the denominator of the shift by Williams, Landel and Ferry.
        if not_none(self.C2) + temperature - self._reference <= 0:
            return "so far below the reference temperature the equation of Williams, Landel and Ferry has no value"
        return None

    def shift_factor(self, temperature: float) -> float:
        """Dimensionless factor a_T by which a temperature in kelvin shifts the frequencies of the moduli."""
        if not self.is_shifted:
            return 1.0
        if not self.shift:
            # Williams, Landel and Ferry: log10 a_T = -C1 (T - T_0)/(C2 + T - T_0).
            apart = temperature - self._reference
            return float(10 ** (-not_none(self.C1) * apart / (not_none(self.C2) + apart)))
        import numpy as np

        # log a_T is straight between the temperatures of the table.
        keys, logs = zip(*((float(key.value), math.log(factor.value)) for key, factor in self.shift), strict=True)
        return math.exp(float(np.interp(temperature, keys, logs)))

    def stiffness(self, shape: float, temperature: float | None, *, viscous: bool = False) -> SampledStiffness:
        """Dynamic stiffness in N m/rad of a shape with k = ``shape`` G, ``shape`` in m^3, at a temperature in kelvin.

        None is the reference. The loss is that of a solid, or of a ``viscous`` fluid.
        """
        shift = 1.0 if temperature is None else self.shift_factor(temperature)
        # What was measured at f holds at f/a_T at this temperature: cold rubber acts as at a higher frequency.
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
        return [Fault(text, ("temperature",), kind="expression-not-allowed")]
    reason = material.temperature_fault(float(temperature.value))
    return [Fault(reason, ("temperature",), kind="out-of-range")] if reason else []


# Shapes of rubber and of silicone films between two parts that turn against each other.


def _length(text: str) -> Value:
    return Value(text, "length", exclusive=True)


@dataclass(frozen=True, kw_only=True)
class ShearedShape(Declared):
    """Base class of rubber or film shapes between two rigid parts that turn against each other."""

    outer_diameter: float = entry(_length("outer diameter"))
    inner_diameter: float = entry(_length("inner diameter"))

    def contradictions(self) -> list[Fault]:
        if self.inner_diameter < self.outer_diameter:
            return []
        return [
            Fault(
                "the inner diameter must be smaller than the outer one",
                ("inner_diameter",),
                kind="contradicting-values",
            )
        ]

    @property
    def factor(self) -> float:
        """Torsional stiffness of the shape over its shear modulus, in m^3."""
        raise NotImplementedError


@dataclass(frozen=True, kw_only=True)
class ShearedDisc(ShearedShape):
    """An annular disc between two flanges: k = pi G (r_o^4 - r_i^4)/(2 t).

    >>> round(ShearedDisc(outer_diameter="400 mm", inner_diameter="200 mm", thickness="50 mm").factor, 6)
    0.047124
    """

    kind: ClassVar[str] = "disc"
    thickness: float = entry(_length("thickness, from flange to flange"))

    @property
    def factor(self) -> float:
        # Disc between faces that turn against each other: k/G = pi (r_o^4 - r_i^4)/(2 t)
        radii = (self.outer_diameter / 2) ** 4 - (self.inner_diameter / 2) ** 4
        return float(math.pi * radii / (2 * self.thickness))


@dataclass(frozen=True, kw_only=True)
class ShearedBush(ShearedShape):
    """A cylindrical bush between two sleeves: k = 4 pi G L/(1/r_i^2 - 1/r_o^2).

    >>> round(ShearedBush(outer_diameter="60 mm", inner_diameter="40 mm", length="50 mm").factor, 8)
    0.00045239
    """

    kind: ClassVar[str] = "bush"
    length: float = entry(_length("length of the bush"))

    @property
    def factor(self) -> float:
        # Sleeve between two cylinders: k/G = 4 pi L/(1/r_i^2 - 1/r_o^2)
        gap = (2 / self.inner_diameter) ** 2 - (2 / self.outer_diameter) ** 2
        return float(4 * math.pi * self.length / gap)


@dataclass(frozen=True, kw_only=True)
class FilmGap(ShearedShape):
    """The gaps round the ring of a viscous damper, thin against its radii: two faces, the outer and the inner rim.

    k/G = pi (r_o^4 - r_i^4)/h_a + 2 pi b r_o^3/h_o + 2 pi b r_i^3/h_i; a gap that is not given has no film that counts.

    >>> round(FilmGap(outer_diameter=0.3, inner_diameter=0.2, axial_gap=0.0005).factor, 6)
    2.552544
    """

    kind: ClassVar[str] = "film"
    axial_gap: float | None = entry(_length("h_a, gap at each of the two faces"), None)
    width: float | None = entry(_length("b, width of the ring"), None)
    outer_gap: float | None = entry(_length("h_o, gap outside of the ring"), None)
    inner_gap: float | None = entry(_length("h_i, gap inside of the ring"), None)

    def contradictions(self) -> list[Fault]:
        rims = [name for name in ("outer_gap", "inner_gap") if getattr(self, name) is not None]
        if rims and self.width is None:
            return [Fault(f"{rims[0]} needs the width of the ring", (rims[0],), on_key=True, kind="missing-entry")]
        if not rims and self.axial_gap is None:
            return [Fault("give a gap: axial_gap, outer_gap or inner_gap", on_key=True, kind="missing-entry")]
        return super().contradictions()

    @property
    def factor(self) -> float:
        outer, inner = self.outer_diameter / 2, self.inner_diameter / 2
        faces = math.pi * (outer**4 - inner**4) / self.axial_gap if self.axial_gap else 0.0
        rims = ((outer, self.outer_gap), (inner, self.inner_gap))
        return float(faces + sum(2 * math.pi * not_none(self.width) * radius**3 / gap for radius, gap in rims if gap))


RUBBER_SHAPES: dict[str, type[ShearedShape]] = {cls.kind: cls for cls in (ShearedDisc, ShearedBush)}


# Faults of a flexible coupling whose entries contradict each other.

_READ_AT = {
    "stiffness_over_torque": "torque",
    "torque_factor": "torque",
    "amplitude_factor": "vibratory_torque",
    "temperature_factor": "temperature",
    "damping_temperature_factor": "temperature",
}
"""Name of the entry with the operating value at which each curve of a coupling is read, by the curve's entry."""
_OVER_FREQUENCY = ("frequency_factor", "loss_over_frequency")


def given_curves(coupling: Any) -> list[tuple[str, str]]:
    """Entry name of every curve that a coupling gives, and of the operating value at which the curve is read."""
    return [(name, operating) for name, operating in _READ_AT.items() if getattr(coupling, name)]


def coupling_faults(coupling: Any) -> list[Fault]:
    """Faults of a coupling in the source of its stiffness, or, where that is clear, in its other entries."""
    faults = _source_faults(coupling)
    if faults or coupling.material is not None:
        return faults or _material_faults(coupling)
    return [
        *_curve_faults(coupling),
        *_damping_faults(coupling),
        *_frequency_faults(coupling),
    ]


def _source_faults(coupling: Any) -> list[Fault]:
    sources = ("stiffness", "stiffness_over_torque", "material")
    given = given_entries(coupling, *sources)
    if not given:
        return [
            Fault("give stiffness, stiffness_over_torque, or material and geometry", on_key=True, kind="missing-entry")
        ]
    if len(given) > 1:
        return one_at_most(coupling, *sources, of="the stiffness")
    if (coupling.material is None) != (coupling.geometry is None):
        lacking = "geometry, as {type: disc, ...}" if coupling.material is not None else "material, as {moduli: ...}"
        return [
            Fault(
                f"stiffness from rubber needs material and geometry; here is no {lacking}",
                on_key=True,
                kind="missing-entry",
            )
        ]
    return []


def _material_faults(coupling: Any) -> list[Fault]:
    others = [*_READ_AT, *_OVER_FREQUENCY, "loss_factor"]
    own = next((name for name in others if getattr(coupling, name)), None)
    if own is not None:
        return [superfluous("the material gives stiffness and damping already", own)]
    return [*temperature_faults(coupling.material, coupling.temperature), *_frequency_faults(coupling)]


def _curve_faults(coupling: Any) -> list[Fault]:
    faults = []
    given = given_curves(coupling)
    for name, operating in given:
        if getattr(coupling, operating) is None:
            faults.append(
                Fault(f"{name} needs {operating}, at which it is read", (name,), on_key=True, kind="missing-entry")
            )
        if is_share(getattr(coupling, name)[0][0]) and coupling.T_KN is None and operating != "temperature":
            text = "rows without a unit are shares of the nominal torque: give T_KN, or torques in N*m"
            faults.append(Fault(text, (name,), on_key=True, kind="missing-entry"))
    for operating in dict.fromkeys(_READ_AT.values()):
        if getattr(coupling, operating) is not None and operating not in {where for _, where in given}:
            curves = " or ".join(name for name, where in _READ_AT.items() if where == operating)
            faults.append(
                Fault(
                    f"nothing here depends on {operating}; give {curves}, or leave it out",
                    (operating,),
                    on_key=True,
                    kind="needless-entry",
                )
            )
    return faults


def _damping_faults(coupling: Any) -> list[Fault]:
    both = one_at_most(coupling, "loss_factor", "damping", "loss_over_frequency", of="the damping")
    if both:
        return both
    if coupling.damping_temperature_factor and coupling.loss_factor is None:
        text = "this factor multiplies loss_factor, which is not given; add loss_factor"
        return [Fault(text, ("damping_temperature_factor",), on_key=True, kind="missing-entry")]
    if coupling.frequency_factor and not (coupling.loss_over_frequency or _loses(coupling.loss_factor)):
        text = "a stiffness over frequency needs a damping, too: loss_factor or loss_over_frequency"
        return [Fault(text, ("frequency_factor",), on_key=True, kind="missing-entry")]
    return []


def _loses(entry: Any) -> bool:
    """Whether a loss factor is above zero, or may be, as parameters give it."""
    return entry is not None and bool(entry.names or loss_factor(entry, {}, RATIONAL) > 0)


def _frequency_faults(coupling: Any) -> list[Fault]:
    """Faults of a coupling's damping that laws over frequency cannot take.

    Their loss is made of numbers: parameters in it would be without derivatives in fits.
    """
    if coupling.material is not None and isinstance(coupling.damping, DampingMeasure):
        return [
            Fault(
                "beside a material the damping is a viscous coefficient; give it in N*m*s/rad",
                ("damping",),
                kind="wrong-unit",
            )
        ]
    if coupling.material is None and coupling.scale is not None:
        return [
            Fault(
                "scale multiplies the moduli of a material, which is not given; add material, or leave it out",
                ("scale",),
                on_key=True,
                kind="needless-entry",
            )
        ]
    if not coupling.frequency_factor:
        return []
    names = ["loss_factor", *(["temperature"] if coupling.damping_temperature_factor else [])]
    return [
        Fault(
            f"with curves over frequency {name} must be a number, not an expression of parameters",
            (name,),
            kind="expression-not-allowed",
        )
        for name in names
        if getattr(getattr(coupling, name), "names", ())
    ]
