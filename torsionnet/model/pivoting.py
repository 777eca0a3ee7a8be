"""Rows solved one after the other, each for one of its unknowns.

A row that leaves two names only ties these in proportion. Nothing is substituted ahead of need: a row is brought down
to names that are still free, and what a name comes to is worked out when it is asked for.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush
from typing import Any

from torsionnet.model.proportions import ProportionalGroup, ProportionLink, Proportions, ProportionSolution


@dataclass
class Grounds:
    """What a conclusion rests on: numbers of rows, and pairs of names that rows tie in proportion."""

    rows: list[int] = field(default_factory=list)
    pairs: list[tuple[Any, Any]] = field(default_factory=list)


class Elimination:
    """Rows taken in one by one, each solved for its unknown that is last in ``order`` and not in ``keep``.

    Attributes
    ----------
    proportions : Proportions
    grounds : dict
        Number of a row -> what it took besides the row to come to its conclusion; a negative number is a conclusion
        drawn when all rows were known.
    redundant : list of int
        Rows that followed from earlier ones.
    blocked : list of int
        Rows that only involve names to be kept; they stay unsatisfied.
    count : int
        How many rows there are.
    """

    def __init__(self, order: Mapping[Any, int], keep: Collection[Any] = ()) -> None:
        self.order: Mapping[Any, int] = order
        self.keep: Collection[Any] = keep
        self.proportions: Proportions = Proportions()
        self.grounds: dict[int, Grounds] = {}
        self.redundant: list[int] = []
        self.blocked: list[int] = []
        self.count: int = 0
        self._settled = 0
        self._dependent: list[ProportionalGroup] = []
        self._to_anchor: dict[Any, Any] = {}

    def copy(self, order: Mapping[Any, int], keep: Collection[Any] = ()) -> Elimination:
        """The same rows, to be followed by others."""
        new = Elimination(order, keep)
        new.proportions = self.proportions.copy()
        new.grounds, new.redundant, new.blocked = dict(self.grounds), [*self.redundant], [*self.blocked]
        new.count, new._settled = self.count, self._settled
        new._dependent = [new.proportions.group(group.lead) for group in self._dependent]
        return new

    def add(self, row: Mapping[Any, Any]) -> None:
        """Take in one more row."""
        index, self.count = self.count, self.count + 1
        current, grounds = self.condensed(row)
        leads = {self.proportions.group(name).lead: name for name in current}
        candidates = [lead for lead in leads if lead not in self.keep]
        if candidates:
            self._solve(leads[max(candidates, key=self.order.__getitem__)], current, index)
        elif current:
            self.blocked.append(index)
            grounds.pairs += [(name, lead) for lead, name in leads.items() if name != lead]
        else:
            self.redundant.append(index)
        if grounds.rows or grounds.pairs:
            self.grounds[index] = grounds

    def blocks(self, row: Mapping[Any, Any]) -> bool:
        """Whether the row would only involve names to be kept."""
        current, _ = self.condensed(row)
        return bool(current) and all(self.proportions.group(name).lead in self.keep for name in current)

    def _solve(self, pivot: Any, row: dict[Any, Any], index: int) -> None:
        factor = row.pop(pivot)
        if len(row) == 1:
            ((other, coefficient),) = row.items()
            self.proportions.join(pivot, ProportionLink(other, factor, coefficient, index))
        else:
            self._conclude(ProportionSolution(pivot, {name: -value / factor for name, value in row.items()}, index))

    def _conclude(self, solution: ProportionSolution) -> None:
        group = self.proportions.group(solution.anchor)
        group.solution = solution
        if solution.row:
            self._dependent.append(group)
            self.proportions.turn(solution.anchor)

    def condensed(self, row: Mapping[Any, Any]) -> tuple[dict[Any, Any], Grounds]:
        """The row over free names of which no two are in proportion, and what that took; exact zeros drop out."""
        grounds = Grounds()
        found: dict[ProportionalGroup, tuple[Any, Any]] = {}
        waiting: list[tuple[int, ProportionalGroup]] = []
        self._gather(row.items(), found, waiting, grounds)
        while waiting:
            _, group = heappop(waiting)
            name, coefficient = found.pop(group)
            assert group.solution is not None
            anchor, sum_, index = group.solution
            grounds.rows.append(index)
            if name != anchor:
                coefficient = self.proportions.to_root(name, self._to_anchor) * coefficient
                grounds.pairs.append((name, anchor))
            self._gather([(other, x * coefficient) for other, x in sum_.items()], found, waiting, grounds)
        return {name: coefficient for name, coefficient in found.values() if coefficient != 0}, grounds

    def _gather(
        self,
        terms: Iterable[tuple[Any, Any]],
        found: dict[ProportionalGroup, tuple[Any, Any]],
        waiting: list[tuple[int, ProportionalGroup]],
        grounds: Grounds,
    ) -> None:
        """Add terms to those found, one for each group; a group with a solution waits for it, the earliest first."""
        for name, coefficient in terms:
            group = self.proportions.group(name)
            if group in found:
                first, total = found[group]
                if name == first:
                    found[group] = (first, total + coefficient)
                else:
                    found[group] = (first, total + self.proportions.ratio(name, first) * coefficient)
                    grounds.pairs.append((name, first))
            elif group.solution is None or group.solution.row:
                found[group] = (name, coefficient)
                if group.solution is not None:
                    heappush(waiting, (group.solution.number, group))
            else:
                grounds.rows.append(group.solution.number)
                grounds.pairs.append((name, group.solution.anchor))

    def settle(self) -> None:
        """Bring every solution down to free names; what comes to a multiple of one name joins its group.

        A solution is made of names that were solved later or never, so the last one comes first.
        """
        dependent, self._dependent = self._dependent, []
        for group in reversed(dependent):
            assert group.solution is not None
            anchor, row, index = group.solution
            row, grounds = self.condensed(row)
            if grounds.rows or grounds.pairs:
                grounds.rows.append(index)
                self._settled += 1
                index = -self._settled
                self.grounds[index] = grounds
            if len(row) == 1:
                ((other, coefficient),) = row.items()
                group.solution = None
                self.proportions.join(anchor, ProportionLink(other, 1, -coefficient, index))
            else:
                self._conclude(ProportionSolution(anchor, row, index))
        self._dependent.reverse()
        self._to_anchor.clear()
        for group in self.proportions.groups():
            self.proportions.turn(group.solution.anchor if group.solution else group.lead)
