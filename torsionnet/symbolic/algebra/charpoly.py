"""Determinants of blocks with many closed loops, by sympy's characteristic polynomial in laws and ratios."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import sympy
from sympy.polys.matrices import DomainMatrix

from torsionnet.base.errors import UsageError
from torsionnet.symbolic.algebra.network import ONE, NetworkMember, Program, ProgramNode, SymbolRow
from torsionnet.symbolic.algebra.recursion import GraphBlock, Quotient

MOST_COORDINATES = 12
"""Largest number of coordinates of a block whose determinant is expanded, as the number of terms grows exponentially
with it."""


@dataclass(frozen=True, eq=False)
class ExpandedBlock:
    """Block of a network whose determinants are polynomials multiplied out in its laws and ratios.

    Raises
    ------
    UsageError
        There are more coordinates than this way can handle.
    """

    block: GraphBlock[Quotient]
    hanging: Mapping[str, Quotient]
    program: Program

    def __post_init__(self) -> None:
        if len(self.names) > MOST_COORDINATES:
            raise UsageError(
                f"{len(self.names)} coordinates that closed loops or planetary sets tie together in many ways have no "
                "short expression; use frequency_response"
            )

    @cached_property
    def names(self) -> tuple[str, ...]:
        return (self.block.top, *self.block.below)

    @property
    def free(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root free, a program node."""
        return self._determinant(0)

    @property
    def held(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root held, a program node."""
        return self._determinant(1)

    def carried(self, end: str) -> ProgramNode:
        """Numerator (program node) of a coordinate's angle without parts beyond, under unit torque nearest the root."""
        return self._motion(end, without=end)

    def reading(self, row: SymbolRow) -> ProgramNode:
        """Numerator (program node) of a sensor's reading in the block under a unit torque nearest the root."""
        total = self.program.leaf(0)
        for name, value in row.items():
            total = total + self.program.leaf(value) * self._motion(name)
        return total

    @cached_property
    def _members(self) -> tuple[NetworkMember[Quotient], ...]:
        return (*self.block.members, *(NetworkMember({name: ONE}, law) for name, law in self.hanging.items()))

    @cached_property
    def _ratios(self) -> tuple[Any, ...]:
        values = (value for member in self._members for value in member.row.values() if not value.is_Rational)
        return tuple(dict.fromkeys(values))

    @cached_property
    def _solved(self) -> tuple[Any, Any]:
        """Numerators of the block's angles under unit torque nearest the root, and determinant, as ring polynomials."""
        count = len(self._members) + len(self._ratios) + 1
        ring, unknowns = sympy.polys.rings.xring([f"x_{i}" for i in range(count)], sympy.QQ)
        index = {name: number for number, name in enumerate(self.names)}
        rows = [[ring.zero] * len(index) for _ in index]
        for first, second, term in self._terms(unknowns):
            rows[index[first]][index[second]] += term
        domain, size = ring.to_domain(), len(index)
        load = [[ring.one if name == self.block.top else ring.zero] for name in self.names]
        stiffness = DomainMatrix(rows, (size, size), domain)
        motion, determinant = stiffness.solve_den(DomainMatrix(load, (size, 1), domain), method="charpoly")
        return motion, determinant

    def _terms(self, unknowns: Sequence[Any]) -> Iterator[tuple[str, str, Any]]:
        """Yield row and column (coordinates by name) and value of each term of the block's dynamic stiffness matrix."""
        ratio = dict(zip(self._ratios, unknowns[len(self._members) :], strict=False))

        def in_ring(value: Any) -> Any:
            return sympy.QQ(value.p, value.q) if value.is_Rational else ratio[value]

        for law, member in zip(unknowns, self._members, strict=False):
            for (first, alpha), (second, beta) in product(member.row.items(), repeat=2):
                yield first, second, law * in_ring(alpha) * in_ring(beta)
        yield self.block.top, self.block.top, unknowns[-1]

    def _determinant(self, power: int) -> ProgramNode:
        terms = {powers: value for powers, value in self._solved[1].terms() if powers[-1] == power}
        return self._node(terms, self._laws())

    def _motion(self, name: str, without: str = "") -> ProgramNode:
        terms = dict(self._solved[0][self.names.index(name), 0].element.terms())
        return self._node(terms, self._laws(without))

    def _laws(self, without: str = "") -> list[Quotient]:
        one = self.program.leaf(1)
        idle = self.hanging.get(without)
        return [Quotient(one, one) if member.law is idle else member.law for member in self._members]

    def _node(self, terms: Mapping[tuple[int, ...], Any], laws: Sequence[Quotient]) -> ProgramNode:
        """Polynomial in laws and ratios as a node of the program, nested by one unknown after the other."""
        one = self.program.leaf(1)
        return self._nested(terms, [*laws, *(Quotient(self.program.leaf(ratio), one) for ratio in self._ratios)], 0)

    def _nested(self, terms: Mapping[tuple[int, ...], Any], payloads: Sequence[Quotient], depth: int) -> ProgramNode:
        if not terms or depth == len(payloads):
            return self.program.leaf(sum(sympy.QQ.to_sympy(value) for value in terms.values()))
        by_power: dict[int, dict[tuple[int, ...], Any]] = {}
        for powers, coefficient in terms.items():
            by_power.setdefault(powers[depth], {})[powers] = coefficient
        unknown, total = payloads[depth], self.program.leaf(0)
        top = max(1, *by_power)
        for power in range(top, -1, -1):
            share = self._nested(by_power.get(power, {}), payloads, depth + 1)
            total = total * unknown.above + (share if power == top else share * unknown.below)
        return total
