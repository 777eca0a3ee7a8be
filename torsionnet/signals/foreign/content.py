"""Named arrays with attributes from a binary file of any format, read in blocks, and limits to their size."""

from __future__ import annotations

import contextlib
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from numpy.typing import NDArray


# Named arrays with attributes from a binary file of any format, read in blocks.

COMPLEX, ROW = "complex", "row"
"""Attributes of an array of complex numbers, and of an array that is a row in the file and a column here."""

UNIT_NAMES = ("unit", "units", "Unit", "Units", "unit_string")
"""Attributes under which programs keep the unit of an array in their files."""

RATE_NAMES, INTERVAL_NAMES = ("sampling_rate", "fs", "sample_rate"), ("sampling_interval", "sample_interval", "dt")
"""Attributes under which programs keep the sampling rate of an array in Hz, or its sampling interval in s."""
START_NAMES = ("start", "start_time", "start_offset", "t0")
"""Attributes under which programs keep the time of the first sample of an array in s."""
WAVE_INTERVAL, WAVE_OFFSET, WAVE_START = "wf_increment", "wf_start_offset", "wf_start_time"
"""Waveform properties of LabVIEW with the sampling interval, the start within the record, and the time it began."""
WAVE_UNIT, WAVE_NAME = "wf_xunit_string", "wf_xname"
"""Waveform properties of LabVIEW with unit and name of the axis."""
MISSING = "missing"
"""Attribute of an array that says in words which of its values were taken for missing ones, as NaN."""
FACTOR_NAMES = ("scale", "gain", "slope", "factor", "sensitivity", "calibration")
"""Attributes under which programs keep a factor of the values of an array, or its inverse: nothing says which."""
OFFSET_NAMES = ("offset", "zero_offset", "bias")
"""Attributes under which programs keep what is to be added to the values of an array, or was taken off them."""

Plain: TypeAlias = str | float | bool | None
Slice: TypeAlias = "Callable[[int, int], NDArray[Any]]"
Blocks: TypeAlias = "Callable[[Sequence[int], int], Iterator[list[NDArray[Any]]]]"


class ForeignFileError(Exception):
    """Error of a library that fails to read a file, or of a refusal to read it, with the reason in one line."""


@dataclass(frozen=True)
class StoredArray:
    """Shape (samples, columns) and attributes of an array in a binary file, and its ``value`` if it is one number."""

    name: str
    shape: tuple[int, ...]
    attributes: Mapping[str, Plain] = field(default_factory=dict)
    value: float | None = None

    @property
    def length(self) -> int:
        return self.shape[0] if self.shape else 1


@dataclass(frozen=True)
class Content:
    """Arrays and attributes of an open binary file of any format.

    ``blocks(numbers, count)`` reads so many samples of these arrays at a time, everything at once where ``count`` is 0.
    ``others`` are the names of what is neither numbers nor text.
    """

    arrays: tuple[StoredArray, ...]
    blocks: Blocks
    attributes: Mapping[str, Plain] = field(default_factory=dict)
    others: tuple[str, ...] = ()


def sliced_blocks(readers: Sequence[Slice], lengths: Sequence[int]) -> Blocks:
    """Reader of blocks of samples from arrays that can each be read from one sample to another.

    They end with the shortest.
    """

    def blocks(numbers: Sequence[int], count: int) -> Iterator[list[NDArray[Any]]]:
        length = min((lengths[number] for number in numbers), default=0)
        step = count or max(length, 1)
        for first in range(0, length, step):
            yield [readers[number](first, min(first + step, length)) for number in numbers]

    return blocks


def memory_content(
    arrays: Sequence[tuple[str, NDArray[Any], Mapping[str, Plain]]],
    attributes: Mapping[str, Plain] | None = None,
    others: Sequence[str] = (),
) -> Content:
    """Content of a file made of arrays that the library has read already."""
    stored = tuple(
        StoredArray(name, values.shape, given, float(values.real.ravel()[0]) if values.size == 1 else None)
        for name, values, given in arrays
    )
    blocks = sliced_blocks([_slice(values) for _, values, _ in arrays], [item.length for item in stored])
    return Content(stored, blocks, attributes or {}, tuple(others))


def _slice(values: NDArray[Any]) -> Slice:
    return lambda first, last: values[first:last]


def plain_attributes(attributes: Mapping[Any, Any]) -> dict[str, Plain]:
    """Attributes of a file or array, by name, that are text or a single number, all others left out.

    >>> plain_attributes({"unit": b"N*m", "count": 3, "table": [1, 2]})
    {'unit': 'N*m', 'count': 3}
    """
    plain: dict[str, Plain] = {}
    for name, value in attributes.items():
        if isinstance(value, bytes):
            plain[str(name)] = value.decode(errors="replace")
        elif isinstance(value, str):
            plain[str(name)] = str(value)
        elif getattr(value, "shape", ()) == () and (number := _number(value)) is not None:
            plain[str(name)] = number
    return plain


def _number(value: Any) -> float | None:
    try:
        return int(value) if hasattr(value, "__index__") else float(value)
    except (TypeError, ValueError, OverflowError):
        return None


def count_samples(arrays: Sequence[StoredArray]) -> int:
    """Number of samples in all arrays of a file together."""
    return sum(prod(item.shape) for item in arrays)


# Limits to the unpacked size of a file, and to the memory and processor time of the process that reads it.

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
