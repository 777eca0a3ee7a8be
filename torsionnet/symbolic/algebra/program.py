"""Straight-line programs, in which a symbolic calculation is recorded step by step, each step once.

A transfer function is calculated once with the :class:`ProgramNode` objects of a :class:`Program`, which only take down
what is done; equal steps are found to be equal. The program is then run in any algebra that has numbers for its leaves:
sympy expressions, polynomials in s, rings, exact rationals, arrays over frequency.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Protocol

from torsionnet.core.memo import Memo

ARITHMETIC = ("+", "*", "/")
"""Operations of a program step that combine two other steps, all that a determinant without subtraction needs."""


class ProgramAlgebra(Protocol):
    """Protocol of an algebra that evaluates programs, whose elements for their inputs (leaves) have +, * and /."""

    def leaf(self, payload: Any) -> Any:
        """Element of an algebra for an input (leaf) of a program, from the input's payload or a Fraction."""
        ...


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
        for index in self.needed(outputs):
            step = self.steps[index]
            if step[0] == "leaf":
                results[index] = algebra.leaf(step[1])
            else:
                left, right = results[step[1]], results[step[2]]
                results[index] = left + right if step[0] == "+" else left * right if step[0] == "*" else left / right
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
