"""Reading of TDMS files of LabVIEW through npTDMS."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.io.foreign.content import Content, Slice, StoredArray, plain_attributes, sliced_blocks

if TYPE_CHECKING:
    from numpy.typing import NDArray


START_TIME = "wf_start_time"
"""Waveform property with the time at which a channel began, passed on in s from the earliest in the file."""


def load() -> None:
    """Import nptdms for TDMS files before the limits of memory and time begin."""
    import nptdms  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the channels of numbers of a TDMS file with their properties, and ``group`` if there are several.

    Times at which channels began are in s from the earliest.
    """
    import nptdms
    import numpy as np

    with path.open("rb") as stream, nptdms.TdmsFile.open(stream, raw_timestamps=True) as file:
        groups = file.groups()
        items = [channel for group in groups for channel in group.channels()]
        items = [item for item in items if len(item) > 0 and np.dtype(item.dtype).kind in "fiub"]
        begins = _begins(items)
        arrays = [
            StoredArray(
                str(item.name),
                (len(item),),
                plain_attributes(item.properties)
                | ({"group": str(item.group_name)} if len(groups) > 1 else {})
                | ({START_TIME: begins[number]} if number in begins else {}),
            )
            for number, item in enumerate(items)
        ]
        blocks = sliced_blocks([_reader(item) for item in items], [item.length for item in arrays])
        yield Content(tuple(arrays), blocks, plain_attributes(file.properties))


def _begins(items: Sequence[Any]) -> dict[int, float]:
    """Times in s at which channels began, by their number, from the earliest; LabVIEW writes 0 where it knows none."""
    stamps = {number: item.properties.get(START_TIME) for number, item in enumerate(items)}
    known = {
        number: (one.seconds, one.second_fractions) for number, one in stamps.items() if getattr(one, "seconds", 0)
    }
    if not known:
        return {}
    # Whole seconds first, as a double has too few digits for the fractions of a second since 1904.
    second, fraction = min(known.values())
    return {number: float(own[0] - second) + (own[1] - fraction) * 2.0**-64 for number, own in known.items()}


def _reader(item: Any) -> Slice:
    def read(first: int, last: int) -> NDArray[Any]:
        values: NDArray[Any] = item.read_data(offset=first, length=last - first)
        return values

    return read
