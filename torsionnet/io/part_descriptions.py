"""Descriptions of laws and constraints in words, for messages about what an export format cannot hold."""

from __future__ import annotations

from typing import Any

from torsionnet.model.elements import Action, Element, Law, Part


def describe_element_part(element: Element, part: Part) -> str:
    """Name and type of an element with the law or constraint of it that cannot be written.

    >>> import torsionnet as tn
    >>> from torsionnet.model.elements import Values
    >>> stage = tn.Gear("stage", nodes=("a", "b"), ratio=3, stiffness=100)
    >>> describe_element_part(stage, stage.parts(Values({}))[0])
    'stage (gear), stiffness on a - 3*b'
    """
    return f"{element.name} ({element.kind}), {describe_part(part)}"


def describe_part(part: Part) -> str:
    """Description of a law, constraint or action in words, what acts, and on which weighted sum of angles."""
    if isinstance(part, Action):
        return f"torque on {row_text(part.row)} that follows {row_text(part.sensed)}"
    if not isinstance(part, Law):
        return f"constraint {row_text(part.row)} = 0"
    found = {
        "inertia": part.inertia != 0,
        "damping": part.damping != 0,
        "stiffness": part.stiffness != 0,
        "loss factor": part.loss_factor != 0,
        "table over frequency": part.table is not None,
    }
    names = [name for name, is_there in found.items() if is_there]
    return f"{' and '.join(names)} on {row_text(part.row)}"


def row_text(row: dict[str, Any]) -> str:
    """Text of a weighted sum of angles by the names of the nodes; ``0`` for an empty one.

    >>> row_text({"a": 1, "b": -2.5})
    'a - 2.5*b'
    """
    text = ""
    for node, share in row.items():
        size = abs(float(share))
        sign = "-" if float(share) < 0 else "+"
        text += f" {sign} " if text else sign.replace("+", "")
        text += node if size == 1 else f"{size:g}*{node}"
    return text or "0"
