"""Counts of the variants beyond each combination of limits, taken in chunks.

A chunk keeps a flag for each variant and limit, so that chunks of other configurations with the same draws can be
united with it. All chunks together keep how often each set of limits was exceeded; whole numbers add up to the same
whatever the order, and any limits can be asked for together afterwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityLimit

MOST_LIMITS = 64
"""Largest number of limits in a study, as the set of limits that a variant exceeds is kept as a number of 64 bits."""


@dataclass(frozen=True, eq=False)
class LimitFlags:
    """Flags that say for each of n variants which limits it is beyond.

    Attributes
    ----------
    flags : (n_limits, n) booleans
    missing : (n_limits,) integers
        Variants whose quantity has no value; they are beyond.
    """

    flags: NDArray[np.bool_]
    missing: NDArray[np.int64]

    @classmethod
    def of(cls, limited: Sequence[tuple[QuantityLimit, FloatArray]]) -> Self:
        """Flags by each limit and the values (n, n_points) in SI of its quantity."""
        missing = [np.isnan(values).any(axis=1).sum() for _, values in limited]
        return cls(np.stack([limit.beyond(values) for limit, values in limited]), np.array(missing, dtype=np.int64))

    @classmethod
    def joined(cls, parts: Sequence[LimitFlags]) -> Self:
        """Flags of the variants of several parts, one after the other."""
        return cls(
            np.concatenate([part.flags for part in parts], axis=1), np.sum([part.missing for part in parts], axis=0)
        )

    @classmethod
    def union(cls, parts: Sequence[LimitFlags]) -> Self:
        """Flags of the variants that are beyond a limit in any of several configurations with the same draws."""
        return cls(
            np.bitwise_or.reduce([part.flags for part in parts]), np.sum([part.missing for part in parts], axis=0)
        )


@dataclass
class LimitCounts:
    """Number of variants beyond each set of limits and within all others.

    Attributes
    ----------
    sets : dict
        Limits as a number with a bit for each, from the lowest -> variants.
    missing : (n_limits,) integers or None

    Examples
    --------
    >>> import numpy as np
    >>> beyond = np.array([[True, True, False], [False, True, True]])
    >>> counts = LimitCounts()
    >>> counts.add(LimitFlags(beyond, np.zeros(2, dtype=np.int64)))
    >>> counts.beyond([0]), counts.beyond([1]), counts.beyond([0, 1])
    (2, 2, 3)
    """

    sets: dict[int, int] = field(default_factory=dict)
    missing: NDArray[np.int64] | None = None

    def add(self, part: LimitFlags) -> None:
        """Count the variants beyond limits of one more chunk."""
        self.missing = part.missing if self.missing is None else self.missing + part.missing
        some = part.flags[:, part.flags.any(axis=0)]
        places = np.arange(len(some), dtype=np.uint64)[:, None]
        # The set of limits that a variant exceeds, as bits of a number.
        sets = np.bitwise_or.reduce(some.astype(np.uint64) << places, axis=0)
        for exceeded, count in zip(*np.unique(sets, return_counts=True), strict=True):
            self.sets[int(exceeded)] = self.sets.get(int(exceeded), 0) + int(count)

    def beyond(self, limits: Iterable[int]) -> int:
        """Number of variants beyond any of some limits, which are given by their places in the order of all limits."""
        wanted = sum(1 << place for place in limits)
        return sum(count for exceeded, count in self.sets.items() if exceeded & wanted)


@dataclass(frozen=True, eq=False)
class LimitTotals:
    """Counts of variants beyond limits that were taken while the variants were calculated.

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

    def add(self, flags: Mapping[str, LimitFlags]) -> None:
        """Count the variants of one more chunk, the same draws in every configuration."""
        for configuration, flags_of_case in flags.items():
            self.cases[configuration].add(flags_of_case)
        self.any_case.add(LimitFlags.union([*flags.values()]))

    def beyond(self, names: Sequence[str], configuration: str) -> int:
        """Number of variants of a configuration beyond any of the limits of the quantities ``names``."""
        return self.cases[configuration].beyond(self._places(names))

    def beyond_in_any(self, names: Sequence[str]) -> int:
        """Number of draws beyond any of the limits of the quantities ``names`` in at least one configuration."""
        return self.any_case.beyond(self._places(names))

    def missing(self, names: Sequence[str]) -> int:
        """Number of missing values of the quantities ``names`` in all configurations."""
        missing = [case.missing for case in self.cases.values() if case.missing is not None]
        return sum(int(counts[place]) for counts in missing for place in self._places(names))

    def require_same_limits(self, limits: Mapping[str, QuantityLimit], names: Sequence[str]) -> None:
        """Refuse limits other than those by which the variants were counted."""
        others = [name for name in names if self.limits.get(name) != limits[name]]
        if others:
            raise UsageError(
                f"{', '.join(others)}: variants were counted by other limits as they were calculated, and of so many "
                "the values are not kept; calculate the study anew with these limits",
                kind="unlike-results",
            )

    def _places(self, names: Sequence[str]) -> list[int]:
        order = list(self.limits)
        return [order.index(name) for name in names]
