"""Exact elimination in sparse homogeneous equations between named unknowns.

Rows are maps from name to coefficient in any arithmetic: exact rationals decide pivots and rank, and numbers that are
recorded over the parameters carry their calculation along.

Sequential elimination of unknowns in linear equations, each row solved for one of its unknowns.

A row that leaves two names ties these in proportion. Nothing is substituted ahead of need: a row is reduced to names
that are still free, and the solution of a name is calculated when it is used.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from heapq import heappop, heappush
from typing import Any

from torsionnet.model.proportions import (
    ProportionalGroup,
    ProportionLink,
    Proportions,
    ProportionSolution,
    rounded_product,
)


@dataclass
class Derivation:
    """Rows of equations, and pairs of proportional unknowns, from which a conclusion on a row follows."""

    rows: list[int] = field(default_factory=list)
    pairs: list[tuple[Any, Any]] = field(default_factory=list)


@dataclass(eq=False)
class Elimination:
    """Elimination of rows one by one, each solved for its unknown that is last in ``order`` and not in ``keep``.

    Attributes
    ----------
    proportions : Proportions
        Groups of names that rows tie in proportion.
    derivation : dict
        Number of a row -> further rows and pairs from which its conclusion follows; negative numbers are conclusions
        drawn after all rows were added.
    redundant : list of int
        Rows that follow from earlier rows.
    blocked : list of int
        Rows that only involve names to be kept; they stay unsatisfied.
    count : int
        Number of rows.
    """

    order: Mapping[Any, int]
    keep: Collection[Any] = ()
    proportions: Proportions = field(default_factory=Proportions)
    derivation: dict[int, Derivation] = field(default_factory=dict)
    redundant: list[int] = field(default_factory=list)
    blocked: list[int] = field(default_factory=list)
    count: int = 0
    _settled: int = 0
    _dependent: list[ProportionalGroup] = field(default_factory=list)
    _to_anchor: dict[Any, Any] = field(default_factory=dict)

    def copy(self, order: Mapping[Any, int], keep: Collection[Any] = ()) -> Elimination:
        """Copy of the elimination with another order of unknowns, to which further rows can be added."""
        new = Elimination(order, keep)
        new.proportions = self.proportions.copy()
        new.derivation, new.redundant, new.blocked = dict(self.derivation), [*self.redundant], [*self.blocked]
        new.count, new._settled = self.count, self._settled
        new._dependent = [new.proportions.group(group.lead) for group in self._dependent]
        return new

    def add(self, row: Mapping[Any, Any]) -> None:
        """Add a row to the elimination and solve it for one of its unknowns."""
        index, self.count = self.count, self.count + 1
        current, derivation = self.condensed(row)
        leads = {self.proportions.group(name).lead: name for name in current}
        candidates = [lead for lead in leads if lead not in self.keep]
        if candidates:
            pivot = leads[max(candidates, key=self.order.__getitem__)]
            factor = current.pop(pivot)
            if len(current) == 1:
                # f x + c y = 0: two names in proportion.
                ((partner, coefficient),) = current.items()
                self.proportions.join(pivot, ProportionLink(partner, factor, coefficient, index))
            else:
                # f x + sum c y = 0: x = sum -(c/f) y, or x = 0 where nothing else is left in the row.
                group, row = self.proportions.group(pivot), {name: -value / factor for name, value in current.items()}
                group.solution = ProportionSolution(pivot, row, index)
                if row:
                    self._dependent.append(group)
                    self.proportions.make_root(pivot)
        elif current:
            self.blocked.append(index)
            derivation.pairs += [(name, lead) for lead, name in leads.items() if name != lead]
        else:
            self.redundant.append(index)
        if derivation.rows or derivation.pairs:
            self.derivation[index] = derivation

    def blocks(self, row: Mapping[Any, Any]) -> bool:
        """Whether the row, reduced, has only unknowns that are to be kept."""
        current, _ = self.condensed(row)
        return bool(current) and all(self.proportions.group(name).lead in self.keep for name in current)

    def condensed(self, row: Mapping[Any, Any]) -> tuple[dict[Any, Any], Derivation]:
        """Coefficients by free name of a row, no two names in proportion, and the rows used for that.

        Exact zeros drop out.
        """
        derivation = Derivation()
        totals: dict[ProportionalGroup, tuple[Any, Any]] = {}
        waiting: list[tuple[int, ProportionalGroup]] = []
        terms: Iterable[tuple[Any, Any]] = row.items()
        while True:
            # One term for each group of names in proportion, y = r x: a x + b y = (a + b r) x.
            for name, coefficient in terms:
                group = self.proportions.group(name)
                if group in totals:
                    first, total = totals[group]
                    if name == first:
                        totals[group] = (first, total + coefficient)
                    else:
                        totals[group] = (first, total + self.proportions.ratio(name, first) * coefficient)
                        derivation.pairs.append((name, first))
                elif group.solution is None or group.solution.row:
                    totals[group] = (name, coefficient)
                    if group.solution is not None:
                        heappush(waiting, (group.solution.number, group))
                else:
                    # The group is held at zero.
                    derivation.rows.append(group.solution.number)
                    derivation.pairs.append((name, group.solution.anchor))
            if not waiting:
                return {name: coefficient for name, coefficient in totals.values() if coefficient != 0}, derivation
            # The group solved first goes out by its solution, x = sum s y, of names solved later or never.
            _, group = heappop(waiting)
            name, coefficient = totals.pop(group)
            assert group.solution is not None
            anchor, solution, index = group.solution
            derivation.rows.append(index)
            if name != anchor:
                coefficient = self.proportions.to_root(name, self._to_anchor) * coefficient
                derivation.pairs.append((name, anchor))
            terms = [(free, share * coefficient) for free, share in solution.items()]

    def back_substitute(self) -> None:
        """Reduce the solution of every eliminated unknown to free names.

        A solution that is a multiple of a name joins its group.

        A solution is made of names that were solved later or never, so the last one comes first.
        """
        dependent, self._dependent = self._dependent, []
        for group in reversed(dependent):
            assert group.solution is not None
            anchor, row, index = group.solution
            row, derivation = self.condensed(row)
            if derivation.rows or derivation.pairs:
                derivation.rows.append(index)
                self._settled += 1
                index = -self._settled
                self.derivation[index] = derivation
            if len(row) == 1:
                # x = c y: the whole group is in proportion to the one free name of its solution.
                ((partner, coefficient),) = row.items()
                group.solution = None
                self.proportions.join(anchor, ProportionLink(partner, 1, -coefficient, index))
            else:
                group.solution = ProportionSolution(anchor, row, index)
                if row:
                    self._dependent.append(group)
                    self.proportions.make_root(anchor)
        self._dependent.reverse()
        self._to_anchor.clear()
        for group in self.proportions.groups():
            self.proportions.make_root(group.solution.anchor if group.solution else group.lead)


_UNIT = object()


class Reduction:
    """Solution of homogeneous linear equations, every eliminated unknown as a row over free ones.

    Attributes
    ----------
    rank : int
        Number of rows that were solved for an unknown.
    redundant : tuple of int
        Rows that follow from earlier rows.
    blocked : tuple of int
        Rows that only involve names to be kept; these stay unsatisfied.
    """

    def __init__(self, elimination: Elimination) -> None:
        elimination.back_substitute()
        self._rows = elimination
        self._proportions = elimination.proportions
        self._ratios: dict[Any, Any] = {}
        self._rounded_ratios: dict[Any, Any] = {}
        self.redundant: tuple[int, ...] = tuple(elimination.redundant)
        self.blocked: tuple[int, ...] = tuple(elimination.blocked)
        self.rank: int = elimination.count - len(self.redundant) - len(self.blocked)

    @property
    def solved(self) -> Mapping[Any, dict[Any, Any]]:
        """Coefficients by free name of every eliminated name; an empty row holds the name at zero."""
        return _Solved(self)

    def followed_by(self, rows: Iterable[Mapping[Any, Any]], order: Mapping[Any, int]) -> Reduction:
        """Solution with further rows added, and without names to be kept."""
        elimination = self._rows.copy(order)
        for row in rows:
            elimination.add(row)
        return Reduction(elimination)

    def eliminated(self) -> Iterator[Any]:
        """Names that are eliminated, for which there is a solution."""
        return (name for name in self._proportions.names() if not self.is_free(name))

    def is_free(self, name: Any) -> bool:
        """Whether the name is free in the solution: solutions are made of it, or no row contains it."""
        group = self._proportions.group(name)
        return group.solution is None and group.lead == name

    def free_names(self, row: Mapping[Any, Any]) -> list[Any]:
        """Free names in a row after its eliminated names are replaced."""
        return [self._proportions.group(name).lead for name in self._rows.condensed(row)[0]]

    def reduced(self, row: Mapping[Any, Any]) -> dict[Any, Any]:
        """Coefficients by free name of a row of any names; exact zeros drop out."""
        current, _ = self._rows.condensed(row)
        return {
            self._proportions.group(name).lead: self._proportions.to_root(name, self._ratios) * value
            for name, value in current.items()
        }

    def in_floats(self, row: Mapping[Any, Any]) -> dict[Any, float]:
        """Coefficients by free name, as floats, of a row of any names; terms that cancel still do so exactly."""
        current, _ = self._rows.condensed(row)
        return {
            self._proportions.group(name).lead: float(
                self._proportions.to_root(name, self._rounded_ratios, rounded_product) * value
            )
            for name, value in current.items()
        }

    def held(self) -> list[Any]:
        """Names that the equations hold at zero, one from each group of names in proportion."""
        solutions = [group.solution for group in self._proportions.groups()]
        return [solution.anchor for solution in solutions if solution and not solution.row]

    def origin(self, name: Any) -> frozenset[int]:
        """Numbers of the rows from which the solution for a name follows."""
        group = self._proportions.group(name)
        if group.solution is None:
            return self._closed(Derivation(pairs=[(name, group.lead)]))
        anchor, row, index = group.solution
        ends = [(free, self._proportions.group(free).lead) for free in row]
        return self._closed(Derivation([index], [(name, anchor), *ends]))

    def origin_of_row(self, index: int) -> frozenset[int]:
        """Numbers of the earlier rows from which the conclusion on a row follows."""
        return self._closed(self._rows.derivation.get(index, Derivation()))

    def _closed(self, derivation: Derivation) -> frozenset[int]:
        closed: set[int] = set()
        waiting = [derivation]
        while waiting:
            derivation = waiting.pop()
            rows = {*derivation.rows, *(row for pair in derivation.pairs for row in self._proportions.between(*pair))}
            waiting += [self._rows.derivation[row] for row in rows - closed if row in self._rows.derivation]
            closed |= rows
        return frozenset(row for row in closed if row >= 0)


class _Solved(Mapping[Any, dict[Any, Any]]):
    """Mapping from each eliminated name to its coefficients by free name, calculated when accessed."""

    def __init__(self, reduction: Reduction) -> None:
        self._reduction = reduction

    def __getitem__(self, name: Any) -> dict[Any, Any]:
        if self._reduction.is_free(name):
            raise KeyError(name)
        return self._reduction.reduced({name: 1})

    def __contains__(self, name: object) -> bool:
        return not self._reduction.is_free(name)

    def __iter__(self) -> Iterator[Any]:
        return self._reduction.eliminated()

    def __len__(self) -> int:
        return self._reduction.rank


def reduce_rows(rows: Iterable[Mapping[Any, Any]], order: Mapping[Any, int], keep: Collection[Any] = ()) -> Reduction:
    """Solution of ``rows`` one after the other, each for its unknown last in ``order`` and not in ``keep``."""
    elimination = Elimination(order, keep)
    for row in rows:
        elimination.add(row)
    return Reduction(elimination)


def substitute(row: Mapping[Any, Any], solved: Mapping[Any, Mapping[Any, Any]]) -> dict[Any, Any]:
    """Coefficients of a row with every solved name replaced by its solution, by name; exact zeros drop out."""
    result: dict[Any, Any] = {}
    for name, coefficient in row.items():
        if name in solved:
            for free, factor in solved[name].items():
                _add(result, free, coefficient * factor)
        else:
            _add(result, name, coefficient)
    return {name: coefficient for name, coefficient in result.items() if coefficient != 0}


def _add(row: dict[Any, Any], name: Any, value: Any) -> None:
    row[name] = row[name] + value if name in row else value


def rows_holding(rows: Sequence[Mapping[Any, Any]], name: Any) -> list[int]:
    """Numbers of the independent ``rows`` that together hold ``name`` at zero."""
    # Shares y of the rows that sum up to the row of the name alone: one equation for each name.
    shares: dict[Any, dict[Any, Any]] = {name: {_UNIT: Fraction(-1)}}
    for index, row in enumerate(rows):
        for other, coefficient in row.items():
            shares.setdefault(other, {})[index] = coefficient
    reduction = reduce_rows(shares.values(), {index: index for index in range(len(rows))}, {_UNIT})
    return [index for index in range(len(rows)) if reduction.free_names({index: 1})]


def smallest_failing_rows(rows: Sequence[Mapping[Any, Any]], suspects: Collection[int], fails: Any) -> list[int]:
    """Smallest set of ``suspects`` for which ``fails(rows of the set)`` is still true, by dropping row after row."""
    kept = sorted(suspects)
    for index in sorted(suspects):
        without = [place for place in kept if place != index]
        if fails([rows[place] for place in without]):
            kept = without
    return kept
