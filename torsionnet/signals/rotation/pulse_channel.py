"""Pulses of a toothed wheel or of an encoder, a channel of a recording with a length of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import Out

PULSE_TIMES = "pulse times"
"""Quantity under which files hold the times of pulses, which are a channel of their own length in s."""


@dataclass(frozen=True, eq=False)
class PulseChannel:
    """Times of the pulses of a toothed wheel or of an encoder, in s on the clock of their recording.

    Attributes
    ----------
    name : str
    times : (n,) array
        Times of the pulses as recorded, s, rising: nothing is repaired.
    tick : float
        Resolution of the times in s, the step of the counter that stamped them; 0 where it is not known.
    notes : tuple of str or Note
        Origin of the times: counter, level of a tooth signal.
    unit_known : bool
        Whether the unit of the recorded times was given; else they were taken for s.

    Raises
    ------
    UsageError
        The times are not finite, or do not rise.

    Examples
    --------
    >>> PulseChannel("flywheel", np.array([0.0, 0.1, 0.2]), tick=1e-6).unit
    's'
    """

    SHOWN: ClassVar = ("name", "count", "first", "last", "tick", "notes")

    name: Annotated[str, Out("channel of pulses")]
    times: NDArray[np.float64]
    tick: Annotated[float, Out("tick", "s", json="tick_s", digits=4)] = 0.0
    notes: Annotated[tuple[NoteOrText, ...], Out("notes")] = ()
    unit_known: bool = True

    def __post_init__(self) -> None:
        steps = np.diff(self.times)
        if not np.isfinite(self.times).all() or (steps <= 0).any():
            at = int(np.flatnonzero(~(steps > 0))[0]) + 1 if not (steps > 0).all() else 0
            raise UsageError(
                f"{self.name}: times of pulses are finite and rise; pulse {at} does not", kind="unordered-rows"
            )

    @property
    def unit(self) -> str:
        """Unit of the times of pulses, s."""
        return "s"

    def __len__(self) -> int:
        """Number of pulses."""
        return len(self.times)

    @property
    def count(self) -> Annotated[int, Out("pulses")]:
        """Number of pulses."""
        return len(self.times)

    @property
    def first(self) -> Annotated[float | None, Out("first", "s", json="first_s")]:
        """Time of the first pulse in s, None without pulses."""
        return float(self.times[0]) if len(self) else None

    @property
    def last(self) -> Annotated[float | None, Out("last", "s", json="last_s")]:
        """Time of the last pulse in s, None without pulses."""
        return float(self.times[-1]) if len(self) else None

    @property
    def span(self) -> str:
        """Number of the pulses and the time in s from the first to the last, as words."""
        count = f"{len(self)} pulse{'s' * (len(self) != 1)}"
        return f"{count} from {self.times[0]:.6g} to {self.times[-1]:.6g} s" if len(self) else count

    def between(self, first: float, last: float) -> PulseChannel:
        """Channel of the pulses from the time ``first`` up to before ``last``, both in s."""
        begin, end = np.searchsorted(self.times, [first, last])
        return replace(self, times=self.times[begin:end])
