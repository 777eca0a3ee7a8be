"""Space of the variants of a study, which gives the values of the varied parameters by the index of a variant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from math import prod
from types import MappingProxyType
from typing import Any, Self

import numpy as np

from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import Fault, ModelError
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.model.model import Model
from torsionnet.study.space.correlation import Correlation
from torsionnet.study.space.samples import Samples
from torsionnet.study.space.space_reading import SpaceEntries, bound_space
from torsionnet.study.space.variations.variation import GridAxis, Marginal, Variation

COVERAGE = 0.9973
"""Share of the values within the tolerance of a distribution that has no limits of its own.

Three standard deviations of a normal one to both sides.
"""


class Space:
    """Variants of a model, with parameters drawn from distributions and crossed with lists and ranges.

    Variant i depends on i alone: on nothing that was asked for before, nor on who asks.

    Parameters
    ----------
    model : Drivetrain
        Model whose values percentages refer to.
    vary : mapping
        Parameter -> variation.
    correlation : sequence of Correlation, optional
    sampling : Samples, optional
        Without it no variants are drawn (``count`` is 0 if anything has a distribution), but answers that choose
        variants themselves have their space.

    Raises
    ------
    ModelError
        With everything that is wrong.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.space.variations.uniform import Uniform
    >>> from torsionnet.study.space.variations.uniform import ListOfValues
    >>> space = Space(tn.load("amt_rig"), {"k_2": Uniform(low="-10 %", high="+10 %"),
    ...     "c_O": ListOfValues(values=[170, 360])}, sampling=Samples(count=3))
    >>> space.count, space.values(2, 4)["c_O"]
    (6, array([170., 360.]))
    """

    def __init__(
        self,
        model: Model,
        vary: Mapping[str, Variation],
        correlation: Sequence[Correlation] = (),
        sampling: Samples | None = None,
    ) -> None:
        entries = SpaceEntries(vary=vary, correlation=tuple(correlation), sampling=sampling)
        bound, faults = bound_space(entries.vary, entries.correlation, entries.sampling, model)
        if bound is None:
            raise ModelError(faults, "the space of variants")
        self.entries, self._bound, self.remarks = entries, bound, tuple(faults)
        """Entries of the space, distributions and axes in SI, and warnings about the entries."""

    @classmethod
    def of(cls, entries: SpaceEntries, model: Model) -> tuple[Self | None, list[Fault]]:
        """Space of variants made from entries that were read, None with an error, and all faults found."""
        try:
            space = cls(model, entries.vary, entries.correlation, entries.sampling)
        except ModelError as error:
            return None, list(error.faults)
        return space, list(space.remarks)

    def at(self, model: Model) -> Self:
        """Space of the same variants for another model or configuration, relative to its values."""
        new, faults = self.of(self.entries, model)
        if new is None:
            raise ModelError(faults, "the space of variants")
        return new

    def to_data(self) -> dict[str, Json]:
        """Entries of a study file that make this space, as JSON data."""
        return self.entries.written_entries()

    @property
    def sampling(self) -> Samples | None:
        return self.entries.sampling

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that vary, in the order in which they were given."""
        return tuple(self.entries.vary)

    @property
    def marginals(self) -> Mapping[str, Marginal]:
        """Distribution of each parameter that has one, by its name."""
        return MappingProxyType(self._bound.joint.marginals)

    @property
    def random_names(self) -> tuple[str, ...]:
        """Names of the parameters that have a distribution."""
        return tuple(self._bound.joint.marginals)

    @property
    def grid(self) -> Mapping[str, GridAxis]:
        """Axis of values of each parameter with a list or range, by its name; the last one changes first."""
        return MappingProxyType(self._bound.axes)

    @property
    def nominal(self) -> Mapping[str, float]:
        """Value in SI of each varied parameter in the model, by name, NaN where it follows the operating point."""
        return MappingProxyType(self._bound.nominal)

    @cached_property
    def draws(self) -> int:
        """Number of draws of the parameters with a distribution, 1 where there are none."""
        if not self.random_names:
            return 1
        return self.sampling.count if self.sampling else 0

    @cached_property
    def count(self) -> int:
        """Number of variants in the space, for each point of the grid all draws."""
        return prod(axis.count for axis in self.grid.values()) * self.draws

    def values(self, start: int, stop: int) -> dict[str, FloatArray]:
        """Values (stop - start,) in SI of every parameter, by its name, in the variants ``start`` to ``stop - 1``."""
        if not 0 <= start <= stop <= self.count:
            raise IndexError(f"variants are 0 to {self.count - 1}, asked for {start} to {stop - 1}")
        if start == stop:
            return {name: np.empty(0) for name in self.names}
        # Draws are the fastest digit of a variant's number; grid points follow.
        point, draw = divmod(start, self.draws)
        places = draw + np.arange(stop - start)
        values = self._on_grid(point, places // self.draws) | self._drawn(draw, stop - start)
        return {name: values[name] for name in self.names}

    def _on_grid(self, point: int, further: Any) -> dict[str, FloatArray]:
        """Values (n,) in SI of each grid parameter at points ``further`` (n,) steps after the point with an index."""
        values = {}
        # Digits of mixed bases, the last axis the lowest.
        for name, axis in reversed(list(self.grid.items())):
            point, digit = divmod(point, axis.count)
            further, places = np.divmod(digit + further, axis.count)
            values[name] = axis.at(places)
        return values

    def _drawn(self, draw: int, count: int) -> dict[str, FloatArray]:
        if self.sampling is None or not self.random_names:
            return {}
        points = self.sampling.points(self.random_names)
        ends = draw + count
        if ends <= self.draws:
            return self.from_unit(points(draw, ends))
        if count < self.draws:
            # The stretch passes the end of the draws once.
            return self.from_unit(np.concatenate([points(draw, self.draws), points(0, ends - self.draws)]))
        all_of_them = self.from_unit(points(0, self.draws))
        places = np.arange(draw, ends) % self.draws
        return {name: column[places] for name, column in all_of_them.items()}

    def from_unit(self, shares: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each of the :attr:`random_names` at points (n, n_random) of the unit cube."""
        return self._bound.joint.from_unit(shares)

    def from_standard_normal(self, normal: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each of the :attr:`random_names` at standard normal variables (n, n_random)."""
        return self._bound.joint.from_standard_normal(normal)

    def to_standard_normal(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Independent standard normal variables (n, n_random) of values (n,) in SI of the :attr:`random_names`."""
        return self._bound.joint.to_standard_normal(values)

    def log_density(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Logarithm (n,) of the joint probability density of the :attr:`random_names` at values (n,) in SI."""
        return self._bound.joint.log_density(values)

    def box(self, coverage: float = COVERAGE) -> dict[str, tuple[float, float]]:
        """Lowest and highest value in SI of every varied parameter, by its name.

        A distribution without a limit on a side ends there where all but ``(1 - coverage)/2`` of its values do.
        """
        tail = (1 - coverage) / 2
        ranges = {name: (axis.low, axis.high) for name, axis in self.grid.items()}
        for name, marginal in self.marginals.items():
            low = marginal.low if np.isfinite(marginal.low) else float(marginal.ppf(tail))
            ranges[name] = (low, marginal.high if np.isfinite(marginal.high) else float(marginal.isf(tail)))
        return {name: ranges[name] for name in self.names}
