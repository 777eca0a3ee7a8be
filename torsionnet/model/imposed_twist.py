"""Check whether a twist, as an error of teeth or of a joint, can be imposed in an element."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.model.elements import Element, Law, Part


def twist_fault(element: Element, parts: Sequence[Part]) -> str | None:
    """Message if no twist can be imposed in an element with these ``parts``, else None.

    >>> from torsionnet.model.elements.gears import Gear
    >>> from torsionnet.model.element_base.laws import Values
    >>> stage = Gear("stage", nodes=("a", "b"), ratio=2)
    >>> twist_fault(stage, stage.parts(Values({})))
    'stage is rigid: an imposed twist needs something that gives way; give it a stiffness'
    """
    laws = [part for part in parts if isinstance(part, Law) and part.acts]
    if len(laws) < len(parts):
        return f"{element.name} is rigid: an imposed twist needs something that gives way; give it a stiffness"
    if len(laws) == 1 and laws[0].inertia == 0:
        return None
    return f"{element.name} has inertia or several springs; impose the twist in a spring or a compliant gear beside it"
