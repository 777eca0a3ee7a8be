"""Merging of all chunks of a study's variants into its result."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.counted_remarks import remark
from torsionnet.study.reductions.histogram import GrowingHistogram
from torsionnet.study.reductions.kept_values import KeptValues
from torsionnet.study.reductions.limit_counts import LimitBits, LimitCounts, LimitTotals
from torsionnet.study.reductions.moments import Moments
from torsionnet.study.reductions.quantity_summary import Summary
from torsionnet.study.run.chunk_values import ChunkValues, widest
from torsionnet.study.run.chunks import Chunks, counted_limits
from torsionnet.study.study import Study
from torsionnet.study.study_result import StudyResult


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
