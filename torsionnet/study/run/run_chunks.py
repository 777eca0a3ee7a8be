"""Calculation of all variants of a study, resumed from the chunks in its folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from itertools import chain
from pathlib import Path

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.study.reductions.limit_counts import MOST_LIMITS
from torsionnet.study.run.calculating import ChunkWork
from torsionnet.study.run.chunk_values import ChunkValues
from torsionnet.study.run.chunks import Chunks, kept_every
from torsionnet.study.run.executor import Executor, SerialExecutor
from torsionnet.study.run.folder_lock import locked
from torsionnet.study.run.reducing import merge_chunks
from torsionnet.study.run.study_folder import StudyFolder, writing
from torsionnet.study.run.study_record import study_record
from torsionnet.study.run.workload import Workload
from torsionnet.study.space.space import Space
from torsionnet.study.study import Study
from torsionnet.study.study_result import StudyResult

SAMPLING = "sampling: {count: 1000}"
"""Example of the ``sampling`` entry that a study without variants needs."""


def no_variants(space: Space) -> str:
    """Message for a study without variants, with the entries that it needs.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.space.variations.normal import Normal
    >>> from torsionnet.study.space.variations.list_of_values import ListOfValues
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
        raise UsageError(no_variants(study.space))
    workload = Workload.of(study)
    workload.require_shorter_than(longest)
    announce(workload)
    every = kept_every(study)
    if every > 1 and len(study.limits) > MOST_LIMITS:
        raise UsageError(f"a study of so many variants has at most {MOST_LIMITS} limits, not {len(study.limits)}")
    chunks = Chunks(len(study.configurations), study.space.count, workload.chunk_size)
    if folder is None:
        work = ChunkWork(study, chunks, every, None)
        return _in_memory(study, work, executor or SerialExecutor(), progress)
    place = StudyFolder(Path(folder).resolve())
    with writing(place.path):
        place.open(study_record(study, chunks, every))
    work = ChunkWork(study, chunks, every, place.path)
    with writing(place.path), locked(place.path):
        place.remove_temporary_files()
        done = {number for number in place.chunk_numbers(chunks.total) if place.chunk(number) is not None}
        left = (number for number in range(chunks.total) if number not in done)
        progress(len(done), chunks.total)
        count = len(done)
        for _ in (executor or SerialExecutor()).map(work, left):
            count += 1
            progress(count, chunks.total)
        return merge_chunks(study, chunks, _stored(place, work), every, place.path)


def _stored(place: StudyFolder, work: ChunkWork) -> Callable[[int], ChunkValues]:
    """Function that reads a chunk of variants from the folder, and calculates one again that was damaged."""

    def chunk(number: int) -> ChunkValues:
        found = place.chunk(number)
        if found is None:
            work(number)
            found = place.chunk(number)
        if found is None:
            raise SolveError(
                f"chunk {number} in {place.path} cannot be read back after it was written; "
                "check the disk, or choose another folder, and run it again"
            )
        return found

    return chunk


def _in_memory(study: Study, work: ChunkWork, executor: Executor, progress: Progress) -> StudyResult:
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

    return merge_chunks(study, work.chunks, chunk, work.every)
