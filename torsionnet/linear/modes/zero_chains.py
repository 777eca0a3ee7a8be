"""Chains of motions for poles at zero, by which these are taken out of the characteristic equation.

A motion x(s) = x_0 + s x_1 + .. for which P(s) x(s) begins with s^k (a root polynomial; its coefficients are a Jordan
chain: I. Gohberg, P. Lancaster and L. Rodman, "Matrix polynomials", 1982, section 1.5) replaces a coordinate,

    P(s) x(s) / s^k    in the column of that coordinate

which takes k roots at zero out of det P and leaves all others. While the matrix is still singular at zero, a null
vector gives the next chain. All numbers are exact: a root at zero is not distinguished from a slow root by its size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from torsionnet.base.errors import SolveError
from torsionnet.linear.modes.exact_pencil import ExactPencil, ExactVector, is_singular
from torsionnet.model.elimination import reduce_rows


@dataclass(frozen=True)
class ZeroChain:
    """Motion x(s) of a root at zero, as vectors by power of s, and the power k with which P(s) x(s) begins."""

    motion: tuple[ExactVector, ...]
    order: int


def zero_chains(pencil: ExactPencil, weights: Sequence[float]) -> dict[int, ZeroChain]:
    """Chains of motions for poles at zero, by the index of the column of P(s) that each replaces.

    The sum of their orders is the number of roots at zero.

    Each replaces the column whose entry in a null vector is largest by ``weights`` (n,).

    Raises
    ------
    SolveError
        The determinant vanishes at every s.
    """
    chains: dict[int, ZeroChain] = {}
    most = sum(len(one.numerator) for one in pencil.delayed) + sum(
        max((len(values) for (row, _), values in pencil.undelayed.items() if row == i), default=0)
        for i in range(pencil.size)
    )
    while is_singular(rows := deflated_coefficient(pencil, chains, 0)):
        vectors = null_vectors(rows)
        if not vectors:
            break
        if sum(one.order for one in chains.values()) > most:
            text = "the torques of controllers cancel the dynamic stiffness: no motion balances a load"
            raise SolveError(f"{text}; change a control law")
        column, chain = _next_chain(vectors[0], chains, weights)
        chains[column] = chain
    return chains


def deflated_coefficient(pencil: ExactPencil, chains: Mapping[int, ZeroChain], power: int) -> list[dict[int, Fraction]]:
    """Rows (column -> rational) of the s^power coefficient in P(s), with some poles at zero taken out."""
    rows = [{j: value for j, value in row.items() if j not in chains} for row in pencil.coefficient_rows(power)]
    for j, chain in chains.items():
        for m, vector in enumerate(chain.motion):
            if m <= chain.order + power:
                for i, value in pencil.coefficient_times(chain.order + power - m, vector).items():
                    rows[i][j] = rows[i].get(j, Fraction(0)) + value
    return [{j: value for j, value in row.items() if value} for row in rows]


def null_vectors(rows: Sequence[ExactVector]) -> list[dict[int, Fraction]]:
    """Vectors (column -> rational) that span the null space of a square matrix of rationals, exactly."""
    size = len(rows)
    solved = reduce_rows([row for row in rows if row], {i: i for i in range(size)}).solved
    found = {column: {column: Fraction(1)} for column in range(size) if column not in solved}
    if found:
        for name, row in solved.items():
            for column, value in row.items():
                found[column][name] = value
    return list(found.values())


def _next_chain(
    vector: ExactVector, chains: Mapping[int, ZeroChain], weights: Sequence[float]
) -> tuple[int, ZeroChain]:
    """Index of the column of P(s) that a null vector replaces, and the chain of motions that replaces it."""
    orders = {i: chains[i].order if i in chains else 0 for i in vector}
    highest = max(orders.values())
    column = max((i for i in vector if orders[i] == highest), key=lambda i: abs(float(vector[i])) * weights[i])
    motion: dict[int, dict[int, Fraction]] = {}
    for i, factor in vector.items():
        for m, part in enumerate(chains[i].motion if i in chains else ({i: Fraction(1)},)):
            held = motion.setdefault(m + highest - orders[i], {})
            for j, value in part.items():
                held[j] = held.get(j, Fraction(0)) + factor / vector[column] * value
    whole = tuple({j: value for j, value in motion.get(m, {}).items() if value} for m in range(max(motion) + 1))
    return column, ZeroChain(whole, highest + 1)
