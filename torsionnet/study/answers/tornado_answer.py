"""Tornado, an answer of a study, the change of quantities by each parameter alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import OneOf, Text, entry
from torsionnet.base.errors import Fault
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
    measure_of,
    quantity_faults,
    register_answer,
    units_of,
)


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
