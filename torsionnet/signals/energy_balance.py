"""Energy balance of motion over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias


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


class DeferredBalance:
    """Energy balance worked out when it is first asked for, since works of many dampers cost more than the motion.

    It has the fields of an :class:`EnergyBalance`, and is stored as one.

    >>> DeferredBalance(lambda: EnergyBalance(10.0, 7.5, {"clutch": 2.5}))
    EnergyBalance(supplied=10.0, stored=7.5, dissipated={'clutch': 2.5})
    """

    def __init__(self, work_out: Callable[[], EnergyBalance]) -> None:
        self._work_out: Callable[[], EnergyBalance] | None = work_out

    @cached_property
    def balance(self) -> EnergyBalance:
        """Balance itself, after which what it was worked out from is no longer held."""
        assert self._work_out is not None
        balance, self._work_out = self._work_out(), None
        return balance

    @property
    def supplied(self) -> float:
        """Work of the torques from outside in J."""
        return self.balance.supplied

    @property
    def stored(self) -> float:
        """Rise of kinetic and stored energy in J."""
        return self.balance.stored

    @property
    def dissipated(self) -> Mapping[str, float]:
        """Energy in J that each element has turned into heat, by name."""
        return self.balance.dissipated

    @property
    def left_over(self) -> float:
        """Energy in J that the sums do not account for: the error of the calculation."""
        return self.balance.left_over

    def __eq__(self, other: object) -> bool:
        return self.balance == (other.balance if isinstance(other, DeferredBalance) else other)

    def __repr__(self) -> str:
        return repr(self.balance)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[EnergyBalance], tuple[float, float, dict[str, float]]]:
        return EnergyBalance, (self.supplied, self.stored, dict(self.dissipated))


AnyBalance: TypeAlias = EnergyBalance | DeferredBalance
"""Energy balance of a motion, worked out or not yet."""
