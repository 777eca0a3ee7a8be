"""Signals of a record of any size: a large file is read in blocks, so that it does not fill the memory."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from torsionnet.signals.record_blocks import Recordings
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import iter_blocks, read_recording

LARGE_FILE = 300_000_000
"""Bytes of a file of signals above which it is read in blocks, so that it does not fill the memory; a larger value
takes more memory, a smaller one blocks needlessly."""
BLOCK_SECONDS = 30.0
"""Duration in s of a block of a large file, as longer ones take more memory and shorter ones more reads: 19 MB for 8
channels at 10 kHz."""


def is_large_record(path: str | os.PathLike[str]) -> bool:
    """Whether the file of a record is so large that it is read in blocks."""
    return Path(path).is_file() and Path(path).stat().st_size > LARGE_FILE


def blocks_of_record(path: str | os.PathLike[str], **reading: Any) -> Iterator[Recording]:
    """Blocks of a large file in SI; arguments are those of :func:`read_recording`, without ``pulses``."""
    return iter_blocks(path, BLOCK_SECONDS, **reading)


def record_or_blocks(path: str | os.PathLike[str], **reading: Any) -> Recordings:
    """Recording of a file in SI, or an iterator of its blocks if the file is large."""
    return blocks_of_record(path, **reading) if is_large_record(path) else read_recording(path, **reading)
