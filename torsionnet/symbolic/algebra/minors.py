"""Determinants of sparse matrices of program nodes without division, with each minor recorded once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from torsionnet.base.errors import UsageError
from torsionnet.base.program import Program, ProgramNode

SparseRow: TypeAlias = Mapping[int, ProgramNode]
"""Row of a sparse matrix, the node of a program in each column that is not zero."""

MOST_MINORS = 20_000
"""Largest number of products recorded before a symbolic determinant is given up, a limit on time and memory."""


def sparse_determinant(rows: Sequence[SparseRow], program: Program) -> ProgramNode:
    """Determinant of a sparse matrix of program nodes by Laplace's expansion along its rows, as a node.

    Raises
    ------
    UsageError
        It would take too many steps.

    Examples
    --------
    >>> program = Program()
    >>> a, b, c = (program.leaf(value) for value in (2, 3, 5))
    >>> program.constant(sparse_determinant([{0: a, 1: b}, {0: c, 1: a}], program))
    Fraction(-11, 1)
    """
    order = _rows_opening_few_columns(rows)
    # Minors of the rows so far by their columns as bits: each is recorded once, however many rows need it.
    minors = {0: program.leaf(_parity(order))}
    steps = 0
    for place, number in enumerate(order):
        # Columns that no later row has must be taken by now.
        later = {column for other in order[place + 1 :] for column in rows[other]}
        closed = sum(1 << column for column in range(len(rows)) if column not in later)
        wider: dict[int, ProgramNode] = {}
        for used, minor in minors.items():
            for column, entry in rows[number].items():
                now = used | 1 << column
                if used >> column & 1 or closed & ~now:
                    continue
                # Laplace: the sign counts the columns on the right that are taken already.
                term = minor * entry * (-1 if (used >> column).bit_count() % 2 else 1)
                wider[now] = wider[now] + term if now in wider else term
                steps += 1
        if steps > MOST_MINORS:
            raise UsageError(
                "the closed loops have too many terms for a symbolic formula; use frequency_response instead",
                kind="too-large",
            )
        minors = wider
    return minors.get((1 << len(rows)) - 1, program.leaf(0))


def _rows_opening_few_columns(rows: Sequence[SparseRow]) -> list[int]:
    """Order of a sparse matrix's rows, as indices, in which few columns are begun and unfinished at any time."""
    left, begun, order = set(range(len(rows))), set[int](), list[int]()
    # Next the row that begins the fewest new columns.
    while left:
        number = min(left, key=lambda row: (len(set(rows[row]) - begun), row))
        left.remove(number)
        begun |= set(rows[number])
        order.append(number)
    return order


def _parity(order: Sequence[int]) -> int:
    swaps = sum(first > second for place, first in enumerate(order) for second in order[place + 1 :])
    return -1 if swaps % 2 else 1
