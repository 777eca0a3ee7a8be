"""HDF5 files, and MAT v7.3 files, which are HDF5: every dataset of numbers is a channel."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.atomic import replacing
from torsionnet.signals.files.arrays import Member, array_source
from torsionnet.signals.files.extras import needed
from torsionnet.signals.files.source import Reader, Source
from torsionnet.signals.files.stored import KEY, TIME, checked_names, plain_keys, stored
from torsionnet.signals.recording import FloatArray, Recording

UNIT_NAMES = ("unit", "units", "Unit", "Units", "unit_string")
CHUNK = 65536


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """An HDF5 file; units are taken from attributes of the datasets."""
    h5py = needed("hdf5")
    with h5py.File(path, "r") as file:
        found: list[tuple[str, Any]] = []
        file.visititems(lambda name, item: found.append((name, item)) if isinstance(item, h5py.Dataset) else None)
        # MATLAB keeps rows and columns the other way round, and text and references as numbers.
        matlab = any("MATLAB_class" in item.attrs for _, item in found)
        members = [_member(name.replace("/", "."), item, matlab) for name, item in found if _is_channel(name, item)]
        rate = [float(file.attrs[name]) for name in ("sampling_rate", "fs", "sample_rate") if name in file.attrs]
        source = array_source(members, _text(file.attrs.get(KEY, "")), path.stem)
        yield source if source.rate or not rate else _with_rate(source, rate[0])


def _with_rate(source: Source, rate: float) -> Source:
    from dataclasses import replace

    return replace(source, rate=rate)


def _is_channel(name: str, item: Any) -> bool:
    text = item.attrs.get("MATLAB_class", b"double") in (b"char", b"cell", "char", "cell")
    return not text and not name.startswith("#") and item.dtype.kind in "fiub" and 0 <= item.ndim <= 2  # noqa: PLR2004


def _member(name: str, item: Any, turned: bool) -> Member:
    rows, columns = (*item.shape, 1, 1)[:2] if item.ndim else (1, 1)
    if item.ndim == 0:
        return Member(name, (1, 1), lambda _first, _last: np.array([[float(item[()])]]))
    across = item.ndim == 2 and (turned or rows == 1)  # noqa: PLR2004
    shape = (columns, rows) if across else (rows, columns)
    return Member(name, shape, _reader(item, across), _unit(item), _text(item.attrs.get("quantity", "")))


def _reader(item: Any, across: bool) -> Reader:
    def read(first: int, last: int) -> FloatArray:
        return np.asarray(item[:, first:last].T if across else item[first:last], dtype=float)

    return read


def _unit(item: Any) -> str:
    return next((_text(item.attrs[name]) for name in UNIT_NAMES if name in item.attrs), "")


def _text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def write(recording: Recording, path: Path) -> None:
    """An HDF5 file of one dataset for every signal, with unit and quantity as attributes."""
    checked_names(recording)
    h5py = needed("hdf5")
    keys = plain_keys(recording.names, r"[/.\0]")
    with replacing(path) as temporary, h5py.File(temporary, "w", track_order=True) as file:
        file.attrs[KEY] = stored(recording, keys)
        file.attrs["sampling_rate"], file.attrs["start"] = recording.sampling_rate, recording.start
        for key, signal in zip(keys, recording, strict=True):
            item = _filled(file, key, signal.values)
            item.attrs["unit"], item.attrs["quantity"] = signal.unit, signal.quantity
        if recording.times is not None:
            _filled(file, TIME, recording.times).attrs["unit"] = "s"


def _filled(file: Any, name: str, values: FloatArray) -> Any:
    item = file.create_dataset(name, shape=values.shape, dtype="f8", chunks=(CHUNK,) if len(values) > CHUNK else None)
    for first in range(0, len(values), 16 * CHUNK):
        item[first : first + 16 * CHUNK] = values[first : first + 16 * CHUNK]
    return item
