"""Calculation of all variants of a study by an executor, resumed from the chunks in its folder."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import chain
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.study.quantities.evaluator import Evaluator, Values
from torsionnet.study.reductions.limit_counts import MOST_LIMITS
from torsionnet.study.reductions.summaries import KeptValues, Summary
from torsionnet.study.run.chunk_values import Chunk, Chunks, ChunkValues, JoinedValues, counted_limits, kept_every
from torsionnet.study.space.space import Space
from torsionnet.study.study import Study
from torsionnet.study.study_result import StudyResult

if TYPE_CHECKING:
    from torsionnet.study.reductions.limit_counts import LimitTotals
    from torsionnet.study.run.study_folder import StudyFolder


# Protocol of executors, which call a function for the chunks of a study or the blocks of its answers.

S = TypeVar("S")
T = TypeVar("T")


class Executor(Protocol):
    """Executor that calls a function for every part of a study, the number of a chunk, or a block of variants."""

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Yield each part of a study with its result, in the order in which they are done.

        Function and parts can be pickled.
        """
        ...


class SerialExecutor:
    """Executor that does one part of a study after the other in this process.

    Examples
    --------
    >>> list(SerialExecutor().map(abs, [-1, 2]))
    [(-1, 1), (2, 2)]
    """

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Yield each part of a study with its result, in the order of the parts."""
        for part in parts:
            yield part, work(part)


def part_name(part: object) -> str:
    """Words for a part of a study in messages.

    >>> part_name(7)
    'chunk 7'
    """
    return f"chunk {part}" if isinstance(part, int) else str(part)


# Calculation of all variants of a study, resumed from the chunks in its folder.

# Calculation of one chunk of a study's variants, and merging of all chunks into its result.

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
        values = self.calculated(self.chunks[number])
        if self.folder is None:
            return values
        from torsionnet.study.run.chunk_values import write_chunk

        write_chunk(self.folder, number, values)
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
            # One chunk at a time in memory: moments and histograms add up, and flags of the same draws are joined.
            values = chunk(number)
            parts[name].add(replace(values, beyond=None))
            if values.beyond is not None:
                flags[name] = values.beyond
        if totals is not None and flags:
            totals.add(flags)
    cases = {name: joined.whole() for name, joined in parts.items()}
    summaries = {
        (name, quantity): Summary(
            asked.measured(study.model_in(name), study.quantities), whole.moments[quantity], whole.histograms[quantity]
        )
        for name, whole in cases.items()
        for quantity, asked in study.quantities.items()
    }
    return StudyResult(
        study,
        summaries,
        KeptValues(every, {(name, key): kept for name, case in cases.items() for key, kept in case.kept.items()}),
        {name: case.impossible for name, case in cases.items()},
        {name: dict(case.remarks) for name, case in cases.items()},
        folder,
        totals,
        {name: case.read for name, case in cases.items()},
    )


def _totals(study: Study) -> LimitTotals:
    from torsionnet.study.reductions.limit_counts import LimitCounts, LimitTotals

    return LimitTotals(counted_limits(study, 2), {name: LimitCounts() for name in study.configurations}, LimitCounts())


# Amount of work of a study, measured on a few variants before it begins.

TIMED_VARIANTS = {False: 64, True: 2}
"""Number of variants that are timed, by whether they are solved one by one, which takes longer."""
CHUNK_POINTS = 4_000_000
"""Points of responses in a chunk of variants solved together, as more take longer between two saved chunks."""
SINGLE_CHUNK_SIZE = 20
"""Variants in a chunk solved one by one, as each may take a second, and all workers are to have some."""
MOST_CHUNK_SIZE = 20_000
"""Most variants in a chunk, so that little is lost when a run is stopped."""
MOST_FILES = 100_000
"""Number of chunks of a study, about, beyond which chunks become larger, as folders of more files are slow."""


TIMED_AGAIN = 5.0
"""Seconds of a study, by a first timing in which plans are made and compiled code is loaded, for a second timing."""


@dataclass(frozen=True)
class Workload:
    """Amount of work of a study, its number of variants, seconds for each on one core, and size of chunks."""

    count: int
    seconds: float
    chunk_size: int
    singly: bool

    @classmethod
    def of(cls, study: Study) -> Workload:
        """Measure the amount of work of a study on some of its variants.

        The size of chunks follows from the study alone, not from the time, which is 0 of very few variants.
        """
        case = study.configurations[0]
        evaluator = study.evaluator(case)
        singly = evaluator.plan is None or any(quantity.singly for quantity in study.quantities.values())
        forms = (quantity.measured(evaluator.model, study.quantities) for quantity in study.quantities.values())
        points = sum(len(form.points) for form in forms)
        size = (
            SINGLE_CHUNK_SIZE if singly else max(LEAST_CHUNK_SIZE, min(MOST_CHUNK_SIZE, CHUNK_POINTS // max(points, 1)))
        )
        size = max(size, ceil(study.count / MOST_FILES))
        size = min(size, study.space.count)
        if study.count <= TIMED_VARIANTS[singly]:  # to time them takes as long as the study
            return cls(study.count, 0.0, size, singly)
        tried = min(TIMED_VARIANTS[singly], study.space.count)
        values = study.space.at(evaluator.model).values(0, tried)
        seconds = _seconds(evaluator, values)
        if seconds / tried * study.count > TIMED_AGAIN:
            seconds = _seconds(evaluator, values)
        return cls(study.count, seconds / tried, size, singly)

    @property
    def total(self) -> float:
        """Time of the whole study in seconds on one core."""
        return self.count * self.seconds

    @property
    def words(self) -> str:
        """Words for the number of variants and the time they take on one core."""
        how = "one by one, " if self.singly else ""
        number = f"{self.count:,}".replace(",", " ")
        return f"{number} variants, {how}about {shown_time(self.total)} on one core"

    def require_shorter_than(self, longest: float) -> None:
        """Refuse a study that takes longer than ``longest`` seconds on one core."""
        if self.total > longest:
            raise UsageError(
                f"the study has {self.count:.4g} variants, about {shown_time(self.total)} on one core; vary fewer "
                "parameters in ranges and lists, draw samples instead (sampling: {method: sobol, count: 10000}), or "
                "let it take that long (--yes; longest= in Python)",
                kind="too-large",
            )


def _seconds(evaluator: Evaluator, values: Values) -> float:
    began = time.perf_counter()
    evaluator(values)
    return time.perf_counter() - began


LEAST_CHUNK_SIZE = 100
"""Fewest variants in a chunk solved together, as with fewer the file of a chunk takes longer than its work."""


def shown_time(seconds: float) -> str:
    """Text of a time in seconds, in a suitable unit.

    >>> shown_time(0.4), shown_time(150), shown_time(4e7)
    ('1 s', '2.5 min', '4.6e+02 days')
    """
    for size, name in ((31557600.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {name}" if seconds < 1e4 * size else f"{seconds / size:.0e} {name}"
    return f"{max(1, ceil(seconds))} s"


SAMPLING = "sampling: {count: 1000}"
"""Example of the ``sampling`` entry that a study without variants needs."""


def no_variants(space: Space) -> str:
    """Message for a study without variants, with the entries that it needs.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.space.variations.normal import Normal
    >>> from torsionnet.study.space.variations.uniform import ListOfValues
    >>> rig, drawn = tn.load("amt_rig"), {"k_2": Normal(deviation="5 %")}
    >>> no_variants(Space(rig, drawn))
    'the study has no variants of its own: give sampling: {count: 1000}, or lists or ranges of values'
    >>> no_variants(Space(rig, {**drawn, "c_O": ListOfValues(values=[170, 360])}))
    'k_2 has a distribution and is not drawn: give sampling: {count: 1000}, or a list or range of values like c_O'
    """
    if not space.grid:
        return f"the study has no variants of its own: give {SAMPLING}, or lists or ranges of values"
    drawn = space.random_names
    has = "has a distribution and is" if len(drawn) == 1 else "have distributions and are"
    like = "a list or range" if len(drawn) == 1 else "lists or ranges"
    return f"{', '.join(drawn)} {has} not drawn: give {SAMPLING}, or {like} of values like {', '.join(space.grid)}"


LONGEST_SECONDS = 7 * 86400.0
"""Longest calculation in seconds on one core unless more is asked for, as a longer one is mostly a wrong range."""

Progress = Callable[[int, int], None]
"""Callback with the number of chunks of variants done and that of all chunks."""


def run_study(
    study: Study,
    folder: str | os.PathLike[str] | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress = lambda _done, _all: None,
    announce: Callable[[Workload], None] = lambda _: None,
    longest: float = LONGEST_SECONDS,
) -> StudyResult:
    """Calculate all variants of a study that are not in the folder yet.

    The result is the same, to the last bit, whoever calculates and however often it was broken off.

    Parameters
    ----------
    study : Study
    folder : path, optional
        Folder that keeps chunks as soon as they are done; without one, they are in memory.
    executor : Executor, optional
        Calls the calculation for every chunk; default: in this process.
    progress : callable, optional
        Called with the number of chunks done and that of all.
    announce : callable, optional
        Called with the amount of work, measured before the calculation begins.
    longest : float
        Most seconds of calculation on one core.

    Raises
    ------
    UsageError
        No variants, more than can be calculated in that time, or a folder that holds something else.
    SolveError
        The folder cannot be written any more; what is in it stays valid.
    """
    if not study.count:
        raise UsageError(no_variants(study.space), kind="nothing-varies")
    workload = Workload.of(study)
    workload.require_shorter_than(longest)
    announce(workload)
    every = kept_every(study)
    if every > 1 and len(study.limits) > MOST_LIMITS:
        raise UsageError(
            f"a study of so many variants has at most {MOST_LIMITS} limits, not {len(study.limits)}", kind="too-large"
        )
    chunks = Chunks(len(study.configurations), study.space.count, workload.chunk_size)
    executor = executor or SerialExecutor()
    if folder is None:
        return _in_memory(ChunkWork(study, chunks, every, None), executor, progress)
    place = Path(folder).resolve()
    return _in_folder(ChunkWork(study, chunks, every, place), place, executor, progress)


def _in_folder(work: ChunkWork, path: Path, executor: Executor, progress: Progress) -> StudyResult:
    """Result of a study of which only those chunks are calculated that are not in its folder."""
    from torsionnet.study.run.study_folder import StudyFolder, locked, study_record, telling_write_errors

    place, total = StudyFolder(path), work.chunks.total
    with telling_write_errors(path):
        place.open(study_record(work.study, work.chunks, work.every))
    with telling_write_errors(path), locked(path):
        place.remove_temporary_files()
        done = {number for number in place.chunk_numbers(total) if place.chunk(number) is not None}
        left = (number for number in range(total) if number not in done)
        progress(len(done), total)
        for count, _ in enumerate(executor.map(work, left), start=len(done) + 1):
            progress(count, total)
        return merge_chunks(work.study, work.chunks, _stored(place, work), work.every, path)


def _stored(place: StudyFolder, work: ChunkWork) -> Callable[[int], ChunkValues]:
    """Function that reads a chunk of variants from the folder, and calculates one again that was damaged."""

    def chunk(number: int) -> ChunkValues:
        values = place.chunk(number)
        if values is None:
            work(number)
            values = place.chunk(number)
        if values is None:
            raise SolveError(
                f"chunk {number} in {place.path} cannot be read back after it was written; "
                "check the disk, or choose another folder, and run it again",
                kind="unreadable-file",
            )
        return values

    return chunk


def _in_memory(work: ChunkWork, executor: Executor, progress: Progress) -> StudyResult:
    """Result of a study that is calculated without a folder.

    Only chunks done before their turn are held, as all would not fit.
    """
    waiting: dict[int, ChunkValues] = {}
    done = enumerate(executor.map(work, chain.from_iterable(work.chunks.side_by_side())), start=1)

    def chunk(number: int) -> ChunkValues:
        while number not in waiting:
            count, (other, values) = next(done)
            if values is not None:
                waiting[other] = values
            progress(count, work.chunks.total)
        return waiting.pop(number)

    return merge_chunks(work.study, work.chunks, chunk, work.every)
