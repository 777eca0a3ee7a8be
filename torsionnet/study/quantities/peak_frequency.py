"""Where a transfer function is largest in a band."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.assembly.rows import FloatArray
from torsionnet.drivetrain import Drivetrain
from torsionnet.study.quantities.peak_quantity import PeakQuantity
from torsionnet.study.quantities.quantity import QuantityForm, register_quantity
from torsionnet.study.quantities.variant_block import VariantBlock


@register_quantity
@dataclass(frozen=True, kw_only=True)
class PeakFrequency(PeakQuantity):
    """Frequency of the largest magnitude of a transfer function in a band."""

    kind: ClassVar[str] = "peak_frequency"

    @property
    def asked(self) -> str:
        return f"frequency of the largest magnitude of {self.quotient} {self.where}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm("Hz")

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return self.peaks(block).frequency[:, None]
