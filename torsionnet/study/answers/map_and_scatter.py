"""Map and scatter, answers of a study: a quantity over two parameters, and all variants over their parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault, SolveError
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import (
    IN_WORDS,
    QUANTITY,
    VARIED,
    AnswerCase,
    AskedStudy,
    OfVariants,
    PlainConclusion,
    StudyAnswer,
    VariantValues,
    answer_cases,
    case_values,
    chosen_quantities,
    measure_of,
    quantity_faults,
    register_answer,
    units_of,
)
from torsionnet.study.quantities.quantity import QuantityLimit

# Map, an answer of a study, the values of a quantity over a grid of two parameters.

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

    drawing: ClassVar[str] = "torsionnet.plot.study.over_parameters:contour_map"

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


# Scatter, an answer of a study, the quantities over the parameters of every variant, and their rank correlations.

FEWEST_RANKED = 10
"""Fewest variants of a rank correlation, as the interval of fewer covers nearly the whole range from -1 to 1."""


@dataclass(frozen=True, eq=False)
class RankCorrelations:
    """Spearman's rank correlations (d,) of d parameters with a quantity, with their confidence intervals.

    The coefficient of a parameter that is the same in all variants is NaN.
    """

    coefficients: FloatArray
    low: FloatArray
    high: FloatArray
    count: int


def rank_correlations(parameters: FloatArray, values: FloatArray) -> RankCorrelations:
    """Spearman's rank correlations (d,) of parameters (n, d) with values (n,), with intervals of 95 %.

    These are those of Bonett and Wright, Fisher's with a standard error of sqrt((1 + r^2/2)/(n - 3)).

    Examples
    --------
    >>> import numpy as np
    >>> x = np.linspace(0, 1, 50)
    >>> rank_correlations(np.column_stack([x, 1 - x]), np.exp(x)).coefficients.round(6).tolist()
    [1.0, -1.0]
    """
    from scipy.special import ndtri
    from scipy.stats import rankdata

    known = np.isfinite(values)
    count = int(known.sum())
    if count < FEWEST_RANKED:
        raise SolveError(
            f"{count} variants have a value; rank correlations take {FEWEST_RANKED} or more", kind="no-solution"
        )
    # Spearman's coefficient is the correlation of ranks; equal values share the mean of theirs.
    ranks = rankdata(np.column_stack([parameters[known], values[known]]), axis=0)
    ranks -= ranks.mean(axis=0)
    sizes = np.sqrt((ranks**2).sum(axis=0))
    products = (ranks[:, :-1] * ranks[:, -1:]).sum(axis=0)
    coefficients = np.full(len(products), np.nan)
    np.divide(products, sizes[:-1] * sizes[-1], out=coefficients, where=sizes[:-1] * sizes[-1] > 0)
    coefficients = np.clip(coefficients, -1, 1)
    # Fisher's z = artanh r is about normal; Bonett and Wright: its standard error is sqrt((1 + r^2/2)/(n - 3)).
    half = float(ndtri(0.975)) * np.sqrt((1 + coefficients**2 / 2) / (count - 3))
    with np.errstate(divide="ignore"):
        middle = np.arctanh(coefficients)
    return RankCorrelations(coefficients, np.tanh(middle - half), np.tanh(middle + half), count)


MOST_SHOWN = 100_000
"""Most variants that are drawn in a scatter figure, as more points only make its file larger."""


@register_answer
@dataclass(frozen=True, kw_only=True)
class Scatter(StudyAnswer):
    """Values of quantities over those of parameters, and Spearman's rank correlations with their intervals.

    A rank correlation is 1 where a quantity always rises with a parameter, -1 where it always falls; correlated
    parameters share theirs.
    """

    kind: ClassVar[str] = "scatter"
    naming: ClassVar[Mapping[str, str]] = {"quantities": QUANTITY}

    quantities: tuple[str, ...] = entry(Listed("default: all that are single numbers", Text("quantity")), None)

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, self.quantities, "quantities")

    def conclude(self, study: AskedStudy, result: VariantValues) -> ScatterResult:
        names = chosen_quantities(study, self.quantities)
        points, correlations = {}, {}
        for case in case_values(study, result, names):
            parameters = np.column_stack(list(case.parameters.values()))
            for name in names:
                correlations[case.label, name] = rank_correlations(parameters, case.quantities[name])
            every = slice(None, None, max(1, len(parameters) // MOST_SHOWN))
            columns = {**case.parameters, **case.quantities}
            points[case.label] = {name: column[every] for name, column in columns.items()}
        units = {name: measure_of(study, name).unit for name in names}
        part = result.kept.words(study.count)
        return ScatterResult(study.title, units_of(study), units, correlations, points, part)


@dataclass(frozen=True, eq=False, repr=False)
class ScatterResult(PlainConclusion):
    """Rank correlations by configuration and quantity, and the values in SI of variants by configuration and name.

    Both are of a part of all variants where ``part`` is not empty.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.over_parameters:scatter_matrix"

    title: str
    parameter_units: Mapping[str, str]
    units: Mapping[str, str]
    correlations: Mapping[tuple[str, str], RankCorrelations]
    points: Mapping[str, Mapping[str, FloatArray]]
    part: str = field(default="", metadata=IN_WORDS)

    @property
    def sentences(self) -> tuple[str, ...]:
        said = []
        for (case, name), ranked in self.correlations.items():
            size = np.nan_to_num(np.abs(ranked.coefficients))
            place = int(size.argmax())
            how = "rises" if ranked.coefficients[place] > 0 else "falls"
            with_what = list(self.parameter_units)[place]
            text = f"{how} most with {with_what} (rank correlation {ranked.coefficients[place]:.2f})"
            said.append(f"{name}, {case}: {text if size[place] else 'goes with none of the parameters'}")
        if self.part:
            said.append(f"correlations and points are of {self.part}")
        return tuple(said)

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("quantity"), Column("parameter"), Column("rank correlation", digits=4),
            Column("from", digits=4), Column("to", digits=4), Column("variants"),
        )  # fmt: skip
        rows = tuple(
            (case, name, parameter, float(r.coefficients[n]), float(r.low[n]), float(r.high[n]), r.count)
            for (case, name), r in self.correlations.items()
            for n, parameter in enumerate(self.parameter_units)
        )
        return Table.of(self.title, "rank correlations", columns, rows, ("intervals 95 %", *self.sentences))


