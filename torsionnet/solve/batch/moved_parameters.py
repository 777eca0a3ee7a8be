"""What of a drivetrain follows varied parameters, before its elements are asked."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from torsionnet.model.definition import Definition
from torsionnet.model.element_base.curves import OnCurve


def derived_from(definition: Definition, names: Collection[str], order: Collection[str]) -> Iterator[str]:
    """Parameters that follow others, in the ``order`` of evaluation."""
    moved = set(names)
    for name in order:
        if name not in moved and definition.parameters[name].value.names & moved:
            moved.add(name)
            yield name


def operating_point_moves(definition: Definition, moved: Collection[str], names: Collection[str]) -> bool:
    """Whether mean speeds and torques, or what is read off curves at them, depend on what is varied.

    ``moved`` are all parameters that do, ``names`` those of them that are varied themselves.
    """
    point, moving = definition.operating_point, frozenset(moved)
    if any(value.names & moving for table in (point.speed, point.torque) for value in table.values()):
        return True
    if definition.following.keys() <= set(names):
        return False
    return any(
        isinstance(spec, OnCurve) and expression.names & moving
        for element in definition.active
        for _, spec, expression, _ in element.expressions()
    )
