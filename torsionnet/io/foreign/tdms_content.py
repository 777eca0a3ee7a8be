"""Reading of TDMS files of LabVIEW through npTDMS."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.io.foreign.content import Content, Slice, StoredArray, plain_attributes, sliced_blocks

if TYPE_CHECKING:
    from numpy.typing import NDArray


def load() -> None:
    """Import nptdms for TDMS files before the limits of memory and time begin."""
    import nptdms  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the channels of numbers of a TDMS file with their properties, and ``group`` if there are several."""
    import nptdms
    import numpy as np

    with path.open("rb") as stream, nptdms.TdmsFile.open(stream) as file:
        groups = file.groups()
        items = [channel for group in groups for channel in group.channels()]
        items = [item for item in items if len(item) > 0 and np.dtype(item.dtype).kind in "fiub"]
        arrays = [
            StoredArray(
                str(item.name),
                (len(item),),
                plain_attributes(item.properties) | ({"group": str(item.group_name)} if len(groups) > 1 else {}),
            )
            for item in items
        ]
        blocks = sliced_blocks([_reader(item) for item in items], [item.length for item in arrays])
        yield Content(tuple(arrays), blocks, plain_attributes(file.properties))


def _reader(item: Any) -> Slice:
    def read(first: int, last: int) -> NDArray[Any]:
        values: NDArray[Any] = item.read_data(offset=first, length=last - first)
        return values

    return read
