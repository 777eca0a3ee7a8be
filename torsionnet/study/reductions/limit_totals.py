"""How many variants of a study are beyond its limits, where the values of single variants are not kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from torsionnet.core.errors import UsageError
from torsionnet.study.quantities.quantity_limit import QuantityLimit
from torsionnet.study.reductions.limit_counts import LimitCounts


@dataclass(frozen=True, eq=False)
class LimitTotals:
    """Counted as the variants were calculated.

    Attributes
    ----------
    limits : mapping
        By quantity, in the order of their places in the counts; those that were in force then.
    cases : mapping
        By configuration.
    any_case : LimitCounts
        Of variants of the same number that are beyond in one configuration at least.
    """

    limits: Mapping[str, QuantityLimit]
    cases: Mapping[str, LimitCounts]
    any_case: LimitCounts

    def beyond(self, names: Sequence[str], configuration: str) -> int:
        """Variants of a configuration beyond any of the limits of these quantities."""
        return self.cases[configuration].beyond(self._places(names))

    def beyond_in_any(self, names: Sequence[str]) -> int:
        """The same, in any of the configurations."""
        return self.any_case.beyond(self._places(names))

    def missing(self, names: Sequence[str]) -> int:
        """Values that there are none of, in all configurations."""
        found = [one.missing for one in self.cases.values() if one.missing is not None]
        return sum(int(one[place]) for one in found for place in self._places(names))

    def agree_with(self, limits: Mapping[str, QuantityLimit], names: Sequence[str]) -> None:
        """Refuse limits that are not those that were counted by."""
        others = [name for name in names if self.limits.get(name) != limits[name]]
        if others:
            raise UsageError(
                f"{', '.join(others)}: variants were counted by other limits as they were calculated, and of so many "
                "the values are not kept; calculate the study anew with these limits"
            )

    def _places(self, names: Sequence[str]) -> list[int]:
        order = list(self.limits)
        return [order.index(name) for name in names]
