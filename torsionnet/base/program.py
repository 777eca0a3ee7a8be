"""Programs in which a calculation is recorded step by step, each step once, and the algebras that evaluate them.

A calculation is done once with the :class:`ProgramNode` objects of a :class:`Program`, which only take down what is
done; equal steps are found to be equal. The program is then run in any algebra that has elements for its inputs
(leaves): sympy expressions, polynomials in s, rings, exact rationals, arrays over frequency.

A plain program has no values, and refuses branches on them. A :class:`Record`, on which laws of elements and ratios of
gears are recorded from the names of parameters, has the present value of each result: branches are decided by it and
recorded as such.
"""

from __future__ import annotations

import math
import operator
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from torsionnet.base.expressions import Algebra, Compound, Name, exact, exact_sqrt
from torsionnet.base.registers import Memo

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

    def root(self, argument: Any) -> Any:
        """Square root of an element of the algebra."""
        return math.sqrt(argument)


@dataclass(eq=False)
class Program:
    """Straight-line program with steps ``("+", a, b)``, ``("*", a, b)``, ``("/", a, b)`` or ``("leaf", payload)``.

    Differences and powers are recorded as sums and products.

    Examples
    --------
    >>> program = Program()
    >>> x = program.leaf("x")
    >>> y = (x + 1) * (x + 1) * 1
    >>> [program.steps[i][0] for i in program.needed([y])]
    ['leaf', 'leaf', '+', '*']
    """

    steps: list[tuple[Any, ...]] = field(default_factory=list)
    nodes: list[ProgramNode] = field(default_factory=list)
    known: dict[Hashable, ProgramNode] = field(default_factory=dict)
    memo: Memo = field(default_factory=Memo)

    def leaf(self, payload: Hashable) -> ProgramNode:
        """Node of a program's input (leaf), a payload that an algebra turns into a value, or a rational constant."""
        node = self.known.get(payload)
        if node is None:
            node = self.known[payload] = self._node(("leaf", _constant(payload)))
        return node

    def node(self, value: Any) -> ProgramNode:
        return value if isinstance(value, ProgramNode) else self.leaf(value)

    def _node(self, step: tuple[Any, ...]) -> ProgramNode:
        node = self.known.get(step)
        if node is None:
            node = ProgramNode(self, len(self.steps), self._value(step))
            self.steps.append(step)
            self.nodes.append(node)
            self.known[step] = node
        return node

    def _value(self, step: tuple[Any, ...]) -> Any:
        """Present value of a step's result, which a program without values has not."""
        del step

    def constant(self, node: ProgramNode) -> Fraction | None:
        """Rational value of a program node that is a constant, None for any other node."""
        sign, payload, *_ = self.steps[node.index]
        return payload if sign == "leaf" and isinstance(payload, Fraction) else None

    def add(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        a, b = self.constant(left), self.constant(right)
        if a is not None and b is not None:
            return self.leaf(a + b)
        if a == 0:
            return right
        return left if b == 0 else self._node(("+", *self._pair(left, right)))

    def multiply(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        a, b = self.constant(left), self.constant(right)
        if a is not None and b is not None:
            return self.leaf(a * b)
        if a == 0 or b == 1:
            return left
        return right if a == 1 or b == 0 else self._node(("*", *self._pair(left, right)))

    def _pair(self, left: ProgramNode, right: ProgramNode) -> Iterable[int]:
        """Operands of a sum or product in the order in which they are recorded, here as they were calculated."""
        return sorted((left.index, right.index))

    def divide(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        a, b = self.constant(left), self.constant(right)
        if a is not None and b:
            return self.leaf(a / b)
        if left is right and b != 0:
            return self.leaf(1)
        return left if b == 1 or a == 0 else self._node(("/", left.index, right.index))

    def subtract(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        return self.add(left, self.negative(right))

    def negative(self, node: ProgramNode) -> ProgramNode:
        return self.multiply(self.leaf(-1), node)

    def power(self, base: ProgramNode, exponent: int) -> ProgramNode:
        """Node of a power with a whole exponent."""
        result = self.leaf(1)
        for _ in range(abs(exponent)):
            result = self.multiply(result, base)
        return self.divide(self.leaf(1), result) if exponent < 0 else result

    def equal(self, left: ProgramNode, right: object) -> bool:
        """Whether two nodes are the same step; without values nothing else can be told."""
        return left is right

    def less(self, left: ProgramNode, right: ProgramNode) -> bool:
        """Refuse a branch on values.

        Raises
        ------
        TypeError
            Always: a program without values cannot decide.
        """
        raise TypeError(f"steps {left.index} and {right.index} have no values to compare: a branch cannot be recorded")

    def needed(self, outputs: Iterable[ProgramNode], known: Collection[int] = ()) -> list[int]:
        """Indices of the program's steps on which its output nodes depend, ascending, without the ``known`` ones."""
        waiting, wanted = [node.index for node in outputs], set()
        while waiting:
            index = waiting.pop()
            if index not in wanted and index not in known:
                wanted.add(index)
                sign, *operands = self.steps[index]
                waiting += operands if sign != "leaf" else ()
        return sorted(wanted)

    def payloads(self, outputs: Iterable[ProgramNode]) -> list[Any]:
        """Payloads (expressions, stiffnesses, constants) of the program's inputs on which output nodes depend."""
        return [self.steps[index][1] for index in self.needed(outputs) if self.steps[index][0] == "leaf"]

    def values_in(
        self, algebra: ProgramAlgebra, outputs: Sequence[ProgramNode], results: dict[int, Any] | None = None
    ) -> list[Any]:
        """Values of the output nodes, in the order given, when the program is evaluated in an algebra.

        ``results`` of earlier runs, by index of their steps, are used and added to.
        """
        results = {} if results is None else results
        combine: dict[str, Callable[..., Any]]
        combine = {"+": algebra.add, "*": algebra.multiply, "/": algebra.divide, "sqrt": algebra.root}
        for index in self.needed(outputs, results):
            sign, *operands = self.steps[index]
            if sign == "leaf":
                results[index] = algebra.leaf(*operands)
            else:
                results[index] = combine[sign](*(results[operand] for operand in operands))
        return [results[node.index] for node in outputs]

    def factors(self, node: ProgramNode) -> Counter[int]:
        """Multiplicity of each factor of a program node that is a product, by the index of the factor's step."""
        factors: Counter[int] = Counter()
        waiting = [node.index]
        while waiting:
            step = self.steps[waiting[-1]]
            index = waiting.pop()
            if step[0] == "*":
                waiting += step[1:]
            else:
                factors[index] += 1
        return factors

    def product(self, factors: Iterable[int]) -> ProgramNode:
        result = self.leaf(1)
        for index in factors:
            result = result * self.at(index)
        return result

    def at(self, index: int) -> ProgramNode:
        return self.nodes[index]

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
    """Node of a program, the result of one step, whose arithmetic records further steps.

    ``value`` is its present value where the program is a :class:`Record`, by which it is compared, else None.
    """

    __slots__ = ("index", "program", "value")

    def __init__(self, program: Program, index: int, value: Any = None) -> None:
        self.program: Program = program
        self.index: int = index
        self.value: Any = value

    def __add__(self, other: Any) -> ProgramNode:
        return self.program.add(self, self.program.node(other))

    def __mul__(self, other: Any) -> ProgramNode:
        return self.program.multiply(self, self.program.node(other))

    def __truediv__(self, other: Any) -> ProgramNode:
        return self.program.divide(self, self.program.node(other))

    def __rtruediv__(self, other: Any) -> ProgramNode:
        return self.program.divide(self.program.node(other), self)

    def __sub__(self, other: Any) -> ProgramNode:
        return self.program.subtract(self, self.program.node(other))

    def __rsub__(self, other: Any) -> ProgramNode:
        return self.program.subtract(self.program.node(other), self)

    def __neg__(self) -> ProgramNode:
        return self.program.negative(self)

    def __pow__(self, exponent: int) -> ProgramNode:
        return self.program.power(self, exponent)

    def __radd__(self, other: Any) -> ProgramNode:
        return self.program.add(self.program.node(other), self)

    def __rmul__(self, other: Any) -> ProgramNode:
        return self.program.multiply(self.program.node(other), self)

    def __eq__(self, other: object) -> bool:
        return self.program.equal(self, other)

    def __lt__(self, other: Any) -> bool:
        return self.program.less(self, self.program.node(other))

    def __gt__(self, other: Any) -> bool:
        return self.program.less(self.program.node(other), self)

    def __hash__(self) -> int:
        return hash(self.index if self.value is None else self.value)

    def __float__(self) -> float:
        return float(self.value)

    @property
    def is_zero(self) -> bool:
        return self.program.constant(self) == 0


_VALUES: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "**": operator.pow,
    "negative": operator.neg,
    "sqrt": exact_sqrt,
}
"""Value of a recorded step from the values of its operands, by the sign of the operation as in an expression."""
_PI = Compound("pi")


@dataclass(eq=False)
class Record(Program):
    """Program that laws of elements and rows of a drivetrain are recorded on, from the names of parameters.

    Elements, constraints and readings calculate with its nodes as they do with fractions.

    Attributes
    ----------
    present : dict
        Value of each parameter, or of pi, by the expression that stands for it.
    decisions : set
        Comparisons on which a branch rested, with the indices of two nodes: ``("==", a, b)`` where they are equal now,
        and ``("<", a, b)`` for either order.

    Examples
    --------
    >>> record = Record()
    >>> k = record.parameter("k", 3)
    >>> float(1 / (2 * k - 1)), k == 3, record.decisions
    (0.2, True, {('==', 0, 7)})
    """

    present: dict[Hashable, Fraction] = field(default_factory=dict)
    decisions: set[tuple[str, int, int]] = field(default_factory=set)

    def parameter(self, name: str, value: Any) -> ProgramNode:
        """Node of a parameter with its present value."""
        self.present[Name(name)] = exact(value)
        return self.leaf(Name(name))

    def node(self, value: Any) -> ProgramNode:
        """Node of any number as written, 0.1 as 1/10, or a node of the record as it is."""
        if isinstance(value, ProgramNode):
            assert value.program is self, "numbers of two records do not mix"
            return value
        return self.leaf(exact(value) if isinstance(value, float) else value)

    def sqrt(self, argument: Any) -> ProgramNode:
        """Node of a square root, a number where the root of a number is exact."""
        node = self.node(argument)
        root = exact_sqrt(node.value)
        if self.constant(node) is not None and isinstance(root, Fraction):
            return self.leaf(root)
        return self._node(("sqrt", node.index))

    @property
    def pi(self) -> ProgramNode:
        self.present[_PI] = exact(math.pi)
        return self.leaf(_PI)

    @property
    def algebra(self) -> Algebra:
        """Arithmetic in which expressions of a model are recorded."""
        return Algebra(number=self.node, sqrt=self.sqrt, pi=self.pi)

    def _value(self, step: tuple[Any, ...]) -> Fraction:
        sign, *operands = step
        if sign == "leaf":
            (payload,) = operands
            return self.present[payload] if payload in self.present else exact(payload)
        value = _VALUES[sign](*(self.nodes[operand].value for operand in operands))
        return exact(value)

    def equal(self, left: ProgramNode, right: object) -> bool:
        """Whether a node has the present value of another one or of a number."""
        other = right.value if isinstance(right, ProgramNode) else exact(right) if isinstance(right, float) else right
        if left.value != other:
            return False
        # Of other values next to none are equal: only what is equal now would be decided otherwise.
        self.decisions.add(("==", left.index, self.node(right).index))
        return True

    def less(self, left: ProgramNode, right: ProgramNode) -> bool:
        self.decisions.add(("<", left.index, right.index))
        return bool(left.value < right.value)
