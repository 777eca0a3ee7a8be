"""Symbolic network of a drivetrain, with laws (inertia, damping, stiffness) on rows over its coordinates.

Straight-line programs, in which a symbolic calculation is recorded step by step, each step once.

A transfer function is calculated once with the :class:`ProgramNode` objects of a :class:`Program`, which only take down
what is done; equal steps are found to be equal. The program is then run in any algebra that has numbers for its leaves:
sympy expressions, polynomials in s, rings, exact rationals, arrays over frequency.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, Generic, TypeAlias, TypeVar

import sympy

from torsionnet.base.registers import Memo
from torsionnet.linear.assembly.symbolic import collect_by_ratio

SymbolRow: TypeAlias = Mapping[str, Any]
"""Row by which a law or a sensor acts on coordinates, sympy coefficients by coordinate, none of them zero."""

ONE = sympy.Integer(1)
"""Exact number one of sympy, shared so that rows and laws compare quickly."""
ZERO = sympy.Integer(0)
"""Exact number zero of sympy, for stiffness, damping or inertia that a law lacks."""


@dataclass(frozen=True)
class Stiffness:
    """Symbolic dynamic stiffness J s^2 + c s + k of a law, where k holds hysteresis and tables."""

    stiffness: Any = ZERO
    damping: Any = ZERO
    inertia: Any = ZERO

    @property
    def parts(self) -> tuple[Any, Any, Any]:
        """Coefficients of 1, s and s^2 of the dynamic stiffness (k, c, J) as sympy expressions."""
        return self.stiffness, self.damping, self.inertia


L = TypeVar("L")


@dataclass(frozen=True, eq=False)
class NetworkMember(Generic[L]):
    """Law of a network with the row over coordinates that it acts on."""

    row: SymbolRow
    law: L


@dataclass(frozen=True, eq=False)
class Network(Generic[L]):
    """Symbolic network of laws on rows, with the dynamic stiffness D(s) = sum of law * row row^T over coordinates."""

    coordinates: tuple[str, ...]
    members: tuple[NetworkMember[L], ...]

    @cached_property
    def grounds(self) -> Mapping[str, list[L]]:
        """Laws of a symbolic network that act on one coordinate alone (to ground), by coordinate."""
        found: dict[str, list[L]] = {}
        for member in self.members:
            if len(member.row) == 1:
                found.setdefault(next(iter(member.row)), []).append(member.law)
        return found

    def contracted(self, row: SymbolRow, keep: str = "") -> Contraction[L]:
        """Network for motions in which a row is zero, with one coordinate of it, not ``keep``, expressed by the others.

        The coefficient of kappa in det(D + kappa a a^T) is a_v^2 times the determinant of what is left, v being the
        coordinate expressed, and so for every bilinear form of the adjugate.
        """
        pivot = self._pivot(row, keep)
        # a_v theta_v + ... = 0, solved for theta_v
        solution = {name: -value / row[pivot] for name, value in row.items() if name != pivot}
        members = [
            NetworkMember(substitute_coordinate(member.row, pivot, solution), member.law) for member in self.members
        ]
        rest = tuple(name for name in self.coordinates if name != pivot)
        left = Network(rest, tuple(member for member in members if member.row))
        # Laws on that row alone have no motion left.
        idle = tuple(member.law for member in members if not member.row)
        return Contraction(left, pivot, solution, row[pivot] ** 2, idle)

    def _pivot(self, row: SymbolRow, keep: str) -> str:
        """Coordinate of a row, by name, that a contraction expresses by the others, in long rows one with few laws."""
        names = [name for name in row if name != keep]
        uses: Counter[str] = Counter()
        # Long rows spread to all other laws on the coordinate that they express.
        if len(row) > 2:
            uses.update(name for member in self.members if len(member.row) > 1 for name in member.row)
        return max(names, key=lambda name: (-uses[name], self.coordinates.index(name)))

    def without(self, member: NetworkMember[L]) -> Network[L]:
        """Copy of the network without one of its laws."""
        return Network(self.coordinates, tuple(other for other in self.members if other is not member))


@dataclass(frozen=True)
class Contraction(Generic[L]):
    """Network with one coordinate expressed by the others, and the factor its determinant has in that of the whole.

    ``idle`` are the laws on motions that are no longer possible.
    """

    network: Network[L]
    pivot: str
    solution: SymbolRow
    factor: Any
    idle: tuple[L, ...]

    def row(self, row: SymbolRow) -> SymbolRow:
        """Row over the remaining coordinates of the network from a row over all coordinates, symbolic."""
        return substitute_coordinate(row, self.pivot, self.solution)


def add_parallel_laws(network: Network[L], total: Callable[[Sequence[tuple[L, Any]]], L]) -> Network[L]:
    """Network in which laws on parallel rows, multiples of one row, are added up to one law by ``total``."""
    groups: dict[tuple[tuple[str, Any], ...], list[tuple[L, Any]]] = {}
    for member in network.members:
        direction, scale = _direction(member.row, groups)
        groups.setdefault(direction, []).append((member.law, scale))
    members = (NetworkMember(dict(direction), total(laws)) for direction, laws in groups.items())
    return Network(network.coordinates, tuple(members))


def _direction(row: SymbolRow, known: Collection[Any]) -> tuple[tuple[tuple[str, Any], ...], Any]:
    """Row normalised so that parallel rows are equal, and the scale that was divided out."""
    names = sorted(row, key=lambda name: row[name] not in (1, -1))
    first, last = row[names[0]], row[names[-1]]
    if len(names) == 2:
        # A pair of coordinates may be known from its other end.
        back = ((names[1], ONE), (names[0], first / last))
        return (back, last) if back in known else (((names[0], ONE), (names[1], last / first)), first)
    return tuple((name, row[name] / first) for name in sorted(names)), first


def reflected_sum(laws: Sequence[tuple[Stiffness, Any]]) -> Stiffness:
    """Sum over laws of dynamic stiffness times squared ratio of motion, with terms collected by squared ratio."""
    total = _Collected()
    for law, ratio in laws:
        total.add(law, ratio)
    return total.law()


class _Collected:
    """Sum so far of dynamic stiffnesses times squared ratios of motion, its terms collected by squared ratio."""

    def __init__(self) -> None:
        self.parts: tuple[dict[Any, Any], ...] = ({}, {}, {})

    def add(self, law: Stiffness, ratio: Any) -> None:
        # Numbers in a squared ratio go into the term, so that only its symbols part the groups.
        number, reflected = (ONE, ONE) if ratio in (1, -1) else (ratio**2).as_coeff_Mul()
        for groups, part in zip(self.parts, law.parts, strict=True):
            if part != 0:
                more = part if number is ONE else number * part
                groups[reflected] = groups[reflected] + more if reflected in groups else more

    def law(self) -> Stiffness:
        return Stiffness(*(collect_by_ratio(groups) for groups in self.parts))


def row_sum(rows: Iterable[tuple[Any, SymbolRow]]) -> dict[str, Any]:
    """Sum of rows, each times its number, as one row by coordinate, without entries that are zero for all values."""
    total: dict[str, Any] = {}
    for factor, row in rows:
        for name, value in row.items():
            total[name] = total[name] + factor * value if name in total else factor * value
    return {name: value for name, value in total.items() if not vanishes(value)}


def substitute_coordinate(row: SymbolRow, pivot: str, solution: SymbolRow) -> SymbolRow:
    """Symbolic row in which one coordinate is replaced by its expression in the others."""
    if pivot not in row:
        return row
    rest = {name: value for name, value in row.items() if name != pivot}
    return row_sum([(ONE, rest), (row[pivot], solution)])


def vanishes(expression: Any) -> bool:
    """Whether a sympy expression is zero for all values of its symbols."""
    return bool(expression == 0 or (expression.is_Add and sympy.cancel(expression) == 0))


ARITHMETIC = ("+", "*", "/")
"""Operations of a program step that combine two other steps, all that a determinant without subtraction needs."""


class ProgramAlgebra:
    """Base of the algebras that evaluate programs; elements add, multiply and divide as Python's +, * and / do."""

    def leaf(self, payload: Any) -> Any:
        """Element of an algebra for an input (leaf) of a program, from the input's payload or a Fraction."""
        raise NotImplementedError

    def add(self, left: Any, right: Any) -> Any:
        """Sum of two elements of the algebra."""
        return left + right

    def multiply(self, left: Any, right: Any) -> Any:
        """Product of two elements of the algebra."""
        return left * right

    def divide(self, above: Any, below: Any) -> Any:
        """Quotient of two elements of the algebra."""
        return above / below


