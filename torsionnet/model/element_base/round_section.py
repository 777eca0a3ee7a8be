"""Round section of a shaft, solid or hollow: faults of its diameters, section modulus."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.expressions import Number
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.element_base.laws import Values

if TYPE_CHECKING:
    from torsionnet.model.element_base.element import Element


def section_faults(element: Any) -> list[Fault]:
    """Faults of an element's outer and inner diameter that contradict each other or are missing.

    A spring may leave out both.
    """
    inner, outer = element.inner_diameter, element.outer_diameter
    if outer is None:
        return (
            []
            if inner == Number(0)
            else [Fault("inner_diameter needs outer_diameter too", ("inner_diameter",), kind="missing-entry")]
        )
    if isinstance(inner, Number) and isinstance(outer, Number) and inner.value >= outer.value:
        return [
            Fault(
                "the inner diameter must be smaller than the outer diameter",
                ("inner_diameter",),
                kind="contradicting-values",
            )
        ]
    return []


def section_fault(element: Element) -> str | None:
    """Message if an element has no diameter and so no shear stress, else None."""
    if element.diameters is not None:
        return None
    said = "{}, a {}, has no diameter, and so no stress; take a shaft, or measure its torque"
    return phrase(said, ModelName(element.name), element.kind)


def section_modulus(element: Element, value: Values) -> Any:
    """Polar section modulus in m^3 of a round shaft, solid or hollow.

    Raises
    ------
    UsageError
        The element has no diameter.
    """
    if element.diameters is None:
        raise UsageError(str(section_fault(element)), kind="missing-entry")
    outer, inner = map(value, element.diameters)
    return value.algebra.pi * (outer**4 - inner**4) / (16 * outer)
