"""What quantities of the largest peak in a band have in common."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.band import Band
from torsionnet.core.entries.spec import entry
from torsionnet.study.quantities.peak_search import CANDIDATES, POINTS, FoundPeaks, band_grid, largest
from torsionnet.study.quantities.transfer_quantity import TransferQuantity

if TYPE_CHECKING:
    from torsionnet.study.quantities.variant_block import VariantBlock


@dataclass(frozen=True, kw_only=True)
class PeakQuantity(TransferQuantity):
    """Base of the quantities of the largest magnitude in a band."""

    kind: ClassVar[str] = "peak in a band"

    band: Any = entry(Band("where it is looked for"))

    @property
    def where(self) -> str:
        """The band, in words."""
        return f"from {self.band[0]:g} to {self.band[1]:g} Hz"

    def peaks(self, block: VariantBlock) -> FoundPeaks:
        """Of every variant; searched once for all quantities of this band."""
        return block.once(("peaks", self.output, self.input, self.excitation, self.band), lambda: self._searched(block))

    def _searched(self, block: VariantBlock) -> FoundPeaks:
        grid = band_grid(*self.band)
        found = FoundPeaks(np.empty(len(block)), np.empty(len(block)))
        for which, part in block.parts(max(len(grid), CANDIDATES * POINTS)):
            found.magnitude[which], found.frequency[which] = largest(partial(self._magnitude, part), grid)
        return found

    def _magnitude(self, block: VariantBlock, frequencies: FloatArray) -> FloatArray:
        return np.abs(self.values(block, frequencies))
