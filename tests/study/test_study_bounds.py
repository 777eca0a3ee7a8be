"""What a study holds and leaves behind stays bounded, however many variants it has."""

from collections import Counter
from math import ceil

import numpy as np
import pytest
from support.study_runs import small_chunks, small_study

from torsionnet.study.quantities import quantity as counted_remarks
from torsionnet.study.quantities import quantity as variant_block
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.natural_frequency import NaturalFrequency
from torsionnet.study.reductions import summaries as histogram
from torsionnet.study.reductions.summaries import GrowingHistogram, Histogram
from torsionnet.study.run import chunk_values as reducing
from torsionnet.study.run import run_chunks as workload
from torsionnet.study.run.chunk_values import ChunkValues
from torsionnet.study.run.run_chunks import SerialExecutor, Workload, run_study


@pytest.fixture
def many_chunks(monkeypatch):
    monkeypatch.setattr(workload, "CHUNK_POINTS", workload.CHUNK_POINTS)
    monkeypatch.setattr(workload, "LEAST_CHUNK_SIZE", workload.LEAST_CHUNK_SIZE)
    small_chunks()


@pytest.mark.parametrize("count", [10**7, 10**10, 10**13])
def test_chunks_grow_with_the_count(count, monkeypatch):
    monkeypatch.setattr(Evaluator, "__call__", lambda *_: {})  # how long a variant takes is not asked here
    study = small_study(count)
    size = Workload.of(study).chunk_size
    assert size >= 20_000
    assert 2 * ceil(count / size) <= 100_002


@pytest.mark.slow
def test_histograms_that_wait_are_few(monkeypatch):
    monkeypatch.setattr(histogram, "MOST_WAITING_BINS", 100)
    parts = np.random.default_rng(1).normal(size=(400, 50, 1))
    growing, most = GrowingHistogram(), 0
    for part in parts:
        growing.add(Histogram.of(part))
        most = max(most, sum(len(one.bins) for one in growing.waiting))
    whole = Histogram.of(parts.reshape(-1, 1))
    np.testing.assert_array_equal(growing.whole().bins, whole.bins)
    np.testing.assert_array_equal(growing.whole().counts, whole.counts)
    assert most <= 2 * len(whole.bins) + 100


@pytest.mark.usefixtures("many_chunks")
def test_chunks_in_memory_are_put_together_as_they_come(monkeypatch):
    """At most one of a serial run waits, and chunks that come in reverse give the same."""
    asked, added = [], []
    add = reducing.JoinedValues.add

    class Watched(SerialExecutor):
        def map(self, work, numbers):
            for done in super().map(work, numbers):
                asked.append(len(added))
                yield done

    monkeypatch.setattr(reducing.JoinedValues, "add", lambda self, chunk: (added.append(0), add(self, chunk))[1])
    study = small_study(60)
    found = run_study(study, executor=Watched())
    assert asked == list(range(1, 12, 2))  # the block of a chunk, then the chunk

    class Reversed(SerialExecutor):
        def map(self, work, numbers):
            return super().map(work, reversed(list(numbers)))

    told = []
    other = run_study(study, executor=Reversed(), progress=lambda done, total: told.append((done, total)))
    assert told == [(done, 6) for done in range(1, 7)]
    assert other.to_data() == found.to_data()


def test_remarks_of_many_chunks_are_few():
    def chunk(number):
        return ChunkValues({}, {}, {}, 0, Counter({f"text {number}, {place}": 2 for place in range(40)}))

    joined = reducing.JoinedValues()
    for number in range(100):
        joined.add(chunk(number))
    assert len(joined.remarks) <= counted_remarks.MOST_REMARKS + 1
    assert sum(joined.remarks.values()) == 100 * 40 * 2


def test_modes_of_the_model_are_found_once(monkeypatch):
    """However many blocks and quantities ask which mode is which."""
    given = []
    tracked = variant_block.track_modes
    monkeypatch.setattr(variant_block, "track_modes", lambda *given_: (given.append(given_[1]), tracked(*given_))[1])
    study = small_study(10)
    two = {f"f_{number}": NaturalFrequency(mode=number) for number in (1, 2)}
    evaluator = Evaluator(study.model_in("II"), study.space.names, two)
    for start in (0, 5):
        block = evaluator.block(study.space.at(evaluator.model).values(start, start + 5))
        block.of("f_1"), block.of("f_2")
    assert len(given) == 2
    assert given[0] is given[1] is not None
