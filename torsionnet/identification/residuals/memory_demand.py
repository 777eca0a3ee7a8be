"""Memory demand of a fit of records, estimated before it starts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from torsionnet.base.errors import UsageError
from torsionnet.identification.residuals.segments import MOST_ROW_BYTES, NUMBERS_PER_BATCH
from torsionnet.signals.recording import Recording
from torsionnet.signals.welch import Welch

MOST_BYTES = 2e9
"""Largest memory demand of one measurement in bytes, above which it is refused, as it would also take hours."""
FLOAT_BYTES, COMPLEX_BYTES = 8, 16
"""Bytes of a real and of a complex number in double precision."""


@dataclass(frozen=True)
class MemoryDemand:
    """Memory demand of one record in a fit, in bytes held throughout and in bytes held for a time.

    Attributes
    ----------
    kept, passing : float
        Bytes held during the whole fit, and temporarily.
    lines : int
        Number of lines compared.
    """

    kept: float
    passing: float
    lines: int

    @property
    def most(self) -> float:
        """Peak memory for the record in bytes, held and temporary together."""
        return self.kept + self.passing


def memory_demand(record: Recording, settings: Welch, band: tuple[float, float]) -> MemoryDemand:
    """Memory demand in bytes of a record whose lines in a band (Hz) are compared, within a factor of two."""
    rate, samples = record.sampling_rate / settings.decimation, len(record) / settings.decimation
    lines = max(0, int((min(band[1], rate / 2) - band[0]) * settings.seconds) + 1)
    covariance = FLOAT_BYTES * (2 * lines) ** 2
    pieces = 3 * COMPLEX_BYTES * lines * settings.samples(rate)
    rows = COMPLEX_BYTES * lines * samples
    held = 2 * rows if rows <= MOST_ROW_BYTES else 0  # else row by row
    transforms = 4 * COMPLEX_BYTES * max(2 * samples, min(NUMBERS_PER_BATCH, 2 * samples * lines))
    return MemoryDemand(
        3 * FLOAT_BYTES * len(record) + 2 * covariance, max(pieces, held + transforms) + 4 * covariance, lines
    )


def total_memory(demands: Iterable[MemoryDemand]) -> float:
    """Peak memory in bytes for all records of a fit, which are processed one after the other."""
    listed = list(demands)
    return sum(one.kept for one in listed) + max((one.passing for one in listed), default=0.0)


def check_memory(label: str, record: Recording, settings: Welch, band: tuple[float, float]) -> None:
    """Raise an error for a measurement that takes more than ``MOST_BYTES`` of memory.

    Raises
    ------
    UsageError
        With advice on settings that take less.
    """
    found = memory_demand(record, settings, band)
    if found.most > MOST_BYTES:
        size = found.most / 1e9
        raise UsageError(
            f"{label}: comparing {found.lines} lines from {band[0]:g} to {band[1]:g} Hz takes {size:.1f} GB of memory; "
            "give a narrower band or shorter windows (seconds)"
        )
