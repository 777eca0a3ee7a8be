"""Map, an answer of a study, the values of a quantity over a grid of two parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import (
    QUANTITY,
    VARIED,
    AnswerCase,
    AskedStudy,
    OfVariants,
    PlainConclusion,
    StudyAnswer,
    VariantValues,
    answer_cases,
    measure_of,
    quantity_faults,
    register_answer,
    units_of,
)
from torsionnet.study.quantities.quantity import QuantityLimit

AGGREGATES: Mapping[str, Callable[..., FloatArray]] = {
    "mean": np.mean,
    "median": np.median,
    "smallest": np.min,
    "largest": np.max,
}
"""Functions by name that reduce the values at one point of a map, over draws of other parameters, to one number."""


@dataclass(frozen=True, eq=False)
class ParameterMap:
    """Values (n_x, n_y) in SI of a quantity over two parameters ``x`` (n_x,) and ``y`` (n_y,), NaN where missing."""

    x: FloatArray
    y: FloatArray
    values: FloatArray

    def where(self, *, largest: bool) -> tuple[float, float, float]:
        """Values in SI of the two parameters and of the quantity where the quantity is largest or smallest."""
        flat = np.nanargmax(self.values) if largest else np.nanargmin(self.values)
        i, j = np.unravel_index(flat, self.values.shape)
        return float(self.x[i]), float(self.y[j]), float(self.values[i, j])


def parameter_map(
    evaluate: OfVariants,
    x: tuple[str, FloatArray],
    y: tuple[str, FloatArray],
    others: Mapping[str, FloatArray],
    aggregate: str = "mean",
) -> ParameterMap:
    """Values of a quantity on a grid of two parameters, reduced over the other parameters to one number at each point.

    Parameters
    ----------
    evaluate : callable
    x, y : tuple
        Name and values.
    others : mapping
        Values (m,) of the other parameters, m = 1 where they are fixed; the same at every point of the map.
    aggregate : {"mean", "median", "smallest", "largest"}
        Reduction of the m values at a point; NaN where one of them is missing.

    Examples
    --------
    >>> import numpy as np
    >>> highest = parameter_map(lambda v: v["a"] * v["b"] + v["c"], ("a", np.array([1.0, 2.0])), ("b", np.array([3.0])),
    ...     {"c": np.array([0.0, 1.0])}, "largest")
    >>> highest.values.tolist()
    [[4.0], [7.0]]
    """
    size = max((len(column) for column in others.values()), default=1)
    # The same draws of the other parameters at every point, so that neighbours differ by the axes alone.
    first, second, which = np.meshgrid(x[1], y[1], np.arange(size), indexing="ij")
    columns = {x[0]: first.ravel(), y[0]: second.ravel()}
    columns |= {name: column[which.ravel()] for name, column in others.items()}
    values = evaluate(columns).reshape(first.shape)
    return ParameterMap(x[1], y[1], np.asarray(AGGREGATES[aggregate](values, axis=2)))


FIXED = "fixed"


@register_answer
@dataclass(frozen=True, kw_only=True)
class Map(StudyAnswer):
    """Values of a quantity over a grid of two parameters in each configuration.

    A parameter that takes values of a list or range has these on its axis, others ``points`` over their tolerance. The
    rest is as in the model, or drawn: then one number is shown of ``draws`` values, the same draws at every point.
    """

    kind: ClassVar[str] = "map"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"quantity": QUANTITY, "x": VARIED, "y": VARIED}

    x: str = entry(Text("parameter"))
    y: str = entry(Text("parameter"))
    quantity: str = entry(Text("quantity"))
    points: int = entry(Count("on the axis of a parameter with a distribution", lower=2, upper=1000), 41)
    others: str = entry(
        OneOf("the other parameters: fixed, or which of the values that they make", (FIXED, *AGGREGATES)), FIXED
    )
    draws: int = entry(Count("of the other parameters", upper=100_000), 64)
    seed: int = entry(Count("another seed draws other values", lower=0, upper=2**32 - 1), 1)

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, (self.quantity,), "quantity")
        if self.x == self.y:
            yield Fault(f"{self.x} is on both axes", ("y",), kind="contradicting-entries")
        for correlation in study.space.entries.correlation:
            if self.others != FIXED and {self.x, self.y} & set(correlation.between):
                text = f"{' and '.join(correlation.between)} are correlated: over an axis with one of them the others"
                yield Fault(f"{text} are no draws; take others: {FIXED}", ("others",), kind="contradicting-entries")

    def variants(self, study: AskedStudy) -> int:
        others = next(answer_cases(study)).space.random_names
        draws = 1 if self.others == FIXED or {*others} <= {self.x, self.y} else self.draws
        sizes = (len(self._axis(case, self.x)) * len(self._axis(case, self.y)) for case in answer_cases(study))
        return draws * sum(sizes)

    def conclude(self, study: AskedStudy, result: VariantValues | None = None) -> MapResult:
        del result
        maps = {case.label: self._of_case(case) for case in answer_cases(study)}
        units = units_of(study)
        return MapResult(
            study.title, (self.x, units[self.x]), (self.y, units[self.y]),
            (self.quantity, measure_of(study, self.quantity).unit), self.others, maps, study.limits.get(self.quantity),
        )  # fmt: skip

    def _of_case(self, case: AnswerCase) -> ParameterMap:
        def values(variants: Mapping[str, FloatArray]) -> FloatArray:
            return case.calculated(variants, (self.quantity,))[self.quantity]

        aggregate = "mean" if self.others == FIXED else self.others
        axes = [(name, self._axis(case, name)) for name in (self.x, self.y)]
        return parameter_map(values, axes[0], axes[1], self._others(case), aggregate)

    def _axis(self, case: AnswerCase, name: str) -> FloatArray:
        if name in case.space.grid:
            axis = case.space.grid[name]
            return np.unique(axis.at(np.arange(axis.count)))
        return np.linspace(*case.space.box()[name], self.points)

    def _others(self, case: AnswerCase) -> dict[str, FloatArray]:
        random = [name for name in case.space.random_names if name not in (self.x, self.y)]
        if self.others == FIXED or not random:
            return {}
        from scipy.stats import qmc

        shares = qmc.LatinHypercube(len(case.space.random_names), rng=np.random.default_rng(self.seed)).random(
            self.draws
        )
        drawn = case.space.from_unit(shares)
        return {name: drawn[name] for name in random}


@dataclass(frozen=True, eq=False, repr=False)
class MapResult(PlainConclusion):
    """Values of a quantity over two parameters in each configuration.

    ``x``, ``y`` and ``quantity`` are names with units.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.contour_map:contour_map"

    title: str
    x: tuple[str, str]
    y: tuple[str, str]
    quantity: tuple[str, str]
    others: str
    maps: Mapping[str, ParameterMap]
    limit: QuantityLimit | None

    @property
    def sentences(self) -> tuple[str, ...]:
        said = []
        for case, map_of_case in self.maps.items():
            if not np.isfinite(map_of_case.values).any():
                said.append(f"{self.quantity[0]}, {case}: no point has a value")
                continue
            for word, largest in (("smallest", False), ("largest", True)):
                x, y, value = map_of_case.where(largest=largest)
                at = f"{self.x[0]} = {x:.4g} {self.x[1]}, {self.y[0]} = {y:.4g} {self.y[1]}"
                said.append(f"{word} {self.quantity[0]}, {case}: {value:.4g} {self.quantity[1]} at {at}")
        return tuple(said)

    def table(self) -> Table:
        columns = (Column("configuration"), Column(*self.x), Column(*self.y), Column(*self.quantity))
        rows = tuple(
            (case, float(x), float(y), float(map_of_case.values[i, j]))
            for case, map_of_case in self.maps.items()
            for i, x in enumerate(map_of_case.x)
            for j, y in enumerate(map_of_case.y)
        )
        note = (
            "other parameters as in the model" if self.others == FIXED else f"{self.others} over the other parameters"
        )
        return Table.of(self.title, f"map of {self.quantity[0]}", columns, rows, (note, *self.sentences))
