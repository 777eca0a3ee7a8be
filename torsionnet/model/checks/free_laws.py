"""Checks of laws of motion where linear results hold: gaps that stand open, and friction that sticks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from torsionnet.core.errors import Fault
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element import Element
from torsionnet.model.elements import Constraint, Law, MotionLaw, Part, Values
from torsionnet.model.kinematics import Kinematics, solve_kinematics
from torsionnet.model.parameters import resolve


def open_gaps(definition: Definition, values: Mapping[str, Any]) -> list[Fault]:
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


def with_gaps_closed(definition: Definition, kinematics: Kinematics) -> tuple[Kinematics, tuple[str, ...]]:
    """Kinematics of a drivetrain whose gaps are closed by torques, and the names of the elements that have these."""
    value = Values(resolve(definition.parameters)[0])
    closed = tuple(one.name for one in definition.active if one.has_motion_laws and _is_open(one, value))
    if not closed:
        return kinematics, ()
    elements = {name: definition.elements[name].with_laws(ClosedParts(definition.elements[name])) for name in closed}
    changed = replace(definition, elements={**definition.elements, **elements}, tangents=None)
    return solve_kinematics(changed, value), closed


def _is_open(element: Element, value: Values) -> bool:
    """Whether nothing of an element acts on a row that one of its laws over the twist has."""
    acting = [
        part.row
        for part in element.parts(value)
        if isinstance(part, Constraint) or (isinstance(part, Law) and part.acts)
    ]
    return any(law.curve.over == "twist" and law.row not in acting for law in _laws(element, value))


def _laws(element: Element, value: Values) -> list[MotionLaw]:
    return [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]


def loose_kinematics(definition: Definition, values: Mapping[str, Any]) -> Kinematics | None:
    """Kinematics in which no law of motion holds its row still, as it may move all the same; None if none does."""
    value = Values(values)
    holding = [one.name for one in definition.active if one.has_motion_laws and _holds(one, value)]
    if not holding:
        return None
    loose = {name: definition.elements[name].with_laws(LooseParts(definition.elements[name])) for name in holding}
    changed = replace(definition, elements={**definition.elements, **loose}, tangents=None)
    return solve_kinematics(changed, value)


def _holds(element: Element, value: Values) -> bool:
    """Whether one of an element's laws of motion stands still, as friction that sticks."""
    held = [part.row for part in element.parts(value) if isinstance(part, Constraint)]
    return any(law.row in held for law in _laws(element, value))


@dataclass(frozen=True)
class LooseParts:
    """Replacement of the method ``parts`` of an element, in which its laws of motion do nothing."""

    element: Element

    def __call__(self, value: Values) -> tuple[Part, ...]:
        whole = self.element.whole_parts(value)
        return tuple(Law(part.row) if isinstance(part, MotionLaw) else part for part in whole)


@dataclass(frozen=True)
class ClosedParts:
    """Replacement of the method ``parts`` of an element, in which its gaps are closed; the stiffness does not count."""

    element: Element

    def __call__(self, value: Values) -> tuple[Part, ...]:
        whole = self.element.whole_parts(value)
        return tuple(
            Law(part.row, stiffness=int(part.curve.over == "twist")) if isinstance(part, MotionLaw) else part
            for part in whole
        )
