"""What a worker of a cluster does: some chunks of a study, one after the other."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from torsionnet.core.threads import one_thread
from torsionnet.study.run.cluster.cluster_losses import ClusterError

if TYPE_CHECKING:
    from distributed import Client

PACKAGES = ("torsionnet", "numpy", "scipy", "numba")
"""Whose version may change a number; without numba another solver is used."""

NAMED = 10
"""Faults that are told one by one."""

Versions = Mapping[str, str]


def check_versions(client: Client) -> Versions:
    """The versions of this process, which every worker there is must have."""
    found = client.get_versions(packages=list(PACKAGES))
    needed = _of_process(found["client"])
    workers = {address: _of_process(told) for address, told in found["workers"].items()}
    faults = [line for address, has in workers.items() for line in differences(address, has, needed)]
    machines = {has["machine"]: address for address, has in workers.items()}
    if len(machines) > 1:
        told = ", ".join(f"{address} is {machine}" for machine, address in machines.items())
        faults.append(f"workers are of different kinds of machines, whose last digits differ: {told}")
    refuse_faults(faults, "Install the same on all workers, start them anew and run the study again")
    return needed


def own_versions() -> Versions:
    """Of this process."""
    from distributed.versions import get_versions

    return _of_process(get_versions(packages=PACKAGES))


def differences(worker: str, has: Versions, needed: Versions) -> Iterator[str]:
    """What another version of Python or of a package is, in words.

    >>> list(differences("tcp://n7:9", {"numpy": "2.1"}, {"numpy": "2.2"}))
    ['worker tcp://n7:9 has numpy 2.1, this process has numpy 2.2']
    """
    for name in ("Python", *PACKAGES):
        if has.get(name) != needed.get(name):
            theirs, ours = (f"{name} {side[name]}" if side.get(name) else f"no {name}" for side in (has, needed))
            yield f"worker {worker} has {theirs}, this process has {ours}"


def refuse_faults(faults: list[str], remedy: str) -> None:
    """Name what is wrong with workers, if anything is; of a thousand of them not all are named."""
    if faults:
        shown = "\n".join(faults[:NAMED]) + (f"\n... and {len(faults) - NAMED} more" if len(faults) > NAMED else "")
        raise ClusterError(f"{shown}\n{remedy}; what was calculated before is kept.")


def _of_process(told: Mapping[str, Any]) -> Versions:
    packages, host = told["packages"], told["host"]
    python = ".".join(str(host["python"]).split(".")[:2])
    return {"Python": python, "machine": str(host["machine"]), **{name: packages[name] or "" for name in PACKAGES}}


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
