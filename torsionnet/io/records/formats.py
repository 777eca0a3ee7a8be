"""Which module reads and writes which file, by its ending.

A module of a format has ``opened(path)``, a context manager that gives a
:class:`~torsionnet.io.records.source.Source`: channels with names and units as they stand in the file, and a reader of
rows in blocks; and, if it writes, ``write(recording, path)`` through :func:`torsionnet.core.atomic.replacing`.
``npz.py`` is a short one to begin from; ``arrays.array_source`` makes a source of named arrays,
``headings.split_heading`` takes a unit off a name. What is wrong with a file is a ValueError in words, with the line
where there is one: the reader adds the name of the file.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from torsionnet.core.errors import UsageError, did_you_mean

MODULES = {
    ".csv": "text",
    ".txt": "text",
    ".tsv": "text",
    ".asc": "text",
    ".dat": "text",
    ".npz": "npz",
    ".mat": "mat",
    ".tdms": "tdms",
    ".uff": "uff",
    ".unv": "uff",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".hdf": "hdf5",
    ".parquet": "parquet",
    ".pq": "parquet",
    ".mf4": "mdf",
    ".mdf": "mdf",
}
LABELS = {
    "text": "text",
    "npz": "NPZ",
    "mat": "MAT",
    "tdms": "TDMS",
    "uff": "UFF58",
    "hdf5": "HDF5",
    "parquet": "Parquet",
    "mdf": "MDF",
}


def format_of(path: Path) -> tuple[str, Any]:
    """Label and module of the format of a file; raises :class:`UsageError` for an ending nobody knows."""
    ending = path.suffix.lower()
    if ending not in MODULES:
        known = ", ".join(MODULES)
        raise UsageError(
            f'"{path.name}" has no ending of a recording{did_you_mean(ending, MODULES)}; expected one of {known}'
        )
    name = MODULES[ending]
    return LABELS[name], importlib.import_module(f"torsionnet.io.records.{name}")
