"""Laws and constraints in words, for what a format has no words for."""

from __future__ import annotations

from typing import Any

from torsionnet.model.elements import Action, Element, Law, Part


def unwritten(element: Element, part: Part) -> str:
    """An element and the part of it that cannot be written.

    >>> import torsionnet as tn
    >>> from torsionnet.model.elements import Values
    >>> stage = tn.Gear("stage", nodes=("a", "b"), ratio=3, stiffness=100)
    >>> unwritten(stage, stage.parts(Values({}))[0])
    'stage (gear), stiffness on a - 3*b'
    """
    return f"{element.name} ({element.kind}), {part_words(part)}"


def part_words(part: Part) -> str:
    """What acts, and on which weighted sum of angles."""
    if isinstance(part, Action):
        return f"torque on {row_words(part.row)} that follows {row_words(part.sensed)}"
    if not isinstance(part, Law):
        return f"constraint {row_words(part.row)} = 0"
    found = {
        "inertia": part.inertia != 0,
        "damping": part.damping != 0,
        "stiffness": part.stiffness != 0,
        "loss factor": part.loss_factor != 0,
        "table over frequency": part.table is not None,
    }
    names = [name for name, is_there in found.items() if is_there]
    return f"{' and '.join(names)} on {row_words(part.row)}"


def row_words(row: dict[str, Any]) -> str:
    """A weighted sum of angles by the names of the nodes; ``0`` for none.

    >>> row_words({"a": 1, "b": -2.5})
    'a - 2.5*b'
    """
    text = ""
    for node, share in row.items():
        size = abs(float(share))
        sign = "-" if float(share) < 0 else "+"
        text += f" {sign} " if text else sign.replace("+", "")
        text += node if size == 1 else f"{size:g}*{node}"
    return text or "0"
