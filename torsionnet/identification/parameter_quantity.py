"""Unit, dimension and physical bounds of a parameter, from the elements of a model that use it."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.expressions import Name
from torsionnet.base.units import expected_unit
from torsionnet.identification.orders.parametric_orders import numbers_of_excitations
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.model.parameters import dimensions


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
        for spec, value in element_in.scalars().values():
            for _, expression, dimension in spec.expressions(value):
                if isinstance(expression, Name) and expression.name == name and isinstance(spec, QuantityKind):
                    return _of(spec, dimension)
    dimension_of = dimensions(model.definition.parameters)[0].get(name)
    return ParameterQuantity("" if dimension_of is None else str(dimension_of).removeprefix("1"))


def _of(spec: QuantityKind[object], dimension: str) -> ParameterQuantity:
    unit = expected_unit(dimension)
    # A measure of damping, such as a damping ratio, is as positive as the damping that it stands for.
    return ParameterQuantity("" if unit == "1" else unit, dimension, (-inf if spec.lower is None else spec.lower, inf))
