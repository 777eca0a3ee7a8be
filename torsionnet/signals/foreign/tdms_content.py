"""Reading of TDMS files of LabVIEW through npTDMS."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.signals.foreign.content import (
    WAVE_START,
    Content,
    Plain,
    Slice,
    StoredArray,
    plain_attributes,
    sliced_blocks,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray


ZERO = "zero"
"""Attribute of time stamps with the earliest time in the file, in UTC."""


def load() -> None:
    """Import nptdms for TDMS files before the limits of memory and time begin."""
    import nptdms  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the channels of numbers of a TDMS file with their properties, and ``group`` if there are several.

    Times at which channels began, and time stamps, are in s from the earliest of both, ``zero``.
    """
    import nptdms
    import numpy as np

    with path.open("rb") as stream, nptdms.TdmsFile.open(stream, raw_timestamps=True) as file:
        groups = file.groups()
        items = [channel for group in groups for channel in group.channels()]
        items = [item for item in items if len(item) > 0 and (_is_stamped(item) or np.dtype(item.dtype).kind in "fiub")]
        begun = _begun(items)
        zero = min(begun.values(), key=_instant, default=None)
        arrays = [
            StoredArray(
                str(item.name),
                (len(item),),
                plain_attributes(item.properties)
                | ({"group": str(item.group_name)} if len(groups) > 1 else {})
                | _origin(item, begun.get(number), zero),
            )
            for number, item in enumerate(items)
        ]
        blocks = sliced_blocks([_reader(item, zero) for item in items], [item.length for item in arrays])
        yield Content(tuple(arrays), blocks, plain_attributes(file.properties))


def _begun(items: Sequence[Any]) -> dict[int, Any]:
    """Times at which channels began, and first time stamps, by number; LabVIEW writes 0 where it knows none."""
    times = {
        number: item[0] if _is_stamped(item) else item.properties.get(WAVE_START) for number, item in enumerate(items)
    }
    return {number: time for number, time in times.items() if getattr(time, "seconds", 0)}


def _instant(time: Any) -> tuple[int, int]:
    return int(time.seconds), int(time.second_fractions)


def _origin(item: Any, begun: Any, zero: Any) -> dict[str, Plain]:
    """Start of a channel in s from ``zero``, of time stamps ``zero`` itself; empty where none is known."""
    if _is_stamped(item):
        return {ZERO: _text(item[0] if zero is None else zero)}
    return {} if begun is None else {WAVE_START: float(_seconds_between(begun, zero))}


def _seconds_between(time: Any, zero: Any) -> Any:
    """Seconds from ``zero`` to a time, or to an array of times.

    Whole seconds first, as a double has too few digits for the fractions of a second since 1904.
    """
    import numpy as np

    parts = np.asarray(time.second_fractions, dtype=float) - float(zero.second_fractions)
    return np.asarray(time.seconds, dtype=np.int64) - int(zero.seconds) + parts * 2.0**-64


def _is_stamped(item: Any) -> bool:
    return bool(item.data_type is not None and item.data_type.__name__ == "TimeStamp")


def _text(stamp: Any) -> str:
    import numpy as np

    return str((stamp.as_datetime64("ns") + np.timedelta64(500, "ns")).astype("datetime64[us]"))  # fractions are cut


def _reader(item: Any, zero: Any) -> Slice:
    def read(first: int, last: int) -> NDArray[Any]:
        values: NDArray[Any] = item.read_data(offset=first, length=last - first)
        return values

    def stamps(first: int, last: int) -> NDArray[Any]:
        return _seconds_between(read(first, last), item[0] if zero is None else zero)  # type: ignore[no-any-return]

    return stamps if _is_stamped(item) else read
