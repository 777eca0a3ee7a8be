"""Peak and peak frequency, two quantities of a study, the largest magnitude of a transfer function in a band."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Band
from torsionnet.base.entries.spec import entry
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.peak_search import CANDIDATES, POINTS, BandPeaks, band_grid, largest
from torsionnet.study.quantities.quantity import QuantityForm, register_quantity
from torsionnet.study.quantities.transfer_quantity import TransferQuantity
from torsionnet.study.quantities.variant_block import VariantBlock


@dataclass(frozen=True, kw_only=True)
class PeakQuantity(TransferQuantity):
    """Base class of the quantities of the largest magnitude of a transfer function in a band."""

    kind: ClassVar[str] = "peak in a band"

    band: tuple[float, float] = entry(Band("where it is looked for"))

    @property
    def range_words(self) -> str:
        """Words for the band, such as "from 1 to 50 Hz"."""
        return f"from {self.band[0]:g} to {self.band[1]:g} Hz"

    def peaks(self, block: VariantBlock) -> BandPeaks:
        """Largest magnitude (n,) of every variant in SI and its frequency (n,) in Hz."""
        return block.once(("peaks", self.output, self.input, self.excitation, self.band), lambda: self._searched(block))

    def _searched(self, block: VariantBlock) -> BandPeaks:
        grid = band_grid(*self.band)
        found = BandPeaks(np.empty(len(block)), np.empty(len(block)))
        for which, part in block.parts(max(len(grid), CANDIDATES * POINTS)):
            found.magnitude[which], found.frequency[which] = largest(partial(self._magnitude, part), grid)
        return found

    def _magnitude(self, block: VariantBlock, frequencies: FloatArray) -> FloatArray:
        return np.abs(self.values(block, frequencies))


@register_quantity
@dataclass(frozen=True, kw_only=True)
class PeakMagnitude(PeakQuantity):
    """Largest magnitude in SI of a transfer function in a band, at a peak or at an end of the band.

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
    def words(self) -> str:
        return f"largest magnitude of {self.quotient} {self.range_words}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(self.unit(model))

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return self.peaks(block).magnitude[:, None]


@register_quantity
@dataclass(frozen=True, kw_only=True)
class PeakFrequency(PeakQuantity):
    """Frequency in Hz of the largest magnitude of a transfer function in a band."""

    kind: ClassVar[str] = "peak_frequency"

    @property
    def words(self) -> str:
        return f"frequency of the largest magnitude of {self.quotient} {self.range_words}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm("Hz")

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return self.peaks(block).frequency[:, None]