@dataclass(eq=False)
class Program:
    """Straight-line program with steps ``("+", a, b)``, ``("*", a, b)``, ``("/", a, b)`` or ``("leaf", payload)``.

    Examples
    --------
    >>> program = Program()
    >>> x = program.leaf("x")
    >>> y = (x + 1) * (x + 1) * 1
    >>> [program.steps[i][0] for i in program.needed([y])]
    ['leaf', 'leaf', '+', '*']
    """

    steps: list[tuple[Any, ...]] = field(default_factory=list)
    known: dict[Hashable, ProgramNode] = field(default_factory=dict)
    memo: Memo = field(default_factory=Memo)

    def leaf(self, payload: Hashable) -> ProgramNode:
        """Node of a program's input (leaf), a payload that an algebra turns into a value, or a rational constant."""
        return self._node(("leaf", _constant(payload)))

    def node(self, value: Any) -> ProgramNode:
        return value if isinstance(value, ProgramNode) else self.leaf(value)

    def _node(self, step: tuple[Any, ...]) -> ProgramNode:
        found = self.known.get(step)
        if found is None:
            found = ProgramNode(self, len(self.steps))
            self.steps.append(step)
            self.known[step] = found
        return found

    def constant(self, node: ProgramNode) -> Fraction | None:
        """Rational value of a program node that is a constant, None for any other node."""
        step = self.steps[node.index]
        return step[1] if step[0] == "leaf" and isinstance(step[1], Fraction) else None

    def add(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        a, b = self.constant(left), self.constant(right)
        if a is not None and b is not None:
            return self.leaf(a + b)
        if a == 0:
            return right
        return left if b == 0 else self._node(("+", *sorted((left.index, right.index))))

    def multiply(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        a, b = self.constant(left), self.constant(right)
        if a is not None and b is not None:
            return self.leaf(a * b)
        if a == 0 or b == 1:
            return left
        return right if a == 1 or b == 0 else self._node(("*", *sorted((left.index, right.index))))

    def divide(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        a, b = self.constant(left), self.constant(right)
        if a is not None and b:
            return self.leaf(a / b)
        if left is right and b != 0:
            return self.leaf(1)
        return left if b == 1 or a == 0 else self._node(("/", left.index, right.index))

    def needed(self, outputs: Iterable[ProgramNode]) -> list[int]:
        """Indices of the program's steps on which its output nodes depend, in ascending order."""
        wanted = {node.index for node in outputs}
        # Backwards, as steps depend on earlier ones alone.
        for index in range(max(wanted, default=-1), -1, -1):
            if index in wanted and self.steps[index][0] in ARITHMETIC:
                wanted.update(self.steps[index][1:])
        return sorted(wanted)

    def payloads(self, outputs: Iterable[ProgramNode]) -> list[Any]:
        """Payloads (expressions, stiffnesses, constants) of the program's inputs on which output nodes depend."""
        return [self.steps[index][1] for index in self.needed(outputs) if self.steps[index][0] == "leaf"]

    def run(self, algebra: ProgramAlgebra, outputs: Sequence[ProgramNode]) -> list[Any]:
        """Values of the output nodes, in the order given, when the program is evaluated in an algebra."""
        results: dict[int, Any] = {}
        combine = {"+": algebra.add, "*": algebra.multiply, "/": algebra.divide}
        for index in self.needed(outputs):
            sign, *operands = self.steps[index]
            if sign == "leaf":
                results[index] = algebra.leaf(*operands)
            else:
                results[index] = combine[sign](*(results[operand] for operand in operands))
        return [results[node.index] for node in outputs]

    def factors(self, node: ProgramNode) -> Counter[int]:
        """Multiplicity of each factor of a program node that is a product, by the index of the factor's step."""
        found: Counter[int] = Counter()
        waiting = [node.index]
        while waiting:
            step = self.steps[waiting[-1]]
            index = waiting.pop()
            if step[0] == "*":
                waiting += step[1:]
            else:
                found[index] += 1
        return found

    def product(self, factors: Iterable[int]) -> ProgramNode:
        result = self.leaf(1)
        for index in factors:
            result = result * self.at(index)
        return result

    def at(self, index: int) -> ProgramNode:
        return self.known[self.steps[index]]

    def reduced(self, numerator: ProgramNode, denominator: ProgramNode) -> tuple[ProgramNode, ProgramNode]:
        """Program nodes of numerator and denominator of a fraction without their common factors."""
        above, below = self.factors(numerator), self.factors(denominator)
        # Equal factors are the same step of the program.
        common = above & below
        if not common or self.constant(numerator) == 0:
            return numerator, denominator
        return self.product((above - common).elements()), self.product((below - common).elements())


def _constant(payload: Any) -> Any:
    if isinstance(payload, int):
        return Fraction(payload)
    return Fraction(payload.p, payload.q) if getattr(payload, "is_Rational", False) else payload


class ProgramNode:
    """Node of a program, the result of one step, whose +, * and / record further steps."""

    __slots__ = ("index", "program")

    def __init__(self, program: Program, index: int) -> None:
        self.program: Program = program
        self.index: int = index

    def __add__(self, other: Any) -> ProgramNode:
        return self.program.add(self, self.program.node(other))

    def __mul__(self, other: Any) -> ProgramNode:
        return self.program.multiply(self, self.program.node(other))

    def __truediv__(self, other: Any) -> ProgramNode:
        return self.program.divide(self, self.program.node(other))

    __radd__ = __add__
    __rmul__ = __mul__

    @property
    def is_zero(self) -> bool:
        return self.program.constant(self) == 0
