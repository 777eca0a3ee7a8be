"""Entries of a toothed wheel or encoder that is read by its pulses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, Flag, Text, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.signals.rotation.stated_pattern import ToothPlaces, is_stated, stated_places


@dataclass(frozen=True, kw_only=True)
class Wheel(Declared):
    """A toothed wheel or an encoder, as its pulses are read.

    Examples
    --------
    >>> Wheel(teeth=60, missing_teeth=2).teeth
    60
    """

    kind: ClassVar[str] = "wheel"
    article: ClassVar[str] = "a wheel"

    teeth: int = entry(Count("pulses per revolution of the wheel, missing ones included", lower=1, upper=10_000_000))
    missing_teeth: int = entry(Count("teeth that the gap lacks, as 2 of a wheel 60-2", lower=0), 0)
    ratio: float = entry(Value("turns of the reference shaft per turn of the wheel", "1", exclusive=True), 1.0)
    reversed: bool = entry(Flag("whether the wheel turns against the sense of the model"), False)
    pattern: str = entry(
        Text("file of its pitch pattern, from the folder of this file; or where its teeth stand: "
             "4 teeth, 2 missing, 2 teeth, 1 missing; or 0, 80, 180, 270 deg"), "",
    )  # fmt: skip

    def contradictions(self) -> list[Fault]:
        if self.missing_teeth and self.missing_teeth >= self.teeth - 1:
            return [Fault(f"a wheel of {self.teeth} teeth cannot lack {self.missing_teeth}", ("missing_teeth",))]
        try:
            stated = self.stated
        except UsageError as error:
            return [Fault(str(error), ("pattern",))]
        if stated and self.missing_teeth:
            return [Fault("the pattern states the gaps already; leave missing_teeth out", ("missing_teeth",))]
        return []

    @property
    def stated(self) -> ToothPlaces | None:
        """Places of the teeth of the wheel where its pattern states them and they are not even."""
        places = stated_places(self.pattern, self.teeth) if is_stated(self.pattern) else None
        return None if places is None or places.repeats == places.count else places

    @property
    def pattern_file(self) -> str:
        """File of the wheel's pitch pattern; empty where there is none."""
        return "" if is_stated(self.pattern) else self.pattern

    @property
    def shows_tooth_0(self) -> bool:
        """Whether the wheel itself tells which tooth is 0, by its gap or by the pattern stated."""
        stated = self.stated
        return self.missing_teeth > 0 or (stated is not None and stated.repeats == 1)
