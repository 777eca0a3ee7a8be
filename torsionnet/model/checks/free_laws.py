"""Notes on laws of motion that leave their sides free where linear results hold, as teeth within their backlash."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.core.errors import Fault
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element import Element
from torsionnet.model.elements import Constraint, Law, MotionLaw, Values


def free_laws(definition: Definition, values: Mapping[str, Any]) -> list[Fault]:
    """Notes on elements in whose gap a drivetrain without an operating point has a free motion."""
    value = Values(values)
    text = (
        "{} stands open in linear results, as nothing presses its sides together, and these move on their own; at an "
        "operating point with a torque through it, it has its stiffness in contact"
    )
    return [
        Fault(text.format(element.name), ("elements", element.name), "note", on_key=True)
        for element in definition.active
        if element.has_motion_laws and _is_open(element, value)
    ]


def _is_open(element: Element, value: Values) -> bool:
    """Whether nothing of an element acts on a row that one of its laws over the twist has."""
    whole = [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]
    acting = [
        part.row
        for part in element.parts(value)
        if isinstance(part, Constraint) or (isinstance(part, Law) and part.acts)
    ]
    return any(law.curve.over == "twist" and law.row not in acting for law in whole)
