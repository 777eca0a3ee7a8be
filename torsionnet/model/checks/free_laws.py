"""Checks of laws of motion where linear results hold: gaps that stand open, friction that sticks, and loops of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from torsionnet.base.errors import Fault, named_list
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element import Element, OtherLaws
from torsionnet.model.elements import Constraint, Law, MotionLaw, Part, Row, Values
from torsionnet.model.elimination import reduce_rows
from torsionnet.model.kinematics import Kinematics, solve_kinematics
from torsionnet.model.parameters import resolve


def open_gaps(definition: Definition, values: Mapping[str, Any], kinematics: Kinematics) -> list[Fault]:
    """Notes on elements in whose gap a drivetrain without an operating point has a free motion.

    Rows that ``kinematics`` hold, as between two locked nodes, cannot move anyway.
    """
    value = Values(values)
    text = (
        "{} stands open in linear results, as nothing presses its sides together, and these move on their own; at an "
        "operating point with a torque through it, it has its stiffness in contact"
    )
    return [
        Fault(phrase(text, ModelName(element.name)), ("elements", element.name), "note", on_key=True)
        for element in definition.active
        if element.has_motion_laws and _is_open(element, value, kinematics)
    ]


def with_gaps_closed(definition: Definition, kinematics: Kinematics) -> tuple[Kinematics, tuple[str, ...]]:
    """Kinematics of a drivetrain whose gaps are closed by torques, and the names of the elements that have these."""
    value = Values(resolve(definition.parameters)[0])
    closed = tuple(
        element.name
        for element in definition.active
        if element.has_motion_laws and _is_open(element, value, kinematics)
    )
    if not closed:
        return kinematics, ()
    elements = {name: definition.elements[name].with_laws(ClosedLaws(definition.elements[name])) for name in closed}
    changed = replace(definition, elements={**definition.elements, **elements}, tangents=None)
    return solve_kinematics(changed, value), closed


def stuck_friction(
    definition: Definition, values: Mapping[str, Any], kinematics: Kinematics, *, operated: bool
) -> list[Fault]:
    """Notes on elements that are rigid in linear results, as their friction sticks.

    Where an operating point is given, it says which friction sticks; only that beside springs on the same row sticks at
    any, as these take all the mean torque. Rows that ``kinematics`` hold without friction are rigid anyway.
    """
    value = Values(values)
    text = "{} sticks in linear results, and is rigid there; {}"
    return [
        Fault(
            phrase(text, ModelName(element.name), element.when_stuck), ("elements", element.name), "note", on_key=True
        )
        for element in definition.active
        if element.when_stuck and element.has_motion_laws and _is_stuck(element, value, kinematics, operated)
    ]


def _is_stuck(element: Element, value: Values, kinematics: Kinematics, operated: bool) -> bool:
    """Whether friction of an element holds one of its rows, with springs beside it if it is ``operated``."""
    held = [part.row for part in element.parts(value) if isinstance(part, Constraint)]
    laws = [law for law in _laws(element, value) if law.row in held and not kinematics.holds_row(law.row)]
    rubbing = [law.row for law in laws if law.curve.over == "rate"]
    if not operated:
        return bool(rubbing)
    return any(
        part.row in rubbing
        for part in element.whole_parts(value)
        if (isinstance(part, Law) and part.is_elastic) or (isinstance(part, MotionLaw) and part.curve.over == "twist")
    )


def sticking_loops(definition: Definition, values: Mapping[str, Any], kinematics: Kinematics) -> list[Fault]:
    """Notes on elements that stick side by side, which leave open how they share a torque.

    ``kinematics`` are those in which nothing sticks; what these hold does not count.
    """
    value, owners = Values(values), list[str]()
    rows: list[Mapping[str, Any]] = []
    for element in definition.active:
        for row in _held_rows(element, value) if element.has_motion_laws else ():
            reduced = kinematics.reduction.reduced(row)
            if reduced:
                rows.append(reduced)
                owners.append(element.name)
    order = {name: number for number, name in enumerate(dict.fromkeys(name for row in rows for name in row))}
    reduction = reduce_rows(rows, order)
    notes = []
    # A row that follows from others: their frictions may share the torque in any way.
    for last in reduction.redundant:
        names = dict.fromkeys(owners[number] for number in sorted({*reduction.origin_of_row(last), last}))
        text = phrase(
            "{} stick in a loop, so that a motion over time cannot tell how they share a torque; "
            "give one of them a stiffness",
            named_list(names, between=" and "),
        )
        notes.append(Fault(text, ("elements", owners[last]), "note", on_key=True))
    return notes


def _is_open(element: Element, value: Values, kinematics: Kinematics) -> bool:
    """Whether nothing of an element acts on a row that one of its laws over the twist has."""
    acting = [
        part.row
        for part in element.parts(value)
        if isinstance(part, Constraint) or (isinstance(part, Law) and part.acts)
    ]
    laws = [law for law in _laws(element, value) if law.row not in acting and not kinematics.holds_row(law.row)]
    return any(law.curve.over == "twist" for law in laws)


def _laws(element: Element, value: Values) -> list[MotionLaw]:
    return [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]


def loose_kinematics(definition: Definition, values: Mapping[str, Any]) -> Kinematics | None:
    """Kinematics in which no law of motion holds its row still, as it may move all the same; None if none does."""
    value = Values(values)
    holding = [element.name for element in definition.active if element.has_motion_laws and _holds(element, value)]
    if not holding:
        return None
    loose = {name: definition.elements[name].with_laws(LooseLaws(definition.elements[name])) for name in holding}
    changed = replace(definition, elements={**definition.elements, **loose}, tangents=None)
    return solve_kinematics(changed, value)


def _holds(element: Element, value: Values) -> bool:
    """Whether one of an element's laws of motion stands still, as friction that sticks."""
    return bool(_held_rows(element, value))


def _held_rows(element: Element, value: Values) -> list[Row]:
    """Rows of laws of motion of an element that stand still."""
    held = [part.row for part in element.parts(value) if isinstance(part, Constraint)]
    rows: list[Row] = []
    for law in _laws(element, value):
        rows += [law.row] if law.row in held and law.row not in rows else []
    return rows


@dataclass(frozen=True)
class LooseLaws(OtherLaws):
    """Laws of an element in which its laws of motion do nothing."""

    def parts(self, value: Values) -> tuple[Part, ...]:
        whole = self.element.whole_parts(value)
        return tuple(Law(part.row) if isinstance(part, MotionLaw) else part for part in whole)


@dataclass(frozen=True)
class ClosedLaws(OtherLaws):
    """Laws of an element in which its gaps are closed; the stiffness does not count."""

    def parts(self, value: Values) -> tuple[Part, ...]:
        whole = self.element.whole_parts(value)
        return tuple(
            Law(part.row, stiffness=int(part.curve.over == "twist")) if isinstance(part, MotionLaw) else part
            for part in whole
        )
