"""Task of a cluster's worker, which calculates some chunks of a study, one after the other."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from torsionnet.base.threads import one_thread
from torsionnet.study.run.cluster.cluster_losses import ClusterError

if TYPE_CHECKING:
    from distributed import Client

PACKAGES = ("torsionnet", "numpy", "scipy", "numba")
"""Packages of a worker whose version may change a number, as without numba another solver is used."""

MOST_LISTED_FAULTS = 10
"""Most faults of workers that a message lists, as of a thousand workers with the same fault a few suffice."""

Versions = Mapping[str, str]


def check_versions(client: Client) -> Versions:
    """Versions of Python and packages in this process, after all workers were found to have the same.

    ClusterError where one has others.
    """
    found = client.get_versions(packages=list(PACKAGES))
    needed = _of_process(found["client"])
    workers = {address: _of_process(reported) for address, reported in found["workers"].items()}
    faults = [line for address, has in workers.items() for line in differences(address, has, needed)]
    machines = {has["machine"]: address for address, has in workers.items()}
    if len(machines) > 1:
        reported = ", ".join(f"{address} is {machine}" for machine, address in machines.items())
        faults.append(f"workers are of different kinds of machines, whose last digits differ: {reported}")
    refuse_faults(faults, "Install the same on all workers, start them anew and run the study again")
    return needed


def own_versions() -> Versions:
    """Versions of Python and of the packages in this process, by name."""
    from distributed.versions import get_versions

    return _of_process(get_versions(packages=PACKAGES))


def differences(worker: str, has: Versions, needed: Versions) -> Iterator[str]:
    """Yield sentences on the versions in which a worker differs from those needed.

    >>> list(differences("tcp://n7:9", {"numpy": "2.1"}, {"numpy": "2.2"}))
    ['worker tcp://n7:9 has numpy 2.1, this process has numpy 2.2']
    """
    for name in ("Python", *PACKAGES):
        if has.get(name) != needed.get(name):
            theirs, ours = (f"{name} {side[name]}" if side.get(name) else f"no {name}" for side in (has, needed))
            yield f"worker {worker} has {theirs}, this process has {ours}"


def refuse_faults(faults: list[str], remedy: str) -> None:
    """Raise ClusterError with the faults of workers and the remedy, if there is a fault."""
    if faults:
        shown = "\n".join(faults[:MOST_LISTED_FAULTS])
        if len(faults) > MOST_LISTED_FAULTS:
            shown += f"\n... and {len(faults) - MOST_LISTED_FAULTS} more"
        raise ClusterError(f"{shown}\n{remedy}; what was calculated before is kept.")


def _of_process(reported: Mapping[str, Any]) -> Versions:
    packages, host = reported["packages"], reported["host"]
    python = ".".join(str(host["python"]).split(".")[:2])
    return {"Python": python, "machine": str(host["machine"]), **{name: packages[name] or "" for name in PACKAGES}}


S = TypeVar("S")
T = TypeVar("T")

_works: dict[str, Callable[[Any], Any]] = {}


@dataclass(frozen=True)
class DoneChunk(Generic[T]):
    """Report of a worker on a chunk of variants that is done; the values of the chunk are in the shared folder.

    Attributes
    ----------
    result : object
        Return value of the work, small.
    seconds : float
        Wall-clock time.
    """

    result: T
    seconds: float


def done_chunks(work: Callable[[S], T], name: str, parts: Sequence[S], needed: Versions) -> list[DoneChunk[T]]:
    """Reports on some chunks of variants, calculated in this worker, which must have the versions ``needed``.

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
    """Refuse versions other than those needed in this worker, which may have joined while the study runs."""
    has = own_versions()
    faults = list(differences(f"process {os.getpid()} of {platform.node()}", has, dict(needed)))
    refuse_faults(faults, "Install the same on all workers, start them anew and run the study again")
