"""Named arrays with attributes from a binary file of any format, read in blocks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
