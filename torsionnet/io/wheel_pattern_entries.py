"""Entries of the file of a wheel's pitch pattern."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed, PairOf
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.spec import Count, EntryError, Flag, OneOf, Schema, Spec, Text, entry
from torsionnet.base.errors import Fault, got

UNITS: Mapping[str, float] = {"deg": math.pi / 180, "rad": 1.0}
"""Factor to rad of each unit in which a file of a pitch pattern may hold its angles."""


class AngleOfTooth(Spec[float]):
    """Entry of a plain number, an angle in the unit that the file of a pitch pattern names."""

    def coerce(self, raw: object) -> float:
        if isinstance(raw, bool) or not isinstance(raw, int | float) or not math.isfinite(raw):
            raise EntryError(f"expected a number, in the unit that the file names, {got(raw)}")
        return float(raw)

    def schema(self) -> Schema:
        return {"type": "number", "description": self.description}

    @property
    def accepted(self) -> str:
        return "float"


@dataclass(frozen=True, kw_only=True)
class WheelPatternFile(Declared):
    """A pitch pattern of a wheel as its file holds it, tooth by tooth.

    Examples
    --------
    >>> WheelPatternFile(teeth=2, unit="deg", positions=[[0.1, 0.01], [-0.1, 0.01]]).positions[0]
    (0.1, 0.01)
    """

    kind: ClassVar[str] = "wheel pattern"
    article: ClassVar[str] = "a wheel pattern"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("the wheel, its machine, the date of the calibration"), "")
    teeth: int = entry(Count("teeth of the wheel, missing ones included", lower=2, upper=10_000_000))
    missing_teeth: int = entry(Count("teeth that the gap lacks, the last ones of a turn", lower=0), 0)
    first_tooth: str = entry(Text("which tooth is 0, as: the first after the gap"), "")
    reversed: bool = entry(Flag("whether the wheel turned against the sense of the model"), False)
    unresolved_orders: tuple[int, ...] = entry(
        Listed("whole orders that may be vibration and are left out", Count("a whole order", lower=1)), ()
    )
    notes: tuple[str, ...] = entry(Listed("records, method, what was assumed", Text("a sentence")), ())
    unit: str = entry(OneOf("unit of the positions", tuple(UNITS)))
    positions: tuple[tuple[float, float], ...] = entry(
        Listed(
            "of each tooth, how far it stands beyond its place, and half of the 95 % interval",
            PairOf("position and half width", AngleOfTooth("an angle"), "[position, half width]"),
            form="a list of [position, half width] of each tooth",
        )
    )

    def contradictions(self) -> list[Fault]:
        faults = []
        if len(self.positions) != self.teeth:
            text = f"{len(self.positions)} positions are given for {self.teeth} teeth, missing ones included"
            faults.append(Fault(text, ("positions",)))
        if self.missing_teeth >= self.teeth - 1:
            text = f"a wheel of {self.teeth} teeth cannot lack {self.missing_teeth}"
            faults.append(Fault(text, ("missing_teeth",)))
        pitch = 2 * math.pi / self.teeth / UNITS[self.unit]
        for place, (position, half_width) in enumerate(self.positions):
            if abs(position) >= pitch / 2:
                text = f"tooth {place} stands {position:g} {self.unit} beyond its place, half a pitch or more"
                faults.append(Fault(f"{text}; check the unit", ("positions", place)))
            if half_width < 0:
                faults.append(Fault(f"the half width of tooth {place} is negative", ("positions", place, 1)))
        return faults
