"""Shapes of rubber and of silicone films between two parts that turn against each other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry, not_none
from torsionnet.base.errors import Fault


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
        return [Fault("the inner diameter must be smaller than the outer one", ("inner_diameter",))]

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
            return [Fault(f"{rims[0]} needs the width of the ring", (rims[0],), on_key=True)]
        if not rims and self.axial_gap is None:
            return [Fault("give a gap: axial_gap, outer_gap or inner_gap", on_key=True)]
        return super().contradictions()

    @property
    def factor(self) -> float:
        outer, inner = self.outer_diameter / 2, self.inner_diameter / 2
        faces = math.pi * (outer**4 - inner**4) / self.axial_gap if self.axial_gap else 0.0
        rims = ((outer, self.outer_gap), (inner, self.inner_gap))
        return float(faces + sum(2 * math.pi * not_none(self.width) * radius**3 / gap for radius, gap in rims if gap))


RUBBER_SHAPES: dict[str, type[ShearedShape]] = {cls.kind: cls for cls in (ShearedDisc, ShearedBush)}
