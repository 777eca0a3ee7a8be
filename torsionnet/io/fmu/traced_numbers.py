"""Numbers that remember how they were calculated from parameters, so that a program can calculate them again.

Elements, constraints and readings run on such numbers as they do on fractions. Every decision on the way (a zero that
drops out, a loop of ratios that closes) falls on the present values. A second, arbitrary set of values, modulo a large
prime, tells whether a decision would have been the same for any values; if not, the parameters behind it are *settled*:
they must not change without the structure of the model changing.

Coordinates of the state space of an FMU, chosen so that its matrices have zeros where the mechanics has them. The kept
coordinates q of a drivetrain are changed, exactly, into three kinds:

    heavy    inertia acts on these, and on nothing else:      M h'' + ..
    damped   massless, but dampers act on these:              C b' + ..
    static   only springs act on these, which give them at once

Angles that change in a rigid-body motion are separate from angles relative to it, so that stiffnesses never see how far
a drivetrain has rotated: their columns for such an angle are empty, not merely small.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, TypeAlias

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Algebra, float_if_long
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import refuse_actions
from torsionnet.linear.modes.modular_arithmetic import residue
from torsionnet.model.elements import Law, Values
from torsionnet.model.elimination import exact, reduce_rows, substitute
from torsionnet.model.kinematics import Kinematics, kinematics_on
from torsionnet.model.parameters import Parameter, evaluation_order

CHECK_PRIME = 2**61 - 1
"""Prime modulus of the second set of values, large, so that other numbers are hardly ever equal by chance."""


@dataclass(frozen=True, eq=False)
class Traced:
    """Number that is recorded with its calculation, its value, and the operation on parameters that gave it.

    Attributes
    ----------
    tape : NumberTape
    value : Fraction
        Value with the present values of the parameters.
    other : int
        Value with the arbitrary values, modulo ``CHECK_PRIME``.
    place : int or None
        Place on the tape of the operation that gave the number; None for a constant.
    """

    tape: NumberTape
    value: Fraction
    other: int
    place: int | None = None

    @property
    def is_constant(self) -> bool:
        return self.place is None

    def __add__(self, right: Any) -> Traced:
        right = self.tape.number(right)
        if self.vanishes or right.vanishes:
            return right if self.vanishes else self
        return self.tape.operation("+", self, right, self.value + right.value, self.other + right.other)

    def __mul__(self, right: Any) -> Traced:
        right = self.tape.number(right)
        for factor, rest in ((self, right), (right, self)):
            if factor.is_constant and factor.value in (0, 1):
                return rest if factor.value else factor
        return self.tape.operation("*", self, right, self.value * right.value, self.other * right.other)

    def __truediv__(self, right: Any) -> Traced:
        right = self.tape.number(right)
        if right.is_constant and right.value == 1:
            return self
        if self.place is not None and self.place == right.place:
            return self.tape.number(1)
        # The check is divided modulo its prime.
        return self.tape.operation(
            "/", self, right, self.value / right.value, self.other * pow(right.other, -1, CHECK_PRIME)
        )

    def __neg__(self) -> Traced:
        if self.is_constant:
            return self.tape.number(-self.value)
        return self.tape.operation("*", self.tape.number(-1), self, -self.value, -self.other)

    def __sub__(self, right: Any) -> Traced:
        return self + (-self.tape.number(right))

    def __rsub__(self, left: Any) -> Traced:
        return self.tape.number(left) - self

    def __rtruediv__(self, left: Any) -> Traced:
        return self.tape.number(left) / self

    def __pow__(self, power: int) -> Traced:
        if power < 0:
            return 1 / self**-power
        result = self.tape.number(1)
        for _ in range(power):
            result = result * self
        return result

    __radd__ = __add__
    __rmul__ = __mul__

    @property
    def vanishes(self) -> bool:
        """Whether the traced number is zero for any values of the parameters."""
        return self.value == 0 and self.other == 0

    def __eq__(self, right: object) -> bool:
        """Whether the number equals another at the present values of the parameters."""
        right = self.tape.number(right)
        equal = self.value == right.value
        if equal and self.other != right.other:
            self.tape.settle(self, right)
        return equal

    def __lt__(self, right: object) -> bool:
        right = self._settled(right)
        return self.value < right.value

    def __gt__(self, right: object) -> bool:
        right = self._settled(right)
        return self.value > right.value

    def _settled(self, right: object) -> Traced:
        """Traced number of ``right``, after both numbers were noted as settled.

        Both numbers become settled, as other values may change their order.
        """
        found = self.tape.number(right)
        self.tape.settle(self, found)
        return found

    def __hash__(self) -> int:
        return hash(self.value)


@dataclass(eq=False)
class NumberTape:
    """Operations that gave traced numbers, in the order of their calculation.

    Attributes
    ----------
    operations : list
        ``("parameter", name)``, ``("sqrt", a)``, ``("+", a, b)``, ``("*", a, b)`` or ``("/", a, b)``.
    settled : set of str
        Parameters on whose values a decision rested.

    Examples
    --------
    >>> tape = NumberTape()
    >>> k = tape.parameter("k", Fraction(3))
    >>> k * 2 - 2 * k == 0, len(tape.settled)
    (True, 0)
    >>> k == 3, tape.settled
    (True, {'k'})
    """

    operations: list[tuple[Any, ...]] = field(default_factory=list)
    settled: set[str] = field(default_factory=set)
    _known: dict[Any, Traced] = field(default_factory=dict)
    _draw: random.Random = field(default_factory=lambda: random.Random(1))

    def number(self, value: Any) -> Traced:
        """Traced number of any value, a constant if it is a fraction or a float."""
        if isinstance(value, Traced):
            return value
        written = exact(value)
        return Traced(self, written, residue(written, CHECK_PRIME))

    def parameter(self, name: str, value: Any) -> Traced:
        """Traced number of a parameter with its present value."""
        return self._recorded(("parameter", name), exact(value), self._draw.randrange(1, CHECK_PRIME))

    def sqrt(self, argument: Any) -> Traced:
        argument = self.number(argument)
        root = exact(float(argument.value) ** 0.5)
        if argument.is_constant:
            return self.number(root)
        return self._recorded(("sqrt", argument), root, self._draw.randrange(1, CHECK_PRIME))

    @property
    def algebra(self) -> Algebra:
        """Arithmetic with traced numbers on this tape for expressions of a model."""
        from math import pi

        return Algebra(number=self.number, sqrt=self.sqrt, pi=self.number(pi))

    def operation(self, sign: str, left: Traced, right: Traced, value: Fraction, other: int) -> Traced:
        """Traced result of an arithmetic operation on two traced numbers."""
        if left.is_constant and right.is_constant:
            return self.number(float_if_long(value))
        if sign != "/" and _order(right) < _order(left):
            left, right = right, left
        return self._recorded((sign, left, right), value, other % CHECK_PRIME)

    def _recorded(self, operation: tuple[Any, ...], value: Fraction, other: int) -> Traced:
        key = (operation[0], *(_order(part) if isinstance(part, Traced) else part for part in operation[1:]))
        if key not in self._known:
            self._known[key] = Traced(self, exact(float_if_long(value)), other, len(self.operations))
            self.operations.append(operation)
        return self._known[key]

    def settle(self, *numbers: Traced) -> None:
        """Record that a decision on the model's structure rests on the parameters behind these numbers."""
        self.settled |= {self.operations[place][1] for place in self.needed(numbers) if self._is_parameter(place)}

    def _is_parameter(self, place: int) -> bool:
        return bool(self.operations[place][0] == "parameter")

    def needed(self, numbers: Iterable[Traced]) -> list[int]:
        """Indices, ascending, of all recorded operations by which these numbers were calculated."""
        waiting = [number.place for number in numbers if number.place is not None]
        found: set[int] = set()
        while waiting:
            place = waiting.pop()
            if place not in found:
                found.add(place)
                parts = (part for part in self.operations[place][1:] if isinstance(part, Traced))
                waiting += [part.place for part in parts if part.place is not None]
        return sorted(found)


