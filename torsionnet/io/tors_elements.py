"""Declared content of TORS files, the JSON format of openTorsion and its editor.

A file has ``components``, each a chain of ``elements``, and ``structure``, pairs ``[component.element,
component.element]`` that let a component begin where an element of another one ends. Lengths are in mm. A disk, a gear
without parent and the beginning of a shaft stand where the chain has come to; a shaft takes it to a new place, and so
does a gear with a parent, on the shaft it drives. Meaning as in ``opentorsion.Parser.from_tors`` of openTorsion 0.3.2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.plain_numbers import PlainNumber
from torsionnet.base.entries.spec import EntryError, Json, Spec, Text, entry
from torsionnet.base.errors import Fault

SHEAR_MODULUS, DENSITY = 80e9, 8000.0
"""Shear modulus in Pa, which a TORS file has no entry for, and density in kg/m^3 that openTorsion takes by default."""


@dataclass(frozen=True, eq=False, repr=False)
class Size(PlainNumber):
    """Entry of a finite number, kept as it is written, which in a file is not below 0, or above 0 if ``exclusive``.

    Negative damping, as that of a load of constant power, is written for openTorsion all the same.
    """

    exclusive: bool = False

    def coerce(self, raw: object) -> float:
        if isinstance(raw, bool) or not isinstance(raw, int | float) or not -inf < raw < inf:
            raise EntryError(f"expected a number as {self.description}, got {raw!r}")
        return raw

    def read(self, raw: object) -> tuple[float | None, list[Fault]]:
        value, faults = super().read(raw)
        if value is None or value > 0 or (value == 0 and not self.exclusive):
            return value, faults
        bound = "be greater than" if self.exclusive else "not be less than"
        return None, [Fault(f"{self.description} must {bound} 0, got {raw!r}")]


class AsWritten(Spec[object]):
    """Entry of anything, kept as it is written."""

    def coerce(self, raw: object) -> object:
        return raw


class TorsPart(Declared):
    """Base of the parts of a TORS file, whose fields have the names of its keys.

    Other programs have keys of their own and leave entries without a value; both are passed over.
    """

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        return [cls.missing(key, name) for key in cls.required() if key not in raw]

    def written_entries(self) -> dict[str, Json]:
        """Plain value of every entry that has one, by name, because defaults of other programs may be others."""
        return {name: spec.plain(value) for name, spec in self.specs() if (value := getattr(self, name)) is not None}


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsElement(TorsPart):
    """Element of a component of a TORS file, of one of the types in :data:`ELEMENT_TYPES`."""

    is_shaft: ClassVar[bool] = False

    name: str = entry(Text("text that no other element of the component has"))
    node: object = entry(AsWritten("name of the node at its end, by torsionnet"), None)
    excitation: object = entry(AsWritten("torque on it"), None)

    common: ClassVar[tuple[str, ...]] = ("node", "excitation")

    def to_data(self) -> Json:
        return {"name": self.name, "type": self.kind, **self.written_entries()}


@dataclass(frozen=True, eq=False, kw_only=True)
class Disk(TorsElement):
    """Disk of a TORS file, with a damper and spring to ground."""

    kind = "Disk"

    inertia: float = entry(Size("inertia in kg m^2"))
    damping: float = entry(Size("damping to ground in N m s/rad"), 0.0)
    stiffness: float | None = entry(Size("stiffness to ground in N m/rad"), None)


@dataclass(frozen=True, eq=False, kw_only=True)
class ShaftDiscrete(TorsElement):
    """Shaft without inertia of a TORS file."""

    kind = "ShaftDiscrete"
    is_shaft = True

    stiffness: float = entry(Size("stiffness in N m/rad"))
    damping: float = entry(Size("damping in N m s/rad"), 0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class ShaftContinuous(TorsElement):
    """Round shaft with inertia of a TORS file."""

    kind = "ShaftContinuous"
    is_shaft = True

    length: float = entry(Size("length in mm", exclusive=True))
    outerDiameter: float = entry(Size("outer diameter in mm", exclusive=True))
    innerDiameter: float = entry(Size("inner diameter in mm"), 0.0)
    density: float = entry(Size("density in kg/m^3", exclusive=True), DENSITY)
    damping: float | None = entry(Size("damping in N m s/rad"), None)

    def contradictions(self) -> list[Fault]:
        has_wall = self.innerDiameter < self.outerDiameter
        return [] if has_wall else [Fault("the inner diameter must be smaller than the outer one")]


@dataclass(frozen=True, eq=False, kw_only=True)
class GearElement(TorsElement):
    """Wheel of a TORS file, with a parent the wheel that it meshes with."""

    kind = "GearElement"

    inertia: float = entry(Size("inertia in kg m^2"))
    diameter: float | None = entry(Size("diameter in mm", exclusive=True), None)
    teeth: float | None = entry(Size("number of teeth", exclusive=True), None)
    parent: str | None = entry(Text("name of the wheel before it that it meshes with"), None)

    def contradictions(self) -> list[Fault]:
        return [] if self.teeth or self.diameter else [Fault("a gear needs teeth or a diameter")]

    def sizes_against(self, parent: GearElement) -> tuple[float, float] | None:
        """Sizes of parent and wheel by which they mesh, in teeth or diameters, or None where they have none alike."""
        pairs = ((parent.teeth, self.teeth), (parent.diameter, self.diameter))
        return next(((first, second) for first, second in pairs if first and second), None)


ELEMENT_TYPES: Mapping[str, type[TorsElement]] = {
    cls.kind: cls for cls in (Disk, ShaftDiscrete, ShaftContinuous, GearElement)
}
"""Classes of elements of TORS files by their ``type``."""


class TypedTorsElement(Typed[TorsElement]):
    """Entry of an element of a TORS file, which is written with its name before its type."""

    def plain(self, value: Any) -> Json:
        return TorsElement.to_data(value)
