"""Options of the caller for reading a recording from a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from torsionnet.signals.rotation.pulse_reading import PulseReading


@dataclass(frozen=True)
class ReadOptions:
    """Options of the caller for reading a recording (names, units, sampling rate in Hz, encoder pulses and so on)."""

    names: Sequence[str] | Mapping[str, str] | None = None
    quantities: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    sampling_rate: float | None = None
    pulses: Mapping[str, float] = field(default_factory=dict)
    readings: Mapping[str, PulseReading] = field(default_factory=dict)
    resample: bool = False
    between: Mapping[str, str] = field(default_factory=dict)
