"""Reading of MDF files through asammdf, which reads all channels as a whole."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import torsionnet.io.foreign.resource_limits as resource_limits
from torsionnet.io.foreign.content import Content, Plain, memory_content


def load() -> None:
    """Import asammdf for MDF files before the limits of memory and time begin."""
    import asammdf  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the channels of numbers of an MDF file, then the time stamps of the first channel in s, and the comment."""
    import asammdf
    import numpy as np

    with asammdf.MDF(path) as file:
        claimed = sum(group.channel_group.cycles_nr * len(group.channels) for group in file.groups)
        resource_limits.check(resource_limits.BYTES_PER_SAMPLE * claimed, path)
        signals = [signal for signal in file.iter_channels() if signal.samples.dtype.kind in "fiub"]
        arrays: list[tuple[str, Any, dict[str, Plain]]] = [
            (str(signal.name), np.asarray(signal.samples, dtype=float), {"unit": str(signal.unit or "")})
            for signal in signals
        ]
        if signals:
            arrays.append(("time", np.asarray(signals[0].timestamps, dtype=float), {"unit": "s"}))
        yield memory_content(arrays, {"comment": str(file.header.comment)})
