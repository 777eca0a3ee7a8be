"""How numbers are shown: units of angle and frequency, kind of amplitude, dB reference.

Results are kept in SI with frequencies in Hz, for motion ~ exp(+j omega t), so that a lag is a negative phase.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from torsionnet.core.errors import UsageError, did_you_mean

ANGLES = {"rad": 1.0, "deg": 180 / math.pi}
FREQUENCIES = {"Hz": 1.0, "cpm": 60.0, "rpm": 60.0, "rad/s": 2 * math.pi}
AMPLITUDES = {"peak": 1.0, "RMS": 1 / math.sqrt(2), "peak-to-peak": 2.0}


@dataclass(frozen=True)
class Conventions:
    """Units and references of tables, files and plots.

    Attributes
    ----------
    angle : {"rad", "deg"}
    frequency : {"Hz", "cpm", "rpm", "rad/s"}
    amplitude : {"peak", "RMS", "peak-to-peak"}
        Of vibrations; a transfer function is a ratio of amplitudes of one kind and does not depend on it.
    db_reference : float
        Value that is 0 dB, in the unit shown.

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
        """Factor from the SI unit of a channel to the unit shown: of what has rad in it, and of stress."""
        return ANGLES[self.angle] if "rad" in unit else 1e-6 if unit == "Pa" else 1.0

    def unit(self, unit: str) -> str:
        """The unit shown for an SI unit."""
        return "N/mm^2" if unit == "Pa" else unit.replace("rad", self.angle)

    @property
    def frequency_scale(self) -> float:
        return FREQUENCIES[self.frequency]

    @property
    def amplitude_scale(self) -> float:
        return AMPLITUDES[self.amplitude]


SI = Conventions()
