"""Exact elimination in sparse homogeneous equations between named unknowns.

Rows are maps from name to coefficient; the arithmetic is whatever the coefficients bring along (exact rationals decide
pivots and rank, twins of rational and symbol carry the symbols along). Knows nothing of drivetrains.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

N = TypeVar("N", bound=Hashable)


@dataclass(frozen=True)
class Reduction:
    """Solution of the rows: every eliminated name in terms of the free ones.

    Attributes
    ----------
    solved : dict
        Eliminated name -> row over the free names; an empty row means the name is held at zero.
    origins : dict
        Eliminated name -> indices of the rows its solution rests on.
    redundant : dict
        Index of every row that followed from earlier ones -> indices of those.
    blocked : dict
        Index of every row that only involves names to be kept -> indices it rests on; these rows stay unsatisfied.
    """

    solved: dict[Any, dict[Any, Any]]
    origins: dict[Any, frozenset[int]]
    redundant: dict[int, frozenset[int]]
    blocked: dict[int, frozenset[int]]

    @property
    def rank(self) -> int:
        return len(self.solved)


def exact(number: Any) -> Fraction:
    """The rational a number was written as: 0.1 becomes 1/10, not its binary neighbour."""
    return (
        number
        if isinstance(number, Fraction)
        else Fraction(repr(float(number)))
        if isinstance(number, float)
        else Fraction(number)
    )


def reduce_rows(rows: Sequence[Mapping[N, Any]], order: Mapping[N, int], keep: Collection[N] = ()) -> Reduction:
    """Solve ``rows`` one after the other, each for its unknown that is last in ``order`` and not in ``keep``."""
    solved: dict[Any, dict[Any, Any]] = {}
    origins: dict[Any, frozenset[int]] = {}
    users: dict[Any, set[Any]] = {}
    redundant: dict[int, frozenset[int]] = {}
    blocked: dict[int, frozenset[int]] = {}
    for index, row in enumerate(rows):
        current, origin = substitute(row, solved), _origin(row, solved, origins)
        if not current:
            redundant[index] = origin
            continue
        candidates = [name for name in current if name not in keep]
        if not candidates:
            blocked[index] = origin
            continue
        pivot = max(candidates, key=lambda name: order[name])
        factor = current.pop(pivot)
        solution = {name: -coefficient / factor for name, coefficient in current.items()}
        origin = origin | {index}
        for user in users.pop(pivot, set()):
            solved[user] = _replace(solved[user], pivot, solution)
            origins[user] |= origin
            for name in solution:
                users.setdefault(name, set()).add(user)
        solved[pivot], origins[pivot] = solution, origin
        for name in solution:
            users.setdefault(name, set()).add(pivot)
    return Reduction(solved, origins, redundant, blocked)


def substitute(row: Mapping[Any, Any], solved: Mapping[Any, Mapping[Any, Any]]) -> dict[Any, Any]:
    """The row with every solved name replaced by its solution; exact zeros drop out."""
    result: dict[Any, Any] = {}
    for name, coefficient in row.items():
        if name in solved:
            for free, factor in solved[name].items():
                _add(result, free, coefficient * factor)
        else:
            _add(result, name, coefficient)
    return {name: coefficient for name, coefficient in result.items() if coefficient != 0}


def _origin(row: Mapping[Any, Any], solved: Mapping[Any, Any], origins: Mapping[Any, frozenset[int]]) -> frozenset[int]:
    return frozenset[int]().union(*(origins[name] for name in row if name in solved))


def _replace(row: dict[Any, Any], name: Any, solution: Mapping[Any, Any]) -> dict[Any, Any]:
    result = dict(row)
    coefficient = result.pop(name, None)
    if coefficient is not None:
        for free, factor in solution.items():
            _add(result, free, coefficient * factor)
    return {free: value for free, value in result.items() if value != 0}


def _add(row: dict[Any, Any], name: Any, value: Any) -> None:
    row[name] = row[name] + value if name in row else value


def smallest_culprits(rows: Sequence[Mapping[N, Any]], suspects: Collection[int], fails: Any) -> list[int]:
    """A smallest set among ``suspects`` for which ``fails(rows of the set)`` still holds: drop one after the other."""
    kept = sorted(suspects)
    for index in sorted(suspects):
        without = [other for other in kept if other != index]
        if fails([rows[other] for other in without]):
            kept = without
    return kept
