"""Recordings in WAV files of sound cards and audio recorders, which are read only."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np

from torsionnet.signals.foreign.content import sliced_blocks
from torsionnet.signals.records.source import FileChannel, Source

RIFF_SIGNATURES = (b"RIFF", b"RIFX", b"RF64")
"""First bytes of WAV files in either order of bytes, and of those above 4 GB."""
SHIFTED_BITS = {24: 8}
"""Bits by which scipy shifts whole numbers of fewer bytes than its own to the left, by the bits of a sample."""


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of a WAV file, its numbers as they are in the file, with the sampling rate of its header."""
    from scipy.io import wavfile

    # From memory: of a file the library takes as much memory as the header says.
    image = path.read_bytes()
    if not image.startswith(RIFF_SIGNATURES):
        raise ValueError("it does not begin as WAV files do; it is damaged, or of another kind")
    read: Any = wavfile.read  # takes a stream, whatever its types say
    with warnings.catch_warnings():
        warnings.simplefilter("error", wavfile.WavFileWarning)
        warnings.filterwarnings("ignore", "Chunk", wavfile.WavFileWarning)  # notes of recorders, passed over
        rate, values = read(io.BytesIO(image))
    bits = _bits(image)
    columns = values.reshape(len(values), -1)
    scaled = columns / 2.0 ** SHIFTED_BITS.get(bits, 0)
    channels = tuple(
        FileChannel(f"channel_{at + 1}", at, length=len(columns), notes=_notes(values, bits))
        for at in range(columns.shape[1])
    )
    readers = [_reader(scaled[:, at]) for at in range(columns.shape[1])]
    yield Source(channels, sliced_blocks(readers, [len(columns)] * len(readers)), rate=float(rate), title=path.stem)


def _reader(values: Any) -> Any:
    return lambda first, last: np.asarray(values[first:last], dtype=float)


def _notes(values: Any, bits: int) -> tuple[str, ...]:
    if values.dtype.kind == "f":
        return ()
    half = 2 ** (bits - 1)
    zero = f", {half} is zero" if values.dtype.kind == "u" else ""
    return (f"whole numbers of {bits} bits, full scale is {half}{zero}",)


def _bits(image: bytes) -> int:
    """Bits of a sample, as the chunk ``fmt`` says; recorders may write long chunks of notes before it."""
    order: Literal["big", "little"] = "big" if image.startswith(b"RIFX") else "little"
    at = 12
    while image[at : at + 4] != b"fmt ":
        size = int.from_bytes(image[at + 4 : at + 8], order)
        at += 8 + size + size % 2  # chunks begin at even places
    return int.from_bytes(image[at + 22 : at + 24], order)
