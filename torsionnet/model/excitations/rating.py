"""What a machine is rated for, as its excitation states it."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.core.errors import Path

FRICTION = (0.75, 1.0)
"""Power at the coupling over indicated power: what engines have."""


@dataclass(frozen=True)
class Rating:
    """The mean torque of a machine at its rated speed, and where both are stated.

    Attributes
    ----------
    torque : float
        N m that it gives, below zero if it takes it.
    path, speed_path : Path
        Of the entries below the excitation; the second is empty where no speed is stated.
    speed : float, optional
        rad/s of its shaft.
    power : float, optional
        W, where that is stated instead of a torque.
    exponent : float
        The torque follows the speed to this power.
    shares : tuple of float
        Least and largest power at the shaft over this: 1 but for indicated powers.
    """

    torque: float
    path: Path
    speed: float | None = None
    speed_path: Path = ()
    power: float | None = None
    exponent: float = 0.0
    shares: tuple[float, float] = (1.0, 1.0)

    def at(self, speed: float) -> tuple[float, ...]:
        """Power in W as stated, taken to be that at ``speed`` in rad/s; and by its curve, where that differs."""
        stated = self.torque * speed if self.power is None else self.power
        if not self.speed:
            return (stated,)
        return stated, self.torque * (speed / self.speed) ** self.exponent * speed
