"""Determinants of blocks with closed loops or laws over several coordinates, by deletion and contraction.

det(D + y a a^T) = det D + y a_v^2 det(D on the motions with a = 0), and so for every bilinear form of the adjugate:
one law less in the first term, one coordinate less in the second, and both again trees of smaller blocks. Blocks with
more than a few loops are left to sympy's characteristic polynomial.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from math import comb
from typing import Any

import sympy
from sympy.polys.matrices import DomainMatrix

from torsionnet.base.errors import UsageError
from torsionnet.base.program import Program, ProgramNode
from torsionnet.symbolic.algebra.network import ONE, Contraction, Network, NetworkMember, SymbolRow, add_parallel_laws
from torsionnet.symbolic.algebra.recursion import GraphBlock, Quotient, Recursion, SolvedBlock, sum_of_quotients

# Determinants of blocks with many closed loops, by sympy's characteristic polynomial in laws and ratios.

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
                "short expression; use frequency_response",
                kind="too-large",
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
    def _angles_and_determinant(self) -> tuple[Any, Any]:
        """Numerators of the block's angles under unit torque nearest the root, and determinant, as ring polynomials."""
        count = len(self._members) + len(self._ratios) + 1
        ring, unknowns = sympy.polys.rings.xring([f"x_{i}" for i in range(count)], sympy.QQ)
        index = {name: number for number, name in enumerate(self.names)}
        rows = [[ring.zero] * len(index) for _ in index]
        for first, second, term in self._matrix_terms(unknowns):
            rows[index[first]][index[second]] += term
        domain, size = ring.to_domain(), len(index)
        load = [[ring.one if name == self.block.top else ring.zero] for name in self.names]
        stiffness = DomainMatrix(rows, (size, size), domain)
        motion, determinant = stiffness.solve_den(DomainMatrix(load, (size, 1), domain), method="charpoly")
        return motion, determinant

    def _matrix_terms(self, unknowns: Sequence[Any]) -> Iterator[tuple[str, str, Any]]:
        """Yield row and column (coordinates by name) and value of each term of the block's dynamic stiffness matrix."""
        ratio = dict(zip(self._ratios, unknowns[len(self._members) :], strict=False))

        def in_ring(value: Any) -> Any:
            return sympy.QQ(value.p, value.q) if value.is_Rational else ratio[value]

        for law, member in zip(unknowns, self._members, strict=False):
            for (first, alpha), (second, beta) in product(member.row.items(), repeat=2):
                yield first, second, law * in_ring(alpha) * in_ring(beta)
        # det(D + x e e^T) = det D + x det(D with the top held): one determinant gives both.
        yield self.block.top, self.block.top, unknowns[-1]

    def _determinant(self, power: int) -> ProgramNode:
        terms = {powers: value for powers, value in self._angles_and_determinant[1].terms() if powers[-1] == power}
        return self._node(terms, self._laws())

    def _motion(self, name: str, without: str = "") -> ProgramNode:
        terms = dict(self._angles_and_determinant[0][self.names.index(name), 0].element.terms())
        return self._node(terms, self._laws(without))

    def _laws(self, without: str = "") -> list[Quotient]:
        unit = self.program.leaf(1)
        idle = self.hanging.get(without)
        return [Quotient(unit, unit) if member.law is idle else member.law for member in self._members]

    def _node(self, terms: Mapping[tuple[int, ...], Any], laws: Sequence[Quotient]) -> ProgramNode:
        """Polynomial in laws and ratios as a node of the program, nested by one unknown after the other."""
        unit = self.program.leaf(1)
        return self._nested(terms, [*laws, *(Quotient(self.program.leaf(ratio), unit) for ratio in self._ratios)], 0)

    def _nested(self, terms: Mapping[tuple[int, ...], Any], payloads: Sequence[Quotient], depth: int) -> ProgramNode:
        if not terms or depth == len(payloads):
            return self.program.leaf(sum(sympy.QQ.to_sympy(value) for value in terms.values()))
        by_power: dict[int, dict[tuple[int, ...], Any]] = {}
        for powers, coefficient in terms.items():
            by_power.setdefault(powers[depth], {})[powers] = coefficient
        unknown, total = payloads[depth], self.program.leaf(0)
        top = max(1, *by_power)
        # Horner's rule; a law enters once at most, as above / below, and ratios have the denominator 1.
        for power in range(top, -1, -1):
            share = self._nested(by_power.get(power, {}), payloads, depth + 1)
            total = total * unknown.above + (share if power == top else share * unknown.below)
        return total


