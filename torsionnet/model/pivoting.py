"""Sequential elimination of unknowns in linear equations, each row solved for one of its unknowns.

A row that leaves two names ties these in proportion. Nothing is substituted ahead of need: a row is reduced to names
that are still free, and the solution of a name is calculated when it is used.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush
from typing import Any

from torsionnet.model.proportions import ProportionalGroup, ProportionLink, Proportions, ProportionSolution


@dataclass
class Derivation:
    """Rows of equations, and pairs of proportional unknowns, from which a conclusion on a row follows."""

    rows: list[int] = field(default_factory=list)
    pairs: list[tuple[Any, Any]] = field(default_factory=list)


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

    def __init__(self, order: Mapping[Any, int], keep: Collection[Any] = ()) -> None:
        self.order: Mapping[Any, int] = order
        self.keep: Collection[Any] = keep
        self.proportions: Proportions = Proportions()
        self.derivation: dict[int, Derivation] = {}
        self.redundant: list[int] = []
        self.blocked: list[int] = []
        self.count: int = 0
        self._settled = 0
        self._dependent: list[ProportionalGroup] = []
        self._to_anchor: dict[Any, Any] = {}

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
            self._solve(leads[max(candidates, key=self.order.__getitem__)], current, index)
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
            self.proportions.make_root(solution.anchor)

    def condensed(self, row: Mapping[Any, Any]) -> tuple[dict[Any, Any], Derivation]:
        """Coefficients by free name of a row, no two names in proportion, and the rows used for that.

        Exact zeros drop out.
        """
        derivation = Derivation()
        found: dict[ProportionalGroup, tuple[Any, Any]] = {}
        waiting: list[tuple[int, ProportionalGroup]] = []
        self._gather(row.items(), found, waiting, derivation)
        while waiting:
            _, group = heappop(waiting)
            name, coefficient = found.pop(group)
            assert group.solution is not None
            anchor, sum_, index = group.solution
            derivation.rows.append(index)
            if name != anchor:
                coefficient = self.proportions.to_root(name, self._to_anchor) * coefficient
                derivation.pairs.append((name, anchor))
            self._gather([(other, x * coefficient) for other, x in sum_.items()], found, waiting, derivation)
        return {name: coefficient for name, coefficient in found.values() if coefficient != 0}, derivation

    def _gather(
        self,
        terms: Iterable[tuple[Any, Any]],
        found: dict[ProportionalGroup, tuple[Any, Any]],
        waiting: list[tuple[int, ProportionalGroup]],
        derivation: Derivation,
    ) -> None:
        """Add terms of a row to ``found``, one for each group of names in proportion.

        Groups with a solution go to ``waiting``, the earliest first.
        """
        for name, coefficient in terms:
            group = self.proportions.group(name)
            if group in found:
                first, total = found[group]
                if name == first:
                    found[group] = (first, total + coefficient)
                else:
                    found[group] = (first, total + self.proportions.ratio(name, first) * coefficient)
                    derivation.pairs.append((name, first))
            elif group.solution is None or group.solution.row:
                found[group] = (name, coefficient)
                if group.solution is not None:
                    heappush(waiting, (group.solution.number, group))
            else:
                derivation.rows.append(group.solution.number)
                derivation.pairs.append((name, group.solution.anchor))

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
                ((other, coefficient),) = row.items()
                group.solution = None
                self.proportions.join(anchor, ProportionLink(other, 1, -coefficient, index))
            else:
                self._conclude(ProportionSolution(anchor, row, index))
        self._dependent.reverse()
        self._to_anchor.clear()
        for group in self.proportions.groups():
            self.proportions.make_root(group.solution.anchor if group.solution else group.lead)
