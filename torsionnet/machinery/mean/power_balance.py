"""Balance of the mean powers of a drivetrain at one speed: what drivers give, absorbers take and elements pass on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from torsionnet.machinery.mean.static_state import StaticState


@dataclass(frozen=True, eq=False)
class PowerBalance:
    """Mean power in W from outside into each node at one speed, above zero where it drives, else below zero.

    Attributes
    ----------
    state : StaticState
        Mean torques of the elements at this speed.
    powers : mapping of str to float
        By node, power from outside in W: above zero where it drives, below zero where it is taken.
    """

    state: StaticState
    powers: Mapping[str, float]

    @property
    def given(self) -> float:
        """Sum of the powers of all drivers in W."""
        return sum(max(power, 0.0) for power in self.powers.values())

    @property
    def taken(self) -> float:
        """Sum of the powers of all absorbers in W, a positive number."""
        return -sum(min(power, 0.0) for power in self.powers.values())

    @property
    def torque(self) -> float:
        """Torque T = P/omega in N m that all absorbed power P would have at the speed of the reference shaft."""
        return self.taken / abs(self.state.speed)

    @property
    def largest_loss(self) -> float:
        """Largest difference in W between the power into an element at its first port and out of it at other ports.

        Zero but for rounding, as gears and shafts pass on what they get; 0 without elements of several ports.
        """
        balance: dict[str, float] = {}
        ports: dict[str, int] = {}
        for load in self.state.loads:
            power = load.power or 0.0
            balance[load.element] = balance.get(load.element, 0.0) + (-power if load.element in ports else power)
            ports[load.element] = ports.get(load.element, 0) + 1
        return max((abs(rest) for name, rest in balance.items() if ports[name] > 1), default=0.0)
