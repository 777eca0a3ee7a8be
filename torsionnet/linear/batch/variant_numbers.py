"""Numbers that hold a parameter's value in all variants, with which elements evaluate their laws at once.

Elements decide by values now and then. Such a decision falls as the first variant has it; those of which it would fall
otherwise are left for another pass, in which one of them is the first. No decision is guessed at.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.expressions import Algebra
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.elements import Action, Element, Law, Part, Values

CANCELLATION_RATIO = 1e-3
"""Ratio of a sum to its terms below which the sum has lost digits that exact fractions would have kept."""
MOST_PASSES = 64
"""Most passes over variants, one per combination of decisions, beyond which variants are looked at one by one."""


class Decisions:
    """Record of which variants decide like the first one wherever an element chooses by a parameter value.

    Attributes
    ----------
    follows : (n,) boolean array
        Variants of which every decision falls as for the first.
    unsure : (n,) boolean array
        Variants whose numbers have lost digits or are not finite.
    """

    def __init__(self, count: int) -> None:
        self.follows = np.ones(count, dtype=bool)
        self.unsure = np.zeros(count, dtype=bool)

    def decide(self, answers: Any) -> bool:
        """Truth of a comparison for the first variant, after marking the variants for which it differs."""
        first = bool(answers[0])
        self.follows &= answers if first else ~answers
        return first


class VariantNumber:
    """Parameter value in every variant, shape (n,), on which elements calculate as on one number."""

    __slots__ = ("decisions", "values")
    __array_ufunc__ = None  # numpy leaves arithmetic with it to the methods below

    def __init__(self, values: FloatArray, decisions: Decisions) -> None:
        self.values: FloatArray = values
        self.decisions: Decisions = decisions

    def _new(self, values: FloatArray) -> VariantNumber:
        return VariantNumber(values, self.decisions)

    def _sum(self, first: Any, second: Any) -> VariantNumber:
        total = first + second
        # A sum far below its terms has lost digits, where the exact fractions of a single model keep them.
        self.decisions.unsure |= (np.abs(total) < CANCELLATION_RATIO * np.abs(first)) & (total != 0)
        return self._new(total)

    def __add__(self, other: Any) -> VariantNumber:
        return self._sum(self.values, _plain(other))

    def __sub__(self, other: Any) -> VariantNumber:
        return self._sum(self.values, -_plain(other))

    def __rsub__(self, other: Any) -> VariantNumber:
        return self._sum(-self.values, _plain(other))

    def __mul__(self, other: Any) -> VariantNumber:
        return self._new(self.values * _plain(other))

    def __truediv__(self, other: Any) -> VariantNumber:
        return self._new(self.values / _plain(other))

    def __rtruediv__(self, other: Any) -> VariantNumber:
        return self._new(_plain(other) / self.values)

    def __pow__(self, power: int) -> VariantNumber:
        return self._new(self.values ** float(power))

    def __neg__(self) -> VariantNumber:
        return self._new(-self.values)

    def __abs__(self) -> VariantNumber:
        return self._new(np.abs(self.values))

    __radd__ = __add__
    __rmul__ = __mul__

    def _compared(self, other: Any, how: Callable[[Any, Any], Any]) -> Any:
        if not isinstance(other, VariantNumber | Fraction | int | float):
            return NotImplemented
        return self.decisions.decide(how(self.values, _plain(other)))

    def __eq__(self, other: object) -> Any:
        return self._compared(other, operator.eq)

    def __lt__(self, other: Any) -> Any:
        return self._compared(other, operator.lt)

    def __le__(self, other: Any) -> Any:
        return self._compared(other, operator.le)

    def __gt__(self, other: Any) -> Any:
        return self._compared(other, operator.gt)

    def __ge__(self, other: Any) -> Any:
        return self._compared(other, operator.ge)

    def __bool__(self) -> bool:
        return self.decisions.decide(self.values != 0)

    def __float__(self) -> float:
        self.decisions.decide(self.values == self.values[0])
        return float(self.values[0])

    def __hash__(self) -> int:
        return hash(float(self))


def _plain(number: Any) -> Any:
    return number.values if isinstance(number, VariantNumber) else float(number)


def _root(number: Any) -> Any:
    if number < 0:
        raise ArithmeticError("the square root of a negative number is not real")
    if isinstance(number, VariantNumber):
        return VariantNumber(np.sqrt(number.values), number.decisions)
    return math.sqrt(number)


VARIANTS = Algebra(number=Fraction, sqrt=_root, pi=math.pi)
"""Arithmetic for expressions in which some parameters are a :class:`VariantNumber`."""


def variant_column(number: Any, count: int) -> FloatArray:
    """Values (count,) of a number in every variant, where a plain number is the same in all."""
    return number.values if isinstance(number, VariantNumber) else np.full(count, float(number))


def passes_over_variants(count: int) -> Iterator[tuple[NDArray[np.intp], Decisions]]:
    """Yield indices of variants and a record of their decisions, until each variant has followed a first one.

    Variants of a combination of decisions beyond :data:`MOST_PASSES` come in no pass.
    """
    rest = np.arange(count)
    for _ in range(MOST_PASSES):
        if not len(rest):
            return
        decisions = Decisions(len(rest))
        yield rest, decisions
        # The first variant follows itself, so that every pass takes at least one away.
        rest = rest[~decisions.follows]


# Elements that depend on varied parameters, and the numbers of their laws in the arrays of a drivetrain.


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

    def has_rows_of(self, parts: tuple[Part, ...]) -> bool:
        """Whether ``parts`` act on the same rows as those of the element, so that only coefficients differ."""
        return len(self.parts) == len(parts) and all(
            type(own) is type(other) and (own.row == other.row if isinstance(own, Law) else own == other)
            for own, other in zip(self.parts, parts, strict=True)
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
    active, planned = {element.name: element for element in definition.active}, []
    for name, declared in definition.elements.items():
        element, asked = active.get(name, declared), _RecordedLookups(numbers)
        # The element's own laws, evaluated in numbers of all variants, show which parameters they look up.
        parts = element.parts(Values(asked, VARIANTS))
        entries = (expression.names for _, _, expression, _ in element.expressions())
        if not asked.names.union(*entries) & moved:
            continue
        # A ratio or a controller's law that varies is more than a coefficient on fixed rows.
        if name in active and any(map(_is_moving, parts)):
            return None
        own = known.get(name, [])
        # Diameters set the section modulus, with which stresses scale beside any law.
        stressed = name in active and any(diameter.names & moved for diameter in element.diameters or ())
        laws = tuple(number for part, number in own if isinstance(part, Law))
        planned.append(PlannedElement(element, tuple(part for part, _ in own), laws, stressed))
    return planned


def _numbered(drivetrain: AssembledModel) -> dict[str, list[tuple[Part, int | None]]]:
    """Springs, dampers, inertias and constraints of a drivetrain by element, each with the number of its law.

    The number is None for what is no acting law.
    """
    numbered: dict[str, list[tuple[Part, int | None]]] = {}
    count = 0
    for owned in drivetrain.assembly.kinematics.parts:
        # Laws without any coefficient have no column in the arrays.
        acts = isinstance(owned.part, Law) and owned.part.acts
        numbered.setdefault(owned.element, []).append((owned.part, count if acts else None))
        count += acts
    return numbered


def _is_moving(part: Part) -> bool:
    numbers = list(part.row.values())
    if isinstance(part, Action):
        numbers += [*part.sensed.values(), *part.numerator, *part.denominator, part.delay]
    return any(isinstance(number, VariantNumber) for number in numbers)
