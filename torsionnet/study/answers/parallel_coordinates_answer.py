"""Parallel coordinates, an answer of a study, every variant a line across axes of parameters and quantities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import Count, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answers.answer_inputs import QUANTITY, chosen_quantities, measure_of, quantity_faults, units_of
from torsionnet.study.answers.case_values import case_values
from torsionnet.study.answers.conclusion_data import IN_WORDS, PlainConclusion

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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


@dataclass(frozen=True, eq=False)
class ParallelCoordinatesResult(PlainConclusion):
    """Values of the variants by configuration and axis, which are beyond a limit, and medians of both kinds.

    Where ``part`` says so, medians are of a part of all variants, and those shown were chosen from it.
    """

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

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        return plot.parallel_coordinates(self, **look)  # type: ignore[no-any-return]
