"""Recordings from and into files: read_recording, write_recording, iter_blocks."""

from torsionnet.io.records.reading import channel_names, iter_blocks, read_recording
from torsionnet.io.records.writing import write_recording

__all__ = ["channel_names", "iter_blocks", "read_recording", "write_recording"]