# Parallel coordinates, an answer of a study, every variant a line across axes of parameters and quantities.


@register_answer
@dataclass(frozen=True, kw_only=True)
class ParallelCoordinates(StudyAnswer):
    """Lines of the variants across axes of parameters and quantities, those of variants beyond a limit in red.

    The table compares the medians of the variants that keep all limits with those of the others.
    """

    kind: ClassVar[str] = "parallel_coordinates"
    naming: ClassVar[Mapping[str, str]] = {"quantities": QUANTITY}

    quantities: tuple[str, ...] = entry(Listed("default: all that are single numbers", Text("quantity")), None)
    lines: int = entry(Count("most variants that are drawn of a configuration", upper=10_000), 400)

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, self.quantities, "quantities")

    def conclude(self, study: AskedStudy, result: VariantValues) -> ParallelCoordinatesResult:
        names = chosen_quantities(study, self.quantities)
        variants, beyond, medians = {}, {}, {}
        for case in case_values(study, result, tuple(dict.fromkeys((*names, *study.limits)))):
            columns = {**case.parameters, **{name: case.quantities[name] for name in names}}
            exceeded = [limit.beyond(case.quantities[name]) for name, limit in study.limits.items()]
            outside = np.any(exceeded, axis=0) if exceeded else np.zeros(len(columns[names[0]]), dtype=bool)
            for name, column in columns.items():
                medians[case.label, name] = (_median(column[~outside]), _median(column[outside]))
            every = slice(None, None, max(1, -(-len(outside) // self.lines)))
            variants[case.label] = {name: column[every] for name, column in columns.items()}
            beyond[case.label] = outside[every]
        units = units_of(study) | {name: measure_of(study, name).unit for name in names}
        return ParallelCoordinatesResult(study.title, units, variants, beyond, medians, result.kept.words(study.count))


def _median(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else float("nan")


@dataclass(frozen=True, eq=False, repr=False)
class ParallelCoordinatesResult(PlainConclusion):
    """Values of the variants by configuration and axis, which are beyond a limit, and medians of both kinds.

    Where ``part`` says so, medians are of a part of all variants, and those shown were chosen from it.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.over_parameters:parallel_coordinates"

    title: str
    units: Mapping[str, str]
    variants: Mapping[str, Mapping[str, FloatArray]]
    beyond: Mapping[str, NDArray[np.bool_]]
    medians: Mapping[tuple[str, str], tuple[float, float]]
    part: str = field(default="", metadata=IN_WORDS)

    @property
    def sentences(self) -> tuple[str, ...]:
        shown = (
            f"{case}: {int(outside.sum())} of {len(outside)} variants shown are beyond a limit"
            for case, outside in self.beyond.items()
        )
        return (*shown, f"medians and lines are of {self.part}") if self.part else tuple(shown)

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("axis"), Column("median within limits"), Column("median beyond"),
            Column("unit"),
        )  # fmt: skip
        rows = tuple((*key, *pair, self.units[key[1]]) for key, pair in self.medians.items())
        return Table.of(self.title, "variants within and beyond limits", columns, rows, self.sentences)
