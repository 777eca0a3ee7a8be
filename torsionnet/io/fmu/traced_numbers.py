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

import math
import random
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, TypeAlias

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Name, exact, exact_sqrt, float_if_long
from torsionnet.base.program import ProgramNode, Record
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import refuse_actions
from torsionnet.linear.modes.modular_arithmetic import residue
from torsionnet.model.elements import Law, Values
from torsionnet.model.elimination import reduce_rows, substitute
from torsionnet.model.kinematics import Kinematics, kinematics_on
from torsionnet.model.parameters import Parameter, evaluation_order

CHECK_PRIME = 2**61 - 1
"""Prime modulus of the second set of values, large, so that other numbers are hardly ever equal by chance."""


@dataclass(eq=False)
class NumberTape(Record):
    """Record of the numbers of an FMU, with values of all results at other, arbitrary values of the parameters.

    Attributes
    ----------
    others : list of int
        Value of each step at the arbitrary values, modulo ``CHECK_PRIME``.

    Examples
    --------
    >>> tape = NumberTape()
    >>> k = tape.parameter("k", Fraction(3))
    >>> k * 2 - 2 * k == 0, len(tape.settled)
    (True, 0)
    >>> k == 3, tape.settled
    (True, {'k'})
    """

    others: list[int] = field(default_factory=list)
    _draw: random.Random = field(default_factory=lambda: random.Random(1))

    def leaf(self, payload: Hashable) -> ProgramNode:
        return super().leaf(exact(float_if_long(payload)) if isinstance(payload, Fraction) else payload)

    @property
    def pi(self) -> ProgramNode:
        return self.node(math.pi)

    def sqrt(self, argument: Any) -> ProgramNode:
        node = self.node(argument)
        return super().sqrt(node) if self.constant(node) is None else self.node(exact_sqrt(node.value))

    def add(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        if self.vanishes(left) or self.vanishes(right):
            return right if self.vanishes(left) else left
        return super().add(left, right)

    def vanishes(self, number: ProgramNode) -> bool:
        """Whether a number is zero for any values of the parameters."""
        return number.value == 0 and self.others[number.index] == 0

    def _value(self, step: tuple[Any, ...]) -> Fraction:
        value = exact(float_if_long(super()._value(step)))
        self.others.append(self._other(*step) % CHECK_PRIME)
        return value

    def _other(self, sign: str, *operands: Any) -> int:
        if sign == "leaf" and isinstance(operands[0], Fraction):
            return residue(operands[0], CHECK_PRIME)
        if sign in ("leaf", "sqrt"):
            return self._draw.randrange(1, CHECK_PRIME)
        left: int = self.others[operands[0]]
        right: int = self.others[operands[1]]
        # The other values are divided modulo their prime.
        factor: int = pow(right, -1, CHECK_PRIME) if sign == "/" else right
        return left + right if sign == "+" else left * factor

    @property
    def settled(self) -> set[str]:
        """Parameters on whose values a decision rested that other values would reverse."""
        behind: set[int] = set()
        for sign, left, right in self.decisions:
            # Other values may change any order; two numbers are equal for all of them, or at these values alone.
            if sign == "<" or self.others[left] != self.others[right]:
                behind |= {left, right}
        payloads = self.payloads(self.at(index) for index in behind)
        return {payload.name for payload in payloads if isinstance(payload, Name)}


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
    parameters: dict[str, ProgramNode]
    values: Values
    kinematics: Kinematics
    changes: tuple[dict[str, Any], ...]
    heavy: tuple[str, ...]
    damped: tuple[str, ...]
    static: tuple[str, ...]
    relative: frozenset[str]

    def over_coordinates(self, row: Mapping[str, Any]) -> dict[str, ProgramNode]:
        """Row of factors on node angles converted to one on the FMU's coordinates, by their names."""
        current: dict[str, Any] = self.kinematics.reduction.reduced(
            {node: self.tape.node(a) for node, a in row.items()}
        )
        for change in self.changes:
            current = substitute(current, change)
        return {name: self.tape.node(value) for name, value in current.items()}


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
    return Motion(tape, parameters, values, kinematics, *kinds.separated())


class _Kinds:
    """Separation of an FMU's coordinates into heavy, damped and static ones, in three stages."""

    def __init__(self, tape: NumberTape, kinematics: Kinematics) -> None:
        self.tape = tape
        self.coordinates = kinematics.coordinates
        laws = [law for _, law in kinematics.laws if law.acts]
        rows = [kinematics.reduction.reduced({node: tape.node(a) for node, a in law.row.items()}) for law in laws]
        self.laws: list[tuple[Law, dict[str, Any]]] = list(zip(laws, rows, strict=True))
        self.changes: list[dict[str, Any]] = []
        self.relative: set[str] = set()

    def separated(self) -> tuple[tuple[dict[str, Any], ...], _Names, _Names, _Names, frozenset[str]]:
        """Changes of coordinates, and names of those with inertia, massless with dampers, without either, relative."""
        # What inertia leaves free is massless, and what dampers leave free of that is static.
        inertial = [row for law, row in self.laws if self._is_there(law.inertia, row)]
        massless = self._made_relative(inertial, self.coordinates)
        heavy = tuple(name for name in self.coordinates if name not in massless)
        inside = [(law, {name: a for name, a in row.items() if name in massless}) for law, row in self.laws]
        damping = [row for law, row in inside if row and self._is_there(law.damping, row)]
        static = self._made_relative(damping, massless)
        damped = tuple(name for name in massless if name not in static)
        # What springs leave free is motion as a rigid body; other angles are taken relative to it.
        elastic = [row for law, row in self.laws if law.is_elastic]
        free = self._made_relative(elastic, (*heavy, *damped, *static))
        self._require_held(free, static)
        return tuple(self.changes), heavy, damped, static, frozenset(self.relative)

    def _is_there(self, coefficient: Any, row: Mapping[str, Any]) -> bool:
        return bool(row) and bool(self.tape.node(coefficient) != 0)

    def _made_relative(self, rows: list[dict[str, Any]], order: tuple[str, ...]) -> tuple[str, ...]:
        """Names of the coordinates that ``rows`` leave free, while the others become relative to these."""
        reduction = reduce_rows(rows, {name: place for place, name in enumerate(order)})
        free = tuple(name for name in order if reduction.is_free(name))
        change: dict[str, Any] = {}
        # Of a name that follows others the motion relative to them is left, x = x' + sum r y.
        for name in order:
            taken = {} if name in free else reduction.reduced({name: 1})
            if taken:
                change[name] = {name: self.tape.node(1), **taken}
                self.relative.add(name)
        self.laws = [(law, substitute(row, change)) for law, row in self.laws]
        self.changes.append(change)
        return free

    def _require_held(self, free: tuple[str, ...], static: tuple[str, ...]) -> None:
        loose = [name for name in free if name in static]
        if loose:
            raise UsageError(
                f"nothing resists the motion of {', '.join(loose)}: no inertia, no damper and no spring",
                kind="indeterminate-motion",
            )


def _parameters(
    tape: NumberTape, definitions: Mapping[str, Parameter], values: Mapping[str, Any], settled: Iterable[str]
) -> dict[str, ProgramNode]:
    """Parameters of a model by name as traced numbers; derived ones follow from others, settled ones are constants."""
    traced: dict[str, ProgramNode] = {}
    for name in evaluation_order(definitions)[0]:
        expression = definitions[name].value
        if name in settled:
            traced[name] = tape.node(values[name])
        elif expression.names:
            traced[name] = expression.evaluate(traced, tape.algebra)
        else:
            traced[name] = tape.parameter(name, values[name])
    return {name: tape.node(traced[name]) for name in definitions}
