"""Symbolic network of a drivetrain, with laws (inertia, damping, stiffness) on rows over its coordinates."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeAlias, TypeVar

import sympy

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
        grounds: dict[str, list[L]] = {}
        for member in self.members:
            if len(member.row) == 1:
                grounds.setdefault(next(iter(member.row)), []).append(member.law)
        return grounds

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
