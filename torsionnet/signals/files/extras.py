"""Packages that only one file format needs."""

from __future__ import annotations

import importlib
from typing import Any

from torsionnet.errors import MissingExtraError

PACKAGES = {
    "tdms": ("nptdms", "npTDMS", "TDMS"),
    "uff": ("pyuff", "pyuff", "UFF58"),
    "hdf5": ("h5py", "h5py", "HDF5 and MAT v7.3"),
    "parquet": ("pyarrow.parquet", "pyarrow", "Parquet"),
    "mdf": ("asammdf", "asammdf", "MDF4"),
    "fmu": ("ziglang", "ziglang", "FMU"),
}
"""Extra: its module, the package it comes in, and the files it is for."""


def needed(extra: str) -> Any:
    """The module of an extra.

    Raises
    ------
    MissingExtraError
        Where it is not installed; the message has the pip command.
    """
    module, package, files = PACKAGES[extra]
    try:
        return importlib.import_module(module)
    except ImportError as error:
        msg = f'{files} files need the package {package}: pip install "torsionnet[{extra}]"'
        raise MissingExtraError(msg) from error
