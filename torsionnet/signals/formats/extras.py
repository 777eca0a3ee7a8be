"""Optional packages that only one file format needs, and reading of files of that format with them."""

from __future__ import annotations

import importlib
import importlib.util
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from torsionnet.base.errors import MissingExtraError
from torsionnet.signals.foreign import Content, process

EXTRA_PACKAGES = {
    "tdms": ("nptdms", "npTDMS", "TDMS"),
    "uff": ("pyuff", "pyuff", "UFF58"),
    "hdf5": ("h5py", "h5py", "HDF5 and MAT v7.3"),
    "parquet": ("pyarrow.parquet", "pyarrow", "Parquet"),
    "mdf": ("asammdf", "asammdf", "MDF4"),
    "fmu": ("ziglang", "ziglang", "FMU"),
}
"""Optional packages by the name of the extra, each with its module, the package it comes in, and files it is for."""


def import_extra(extra: str) -> Any:
    """Import the module of an extra and return it.

    Raises
    ------
    MissingExtraError
        Where it is not installed; the message has the pip command.
    """
    try:
        return importlib.import_module(EXTRA_PACKAGES[extra][0])
    except ImportError as error:
        raise _missing(extra) from error


def require_extra(extra: str) -> None:
    """Raise :class:`MissingExtraError` where the package of an extra is not installed, without importing it."""
    if importlib.util.find_spec(EXTRA_PACKAGES[extra][0].partition(".")[0]) is None:
        raise _missing(extra)


def open_foreign(path: Path, form: str) -> AbstractContextManager[Content]:
    """Context manager with the content of a file that is read in a separate process.

    ``form`` names a module of :mod:`torsionnet.signals.foreign`.
    """
    if form in EXTRA_PACKAGES:
        require_extra(form)
    return process.open_content(path, form)


def _missing(extra: str) -> MissingExtraError:
    _, package, files = EXTRA_PACKAGES[extra]
    return MissingExtraError(f'{files} files need the package {package}: pip install "torsionnet[{extra}]"')
