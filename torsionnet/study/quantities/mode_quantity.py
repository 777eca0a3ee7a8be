"""What quantities of one mode have in common: which mode it is, in the nominal model and in every variant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from torsionnet.assembly.rows import ComplexArray
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Count, OneOf
from torsionnet.core.errors import Fault
from torsionnet.drivetrain import Drivetrain
from torsionnet.response.modes import OSCILLATORY, Modes
from torsionnet.solve.modes.modes import natural_modes
from torsionnet.study.quantities.quantity import StudyQuantity

if TYPE_CHECKING:
    from torsionnet.study.quantities.variant_block import VariantBlock

TRACKED, ASCENDING = "tracked", "ascending"
MIXED = "veers: a fifth or more of its energy is that of another mode of the model"


@dataclass(frozen=True, kw_only=True)
class ModeQuantity(StudyQuantity):
    """Base of the quantities of one mode of vibration.

    ``tracked``, the default, is the mode of every variant whose shape is that of the nominal mode of this number, by
    the modal assurance criterion, wherever its frequency has gone; ``ascending`` the one of this number by size.
    """

    kind: ClassVar[str] = "mode"

    mode: int = entry(Count("1 is the lowest vibration; rigid bodies and overdamped motions do not count"))
    order: str | None = entry(
        OneOf(
            "the mode that the nominal one becomes, or the n-th by frequency; default: tracked", (TRACKED, ASCENDING)
        ),
        None,
    )

    def unfit(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        yield from self.beyond(len(vibrating(natural_modes(model)[0])))

    @property
    def which_mode(self) -> str:
        """Which mode, in words."""
        if self.order == ASCENDING:
            return f"mode {self.mode} by frequency"
        return f"mode {self.mode}, followed by its shape"

    def beyond(self, count: int) -> Iterator[Fault]:
        """What is wrong where there are only so many modes."""
        if self.mode > count:
            there = f"{count} mode{'s' * (count != 1)} of vibration" if count else "no mode of vibration"
            yield Fault(f"there is no mode {self.mode}; the model has {there}", ("mode",))

    def eigenvalue(self, block: VariantBlock) -> ComplexArray:
        """rad/s, (n_variants,); NaN where a variant has no such vibration."""
        if self.order == ASCENDING:
            return nth_vibration(block.every_mode.eigenvalues, self.mode)
        place = vibrating(block.modes.reference)[self.mode - 1]
        mixed = int(np.sum(block.modes.veering[:, place]))
        if mixed:
            block.remark(f"mode {self.mode} {MIXED}", mixed)
        chosen = block.modes.eigenvalues[:, place]
        return np.where(chosen.imag > 0, chosen, complex(np.nan, np.nan))


def nth_vibration(eigenvalues: ComplexArray, number: int) -> ComplexArray:
    """The n-th by size (n_variants,) of the vibrations among eigenvalues (n_variants, n_modes), NaN without one."""
    vibrates = eigenvalues.imag > 0
    places = np.argsort(np.where(vibrates, np.abs(eigenvalues), np.inf), axis=1, kind="stable")
    if places.shape[1] < number:
        return np.full(len(eigenvalues), complex(np.nan, np.nan))
    place = places[:, number - 1 : number]
    found = np.take_along_axis(eigenvalues, place, axis=1)[:, 0]
    return np.where(np.take_along_axis(vibrates, place, axis=1)[:, 0], found, complex(np.nan, np.nan))


def vibrating(modes: Modes) -> list[int]:
    """Places of the modes of vibration among all modes of a model, by rising ``|lambda|``."""
    return [place for place, kind in enumerate(modes.kinds) if kind == OSCILLATORY]
