"""Sensitivities, answers of a study: tornado of each parameter alone, and Sobol indices of shares in the variance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault, SolveError, UsageError
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import (
    QUANTITY,
    AnswerCase,
    AskedStudy,
    OfPoints,
    PlainConclusion,
    StudyAnswer,
    VariantValues,
    answer_cases,
    chosen_quantities,
    distribution_faults,
    measure_of,
    quantity_faults,
    register_answer,
    units_of,
)

# Sobol indices, an answer of a study, the shares of the parameters in the variance of a quantity.

RESAMPLES = 1000
"""Bootstrap resamples of the Sobol indices, enough for the ends of a 95 % interval, as 25 lie beyond each end."""
FEWEST_BASE_POINTS = 64
"""Fewest base points of Sobol indices, as the intervals of fewer cover nearly all values from 0 to 1."""


@dataclass(frozen=True, eq=False)
class SobolEstimates:
    """Sobol indices (d,) of d parameters, first-order and total, with the ends of their intervals, all from 0 to 1.

    ``variance`` is that of the quantity, ``evaluations`` the number of variants, ``without_value`` the number of base
    points left out because one of their variants has no value.
    """

    first: FloatArray
    first_low: FloatArray
    first_high: FloatArray
    total: FloatArray
    total_low: FloatArray
    total_high: FloatArray
    variance: float
    evaluations: int
    without_value: int


def sobol_points(n_parameters: int, base: int, seed: int) -> FloatArray:
    """Sampling points (base (d + 2), d) of the unit cube, A, B, and A with one column after another from B.

    Raises
    ------
    UsageError
        Too few base points, or no power of two.
    """
    from scipy.stats import qmc

    if base < FEWEST_BASE_POINTS or base & (base - 1):
        raise UsageError(
            f"the number of base points must be a power of two, {FEWEST_BASE_POINTS} or more; got {base}",
            kind="out-of-range",
        )
    # A and B are halves of one sequence in 2 d dimensions, so that they are even together.
    pair = qmc.Sobol(2 * n_parameters, rng=np.random.default_rng(seed)).random(base)
    first, second = pair[:, :n_parameters], pair[:, n_parameters:]
    exchanged = [np.where(np.arange(n_parameters) == column, second, first) for column in range(n_parameters)]
    return np.concatenate([first, second, *exchanged])


def estimates_of(at_points: FloatArray, base: int, seed: int, confidence: float) -> SobolEstimates:
    """First-order and total Sobol indices by the formulas of Saltelli (2010) and Jansen, with intervals.

    Intervals are percentiles over resampled base points, which takes those for independent and makes the intervals
    wider than needed. The estimates are those of :func:`scipy.stats.sobol_indices`, whose bootstrap takes no seed; here
    the same seed gives the same bytes.

    Parameters
    ----------
    at_points : (base * (d + 2),) array
        Values of the quantity at :func:`sobol_points`; base points where one is missing are left out.
    base, seed : int
        Those of the points.
    confidence : float

    Raises
    ------
    SolveError
        The quantity does not vary, or has hardly any values.
    """
    values = at_points.reshape(-1, base)
    # A base point counts with all its d + 2 variants or not at all.
    whole = np.isfinite(values).all(axis=0)
    if whole.sum() < FEWEST_BASE_POINTS:
        raise SolveError(
            f"only {whole.sum()} of {base} base points can be used, at the others a variant "
            "has no value; narrow the distributions, or take more points",
            kind="no-solution",
        )
    terms = _terms(values[:, whole])
    numbers = np.random.default_rng([seed, 1])
    # Bootstrap over base points, which keep their d + 2 variants together.
    drawn = np.array([_indices(terms[numbers.integers(len(terms), size=len(terms))]) for _ in range(RESAMPLES)])
    tail = (1 - confidence) / 2
    # A share of a variance: an interval holds its truth as often without the part that lies beyond 0 or 1.
    low, high = np.clip(np.quantile(drawn, [tail, 1 - tail], axis=0), 0.0, 1.0)
    indices = np.clip(_indices(terms), 0.0, 1.0)
    variance = float(values[:2, whole].var())
    return SobolEstimates(
        indices[0], low[0], high[0], indices[1], low[1], high[1], variance, values.size, base - int(whole.sum())
    )


def _terms(values: FloatArray) -> FloatArray:
    """Terms (n, 2 d + 2) of n base points whose means give the indices, numerators first, then moments of A and B."""
    # About the common mean, as a large one would hide the variance in rounding.
    a, b = values[:2] - values[:2].mean()
    if np.ptp(values[:2]) <= 1e-12 * np.abs(values[:2]).max():
        raise SolveError("the quantity does not vary, so that nothing has a share in its variance", kind="no-solution")
    moved = values[2:] - values[:2].mean()
    # First order by Saltelli, mean of f_B (f_AB - f_A); total by Jansen, mean of (f_A - f_AB)^2/2.
    return np.column_stack([*(b * (moved - a)), *((a - moved) ** 2 / 2), (a + b) / 2, (a**2 + b**2) / 2])


def _indices(terms: FloatArray) -> FloatArray:
    """First-order and total Sobol indices (2, d) from the terms (n, 2 d + 2) of n base points."""
    means = terms.mean(axis=0)
    variance = means[-1] - means[-2] ** 2
    return np.asarray(means[:-2].reshape(2, -1) / variance)


@register_answer
@dataclass(frozen=True, kw_only=True)
class SobolIndices(StudyAnswer):
    """First-order and total Sobol indices of the parameters for each quantity, with bootstrap intervals.

    A first-order index is the share of the variance that a parameter makes alone, a total index the share that would be
    left if only that parameter varied, whatever the others do with it. Parameters have to be independent. Every
    configuration takes count (number of parameters + 2) variants.
    """

    kind: ClassVar[str] = "sobol_indices"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"quantities": QUANTITY}

    quantities: tuple[str, ...] = entry(Listed("default: all that are single numbers", Text("quantity")), None)
    count: int = entry(Count("base points, a power of two", lower=FEWEST_BASE_POINTS, upper=2**22), 1024)
    seed: int = entry(Count("another seed draws other variants", lower=0, upper=2**32 - 1), 1)
    confidence: float = entry(Value("of the intervals", "1", exclusive=True, below=1), 0.95)

    def contradictions(self) -> list[Fault]:
        if self.count & (self.count - 1):
            return [
                Fault(
                    f"base points are a power of two, as {1 << self.count.bit_length()}",
                    ("count",),
                    kind="out-of-range",
                )
            ]
        return []

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, self.quantities, "quantities")
        yield from distribution_faults(study)
        if study.space.entries.correlation:
            text = "Sobol indices share out a variance among independent parameters, and these are correlated"
            yield Fault(
                f"{text}; rank correlations (type: scatter) take any", on_key=True, kind="contradicting-entries"
            )

    def variants(self, study: AskedStudy) -> int:
        return len(study.configurations) * self.count * (len(study.space.random_names) + 2)

    def conclude(self, study: AskedStudy, result: VariantValues | None = None) -> SobolResult:
        del result
        names = chosen_quantities(study, self.quantities)
        estimates: dict[tuple[str, str], SobolEstimates] = {}
        for case in answer_cases(study):
            estimates |= {(case.label, name): estimate for name, estimate in self._of_case(case, names).items()}
        return SobolResult(study.title, study.space.random_names, estimates, self.confidence)

    def _of_case(self, case: AnswerCase, names: tuple[str, ...]) -> Mapping[str, SobolEstimates]:
        points = sobol_points(len(case.space.random_names), self.count, self.seed)
        values = case.calculated(case.space.from_unit(points), names)
        return {name: estimates_of(values[name], self.count, self.seed, self.confidence) for name in names}


@dataclass(frozen=True, eq=False, repr=False)
class SobolResult(PlainConclusion):
    """Sobol indices of ``parameters`` with their intervals, by configuration and quantity."""

    drawing: ClassVar[str] = "torsionnet.plot.study.study_tornado:sobol_indices"

    title: str
    parameters: tuple[str, ...]
    indices: Mapping[tuple[str, str], SobolEstimates]
    confidence: float

    @property
    def sentences(self) -> tuple[str, ...]:
        return tuple(text for key, estimate in self.indices.items() for text in self._about(key, estimate))

    def _about(self, key: tuple[str, str], estimate: SobolEstimates) -> Iterator[str]:
        case, name = key
        order = sorted(range(len(self.parameters)), key=lambda place: -estimate.total[place])
        first = order[0]
        share = f"{100 * estimate.first[first]:.3g} % alone, {100 * estimate.total[first]:.3g} % with all it acts with"
        yield f"{name}, {case}: most of its variance comes from {self.parameters[first]} ({share})"
        idle = [self.parameters[place] for place in order if estimate.total_high[place] < 0.01]
        if idle:
            yield f"{name}, {case}: {', '.join(idle)} could as well be fixed (total indices below 0.01)"
        if estimate.without_value:
            left_out = f"{estimate.without_value} base points left out"
            yield f"{name}, {case}: {left_out}, as one of their variants has no value"

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("quantity"), Column("parameter"), Column("first order", digits=4),
            Column("from", digits=4), Column("to", digits=4), Column("total", digits=4), Column("from", digits=4),
            Column("to", digits=4), Column("variants"),
        )  # fmt: skip
        shown = ("first", "first_low", "first_high", "total", "total_low", "total_high")
        rows = tuple(
            (*key, name, *(float(getattr(estimate, array)[place]) for array in shown), estimate.evaluations)
            for key, estimate in self.indices.items()
            for place, name in enumerate(self.parameters)
        )
        note = f"estimators of Saltelli and Jansen, bootstrap intervals {100 * self.confidence:g} %"
        return Table.of(self.title, "Sobol indices", columns, rows, (note, *self.sentences))


# Tornado, an answer of a study, the change of quantities by each parameter alone.


@dataclass(frozen=True, eq=False)
class Swings:
    """Value of a quantity with all parameters in the middle, and values (d,) with each at either end of its span."""

    middle: float
    at_low: FloatArray
    at_high: FloatArray

    @property
    def order(self) -> list[int]:
        """Indices of the parameters by the size of the change of the quantity, the largest first."""
        with_middle = np.stack([self.at_low, self.at_high, np.full(len(self.at_low), self.middle)])
        swings = np.nan_to_num(np.ptp(with_middle, axis=0))
        return [int(index) for index in np.argsort(-swings, kind="stable")]


def one_at_a_time(function: OfPoints, middle: FloatArray, low: FloatArray, high: FloatArray) -> Swings:
    """Values of a function at a middle point (d,) and with each coordinate at either end of its span (2 d + 1 points).

    Examples
    --------
    >>> import numpy as np
    >>> swing = one_at_a_time(lambda p: p[:, 0] + 3 * p[:, 1], np.zeros(2), -np.ones(2), np.ones(2))
    >>> swing.at_high.tolist(), swing.order
    ([1.0, 3.0], [1, 0])
    """
    d = len(middle)
    alone = np.eye(d, dtype=bool)
    points = np.concatenate([middle[None], np.where(alone, low, middle), np.where(alone, high, middle)])
    values = function(points)
    return Swings(float(values[0]), values[1 : d + 1], values[d + 1 :])


TOLERANCE, DEVIATION = "tolerance", "standard deviation"
SHARE_WITHIN_DEVIATION = 0.6826894921370859
"""Share of a normal distribution within one standard deviation of its mean, the span of a distribution in a tornado."""


@register_answer
@dataclass(frozen=True, kw_only=True)
class Tornado(StudyAnswer):
    """Values of quantities with one parameter at either end of its span and all others in the middle of theirs.

    The span is the whole tolerance, or where a parameter has a distribution the middle 68.27 % of its values, one
    standard deviation of a normal one to both sides. Twice the number of parameters, and one variant.
    """

    kind: ClassVar[str] = "tornado"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"quantities": QUANTITY}

    quantities: tuple[str, ...] = entry(Listed("default: all that are single numbers", Text("quantity")), None)
    span: str = entry(OneOf("how far each parameter is moved", (TOLERANCE, DEVIATION)), TOLERANCE)

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, self.quantities, "quantities")

    def conclude(self, study: AskedStudy, result: VariantValues | None = None) -> TornadoResult:
        del result
        names = chosen_quantities(study, self.quantities)
        swings, spans = {}, {}
        for case in answer_cases(study):
            spans[case.label] = self._spans(case)
            for name in names:
                swings[case.label, name] = self._swings(case, name, spans[case.label])
        units = {name: measure_of(study, name).unit for name in names}
        return TornadoResult(study.title, units_of(study), units, spans, swings)

    def _spans(self, case: AnswerCase) -> dict[str, tuple[float, float, float]]:
        """Low end, middle and high end of each parameter's span in SI, by its name."""
        space = case.space
        spans = {name: (low, (low + high) / 2, high) for name, (low, high) in space.box().items()}
        # Else the quantiles that are a standard deviation from the middle of a normal distribution.
        tail = (1 - SHARE_WITHIN_DEVIATION) / 2
        for name, marginal in space.marginals.items():
            middle = float(marginal.ppf(0.5))
            ends = (
                (spans[name][0], spans[name][2])
                if self.span == TOLERANCE
                else (float(marginal.ppf(tail)), float(marginal.isf(tail)))
            )
            spans[name] = (ends[0], middle, ends[1])
        # A parameter of a grid swings about the value that the model has.
        for name in space.grid:
            if not np.isnan(space.nominal[name]):
                spans[name] = (spans[name][0], space.nominal[name], spans[name][2])
        return spans

    def _swings(self, case: AnswerCase, quantity: str, spans: Mapping[str, tuple[float, float, float]]) -> Swings:
        low, middle, high = np.array(list(spans.values())).T

        def values(points: FloatArray) -> FloatArray:
            return case.calculated(dict(zip(spans, points.T, strict=True)), (quantity,))[quantity]

        return one_at_a_time(values, middle, low, high)


