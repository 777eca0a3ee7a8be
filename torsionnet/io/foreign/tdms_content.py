"""Reading of TDMS files of LabVIEW through npTDMS."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.io.foreign.content import Content, Slice, StoredArray, plain_attributes, sliced_blocks

if TYPE_CHECKING:
    from numpy.typing import NDArray


START_TIME, ZERO = "wf_start_time", "zero"
"""Waveform property with the time at which a channel began, passed on in s from the earliest in the file; attribute of
time stamps with the first of them, in UTC."""


def load() -> None:
    """Import nptdms for TDMS files before the limits of memory and time begin."""
    import nptdms  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the channels of numbers of a TDMS file with their properties, and ``group`` if there are several.

    Times at which channels began are in s from the earliest, time stamps from the first, ``zero``.
    """
    import nptdms
    import numpy as np

    with path.open("rb") as stream, nptdms.TdmsFile.open(stream, raw_timestamps=True) as file:
        groups = file.groups()
        items = [channel for group in groups for channel in group.channels()]
        items = [item for item in items if len(item) > 0 and (_is_stamped(item) or np.dtype(item.dtype).kind in "fiub")]
        begins = _begins(items)
        arrays = [
            StoredArray(
                str(item.name),
                (len(item),),
                plain_attributes(item.properties)
                | ({"group": str(item.group_name)} if len(groups) > 1 else {})
                | ({START_TIME: begins[number]} if number in begins else {})
                | ({ZERO: _text(item[0])} if _is_stamped(item) else {}),
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


def _is_stamped(item: Any) -> bool:
    return bool(item.data_type is not None and item.data_type.__name__ == "TimeStamp")


def _text(stamp: Any) -> str:
    import numpy as np

    return str((stamp.as_datetime64("ns") + np.timedelta64(500, "ns")).astype("datetime64[us]"))  # fractions are cut


def _reader(item: Any) -> Slice:
    def read(first: int, last: int) -> NDArray[Any]:
        values: NDArray[Any] = item.read_data(offset=first, length=last - first)
        return values

    def stamps(first: int, last: int) -> NDArray[Any]:
        known: Any = read(first, last)
        parts = known.second_fractions.astype(float) - float(zero.second_fractions)
        return (known.seconds - zero.seconds) + parts * 2.0**-64  # type: ignore[no-any-return]

    zero: Any = item[0] if _is_stamped(item) else None
    return read if zero is None else stamps
