"""Damping ratios of modes that are followed from variant to variant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.drivetrain import Drivetrain
from torsionnet.study.quantities.mode_quantity import ModeQuantity
from torsionnet.study.quantities.quantity import QuantityForm, register_quantity
from torsionnet.study.quantities.variant_block import VariantBlock


@register_quantity
@dataclass(frozen=True, kw_only=True)
class DampingRatio(ModeQuantity):
    """``-Re lambda/|lambda|`` of a vibration mode."""

    kind: ClassVar[str] = "damping_ratio"

    @property
    def asked(self) -> str:
        return f"damping ratio of {self.which_mode}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm()

    def evaluate(self, block: VariantBlock) -> FloatArray:
        found = self.eigenvalue(block)
        return np.asarray((-found.real / np.abs(found))[:, None])
