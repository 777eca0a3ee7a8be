"""The drivetrain as the recursion sees it: coordinates, and laws on rows over them, in symbols."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import sympy

SymbolRow: TypeAlias = Mapping[str, Any]
"""Coordinate -> sympy expression, nowhere zero."""

ONE = sympy.Integer(1)
ZERO = sympy.Integer(0)


@dataclass(frozen=True)
class Stiffness:
    """Dynamic stiffness J s^2 + c s + k; hysteresis and tables stand in k."""

    stiffness: Any = ZERO
    damping: Any = ZERO
    inertia: Any = ZERO

    @property
    def parts(self) -> tuple[Any, Any, Any]:
        """Coefficients of 1, s, s^2."""
        return self.stiffness, self.damping, self.inertia


@dataclass(frozen=True, eq=False)
class Member:
    """A law on a row over coordinates."""

    row: SymbolRow
    law: Stiffness


@dataclass(frozen=True, eq=False)
class Network:
    """D(s) = sum of law * row row^T over the coordinates."""

    coordinates: tuple[str, ...]
    members: tuple[Member, ...]

    @cached_property
    def graph(self) -> Graph:
        """The network with parallel laws added up."""
        return graph_of(self)

    def contracted(self, row: SymbolRow) -> Contraction:
        """The network on the motions with row = 0.

        With the last coordinate v of the row expressed by the others, the coefficient of kappa in
        det(D + kappa a a^T) is a_v^2 times the determinant of what is left, and so for every bilinear form of the
        adjugate.
        """
        pivot = max(row, key=self.coordinates.index)
        solution = {name: -value / row[pivot] for name, value in row.items() if name != pivot}
        members = (Member(substituted(member.row, pivot, solution), member.law) for member in self.members)
        rest = tuple(name for name in self.coordinates if name != pivot)
        return Contraction(Network(rest, tuple(m for m in members if m.row)), pivot, solution, row[pivot] ** 2)

    def without(self, member: Member) -> Network:
        """The network with one law less."""
        return Network(self.coordinates, tuple(other for other in self.members if other is not member))


@dataclass(frozen=True)
class Contraction:
    """A network with one coordinate less, what became of it, and the factor of its determinant."""

    network: Network
    pivot: str
    solution: SymbolRow
    factor: Any

    def row(self, row: SymbolRow) -> SymbolRow:
        """A row over the coordinates before as one over those left."""
        return substituted(row, self.pivot, self.solution)


@dataclass(frozen=True)
class Edge:
    """All laws on the motion theta_first - ratio * theta_second."""

    first: str
    second: str
    ratio: Any
    law: Stiffness

    @property
    def member(self) -> Member:
        return Member({self.first: ONE, self.second: -self.ratio}, self.law)

    def coefficients(self, near: str) -> tuple[Any, Any]:
        """Coefficients of the row at ``near`` and at the other end."""
        return (ONE, -self.ratio) if near == self.first else (-self.ratio, ONE)


@dataclass(frozen=True, eq=False)
class Graph:
    """A network with the laws on equal rows added up: to ground, between two coordinates, and over more."""

    coordinates: tuple[str, ...]
    grounds: Mapping[str, Stiffness]
    edges: tuple[Edge, ...]
    wide: tuple[Member, ...]

    @property
    def network(self) -> Network:
        """The same laws, added up."""
        grounded = (Member({name: ONE}, law) for name, law in self.grounds.items())
        return Network(self.coordinates, (*grounded, *(edge.member for edge in self.edges), *self.wide))


def graph_of(network: Network) -> Graph:
    """Add up parallel laws, each term collected by the ratios it is reflected with."""
    grounds: dict[str, _Collected] = {}
    edges: dict[tuple[str, str, Any], _Collected] = {}
    wide: dict[tuple[tuple[str, Any], ...], _Collected] = {}
    for member in network.members:
        names = sorted(member.row, key=lambda name: member.row[name] not in (1, -1))
        scale = member.row[names[0]]
        if len(names) == 1:
            grounds.setdefault(names[0], _Collected()).add(member.law, scale)
        elif len(names) == 2:  # noqa: PLR2004
            key = _known(edges, names[0], names[1], -member.row[names[1]] / scale)
            own = member.row[key[0]]
            edges.setdefault(key, _Collected()).add(member.law, own)
        else:
            row = tuple((name, value / scale) for name, value in member.row.items())
            wide.setdefault(row, _Collected()).add(member.law, scale)
    return Graph(
        network.coordinates,
        {name: total.law() for name, total in grounds.items()},
        tuple(Edge(*key, total.law()) for key, total in edges.items()),
        tuple(Member(dict(row), total.law()) for row, total in wide.items()),
    )


def _known(edges: Mapping[tuple[str, str, Any], Any], first: str, second: str, ratio: Any) -> tuple[str, str, Any]:
    """The edge, the way round in which it is already there."""
    back = (second, first, 1 / ratio)
    return back if back in edges else (first, second, ratio)


class _Collected:
    """A sum of laws times squared ratios."""

    def __init__(self) -> None:
        self.parts: tuple[dict[Any, Any], ...] = ({}, {}, {})

    def add(self, law: Stiffness, ratio: Any) -> None:
        number, reflected = (ONE, ONE) if ratio in (1, -1) else (ratio**2).as_coeff_Mul()
        for groups, part in zip(self.parts, law.parts, strict=True):
            if part != 0:
                more = part if number is ONE else number * part
                groups[reflected] = groups[reflected] + more if reflected in groups else more

    def law(self) -> Stiffness:
        return Stiffness(*(collected(groups) for groups in self.parts))


def collected(groups: Mapping[Any, Any]) -> Any:
    """Sum of ratio * total, each total expanded by itself."""
    if not groups:
        return ZERO
    if list(groups) == [ONE]:
        return _expanded(groups[ONE])
    return sympy.Add(*(ratio * _expanded(total) for ratio, total in groups.items()))


def _expanded(total: Any) -> Any:
    return total if total.is_Atom else sympy.expand(total)


def row_sum(rows: Iterable[tuple[Any, SymbolRow]]) -> dict[str, Any]:
    """Sum of factor * row; what is zero for all values of the symbols drops out."""
    total: dict[str, Any] = {}
    for factor, row in rows:
        for name, value in row.items():
            total[name] = total[name] + factor * value if name in total else factor * value
    return {name: value for name, value in total.items() if not vanishes(value)}


def substituted(row: SymbolRow, pivot: str, solution: SymbolRow) -> SymbolRow:
    """The row with one coordinate replaced."""
    if pivot not in row:
        return row
    rest = {name: value for name, value in row.items() if name != pivot}
    return row_sum([(ONE, rest), (row[pivot], solution)])


def vanishes(expression: Any) -> bool:
    """Whether an expression is zero for all values of its symbols."""
    return bool(expression == 0 or (expression.is_Add and sympy.cancel(expression) == 0))