def _order(number: Traced) -> tuple[int, Any]:
    """Sort key of a traced number in a sum or product, constants first, so that exchanged operands give equal keys."""
    return (0, number.value) if number.place is None else (1, number.place)


# Coordinates of the state space of an FMU, chosen so that its matrices have zeros where the mechanics has them.

_Names: TypeAlias = tuple[str, ...]


@dataclass(frozen=True)
class Motion:
    """Laws of a drivetrain over the coordinates of its FMU, with how they follow from the parameters.

    Attributes
    ----------
    tape : NumberTape
    parameters : dict
        Every parameter on the tape.
    values : Values
        Values of expressions, on the tape.
    kinematics : Kinematics
        Constraints and coordinates of the drivetrain, on the tape.
    changes : tuple of dict
        Coordinate -> row over the coordinates of the next stage, one after the other.
    heavy, damped, static : tuple of str
        Names of the coordinates, each that of a node.
    relative : frozenset of str
        Coordinates that are no longer the angle of their node alone.
    """

    tape: NumberTape
    parameters: dict[str, Traced]
    values: Values
    kinematics: Kinematics
    changes: tuple[dict[str, Any], ...]
    heavy: tuple[str, ...]
    damped: tuple[str, ...]
    static: tuple[str, ...]
    relative: frozenset[str]

    def over_coordinates(self, row: Mapping[str, Any]) -> dict[str, Traced]:
        """Row of factors on node angles converted to one on the FMU's coordinates, by their names."""
        current: dict[str, Any] = self.kinematics.reduced({node: self.tape.number(a) for node, a in row.items()})
        for change in self.changes:
            current = substitute(current, change)
        return {name: self.tape.number(value) for name, value in current.items()}


