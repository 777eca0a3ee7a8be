"""Recordings into files."""

from __future__ import annotations

import os
from pathlib import Path

from torsionnet.io.records.formats import format_of
from torsionnet.response.recording import Recording


def write_recording(recording: Recording, path: str | os.PathLike[str]) -> None:
    """Write a recording in the format of the ending of ``path``, whole or not at all.

    Reading the file again gives the same names, quantities, values, rate, start and notes. UFF58 files keep of the
    notes and names what fits into lines of 80 characters.

    Raises
    ------
    UsageError
        The ending is not known, or two channels would have one name in the file.
    MissingExtraError
        The package for the format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from torsionnet.io.records import read_recording
    >>> from torsionnet.response.recording import Signal
    >>> path = Path(tempfile.mkdtemp(), "test.npz")
    >>> write_recording(Recording((Signal("T_T", "torque", np.array([0.0, 1.0])),), sampling_rate=10e3), path)
    >>> read_recording(path)
    <Recording T_T: 2 samples at 10000 Hz, 0.0002 s>
    """
    target = Path(path)
    _, module = format_of(target)
    module.write(recording, target)
