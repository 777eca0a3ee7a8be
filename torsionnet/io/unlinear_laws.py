"""Refusal of laws of motion by formats that hold linear elements only."""

from __future__ import annotations

from torsionnet.core.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.elements import Element, MotionLaw, Values

MOST_NAMES = 5
"""Most elements that the message names; the rest are counted."""


def refuse_laws_of_motion(drivetrain: Drivetrain, target: str) -> None:
    """Refuse a drivetrain whose laws of motion have no operating point, for a format that holds their tangents.

    Raises
    ------
    UsageError
        Naming the elements, and what gives them an operating point.
    """
    value = Values(drivetrain.exact_values)
    tangents = drivetrain.definition.tangents
    is_loaded = tangents is not None and tangents.is_loaded
    found = [
        f"{one.name} ({one.kind})"
        for one in drivetrain.elements.values()
        if not one.is_linearised(value) or not (is_loaded or _has_point_of_its_own(one, value))
    ]
    if not found:
        return
    rest = f" and {len(found) - MOST_NAMES} more" if len(found) > MOST_NAMES else ""
    raise UsageError(
        f"{target} holds linear elements, and {', '.join(found[:MOST_NAMES])}{rest} follow laws of motion that are not "
        "linear; write the model at an operating point, which has their tangents: model.at(torque={...}), or load: or "
        "operating_point: in its file"
    )


def _has_point_of_its_own(element: Element, value: Values) -> bool:
    """Whether an element is linear without an operating point of the drivetrain: by its entries, or as it is."""
    if not element.has_motion_laws or element.has_own_working_point:
        return True
    return not any(isinstance(part, MotionLaw) for part in element.whole_parts(value))
