"""List of simple operations on registers that carries out an elimination, in numpy or in a compiled loop.

A register holds one number for every point. What an operation does with its target t, from registers a and b:

    LAW       t = dynamic stiffness of slot a
    CONSTANT  t = factor
    SUM       t = r_a + factor r_b;  the point is uncertain where little is left of r_b
    PIVOT     as SUM, but not checked: the shares of the sum are
    PRODUCT   t = r_a r_b
    QUOTIENT  t = r_a / r_b
    INVERSE   t = 1 / r_a
    WATCH     the point is uncertain where r_a, a share of a sum, is large
    OUTPUT    value number t = factor r_a

Only what an output needs is on the tape, and a register is used again as soon as what it holds is needed no more: the
numbers of a walk stay in the cache however large the drivetrain is.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LAW, CONSTANT, SUM, PIVOT, PRODUCT, QUOTIENT, INVERSE, WATCH, OUTPUT = range(9)
"""Codes of the operations on an elimination's tape, each with the meaning listed at the head of the module."""
_READS = {SUM: 2, PIVOT: 2, PRODUCT: 2, QUOTIENT: 2, INVERSE: 1, WATCH: 1, OUTPUT: 1}
"""Number of registers that an operation reads, by its code, where operations not listed read none."""


class Operation(NamedTuple):
    """Operation of an elimination, as code, target register, two source registers and a factor."""

    code: int
    t: int
    a: int = 0
    b: int = 0
    factor: float = 1.0

    @property
    def read(self) -> tuple[int, ...]:
        return (self.a, self.b)[: _READS.get(self.code, 0)]

    @property
    def sets(self) -> bool:
        return self.code not in (WATCH, OUTPUT)


@dataclass(frozen=True, eq=False)
class Tape:
    """Operations (n, 4) of an elimination with factors (n,), and the numbers of registers and output values."""

    operations: NDArray[np.int64]
    factors: NDArray[np.float64]
    n_registers: int
    n_values: int

    def __len__(self) -> int:
        return len(self.operations)

    @property
    def reached(self) -> list[int]:
        """Numbers of the output values that any excitation reaches. All others are zero whatever the stiffnesses."""
        found: list[int] = self.operations[self.operations[:, 0] == OUTPUT, 1].tolist()
        return found


class TapeQuantity(NamedTuple):
    """Quantity in an elimination, ``factor`` times the result of operation ``name``, or ``factor`` if ``name`` < 0."""

    name: int
    factor: float


@dataclass
class Writer:
    """Operations of an elimination as they are written down.

    Scalar factors are carried along until an operation needs them.
    """

    operations: list[Operation] = field(default_factory=list)
    n_names: int = 0

    def new(self, code: int, a: int = 0, b: int = 0, factor: float = 1.0) -> int:
        """Append an operation of an elimination and return the number by which its result is named."""
        self.operations.append(Operation(code, self.n_names, a, b, factor))
        self.n_names += 1
        return self.n_names - 1

    def name(self, quantity: TapeQuantity) -> int:
        return quantity.name if quantity.name >= 0 else self.new(CONSTANT)

    def plus(self, known: TapeQuantity | None, term: TapeQuantity, code: int = SUM) -> TapeQuantity:
        """Sum of two quantities of an elimination, or ``term`` itself where ``known`` is None."""
        if known is None or not known.factor:
            return term
        if known.name < 0 and term.name < 0:
            return TapeQuantity(-1, known.factor + term.factor)
        first, second = self.name(known), self.name(term)
        return TapeQuantity(self.new(code, first, second, term.factor / known.factor), known.factor)

    def times(self, first: TapeQuantity, second: TapeQuantity) -> TapeQuantity:
        factor = first.factor * second.factor
        if first.name < 0 or second.name < 0:
            return TapeQuantity(max(first.name, second.name), factor)
        return TapeQuantity(self.new(PRODUCT, first.name, second.name), factor)

    def over(self, above: TapeQuantity, below: TapeQuantity) -> TapeQuantity:
        factor = above.factor / below.factor
        if above.name < 0:
            return TapeQuantity(self.new(INVERSE, self.name(below)), factor)
        return TapeQuantity(self.new(QUOTIENT, above.name, self.name(below)), factor)

    def watch(self, share: TapeQuantity) -> None:
        self.operations.append(Operation(WATCH, 0, share.name, 0, abs(share.factor)))

    def output(self, number: int, value: TapeQuantity) -> None:
        self.operations.append(Operation(OUTPUT, number, self.name(value), 0, value.factor))

    def tape(self, n_values: int) -> Tape:
        """Tape of the operations that the outputs of an elimination depend on, with registers for their results."""
        placed, n_registers = _with_registers(_needed(self.operations))
        operations = np.array([one[:4] for one in placed], dtype=np.int64).reshape(-1, 4)
        return Tape(operations, np.array([one.factor for one in placed]), n_registers, n_values)


def _needed(operations: list[Operation]) -> list[Operation]:
    """Operations of an elimination that at least one output depends on, in their order."""
    used: set[int] = set()
    kept = []
    for one in reversed(operations):
        if one.code == OUTPUT or (one.a if one.code == WATCH else one.t) in used:
            used.update(one.read)
            kept.append(one)
    return kept[::-1]


def _with_registers(operations: list[Operation]) -> tuple[list[Operation], int]:
    """Operations of an elimination with registers in place of named results, and the number of registers.

    A register is reused after the last operation on its name.
    """
    last = {name: place for place, one in enumerate(operations) for name in one.read}
    home: dict[int, int] = {}
    free: list[int] = []
    placed, count = [], 0
    for place, one in enumerate(operations):
        sources = [home[name] for name in one.read]
        target = one.t
        # Never the place of a source: compilers make vector instructions only of what does not overlap.
        if one.sets:
            if not free:
                free.append(count)
                count += 1
            target = home[one.t] = free.pop()
        free += [home.pop(name) for name in dict.fromkeys(one.read) if last[name] == place]
        a, b = (*sources, one.a, one.b)[:2] if len(sources) != 1 else (sources[0], one.b)
        placed.append(Operation(one.code, target, a, b, one.factor))
    return placed, count
