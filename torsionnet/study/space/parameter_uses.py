"""Which entries of elements are nothing but a parameter, which then is of their kind."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.expressions import Name
from torsionnet.model.model import Model


@dataclass(frozen=True)
class ParameterUse:
    """An entry of an element: what it is, and the name of its dimension."""

    quantity: PhysicalQuantity
    dimension: str


def parameter_uses(model: Model) -> dict[str, list[ParameterUse]]:
    """Uses of every parameter that stands alone somewhere; those of the same kind once."""
    found: dict[str, dict[object, ParameterUse]] = {}
    for element in model.definition.elements.values():
        for _, spec, expression, dimension in element.expressions():
            if isinstance(expression, Name) and isinstance(spec, PhysicalQuantity):
                kind = dimension, spec.lower, spec.exclusive, spec.nonzero
                found.setdefault(expression.name, {}).setdefault(kind, ParameterUse(spec, dimension))
    return {name: list(uses.values()) for name, uses in found.items()}