def trace_motion(drivetrain: Drivetrain) -> Motion:
    """Coordinates and laws of a drivetrain as they follow from parameters, as many of them left open as possible."""
    settled: set[str] = set()
    # A decision that other values would reverse settles its parameters: again, with these as constants.
    while True:
        motion = _traced(drivetrain, settled)
        if motion.tape.settled <= settled:
            return motion
        settled |= motion.tape.settled


def _traced(drivetrain: Drivetrain, settled: Iterable[str]) -> Motion:
    refuse_actions(drivetrain.assembly.system.actions, "an FMU is")
    definition, tape = drivetrain.definition, NumberTape()
    parameters = _parameters(tape, definition.parameters, drivetrain.exact_values, settled)
    values = Values(parameters, tape.algebra)
    kinematics = kinematics_on(values, drivetrain.assembly.kinematics, definition)
    kinds = _Kinds(tape, kinematics)
    return Motion(tape, parameters, values, kinematics, *kinds.found())


class _Kinds:
    """Separation of an FMU's coordinates into heavy, damped and static ones, in three stages."""

    def __init__(self, tape: NumberTape, kinematics: Kinematics) -> None:
        self.tape = tape
        self.coordinates = kinematics.coordinates
        laws = [law for _, law in kinematics.laws if law.acts]
        rows = [kinematics.reduced({node: tape.number(a) for node, a in law.row.items()}) for law in laws]
        self.laws: list[tuple[Law, dict[str, Any]]] = list(zip(laws, rows, strict=True))
        self.changes: list[dict[str, Any]] = []
        self.relative: set[str] = set()

    def found(self) -> tuple[tuple[dict[str, Any], ...], _Names, _Names, _Names, frozenset[str]]:
        """Changes of coordinates, and names of those with inertia, massless with dampers, without either, relative."""
        # What inertia leaves free is massless, and what dampers leave free of that is static.
        inertial = [row for law, row in self.laws if self._is_there(law.inertia, row)]
        massless = self._separated(inertial, self.coordinates)
        heavy = tuple(name for name in self.coordinates if name not in massless)
        inside = [(law, {name: a for name, a in row.items() if name in massless}) for law, row in self.laws]
        damping = [row for law, row in inside if row and self._is_there(law.damping, row)]
        static = self._separated(damping, massless)
        damped = tuple(name for name in massless if name not in static)
        # What springs leave free is motion as a rigid body; other angles are taken relative to it.
        elastic = [row for law, row in self.laws if law.is_elastic]
        free = self._separated(elastic, (*heavy, *damped, *static))
        self._require_held(free, static)
        return tuple(self.changes), heavy, damped, static, frozenset(self.relative)

    def _is_there(self, coefficient: Any, row: Mapping[str, Any]) -> bool:
        return bool(row) and bool(self.tape.number(coefficient) != 0)

    def _separated(self, rows: list[dict[str, Any]], order: tuple[str, ...]) -> tuple[str, ...]:
        """Names of the coordinates that ``rows`` leave free, while the others become relative to these."""
        reduction = reduce_rows(rows, {name: place for place, name in enumerate(order)})
        free = tuple(name for name in order if reduction.is_free(name))
        change: dict[str, Any] = {}
        for name in order:
            taken = {} if name in free else reduction.reduced({name: 1})
            if taken:
                change[name] = {name: self.tape.number(1), **taken}
                self.relative.add(name)
        self.laws = [(law, substitute(row, change)) for law, row in self.laws]
        self.changes.append(change)
        return free

    def _require_held(self, free: tuple[str, ...], static: tuple[str, ...]) -> None:
        loose = [name for name in free if name in static]
        if loose:
            raise UsageError(f"nothing resists the motion of {', '.join(loose)}: no inertia, no damper and no spring")


def _parameters(
    tape: NumberTape, definitions: Mapping[str, Parameter], values: Mapping[str, Any], settled: Iterable[str]
) -> dict[str, Traced]:
    """Parameters of a model by name as traced numbers; derived ones follow from others, settled ones are constants."""
    traced: dict[str, Traced] = {}
    for name in evaluation_order(definitions)[0]:
        expression = definitions[name].value
        if name in settled:
            traced[name] = tape.number(values[name])
        elif expression.names:
            traced[name] = expression.evaluate(traced, tape.algebra)
        else:
            traced[name] = tape.parameter(name, values[name])
    return {name: tape.number(traced[name]) for name in definitions}
