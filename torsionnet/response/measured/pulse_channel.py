"""Pulses of a toothed wheel or of an encoder, a channel of a recording with a length of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import UsageError

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
    notes : tuple of str
        Origin of the times: counter, level of a tooth signal.

    Raises
    ------
    UsageError
        The times are not finite, or do not rise.

    Examples
    --------
    >>> PulseChannel("flywheel", np.array([0.0, 0.1, 0.2]), tick=1e-6).unit
    's'
    """

    name: str
    times: NDArray[np.float64]
    tick: float = 0.0
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        steps = np.diff(self.times)
        if not np.isfinite(self.times).all() or (steps <= 0).any():
            at = int(np.flatnonzero(~(steps > 0))[0]) + 1 if not (steps > 0).all() else 0
            raise UsageError(f"{self.name}: times of pulses are finite and rise; pulse {at} does not")

    @property
    def unit(self) -> str:
        """Unit of the times of pulses, s."""
        return "s"

    def __len__(self) -> int:
        """Number of pulses."""
        return len(self.times)
