"""MAT v5 files as bytes."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

HEADER = 116
"""Bytes of free text at the beginning of a MAT v5 file, where scipy writes today's date."""


def mat_bytes(content: Mapping[str, Any]) -> bytes:
    """A MAT v5 file with these variables; equal content gives equal bytes."""
    from scipy.io import savemat

    buffer = io.BytesIO()
    write: Any = savemat  # takes a stream, whatever its types say
    write(buffer, dict(content), oned_as="column", long_field_names=True)
    return b"MATLAB 5.0 MAT-file, torsionnet".ljust(HEADER) + buffer.getvalue()[HEADER:]


def cells(texts: Iterable[str]) -> Any:
    """A row of texts as a cell array."""
    listed = list(texts)
    row = np.empty((1, len(listed)), dtype=object)
    row[0, :] = listed
    return row
