"""Calculation of one chunk of a study's variants, and merging of all chunks into its result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.reductions.summaries import KeptValues, Summary
from torsionnet.study.run.chunk_values import Chunk, Chunks, ChunkValues, JoinedValues, counted_limits
from torsionnet.study.space.space import Space
from torsionnet.study.study import Study
from torsionnet.study.study_result import StudyResult

if TYPE_CHECKING:
    from torsionnet.study.reductions.limit_counts import LimitTotals

BLOCK_SIZE = 500
"""Number of variants of a chunk solved together, since larger blocks take more memory, but change no value."""


@dataclass(frozen=True, eq=False)
class ChunkWork:
    """Function that calculates a chunk of variants by its number and keeps it in a folder.

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

    def __call__(self, number: int) -> ChunkValues | None:
        """Calculate a chunk of variants and return its values; None where they were written to the folder."""
        found = self.calculated(self.chunks[number])
        if self.folder is None:
            return found
        from torsionnet.study.run.chunk_files import write_chunk

        write_chunk(self.folder, number, found)
        return None

    def calculated(self, chunk: Chunk) -> ChunkValues:
        """Values and statistics in SI of all quantities of the variants of a chunk."""
        if chunk.case not in self._cases:
            evaluator = self.study.evaluator(self.study.configurations[chunk.case])
            self._cases[chunk.case] = evaluator, self.study.space.at(evaluator.model)
        evaluator, space = self._cases[chunk.case]
        values = space.values(chunk.start, chunk.stop)
        limits, parts = counted_limits(self.study, self.every), JoinedValues()
        for start in range(0, len(chunk), BLOCK_SIZE):
            block = evaluator.block({name: column[start : start + BLOCK_SIZE] for name, column in values.items()})
            parts.add(ChunkValues.of(block, chunk.start + start, self.every, limits))
        whole = parts.whole()
        return replace(whole, remarks=dict(sorted(whole.remarks.items())))


def merge_chunks(
    study: Study, chunks: Chunks, chunk: Callable[[int], ChunkValues], every: int = 1, folder: Path | None = None
) -> StudyResult:
    """Merge all chunks of a study's variants into its result.

    Chunks are merged in the order of their numbers, whatever the order in which they were done.
    """
    names = study.configurations
    parts = {name: JoinedValues(sharing=len(names)) for name in names}
    totals = _totals(study) if every > 1 else None
    for numbers in chunks.side_by_side():
        flags = {}
        for name, number in zip(names, numbers, strict=True):
            found = chunk(number)
            parts[name].add(replace(found, beyond=None))
            if found.beyond is not None:
                flags[name] = found.beyond
        if totals is not None and flags:
            totals.add(flags)
    cases = {name: one.whole() for name, one in parts.items()}
    summaries = {
        (name, quantity): Summary(
            one.measured(study.model_in(name), study.quantities), whole.moments[quantity], whole.histograms[quantity]
        )
        for name, whole in cases.items()
        for quantity, one in study.quantities.items()
    }
    return StudyResult(
        study,
        summaries,
        KeptValues(every, {(name, key): kept for name, one in cases.items() for key, kept in one.kept.items()}),
        {name: one.impossible for name, one in cases.items()},
        {name: dict(one.remarks) for name, one in cases.items()},
        folder,
        totals,
        {name: one.read for name, one in cases.items()},
    )


def _totals(study: Study) -> LimitTotals:
    from torsionnet.study.reductions.limit_counts import LimitCounts, LimitTotals

    return LimitTotals(counted_limits(study, 2), {name: LimitCounts() for name in study.configurations}, LimitCounts())
