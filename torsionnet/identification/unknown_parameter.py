"""Unknown parameter of a fit with its start value, bounds and prior."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Name
from torsionnet.base.units import expected_unit
from torsionnet.identification.orders.parametric_orders import numbers_of_excitations
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.model.parameters import dimensions

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
            raise UsageError(f"a start value is a finite number in SI, got {self.start}", kind="not-finite")
        for size in (self.start, *(self.prior or ()), *(self.bounds or ())):
            if size and np.isfinite(size) and not 1 / LARGEST_SIZE < abs(size) < LARGEST_SIZE:
                raise UsageError(
                    f"{size:g} is out of range for a parameter ({1 / LARGEST_SIZE:g} to {LARGEST_SIZE:g} in SI); "
                    "check its unit",
                    kind="implausible-size",
                )
        if self.bounds is not None and not self.bounds[0] < self.bounds[1]:
            raise UsageError(f"the lower bound must be below the upper bound, got {self.bounds}", kind="unordered-rows")
        if self.prior is not None and not self.prior[1] > 0:
            raise UsageError(
                f"a prior is a mean and a standard deviation above 0, got {self.prior}", kind="out-of-range"
            )


def read_unknowns(parameters: str | Sequence[str] | Mapping[str, Unknown | float | None]) -> dict[str, Unknown]:
    """Unknown parameters of a fit by name, from names alone, or names with a start value or an :class:`Unknown`.

    >>> read_unknowns({"c_O": 100, "c_B": None})["c_O"].start
    100.0
    """
    if isinstance(parameters, str):
        parameters = [parameters]
    if not isinstance(parameters, Mapping):
        unknowns = {name: Unknown() for name in parameters}
    else:
        unknowns = {name: _one(name, given) for name, given in parameters.items()}
    if not unknowns:
        raise UsageError("name at least one parameter to be found", kind="missing-entry")
    return unknowns


def _one(name: str, given: Unknown | float | None) -> Unknown:
    if isinstance(given, Unknown):
        return given
    if given is None:
        return Unknown()
    try:
        return Unknown(float(given))
    except (TypeError, ValueError):
        raise UsageError(
            f"{name}: expected a start value in SI or Unknown(...), got {given!r}", kind="wrong-form"
        ) from None


# Unit, dimension and physical bounds of a parameter, from the elements of a model that use it.


@dataclass(frozen=True)
class ParameterQuantity:
    """Unit, dimension and physical bounds of a parameter or a field of an element.

    Attributes
    ----------
    unit : str
        SI; empty for a plain number.
    dimension : str
        ``"damping"``, ``"stiffness"``, ...; empty if no element uses the parameter as such.
    bounds : tuple of float
        Lowest and highest value that is physically possible, SI.
    """

    unit: str = ""
    dimension: str = ""
    bounds: tuple[float, float] = (-inf, inf)


def parameter_quantity(model: AssembledModel, name: str) -> ParameterQuantity:
    """Unit, dimension and bounds of a parameter of a model, of ``element.field`` or of a number of an excitation.

    >>> import torsionnet as tn
    >>> parameter_quantity(tn.load("dmf_rig"), "k_2")
    ParameterQuantity(unit='N*m/rad', dimension='stiffness', bounds=(0.0, inf))
    """
    number = numbers_of_excitations(model, [name]).get(name)
    if number is not None:
        return ParameterQuantity(number.unit, number.dimension, number.bounds)
    element, _, field = name.rpartition(".")
    if name not in model.definition.parameters and element in model.definition.elements:
        spec, _ = model.definition.elements[element].scalars().get(field, (None, None))
        return _of(spec, spec.dimension) if isinstance(spec, QuantityKind) else ParameterQuantity()
    for element_in in model.definition.elements.values():
        for _, spec, expression, dimension in element_in.expressions():
            if isinstance(expression, Name) and expression.name == name and isinstance(spec, QuantityKind):
                return _of(spec, dimension)
    dimension_of = dimensions(model.definition.parameters)[0].get(name)
    return ParameterQuantity("" if dimension_of is None else str(dimension_of).removeprefix("1"))


def _of(spec: QuantityKind[object], dimension: str) -> ParameterQuantity:
    unit = expected_unit(dimension)
    # A measure of damping, such as a damping ratio, is as positive as the damping that it stands for.
    return ParameterQuantity("" if unit == "1" else unit, dimension, (-inf if spec.lower is None else spec.lower, inf))
