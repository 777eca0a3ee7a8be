"""Base class of quantities of a study over the speeds of the machinery."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import Count, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.excitations.speed_range import SpeedBand
from torsionnet.study.quantities.quantity import StudyQuantity

OWN = ("excitations", "speeds", "every")
"""Names of the entries that every quantity over the speeds of the machinery has."""


@dataclass(frozen=True, kw_only=True)
class SpeedQuantity(StudyQuantity):
    """Base class of the quantities of a study at all speeds of the model, or at some of them."""

    kind: ClassVar[str] = "over speed"

    excitations: tuple[str, ...] = entry(Listed("excitations that act; default: all", Text("an excitation")), None)
    speeds: tuple[float, float] | None = entry(SpeedBand("part of the model's speeds"), None)
    every: int = entry(Count("only every n-th of them, and the last, to save time", upper=10_000), 1)

    common: ClassVar[tuple[str, ...]] = OWN

    def at(self, model: Drivetrain) -> FloatArray:
        """Speeds (n_speeds,) in rad/s at which the quantity is calculated; empty where the model has no speeds."""
        given = model.definition.speeds
        found = np.array(given.values if given else ())
        if self.speeds is not None:
            low, high = self.speeds
            found = found[(found >= low * (1 - 1e-9)) & (found <= high * (1 + 1e-9))]
        return np.append(found[:-1][:: self.every], found[-1:])

    @staticmethod
    def is_range(model: Drivetrain) -> bool:
        """Whether the model's speeds are a range, which includes all speeds between them, and not a list."""
        given = model.definition.speeds
        return given is not None and not given.list

    @property
    def range_words(self) -> str:
        """Words for the speeds and excitations of the quantity, such as "at all speeds"."""
        acting = f"under {', '.join(self.excitations)}, " if self.excitations else ""
        over = "at all speeds" if self.speeds is None else speed_words(self.speeds)
        return acting + (over if self.every == 1 else f"{over}, one of {self.every}")

    def empty_range_faults(self, model: Drivetrain) -> Iterator[Fault]:
        """Yield a fault where none of the model's speeds lies in the range of the quantity."""
        if model.definition.speeds is not None and not len(self.at(model)):
            yield Fault("none of the model's speeds lies in this range", ("speeds",))


def speed_words(speeds: tuple[float, float]) -> str:
    """Words in r/min for a range of speeds in rad/s.

    >>> speed_words((62.83185307179586, 157.07963267948966))
    'from 600 to 1500 r/min'
    """
    return f"from {speeds[0] * RPM:.6g} to {speeds[1] * RPM:.6g} r/min"
