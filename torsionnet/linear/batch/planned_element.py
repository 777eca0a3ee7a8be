"""Elements that depend on varied parameters, and the numbers of their laws in the arrays of a drivetrain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.batch.variant_numbers import VARIANTS, VariantNumber
from torsionnet.model.elements import Action, Element, Law, Part, Values


@dataclass(frozen=True, eq=False)
class PlannedElement:
    """Element that depends on varied parameters, with its parts and the numbers of its laws.

    Attributes
    ----------
    element : Element
    parts : tuple of Part
        Its own in the drivetrain as it is; none if it is switched off.
    laws : tuple of int or None
        Numbers of its laws in the arrays; None for one that does not act.
    is_stressed : bool
        Whether its section depends on varied parameters.
    """

    element: Element
    parts: tuple[Part, ...]
    laws: tuple[int | None, ...]
    is_stressed: bool

    @property
    def is_on(self) -> bool:
        return bool(self.parts)

    def has_rows_of(self, found: tuple[Part, ...]) -> bool:
        """Whether ``found`` parts act on the same rows as those of the element, so that only coefficients differ."""
        return len(self.parts) == len(found) and all(
            type(one) is type(other) and (one.row == other.row if isinstance(one, Law) else one == other)
            for one, other in zip(self.parts, found, strict=True)
        )


class _RecordedLookups(dict[str, Any]):
    """Dictionary of parameter values that records which names were looked up."""

    def __init__(self, numbers: Mapping[str, Any]) -> None:
        super().__init__(numbers)
        self.names: set[str] = set()

    def __getitem__(self, name: str) -> Any:
        self.names.add(name)
        return super().__getitem__(name)


def planned_elements(
    drivetrain: AssembledModel, numbers: Mapping[str, Any], moved: frozenset[str]
) -> list[PlannedElement] | None:
    """Elements that depend on the parameters ``moved``, or None if a row or a controller's law depends on them.

    ``numbers`` are the values of all parameters, those ``moved`` as :class:`VariantNumber`.
    """
    definition, known = drivetrain.definition, _numbered(drivetrain)
    active, found = {element.name: element for element in definition.active}, []
    for name, declared in definition.elements.items():
        element, asked = active.get(name, declared), _RecordedLookups(numbers)
        parts = element.parts(Values(asked, VARIANTS))
        entries = (expression.names for _, _, expression, _ in element.expressions())
        if not asked.names.union(*entries) & moved:
            continue
        if name in active and any(map(_is_moving, parts)):
            return None
        own = known.get(name, [])
        stressed = name in active and any(one.names & moved for one in element.diameters or ())
        laws = tuple(number for part, number in own if isinstance(part, Law))
        found.append(PlannedElement(element, tuple(part for part, _ in own), laws, stressed))
    return found


def _numbered(drivetrain: AssembledModel) -> dict[str, list[tuple[Part, int | None]]]:
    """Springs, dampers, inertias and constraints of a drivetrain by element, each with the number of its law.

    It is None for what is no acting law.
    """
    found: dict[str, list[tuple[Part, int | None]]] = {}
    count = 0
    for owned in drivetrain.assembly.kinematics.parts:
        acts = isinstance(owned.part, Law) and owned.part.acts
        found.setdefault(owned.element, []).append((owned.part, count if acts else None))
        count += acts
    return found


def _is_moving(part: Part) -> bool:
    numbers = list(part.row.values())
    if isinstance(part, Action):
        numbers += [*part.sensed.values(), *part.numerator, *part.denominator, part.delay]
    return any(isinstance(one, VariantNumber) for one in numbers)
