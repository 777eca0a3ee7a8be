"""Limits to the unpacked size of a file, and to the memory and processor time of the process that reads it."""

from __future__ import annotations

import contextlib
import signal
import sys
from pathlib import Path

from torsionnet.signals.foreign.content import ForeignFileError

LEAST_UNPACKED, UNPACKED_RATIO = 256_000_000, 100
"""Bytes to which any file may unpack, and the multiple of its own size that it may reach where that is more."""
SPARE_MEMORY, MEMORY_COPIES = 900_000_000, 4
"""Bytes of memory that a library may take besides a file's samples, and copies of the samples that it may hold."""
LEAST_CPU_TIME, BYTES_PER_CPU_SECOND = 1.4, 3e5
"""Processor time in s that reading any file may take, and bytes of a file that allow another second."""
BYTES_PER_SAMPLE = 8
"""Bytes of a sample in memory, where all become double-precision numbers, whatever they are in the file."""


def largest_unpacked(path: Path) -> int:
    """Largest size in bytes that a file may unpack to."""
    return max(LEAST_UNPACKED, UNPACKED_RATIO * path.stat().st_size)


def check(size: float, path: Path, what: str = "the file") -> None:
    """Refuse data that would unpack to more bytes than a file of this size may."""
    if size > largest_unpacked(path):
        raise ForeignFileError(
            f"{what} would take {size / 1e6:.6g} MB when unpacked; "
            f"a file of {path.stat().st_size / 1e3:.4g} kB may take {largest_unpacked(path) / 1e6:.4g} MB"
        )


def confine(path: Path) -> None:
    """Limit the memory and processor time of this process for reading one file, on Linux only."""
    if sys.platform != "linux":
        return
    import resource

    # SIGPROF ends the process; a limit to processor time would count in whole seconds, from the start of it.
    signal.setitimer(signal.ITIMER_PROF, LEAST_CPU_TIME + path.stat().st_size / BYTES_PER_CPU_SECOND)
    with contextlib.suppress(OSError, StopIteration, ValueError):
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        data = next(int(line.split()[1]) for line in lines if line.startswith("VmData:"))
        _lower(
            resource.RLIMIT_DATA, 1024 * data + SPARE_MEMORY + MEMORY_COPIES * (largest_unpacked(path) - LEAST_UNPACKED)
        )
    _lower(resource.RLIMIT_CORE, 0)


def _lower(which: int, limit: int) -> None:
    """Set the soft limit of a resource of this process, so that the next file may have another."""
    import resource

    _, hard = resource.getrlimit(which)
    if hard != resource.RLIM_INFINITY:
        limit = min(limit, hard)
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(which, (limit, hard))
