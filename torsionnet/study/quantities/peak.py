"""The largest magnitude of a transfer function in a band."""

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
class PeakMagnitude(PeakQuantity):
    """Largest magnitude of a transfer function in a band, at a peak or at an end of the band.

    It is found between the points of a grid, to 1e-9 of itself; peaks less than 1 % apart may count as one. Infinite
    where nothing damps.

    Examples
    --------
    >>> import numpy as np
    >>> import torsionnet as tn
    >>> J, k, c = 2.0, 8e4, 40.0
    >>> crank = tn.Drivetrain("crank", [tn.Inertia("mass", node="a", inertia=J),
    ...     tn.Spring("shaft", nodes=("a", "ground"), stiffness=k, damping="c")], parameters={"c": c})
    >>> block = VariantBlock(crank, {"c": np.array([c])}, {}, None)
    >>> top = PeakMagnitude(output="a", input="a", band="1..100 Hz").evaluate(block)
    >>> zeta = c / (2 * (k * J) ** 0.5)
    >>> bool(abs(top[0, 0] * k * 2 * zeta * (1 - zeta**2) ** 0.5 - 1) < 1e-12)
    True
    """

    kind: ClassVar[str] = "peak"

    @property
    def asked(self) -> str:
        return f"largest magnitude of {self.quotient} {self.where}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(self.unit(model))

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return self.peaks(block).magnitude[:, None]
