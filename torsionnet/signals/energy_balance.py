"""Energy balance of motion over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property


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


class DeferredBalance(EnergyBalance):
    """Energy balance worked out when it is first asked for, since works of many dampers cost more than the motion.

    >>> DeferredBalance(lambda: EnergyBalance(10.0, 7.5, {"clutch": 2.5}))
    EnergyBalance(supplied=10.0, stored=7.5, dissipated={'clutch': 2.5})
    """

    def __init__(self, work_out: Callable[[], EnergyBalance]) -> None:
        self.__dict__["_work_out"] = work_out

    @cached_property
    def _found(self) -> EnergyBalance:
        found: EnergyBalance = self.__dict__.pop("_work_out")()
        return found

    @property
    def supplied(self) -> float:
        return self._found.supplied

    @property
    def stored(self) -> float:
        return self._found.stored

    @property
    def dissipated(self) -> Mapping[str, float]:
        return self._found.dissipated

    def __eq__(self, other: object) -> bool:
        return self._found == other

    def __repr__(self) -> str:
        return repr(self._found)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[EnergyBalance], tuple[float, float, dict[str, float]]]:
        return EnergyBalance, (self.supplied, self.stored, dict(self.dissipated))
