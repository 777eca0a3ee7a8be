"""Many closed loops: sympy's characteristic polynomial, with every law as one unknown of a ring."""

from __future__ import annotations

from typing import Any

import sympy
from sympy.polys.matrices import DomainMatrix

from torsionnet.errors import UsageError
from torsionnet.symbolics.network import Network, SymbolRow
from torsionnet.symbolics.program import Node, Program

MOST_COORDINATES = 12


def charpoly_determinant(network: Network, program: Program) -> Node:
    """Det D."""
    return _solved(network, program, {})[1]


def charpoly_bilinear(network: Network, program: Program, reading: SymbolRow, load: SymbolRow) -> Node:
    """Reading^T adj(D) load.

    Raises
    ------
    UsageError
        There are more coordinates than this way can handle.
    """
    motion, _ = _solved(network, program, load)
    total = program.leaf(0)
    for name, value in reading.items():
        total = total + program.leaf(value) * motion[name]
    return total


def _solved(network: Network, program: Program, load: SymbolRow) -> tuple[dict[str, Node], Node]:
    """Adj(D) load by coordinate, and det D."""
    network = network.graph.network
    size = len(network.coordinates)
    if size > MOST_COORDINATES:
        msg = (
            f"{size} coordinates that closed loops, shafts with inertia of their own or planetary sets tie together "
            "have no short expression; use frequency_response, or replace such a shaft by a spring and inertias"
        )
        raise UsageError(msg)
    payloads = list(dict.fromkeys(_payloads(network, load)))
    ring, generators = sympy.polys.rings.xring([f"x_{i}" for i in range(len(payloads))], sympy.QQ)
    number = dict(zip(payloads, generators, strict=True))
    matrix, right = _matrices(network, load, ring, number)
    if not load:
        return {}, _node(matrix.charpoly()[-1] * (-1) ** size, payloads, program)
    motion, determinant = matrix.solve_den(right, method="charpoly")
    nodes = (_node(motion[row, 0].element, payloads, program) for row in range(size))
    return dict(zip(network.coordinates, nodes, strict=True)), _node(determinant, payloads, program)


def _payloads(network: Network, load: SymbolRow) -> Any:
    for member in network.members:
        yield member.law
        yield from member.row.values()
    yield from load.values()


def _matrices(network: Network, load: SymbolRow, ring: Any, number: dict[Any, Any]) -> tuple[Any, Any]:
    index = {name: position for position, name in enumerate(network.coordinates)}
    size = len(index)
    rows = [[ring.zero] * size for _ in range(size)]
    for member in network.members:
        for first, alpha in member.row.items():
            for second, beta in member.row.items():
                rows[index[first]][index[second]] += (
                    number[member.law] * _in_ring(alpha, number) * _in_ring(beta, number)
                )
    right = [[_in_ring(load[name], number) if name in load else ring.zero] for name in network.coordinates]
    domain = ring.to_domain()
    return DomainMatrix(rows, (size, size), domain), DomainMatrix(right, (size, 1), domain)


def _in_ring(coefficient: Any, number: dict[Any, Any]) -> Any:
    return sympy.QQ(coefficient.p, coefficient.q) if coefficient.is_Rational else number[coefficient]


def _node(polynomial: Any, payloads: list[Any], program: Program) -> Node:
    """A polynomial of the ring as steps, nested by one unknown after the other."""
    return _nested(dict(polynomial.terms()), 0, payloads, program)


def _nested(terms: dict[tuple[int, ...], Any], depth: int, payloads: list[Any], program: Program) -> Node:
    if not terms:
        return program.leaf(0)
    if depth == len(payloads):
        return program.leaf(sympy.QQ.to_sympy(next(iter(terms.values()))))
    by_power: dict[int, dict[tuple[int, ...], Any]] = {}
    for powers, coefficient in terms.items():
        by_power.setdefault(powers[depth], {})[powers] = coefficient
    unknown = program.leaf(payloads[depth])
    total = program.leaf(0)
    for power in range(max(by_power), -1, -1):
        total = total * unknown + _nested(by_power.get(power, {}), depth + 1, payloads, program)
    return total
