"""The round section of a shaft, solid or hollow."""

from __future__ import annotations

from typing import Any

from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Number


def section_faults(element: Any) -> list[Fault]:
    """What is wrong with the outer and inner diameter of an element; a spring may do without both."""
    inner, outer = element.inner_diameter, element.outer_diameter
    if outer is None:
        return [] if inner == Number(0) else [Fault("inner_diameter needs outer_diameter too", ("inner_diameter",))]
    if isinstance(inner, Number) and isinstance(outer, Number) and inner.value >= outer.value:
        return [Fault("the inner diameter must be smaller than the outer diameter", ("inner_diameter",))]
    return []
