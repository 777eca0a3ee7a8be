"""What a fit of records takes in memory, told before it starts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from torsionnet.core.errors import UsageError
from torsionnet.identification.residuals.segments import BATCH, HELD
from torsionnet.response.recording import Recording
from torsionnet.signals.welch import Welch

MOST = 2e9
"""Bytes beyond which a measurement is refused; it would also take hours."""
NUMBER, COMPLEX = 8, 16
"""Bytes."""


@dataclass(frozen=True)
class Demand:
    """Memory that one record takes in a fit.

    Attributes
    ----------
    kept, passing : float
        Bytes, through the whole fit and for a moment.
    lines : int
        Lines compared.
    """

    kept: float
    passing: float
    lines: int

    @property
    def most(self) -> float:
        """At the highest."""
        return self.kept + self.passing


def demand(record: Recording, settings: Welch, band: tuple[float, float]) -> Demand:
    """What a record takes whose lines in a band are compared, within a factor of two."""
    rate, samples = record.sampling_rate / settings.decimation, len(record) / settings.decimation
    lines = max(0, int((min(band[1], rate / 2) - band[0]) * settings.seconds) + 1)
    covariance = NUMBER * (2 * lines) ** 2
    pieces = 3 * COMPLEX * lines * settings.samples(rate)
    rows = COMPLEX * lines * samples
    held = 2 * rows if rows <= HELD else 0  # else row by row
    transforms = 4 * COMPLEX * max(2 * samples, min(BATCH, 2 * samples * lines))
    return Demand(3 * NUMBER * len(record) + 2 * covariance, max(pieces, held + transforms) + 4 * covariance, lines)


def total(demands: Iterable[Demand]) -> float:
    """Bytes for all the records of a fit, which are treated one after the other."""
    listed = list(demands)
    return sum(one.kept for one in listed) + max((one.passing for one in listed), default=0.0)


def check_memory(label: str, record: Recording, settings: Welch, band: tuple[float, float]) -> None:
    """Refuse a measurement that takes too much.

    Raises
    ------
    UsageError
        With what takes less.
    """
    found = demand(record, settings, band)
    if found.most > MOST:
        size = found.most / 1e9
        raise UsageError(
            f"{label}: comparing {found.lines} lines from {band[0]:g} to {band[1]:g} Hz takes {size:.1f} GB of memory; "
            "give a narrower band or shorter windows (seconds)"
        )
