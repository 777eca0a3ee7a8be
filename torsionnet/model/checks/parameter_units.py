"""Units of the parameters of a model."""

from __future__ import annotations

from torsionnet.base.expressions import Name
from torsionnet.base.units import expected_unit
from torsionnet.model.definition import Definition
from torsionnet.model.parameters import dimensions


def parameter_units(definition: Definition) -> dict[str, str]:
    """SI unit of every parameter by name, by its use (N*m or N*m/rad) or else by its dimension.

    Empty for a plain number.

    Examples
    --------
    >>> import torsionnet as tn
    >>> parameter_units(tn.load("amt_rig").definition)["k_1"]
    'N*m/rad'
    """
    by_name = dimensions(definition.parameters)[0]
    units = {name: "" if dimension is None else str(dimension) for name, dimension in by_name.items()}
    for element in definition.elements.values():
        for _, _, expression, dimension in element.expressions():
            if isinstance(expression, Name) and dimension:
                units[expression.name] = expected_unit(dimension)
    return {name: "" if unit == "1" else unit for name, unit in units.items()}