@dataclass(frozen=True, eq=False, repr=False)
class TornadoResult(PlainConclusion):
    """Changes of each quantity by each parameter alone, by configuration and quantity.

    ``spans``: low end, middle, high end by configuration and parameter.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.study_tornado:study_tornado"

    title: str
    parameter_units: Mapping[str, str]
    units: Mapping[str, str]
    spans: Mapping[str, Mapping[str, tuple[float, float, float]]]
    swings: Mapping[tuple[str, str], Swings]

    @property
    def sentences(self) -> tuple[str, ...]:
        said = []
        for (case, name), swing in self.swings.items():
            place = swing.order[0]
            parameter = list(self.spans[case])[place]
            ends = f"{swing.at_low[place]:.4g} to {swing.at_high[place]:.4g} {self.units[name]}".rstrip()
            said.append(f"{name}, {case}: {parameter} moves it most, {ends}")
        return tuple(said)

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("quantity"), Column("parameter"), Column("low end"), Column("high end"),
            Column("unit"), Column("at low end"), Column("in the middle"), Column("at high end"), Column("unit"),
        )  # fmt: skip
        rows = tuple(
            (case, name, parameter, spans[parameter][0], spans[parameter][2], self.parameter_units[parameter],
             float(swing.at_low[place]), swing.middle, float(swing.at_high[place]), self.units[name])
            for (case, name), swing in self.swings.items()
            for spans in [self.spans[case]]
            for place, parameter in ((place, list(spans)[place]) for place in swing.order)
        )  # fmt: skip
        return Table.of(self.title, "one parameter at a time", columns, rows, self.sentences)
