"""Reading of MDF files through asammdf, which reads all channels as a whole."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import torsionnet.signals.foreign.content as resource_limits
from torsionnet.signals.foreign.content import Content, Plain, memory_content

if TYPE_CHECKING:
    from numpy.typing import NDArray

LONGEST_NAME = 40
"""Most letters of the comment of a group that is taken for its name."""
MASTERS = {1: "", 2: "an angle", 3: "a distance", 4: "an index"}
"""Words for a master channel by its kind, empty for a time."""


def load() -> None:
    """Import asammdf for MDF files before the limits of memory and time begin."""
    import asammdf  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the channels of numbers of an MDF file, then the time stamps of its rasters, and the comment.

    ``raster`` of a channel is the number of its stamps among these, ``over`` what its master is where that is no time,
    ``group`` the name of its group. Samples with an invalidation bit are NaN, and counted in ``invalid``.
    """
    import asammdf
    import numpy as np

    with asammdf.MDF(path) as file:
        claimed = sum(group.channel_group.cycles_nr * len(group.channels) for group in file.groups)
        resource_limits.check(resource_limits.BYTES_PER_SAMPLE * claimed, path)
        names = [_group_name(group) for group in file.groups]
        groups = [
            name if name and names.count(name) == 1 else f"group {number}" for number, name in enumerate(names, 1)
        ]
        arrays: list[tuple[str, Any, dict[str, Plain]]] = []
        rasters: list[tuple[str, NDArray[Any]]] = []
        for signal in file.iter_channels(copy_master=False):
            if signal.samples.dtype.kind not in "fiub" or not len(signal.samples):
                continue
            values, told = np.array(signal.samples, dtype=float), _attributes(file, signal, rasters)
            if signal.invalidation_bits is not None:
                invalid = np.asarray(signal.invalidation_bits, dtype=bool)
                values[invalid], told["invalid"] = np.nan, int(invalid.sum())
            arrays.append((str(signal.name), values, told | {"group": groups[signal.group_index]}))
        arrays += [("time", stamps, {"unit": unit}) for unit, stamps in rasters]
        yield memory_content(arrays, {"comment": str(file.header.comment), "rasters": len(rasters)})


def _group_name(group: Any) -> str:
    """Name of a group of an MDF file, of its source, or a comment of one short line; empty where it has none."""
    header = group.channel_group
    source = getattr(header, "acq_source", None)  # groups of version 3 have none
    given = (getattr(header, "acq_name", ""), getattr(source, "name", ""), getattr(header, "comment", ""))
    names = (str(name).strip() for name in given if name)
    return next((name for name in names if name and len(name) <= LONGEST_NAME and name.isprintable()), "")


def _attributes(file: Any, signal: Any, rasters: list[tuple[str, NDArray[Any]]]) -> dict[str, Plain]:
    """Unit of a channel and what it is over, of time the number of its raster, to which new stamps are added."""
    import numpy as np

    group = file.groups[signal.group_index].channel_group
    at = getattr(group, "cg_master_index", None)  # the group of a column may have its master in another
    index = signal.group_index if at is None else at
    place = file.masters_db.get(index)
    master = None if place is None else file.groups[index].channels[place]
    kind = 4 if master is None else getattr(master, "sync_type", 1)
    unit = str(getattr(getattr(master, "conversion", None), "unit", "") or getattr(master, "unit", "") or "")
    told: dict[str, Plain] = {"unit": str(signal.unit or "")}
    if MASTERS.get(kind):
        return told | {"over": f"{MASTERS[kind]}{f' in {unit}' if unit else ''}"}
    stamps = np.asarray(signal.timestamps, dtype=float)
    same = (number for number, raster in enumerate(rasters) if raster[0] == unit and np.array_equal(raster[1], stamps))
    number = next(same, len(rasters))
    if number == len(rasters):
        rasters.append((unit, stamps))
    return told | {"raster": number}
