"""How many draws are beyond limits: by the values of all variants, or as counted where there are very many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from torsionnet.study.reductions.limit_totals import LimitTotals

Weights = Mapping[str, float]
"""Shares of configurations."""


class DrawsBeyond(Protocol):
    """Draws beyond any of the limits of some quantities; of a draw that is beyond at some points of a grid, a part."""

    def in_case(self, names: Sequence[str], configuration: str) -> float: ...
    def in_any(self, names: Sequence[str]) -> float: ...
    def on_average(self, names: Sequence[str], weights: Weights) -> float: ...


@dataclass(frozen=True, eq=False)
class KeptBeyond:
    """By which variants (n_grid, n_draws) are beyond, by configuration and quantity."""

    beyond: Mapping[str, Mapping[str, NDArray[np.bool_]]]

    def in_case(self, names: Sequence[str], configuration: str) -> float:
        """In one configuration."""
        return _draws(self._any_limit(names, configuration))

    def in_any(self, names: Sequence[str]) -> float:
        """In at least one of them."""
        return _draws(self._each(names).any(axis=0))

    def on_average(self, names: Sequence[str], weights: Weights) -> float:
        """The weighted mean over configurations."""
        shares = np.array([weights.get(case, 0.0) for case in self.beyond])
        return _draws(np.tensordot(shares / shares.sum(), self._each(names), axes=1))

    def _any_limit(self, names: Sequence[str], case: str) -> NDArray[np.bool_]:
        return np.asarray(np.any([self.beyond[case][name] for name in names], axis=0))

    def _each(self, names: Sequence[str]) -> NDArray[np.bool_]:
        return np.array([self._any_limit(names, case) for case in self.beyond])


def _draws(beyond: Any) -> float:
    """By the mean over the points of the grid."""
    return float(np.asarray(beyond, dtype=float).mean(axis=0).sum())


@dataclass(frozen=True, eq=False)
class CountedBeyond:
    """By the counts of variants; each draw is ``n_grid`` variants."""

    totals: LimitTotals
    n_grid: int

    def in_case(self, names: Sequence[str], configuration: str) -> float:
        """In one configuration."""
        return self.totals.beyond(names, configuration) / self.n_grid

    def in_any(self, names: Sequence[str]) -> float:
        """In at least one of them."""
        return self.totals.beyond_in_any(names) / self.n_grid

    def on_average(self, names: Sequence[str], weights: Weights) -> float:
        """The weighted mean over configurations."""
        total = sum(weight * self.in_case(names, case) for case, weight in weights.items())
        return total / sum(weights.values())
