"""Conventions for showing results, units of angle and frequency, kind of amplitude, dB reference.

Results are kept in SI with frequencies in Hz, for motion ~ exp(+j omega t), so that a lag is a negative phase.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from torsionnet.core.errors import UsageError, did_you_mean

ANGLES = {"rad": 1.0, "deg": 180 / math.pi}
"""Factor from rad to each unit in which angles are shown, by name of the unit."""
FREQUENCIES = {"Hz": 1.0, "cpm": 60.0, "rpm": 60.0, "rad/s": 2 * math.pi}
"""Factor from Hz to each unit in which frequencies are shown, by name of the unit."""
AMPLITUDES = {"peak": 1.0, "RMS": 1 / math.sqrt(2), "peak-to-peak": 2.0}
"""Factor from the peak value of a vibration to each kind of amplitude, by name of the kind."""


@dataclass(frozen=True)
class Conventions:
    """Units of angle and frequency, kind of amplitude and dB reference of tables, files and plots.

    Attributes
    ----------
    angle : {"rad", "deg"}
    frequency : {"Hz", "cpm", "rpm", "rad/s"}
    amplitude : {"peak", "RMS", "peak-to-peak"}
        Kind of amplitude of vibrations; transfer functions do not depend on it.
    db_reference : float
        Value shown as 0 dB, in the unit shown.

    Examples
    --------
    >>> Conventions(angle="deg").scale("rad")
    57.29577951308232
    """

    angle: str = "rad"
    frequency: str = "Hz"
    amplitude: str = "peak"
    db_reference: float = 1.0

    def __post_init__(self) -> None:
        for name, known in (("angle", ANGLES), ("frequency", FREQUENCIES), ("amplitude", AMPLITUDES)):
            chosen = getattr(self, name)
            if chosen not in known:
                raise UsageError(
                    f'{name} "{chosen}" is not known{did_you_mean(str(chosen), known)}; choose {", ".join(known)}'
                )
        if not (math.isfinite(self.db_reference) and self.db_reference > 0):
            raise UsageError(f"the dB reference must be a positive number, got {self.db_reference}")

    def scale(self, unit: str) -> float:
        """Factor from an SI unit to the unit in which its values are shown; not 1 for angles and stresses."""
        return ANGLES[self.angle] if "rad" in unit else 1e-6 if unit == "Pa" else 1.0

    def unit(self, unit: str) -> str:
        """Name of the unit in which values of an SI unit are shown, such as deg for rad."""
        return "N/mm^2" if unit == "Pa" else unit.replace("rad", self.angle)

    def unit_of_column(self, unit: str) -> str:
        """Name of the unit in which a table's column of an SI unit, or of Hz, is shown."""
        return self.frequency if unit == "Hz" else self.unit(unit)

    def scale_of_column(self, unit: str) -> float:
        """Factor from the SI unit, or Hz, of a table's column to the unit in which it is shown."""
        return self.frequency_scale if unit == "Hz" else self.scale(unit)

    @property
    def frequency_scale(self) -> float:
        """Factor from Hz to the unit in which frequencies are shown."""
        return FREQUENCIES[self.frequency]

    @property
    def amplitude_scale(self) -> float:
        """Factor from the peak value of a vibration to the kind of amplitude shown."""
        return AMPLITUDES[self.amplitude]


SI = Conventions()
"""Conventions with SI units, Hz and peak amplitudes."""
