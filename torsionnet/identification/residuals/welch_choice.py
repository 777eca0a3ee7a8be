"""Settings by which a record is averaged, from the entries of a file and from the record."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.identification.plan.fit_entries import FitSettings
from torsionnet.identification.residuals.measurement_blocks import default_settings
from torsionnet.signals.decimation import factor_for
from torsionnet.signals.recording import Recording
from torsionnet.signals.welch import PAPER, Welch


def welch_settings(settings: FitSettings) -> Welch:
    """Welch settings that the entries of a file give, the others by default.

    Raises
    ------
    UsageError
        A length, overlap or trend that there is not.
    """
    given = {name: value for name, _ in settings.specs() if (value := getattr(settings, name)) is not None}
    return replace(PAPER if given.pop("preset", "") else Welch(), **given)


def record_settings(
    record: Recording, band: tuple[float, float] | None, settings: Welch | None, decimation: int | None
) -> Welch:
    """Welch settings of one record, decimated as far as the band in Hz allows where no decimation is given."""
    if settings is None:
        return default_settings(record, band)
    if decimation is not None:
        return settings
    return replace(settings, decimation=factor_for(record.sampling_rate, band[1] if band else 0.0))
