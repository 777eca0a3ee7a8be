"""Unknown parameter of a fit with its start value, bounds and prior."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError

LARGEST_SIZE = 1e20
"""Largest size in SI of a start value, bound or prior, and the reciprocal of the smallest, beyond which it is a
mistake."""


@dataclass(frozen=True)
class Unknown:
    """Unknown parameter of a fit, with its start value, bounds and prior in SI.

    Attributes
    ----------
    start : float, optional
        SI; by default the value in the model.
    bounds : tuple of float, optional
        SI; by default those of the model file, else 0 and infinity for a value that begins above 0.
    prior : tuple of float, optional
        Mean and standard deviation known from elsewhere, SI; counts like a measurement.
    per_configuration : bool, optional
        Whether every measurement finds a value of its own instead of sharing one.
    """

    start: float | None = None
    bounds: tuple[float, float] | None = None
    prior: tuple[float, float] | None = None
    per_configuration: bool = False

    def __post_init__(self) -> None:
        if self.start is not None and not np.isfinite(self.start):
            raise UsageError(f"a start value is a finite number in SI, got {self.start}")
        for size in (self.start, *(self.prior or ()), *(self.bounds or ())):
            if size and np.isfinite(size) and not 1 / LARGEST_SIZE < abs(size) < LARGEST_SIZE:
                raise UsageError(
                    f"{size:g} is out of range for a parameter ({1 / LARGEST_SIZE:g} to {LARGEST_SIZE:g} in SI); "
                    "check its unit"
                )
        if self.bounds is not None and not self.bounds[0] < self.bounds[1]:
            raise UsageError(f"the lower bound must be below the upper bound, got {self.bounds}")
        if self.prior is not None and not self.prior[1] > 0:
            raise UsageError(f"a prior is a mean and a standard deviation above 0, got {self.prior}")


def read_unknowns(parameters: str | Sequence[str] | Mapping[str, Unknown | float | None]) -> dict[str, Unknown]:
    """Unknown parameters of a fit by name, from names alone, or names with a start value or an :class:`Unknown`.

    >>> read_unknowns({"c_O": 100, "c_B": None})["c_O"].start
    100.0
    """
    if isinstance(parameters, str):
        parameters = [parameters]
    if not isinstance(parameters, Mapping):
        found = {name: Unknown() for name in parameters}
    else:
        found = {name: _one(name, given) for name, given in parameters.items()}
    if not found:
        raise UsageError("name at least one parameter to be found")
    return found


def _one(name: str, given: Unknown | float | None) -> Unknown:
    if isinstance(given, Unknown):
        return given
    if given is None:
        return Unknown()
    try:
        return Unknown(float(given))
    except (TypeError, ValueError):
        raise UsageError(f"{name}: expected a start value in SI or Unknown(...), got {given!r}") from None