MOST_LOOPS = 3
"""Largest number of loops in a block solved by deletion and contraction, as with more the characteristic polynomial is
shorter."""
MOST_FORESTS = 2000
"""Largest number of forests that deletion and contraction may lead to in one block, as that is the length of the
result."""


def solve_block(block: GraphBlock[Quotient], hanging: Mapping[str, Quotient], program: Program) -> SolvedBlock:
    """Solved block of more than two coordinates, with its determinants and readings, parts beyond it included."""
    loops = loops_of(block)
    # Every loop is opened at one of the laws, which leaves so many forests at most.
    if loops > MOST_LOOPS or comb(len(block.members), loops) > MOST_FORESTS:
        return ExpandedBlock(block, hanging, program)
    return SplitBlock(block, hanging, program)


def loops_of(block: GraphBlock[Quotient]) -> int:
    """Number of loops of a block, its laws over more than two coordinates plus its pairs beyond a spanning tree."""
    pairs = {frozenset(member.row) for member in block.members if len(member.row) == 2}
    wide = sum(len(member.row) > 2 for member in block.members)
    return wide + max(0, len(pairs) - len(block.below))


@dataclass(frozen=True, eq=False)
class SplitBlock:
    """Block solved by splitting off one law, once without that law and once with its motion constrained to zero."""

    block: GraphBlock[Quotient]
    hanging: Mapping[str, Quotient]
    program: Program
    others: dict[str, SplitBlock] = field(default_factory=dict)

    @cached_property
    def network(self) -> Network[Quotient]:
        """Network of one block, in which the parts beyond it are laws to ground."""
        grounds = (NetworkMember({name: ONE}, law) for name, law in self.hanging.items())
        return Network((self.block.top, *self.block.below), (*self.block.members, *grounds))

    @cached_property
    def member(self) -> NetworkMember[Quotient]:
        """Law that is split off a block, the one over most coordinates, else of the fewest between two coordinates."""
        among = Counter(frozenset(member.row) for member in self.block.members)
        return max(self.block.members, key=lambda member: (len(member.row), -among[frozenset(member.row)]))

    @cached_property
    def contraction(self) -> Contraction[Quotient]:
        return self.network.without(self.member).contracted(self.member.row, keep=self.block.top)

    @cached_property
    def deleted(self) -> Recursion:
        return Recursion(self.network.without(self.member), self.program, self.block.top, solve_block)

    @cached_property
    def contracted(self) -> Recursion:
        network = add_parallel_laws(self.contraction.network, lambda laws: sum_of_quotients(laws, self.program))
        return Recursion(network, self.program, self.block.top, solve_block)

    @cached_property
    def weight(self) -> ProgramNode:
        """Program node that multiplies the determinant of the network in which the split law's motion is zero."""
        result = self.program.leaf(self.contraction.factor) * self.member.law.above
        # The contracted network lacks the denominators of laws that cannot act in it.
        for law in self.contraction.idle:
            result = result * law.below
        return result

    def _joined(self, deleted: ProgramNode, contracted: ProgramNode) -> ProgramNode:
        return self.member.law.below * deleted + self.weight * contracted

    @cached_property
    def held(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root held, a program node."""
        return self._joined(self.deleted.held, self.contracted.held)

    @cached_property
    def free(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root free, a program node."""
        return self._joined(self.deleted.determinant, self.contracted.determinant)

    def reading(self, row: SymbolRow) -> ProgramNode:
        """Numerator (program node) of a sensor's reading in the block under a unit torque nearest the root."""
        return self._joined(self.deleted.reading(row), self.contracted.reading(self.contraction.row(row)))

    def carried(self, end: str) -> ProgramNode:
        """Numerator (program node) of a coordinate's angle without parts beyond, under unit torque nearest the root."""
        if end not in self.others:
            bare = {name: law for name, law in self.hanging.items() if name != end}
            self.others[end] = replace(self, hanging=bare, others={})
        return self.others[end].reading({end: ONE})
