"""A chunk as it grows, block by block of variants that are solved together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.reductions.counted_remarks import remark
from torsionnet.study.reductions.kept_values import extremes, kept_indices
from torsionnet.study.quantities.quantity_limit import QuantityLimit
from torsionnet.study.reductions.histogram import GrowingHistogram, Histogram
from torsionnet.study.reductions.limit_counts import LimitBits
from torsionnet.study.reductions.moments import Moments
from torsionnet.study.run.chunk_values import ChunkValues
from torsionnet.study.quantities.variant_block import VariantBlock


@dataclass
class JoinedBlocks:
    """Blocks of variants in their order, put together.

    Attributes
    ----------
    every : int
        Of every so many variants the values are kept; of all where it is 1, and then parameters are not.
    limits : mapping
        By quantity; variants beyond them are counted.
    """

    every: int
    limits: Mapping[str, QuantityLimit]
    numbers: dict[str, list[FloatArray]] = field(default_factory=dict)
    extremes: dict[str, list[FloatArray]] = field(default_factory=dict)
    parameters: dict[str, list[FloatArray]] = field(default_factory=dict)
    moments: dict[str, Moments] = field(default_factory=dict)
    histograms: dict[str, GrowingHistogram] = field(default_factory=dict)
    beyond: dict[str, list[NDArray[np.bool_]]] = field(default_factory=dict)
    missing: Counter[str] = field(default_factory=Counter)
    impossible: int = 0
    remarks: Counter[str] = field(default_factory=Counter)

    def add(self, start: int, block: VariantBlock, names: tuple[str, ...]) -> None:
        """The next variants, of which the first is number ``start``."""
        self.impossible += int(block.impossible.sum())
        chosen = kept_indices(start, start + len(block), self.every)
        for name in names:
            found = block.of(name)
            own = Moments.of(found, start)
            self.moments[name] = self.moments[name].joined(own) if name in self.moments else own
            self.histograms.setdefault(name, GrowingHistogram()).add(Histogram.of(found))
            if found.shape[1] == 1:
                self.numbers.setdefault(name, []).append(found[chosen, 0])
            else:
                self.extremes.setdefault(name, []).append(extremes(found[chosen]))
            if name in self.limits:
                self.beyond.setdefault(name, []).append(self.limits[name].beyond(found))
                self.missing[name] += int(np.isnan(found).any(axis=1).sum())
        if self.every > 1:
            for name, column in block.values.items():
                self.parameters.setdefault(name, []).append(column[chosen])
        for text, count in block.remarks.items():
            remark(self.remarks, text, count)

    def whole(self) -> ChunkValues:
        """All of them."""
        return ChunkValues(
            _joined(self.numbers),
            self.moments,
            {name: parts.whole() for name, parts in self.histograms.items()},
            self.impossible,
            self.remarks,
            _joined(self.extremes),
            _joined(self.parameters),
            self._bits() if self.limits else None,
        )

    def _bits(self) -> LimitBits:
        beyond = np.stack([np.concatenate(self.beyond[name]) for name in self.limits])
        return LimitBits.of(beyond, np.array([self.missing[name] for name in self.limits], dtype=np.int64))


def _joined(parts: Mapping[str, list[FloatArray]]) -> dict[str, FloatArray]:
    return {name: np.concatenate(each) for name, each in parts.items()}
