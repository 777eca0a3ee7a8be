"""What a worker of a cluster does: some chunks of a study, one after the other."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from typing import Any, Generic, TypeVar

from torsionnet.core.threads import one_thread
from torsionnet.study.cluster.worker_versions import Versions, differences, own_versions, refuse_faults

S = TypeVar("S")
T = TypeVar("T")

_works: dict[str, Callable[[Any], Any]] = {}


@dataclass(frozen=True)
class DoneChunk(Generic[T]):
    """What comes back to the client; the values of the chunk lie in the shared folder.

    Attributes
    ----------
    result : object
        What the work told of it, small.
    seconds : float
        Wall clock.
    """

    result: T
    seconds: float


def done_chunks(work: Callable[[S], T], name: str, parts: Sequence[S], needed: Versions) -> list[DoneChunk[T]]:
    """Calculate these parts in this process, which must have the versions ``needed``.

    Work of the same ``name`` is the same: what a process prepares for the first task serves for those after it.
    """
    _check(tuple(sorted(needed.items())))
    work = _remembered(name, work)
    done: list[DoneChunk[T]] = []
    with one_thread():
        for part in parts:
            began = perf_counter()
            result = work(part)
            done.append(DoneChunk(result, perf_counter() - began))
    return done


def _remembered(name: str, work: Callable[[S], T]) -> Callable[[S], T]:
    if name not in _works:
        _works.clear()
    return _works.setdefault(name, work)


@cache
def _check(needed: tuple[tuple[str, str], ...]) -> None:
    """Workers may join while a study runs, after all others were looked at."""
    has = own_versions()
    faults = list(differences(f"process {os.getpid()} of {platform.node()}", has, dict(needed)))
    refuse_faults(faults, "Install the same on all workers, start them anew and run the study again")
