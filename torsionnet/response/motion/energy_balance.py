"""Energy balance of motion over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class EnergyBalance:
    """Energies in J between the first and the last sample of a motion over time.

    Attributes
    ----------
    supplied : float
        Work of the torques from outside.
    stored : float
        Rise of the kinetic energy of inertias and of the energy stored in springs.
    dissipated : mapping
        Energy that each element has turned into heat, by name.

    Examples
    --------
    >>> EnergyBalance(10.0, 7.5, {"clutch": 2.5}).left_over
    0.0
    """

    supplied: float
    stored: float
    dissipated: Mapping[str, float] = field(default_factory=dict)

    @property
    def left_over(self) -> float:
        """Energy in J that the sums do not account for: the error of the calculation."""
        return self.supplied - self.stored - sum(self.dissipated.values())
