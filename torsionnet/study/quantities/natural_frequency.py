"""Natural frequencies, followed from variant to variant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import OneOf
from torsionnet.core.errors import Fault, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.solve.modes.mode_pairs import undamped_place
from torsionnet.study.quantities.mode_quantity import ASCENDING, ModeQuantity
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, register_quantity
from torsionnet.study.quantities.variant_block import VariantBlock

UNDAMPED = "undamped"
WORDS = {"natural": "natural frequency", "damped": "frequency of the damped vibration"}


@register_quantity
@dataclass(frozen=True, kw_only=True)
class NaturalFrequency(ModeQuantity):
    """Frequency of a vibration mode: ``|lambda|/2pi``, damped ``Im lambda/2pi``, or undamped, of M and K alone.

    Undamped ones are followed by their place among all by size: that of the mode of this number in the nominal model.
    """

    kind: ClassVar[str] = "natural_frequency"

    which: str = entry(OneOf("|lambda|/2pi, Im lambda/2pi, or without damping", ("natural", "damped", UNDAMPED)),
                       "natural")  # fmt: skip

    def contradictions(self) -> list[Fault]:
        if self.which == UNDAMPED and self.order not in (None, ASCENDING):
            return [Fault("undamped natural frequencies are counted by size: order is ascending", ("order",))]
        return []

    def unfit(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        if self.which != UNDAMPED:
            yield from super().unfit(model, quantities)
        else:
            try:
                undamped_place(model, self.mode)
            except UsageError as error:
                yield Fault(str(error), ("mode",))

    @property
    def asked(self) -> str:
        if self.which == UNDAMPED:
            return f"undamped natural frequency number {self.mode}"
        return f"{WORDS[self.which]} of {self.which_mode}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm("Hz")

    def evaluate(self, block: VariantBlock) -> FloatArray:
        if self.which == UNDAMPED:
            return self.undamped(block)
        found = self.eigenvalue(block)
        size = np.abs(found) if self.which == "natural" else found.imag
        return np.asarray(size[:, None] / (2 * np.pi))

    def undamped(self, block: VariantBlock) -> FloatArray:
        """Of the place of the nominal mode among those above 0."""
        place, _ = undamped_place(block.model, self.mode)
        return nth_above_zero(block.every_mode.undamped_natural_frequencies, place + 1)


def nth_above_zero(sizes: FloatArray, number: int) -> FloatArray:
    """The n-th (n, 1) by size of values (n, n_values) above 0 in every row, NaN where there are fewer."""
    rising = np.sort(np.where(sizes > 0, sizes, np.inf), axis=1)
    if rising.shape[1] < number:
        return np.full((len(sizes), 1), np.nan)
    chosen = rising[:, number - 1 : number]
    return np.where(np.isfinite(chosen), chosen, np.nan)
