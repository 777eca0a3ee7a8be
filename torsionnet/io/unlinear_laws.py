"""Refusal of laws of motion by formats that hold linear elements only."""

from __future__ import annotations

from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.elements import MotionLaw, Values
from torsionnet.model.law_network import following_elements

MOST_NAMES = 5
"""Most elements that the message names; the rest are counted."""


def refuse_laws_of_motion(drivetrain: Drivetrain, target: str) -> None:
    """Refuse a drivetrain whose laws of motion have no operating point, for a format that holds their tangents.

    Raises
    ------
    UsageError
        Naming the elements, and what gives them an operating point.
    """
    definition = drivetrain.definition
    if definition.tangents is not None and definition.tangents.is_loaded:
        return
    value = Values(drivetrain.exact_values)
    found = [
        f"{one.name} ({one.kind})"
        for one in following_elements(definition)
        if any(isinstance(part, MotionLaw) for part in one.whole_parts(value))
    ]
    if not found:
        return
    rest = f" and {len(found) - MOST_NAMES} more" if len(found) > MOST_NAMES else ""
    raise UsageError(
        f"{target} holds linear elements, and {', '.join(found[:MOST_NAMES])}{rest} follow laws of motion that are not "
        "linear; write the model at an operating point, which has their tangents: model.at(torque={...}), or load: or "
        "operating_point: in its file"
    )
