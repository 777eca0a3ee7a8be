"""All chunks of a study put together in their order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.counted_remarks import remark
from torsionnet.study.quantity_summary import Summary
from torsionnet.study.reductions.histogram import GrowingHistogram
from torsionnet.study.reductions.moments import Moments
from torsionnet.study.run.chunk_values import ChunkValues
from torsionnet.study.run.chunks import Chunks
from torsionnet.study.study import Study
from torsionnet.study.study_result import StudyResult


def reduced(
    study: Study, chunks: Chunks, chunk: Callable[[int], ChunkValues], folder: Path | None = None
) -> StudyResult:
    """All chunks put together in their order, whatever the order in which they were done."""
    summaries: dict[tuple[str, str], Summary] = {}
    kept: dict[tuple[str, str], FloatArray] = {}
    impossible: dict[str, int] = {}
    remarks: dict[str, dict[str, int]] = {}
    for case, name in enumerate(study.configurations):
        whole = _Joined()
        for number in chunks.of_case(case):
            whole.add(chunk(number))
        model = study.model_in(name)
        for quantity, one in study.quantities.items():
            moments, histogram = whole.moments[quantity], whole.histograms[quantity].whole()
            summaries[name, quantity] = Summary(one.measured(model, study.quantities), moments, histogram)
        kept |= {(name, quantity): np.concatenate(parts) for quantity, parts in whole.values.items()}
        impossible[name], remarks[name] = whole.impossible, dict(whole.remarks)
    return StudyResult(study, summaries, kept, impossible, remarks, folder)


@dataclass
class _Joined:
    moments: dict[str, Moments] = field(default_factory=dict)
    histograms: dict[str, GrowingHistogram] = field(default_factory=dict)
    values: dict[str, list[FloatArray]] = field(default_factory=dict)
    impossible: int = 0
    remarks: Counter[str] = field(default_factory=Counter)

    def add(self, chunk: ChunkValues) -> None:
        for name, moments in chunk.moments.items():
            known = name in self.moments
            self.moments[name] = self.moments[name].joined(moments) if known else moments
            self.histograms.setdefault(name, GrowingHistogram()).add(chunk.histograms[name])
        for name, values in chunk.values.items():
            self.values.setdefault(name, []).append(values)
        self.impossible += chunk.impossible
        for text, count in sorted(chunk.remarks.items()):
            remark(self.remarks, text, count)
