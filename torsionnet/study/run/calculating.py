"""Calculation of one chunk of a study's variants."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.atomic import write_bytes
from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.quantity import QuantityLimit
from torsionnet.study.quantities.variant_block import VariantBlock, remark
from torsionnet.study.reductions.limit_counts import LimitBits, LimitCounts, LimitTotals
from torsionnet.study.reductions.summaries import (
    GrowingHistogram,
    Histogram,
    KeptValues,
    Moments,
    Summary,
    extremes,
    kept_indices,
)
from torsionnet.study.run.chunk_values import Chunk, Chunks, ChunkValues, counted_limits, widest
from torsionnet.study.space.space import Space
from torsionnet.study.study import Study
from torsionnet.study.study_result import StudyResult


@dataclass
class JoinedBlocks:
    """Values and statistics of the blocks of variants in a chunk, joined in their order.

    Attributes
    ----------
    every : int
        Every how many-th variant keeps its values; with 1 all do, and parameters are not kept.
    limits : mapping
        Quantity -> limit by which variants are counted.
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
    read: list[FloatArray] = field(default_factory=list)

    def add(self, start: int, block: VariantBlock, names: tuple[str, ...]) -> None:
        """Add the next block of variants, the first of which has the index ``start``."""
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
        self.read.append(block.read)

    def whole(self) -> ChunkValues:
        """Values and statistics of all variants added to the chunk."""
        return ChunkValues(
            _joined(self.numbers),
            self.moments,
            {name: parts.whole() for name, parts in self.histograms.items()},
            self.impossible,
            self.remarks,
            _joined(self.extremes),
            _joined(self.parameters),
            self._bits() if self.limits else None,
            widest(self.read),
        )

    def _bits(self) -> LimitBits:
        beyond = np.stack([np.concatenate(self.beyond[name]) for name in self.limits])
        return LimitBits.of(beyond, np.array([self.missing[name] for name in self.limits], dtype=np.int64))


def _joined(parts: Mapping[str, list[FloatArray]]) -> dict[str, FloatArray]:
    return {name: np.concatenate(each) for name, each in parts.items()}


BLOCK_SIZE = 500
"""Number of variants of a chunk solved together, since larger blocks take more memory, but change no value."""


def chunk_file(folder: Path, number: int) -> Path:
    """Path of the file with the values of one chunk of variants."""
    return folder / "chunks" / f"{number:08d}.npz"


@dataclass(frozen=True, eq=False)
class ChunkWork:
    """Function that calculates a chunk of variants by its number and keeps it in a folder.

    Other processes receive the study alone.

    Attributes
    ----------
    study : Study
    chunks : Chunks
    every : int
        Every how many-th variant keeps its values beside the statistics; 1: all.
    folder : Path or None
        Folder of the study; None: the values themselves are returned.
    """

    study: Study
    chunks: Chunks
    every: int
    folder: Path | None
    _cases: dict[int, tuple[Evaluator, Space]] = field(default_factory=dict)

    def __reduce__(self) -> tuple[Callable[[bytes], ChunkWork], tuple[bytes]]:
        try:
            return _unpacked, (pickle.dumps((self.study, self.chunks, self.every, self.folder)),)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            text = "define functions of quantities at the top level of a module, or run it in one process"
            raise UsageError(f"the study cannot be handed to other processes ({error}); {text}") from None

    def __call__(self, number: int) -> ChunkValues | None:
        """Calculate a chunk of variants and return its values; None where they were written to the folder."""
        found = self.calculated(self.chunks[number])
        if self.folder is None:
            return found
        write_bytes(chunk_file(self.folder, number), found.to_bytes(number))
        return None

    def calculated(self, chunk: Chunk) -> ChunkValues:
        """Values and statistics in SI of all quantities of the variants of a chunk."""
        if chunk.case not in self._cases:
            evaluator = self.study.evaluator(self.study.configurations[chunk.case])
            self._cases[chunk.case] = evaluator, self.study.space.at(evaluator.model)
        evaluator, space = self._cases[chunk.case]
        values = space.values(chunk.start, chunk.stop)
        parts = JoinedBlocks(self.every, counted_limits(self.study, self.every))
        for start in range(0, len(chunk), BLOCK_SIZE):
            block = evaluator.block({name: column[start : start + BLOCK_SIZE] for name, column in values.items()})
            parts.add(chunk.start + start, block, tuple(self.study.quantities))
        return parts.whole()


