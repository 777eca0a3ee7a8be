"""Fault that a bench put into a record, so that what is found can be compared with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.result_rows import Out


@dataclass(frozen=True)
class TrueFault:
    """Fault of a channel of a virtual test: its kind, its time in s of the first clock, and its size.

    The size is the number of the tooth of a lost or double pulse, the length in s of a drop-out, and in SI of others.

    Examples
    --------
    >>> print(TrueFault("fly", "missing pulse", 1.25, 731))
    fly: missing pulse at 1.25 s, 731
    """

    channel: Annotated[str, Out("channel")]
    kind: Annotated[str, Out("fault")]
    time: Annotated[float, Out("time", "s", json="time_s")]
    size: Annotated[float, Out("size")]

    def __str__(self) -> str:
        return f"{self.channel}: {self.kind} at {self.time:.6g} s, {self.size:.6g}"
