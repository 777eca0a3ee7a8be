"""Band mean, a quantity of a study, the mean magnitude of a transfer function over a frequency band."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Band
from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityForm, register_quantity
from torsionnet.study.quantities.transfer_quantity import TransferQuantity
from torsionnet.study.quantities.variant_block import VariantBlock


@register_quantity
@dataclass(frozen=True, kw_only=True)
class BandMean(TransferQuantity):
    """Mean or root mean square of a transfer function's magnitude at evenly spaced frequencies of a band."""

    kind: ClassVar[str] = "band_mean"

    band: tuple[float, float] = entry(Band("the frequencies", from_zero=True))
    points: int = entry(Count("evenly spaced, both ends among them", lower=2, upper=100_000), 200)
    mean: str = entry(OneOf("root mean square, or mean of the magnitudes", ("rms", "arithmetic")), "rms")

    @property
    def words(self) -> str:
        what = "mean" if self.mean == "arithmetic" else "root mean square"
        return f"{what} of the magnitude of {self.quotient} from {self.band[0]:g} to {self.band[1]:g} Hz"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(self.unit(model))

    def evaluate(self, block: VariantBlock) -> FloatArray:
        low, high = self.band
        frequencies = np.linspace(low, high, self.points)
        found = np.empty((len(block), 1))
        for which, part in block.parts(self.points):
            sizes = np.abs(self.values(part, frequencies))
            found[which, 0] = sizes.mean(axis=1) if self.mean == "arithmetic" else np.sqrt((sizes**2).mean(axis=1))
        return found
