"""Sparse systems of linear equations in ball arithmetic: one order of pivots, followed at many frequencies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import acb

Entries = Mapping[tuple[str, str], acb]


class SingularError(ArithmeticError):
    """No pivot is certain to differ from zero at this precision."""


@dataclass(frozen=True)
class Order:
    """Pivots (row, column), with the rows below each that it has to be subtracted from."""

    steps: tuple[tuple[str, str, tuple[str, ...]], ...]
    sign: int


def rows_of(entries: Entries) -> dict[str, dict[str, acb]]:
    rows: dict[str, dict[str, acb]] = {}
    for (row, column), value in entries.items():
        rows.setdefault(row, {})[column] = value
    return rows


def make_order(entries: Entries, names: Sequence[str]) -> Order:
    """Pivots that fill in little, certain not to vanish where the entries were taken."""
    rows = rows_of(entries)
    columns: dict[str, set[str]] = {name: set() for name in names}
    for row, column in entries:
        columns[column].add(row)
    steps = []
    while rows:
        pivot = (
            min(
                ((len(at) - 1) * (len(columns[column]) - 1), row, column)
                for row, at in rows.items()
                for column, value in at.items()
                if not value.contains(0)
            )
            if any(not value.contains(0) for at in rows.values() for value in at.values())
            else None
        )
        if pivot is None:
            raise SingularError
        _, row, column = pivot
        below = tuple(sorted(columns[column] - {row}))
        steps.append((row, column, below))
        _eliminate(rows, row, column, below)
        for other in rows.pop(row):
            columns[other].discard(row)
            for name in below:
                if other in rows[name]:
                    columns[other].add(name)
        del columns[column]
    return Order(tuple(steps), _sign([names.index(row) for row, *_ in steps], [names.index(c) for _, c, _ in steps]))


def _eliminate(rows: dict[str, dict[str, acb]], row: str, column: str, below: Sequence[str]) -> dict[str, acb]:
    """Subtract the pivot row from those below; the factors by row."""
    pivot = rows[row]
    factors = {}
    for name in below:
        at = rows[name]
        factor = factors[name] = at.pop(column) / pivot[column]
        for other, value in pivot.items():
            if other != column:
                at[other] = at[other] - factor * value if other in at else -factor * value
    return factors


def _sign(rows: Sequence[int], columns: Sequence[int]) -> int:
    """Of the permutation that takes the rows to the columns."""
    target, seen, sign = dict(zip(rows, columns, strict=True)), set(), 1
    for start in target:
        length, at = 0, start
        while at not in seen:
            seen.add(at)
            at = target[at]
            length += 1
        if length and length % 2 == 0:
            sign = -sign
    return sign


def determinant(entries: Entries, order: Order) -> acb:
    rows = rows_of(entries)
    product = acb(order.sign)
    for row, column, below in order.steps:
        if rows[row][column].contains(0):
            raise SingularError
        product *= rows[row][column]
        _eliminate(rows, row, column, below)
    return product


def solve(entries: Entries, order: Order, loads: Sequence[Mapping[str, acb]]) -> list[dict[str, acb]]:
    """The unknowns under each load (row to value)."""
    rows = rows_of(entries)
    work = [dict(load) for load in loads]
    for row, column, below in order.steps:
        if rows[row][column].contains(0):
            raise SingularError
        factors = _eliminate(rows, row, column, below)
        for load in work:
            if row in load:
                for name, factor in factors.items():
                    load[name] = load.get(name, 0) - factor * load[row]
    return [_back(rows, order, load) for load in work]


def _back(rows: Mapping[str, Mapping[str, acb]], order: Order, load: Mapping[str, acb]) -> dict[str, acb]:
    found: dict[str, acb] = {}
    for row, column, _ in reversed(order.steps):
        value = load.get(row, acb(0))
        for other, entry in rows[row].items():
            if other != column and other in found:
                value = value - entry * found[other]
        found[column] = value / rows[row][column]
    return found