@lru_cache(maxsize=2)
def _unpacked(packed: bytes) -> ChunkWork:
    """Function that calculates chunks, unpacked in another process and cached so that its plans serve again."""
    return ChunkWork(*pickle.loads(packed))  # noqa: S301  (packed by the process that asks)


# Merging of all chunks of a study's variants into its result.


def merge_chunks(
    study: Study, chunks: Chunks, chunk: Callable[[int], ChunkValues], every: int = 1, folder: Path | None = None
) -> StudyResult:
    """Merge all chunks of a study's variants into its result.

    Chunks are merged in the order of their numbers, whatever the order in which they were done.
    """
    names = study.configurations
    wholes = [_Joined(sharing=len(names)) for _ in names]
    in_any = LimitCounts()
    for numbers in chunks.side_by_side():
        bits = []
        for whole, number in zip(wholes, numbers, strict=True):
            found = chunk(number)
            whole.add(found)
            bits += [] if found.beyond is None else [found.beyond]
        if bits:
            in_any.add(LimitBits.union(bits))
    cases = dict(zip(names, wholes, strict=True))
    return StudyResult(
        study,
        _summaries(study, cases),
        KeptValues(
            every,
            {(name, key): np.concatenate(parts) for name, one in cases.items() for key, parts in one.values.items()},
            {(name, key): np.concatenate(parts) for name, one in cases.items() for key, parts in one.extremes.items()},
            {
                (name, key): np.concatenate(parts)
                for name, one in cases.items()
                for key, parts in one.parameters.items()
            },
        ),
        {name: one.impossible for name, one in cases.items()},
        {name: dict(one.remarks) for name, one in cases.items()},
        folder,
        None if every == 1 else _totals(study, cases, in_any),
        {name: widest(one.read) for name, one in cases.items()},
    )


def _totals(study: Study, cases: Mapping[str, _Joined], in_any: LimitCounts) -> LimitTotals:
    return LimitTotals(counted_limits(study, 2), {name: one.beyond for name, one in cases.items()}, in_any)


def _summaries(study: Study, cases: Mapping[str, _Joined]) -> dict[tuple[str, str], Summary]:
    found = {}
    for name, whole in cases.items():
        model = study.model_in(name)
        for quantity, one in study.quantities.items():
            moments, histogram = whole.moments[quantity], whole.histograms[quantity].whole()
            found[name, quantity] = Summary(one.measured(model, study.quantities), moments, histogram)
    return found


@dataclass
class _Joined:
    sharing: int = 1
    moments: dict[str, Moments] = field(default_factory=dict)
    histograms: dict[str, GrowingHistogram] = field(default_factory=dict)
    values: dict[str, list[FloatArray]] = field(default_factory=dict)
    extremes: dict[str, list[FloatArray]] = field(default_factory=dict)
    parameters: dict[str, list[FloatArray]] = field(default_factory=dict)
    beyond: LimitCounts = field(default_factory=LimitCounts)
    impossible: int = 0
    remarks: Counter[str] = field(default_factory=Counter)
    read: list[FloatArray] = field(default_factory=list)

    def add(self, chunk: ChunkValues) -> None:
        for name, moments in chunk.moments.items():
            known = name in self.moments
            self.moments[name] = self.moments[name].joined(moments) if known else moments
            self.histograms.setdefault(name, GrowingHistogram(sharing=self.sharing)).add(chunk.histograms[name])
        kept = ((self.values, chunk.values), (self.extremes, chunk.extremes), (self.parameters, chunk.parameters))
        for parts, found in kept:
            for name, values in found.items():
                parts.setdefault(name, []).append(values)
        if chunk.beyond is not None:
            self.beyond.add(chunk.beyond)
        self.impossible += chunk.impossible
        for text, count in sorted(chunk.remarks.items()):
            remark(self.remarks, text, count)
        self.read.append(chunk.read)
