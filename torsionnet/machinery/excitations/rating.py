"""Rated torque and speed of a machine, as its excitation states them."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.base.errors import EntryPath

MECHANICAL_EFFICIENCIES = (0.75, 1.0)
"""Smallest and largest usual power of engines at the coupling over the indicated power."""


@dataclass(frozen=True)
class Rating:
    """Mean torque of a machine in N m at its rated speed in rad/s, with the entries that state both.

    Attributes
    ----------
    torque : float
        N m, above zero if the machine drives, below zero if it is driven.
    path, speed_path : Path
        Entries of torque and speed below the excitation; the second is empty without a stated speed.
    speed : float, optional
        Speed of its shaft, rad/s.
    power : float, optional
        Power in W, where the entry states a power.
    exponent : float
        Exponent of the torque over speed.
    shares : tuple of float
        Least and largest power at the shaft over the rated power: 1 but for indicated powers.
    """

    torque: float
    path: EntryPath
    speed: float | None = None
    speed_path: EntryPath = ()
    power: float | None = None
    exponent: float = 0.0
    shares: tuple[float, float] = (1.0, 1.0)

    def at(self, speed: float) -> tuple[float, ...]:
        """Power in W as stated, and, with a stated speed, power in W at ``speed`` in rad/s by the torque curve."""
        stated = self.torque * speed if self.power is None else self.power
        if not self.speed:
            return (stated,)
        return stated, self.torque * (speed / self.speed) ** self.exponent * speed
