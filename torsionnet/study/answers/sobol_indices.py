"""The answer ``type: sobol_indices``: which parameters the variance of a quantity comes from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.composite import Listed
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Count, Text
from torsionnet.core.errors import Fault
from torsionnet.response.table import Column, Table
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answers.answer_names import QUANTITY
from torsionnet.study.answers.answer_case import AnswerCase, answer_cases
from torsionnet.study.answers.asking import chosen_quantities, distribution_faults, quantity_faults
from torsionnet.study.answers.conclusion_data import PlainConclusion
from torsionnet.study.answers.sobol_estimates import FEWEST, SobolEstimates, estimates_of, sobol_points

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@register_answer
@dataclass(frozen=True, kw_only=True)
class SobolIndices(StudyAnswer):
    """First-order and total Sobol indices with bootstrap intervals.

    A first-order index is the share of the variance that a parameter makes alone, a total index the share that would be
    left if only that parameter varied, whatever the others do with it. Parameters have to be independent. Every
    configuration takes count (number of parameters + 2) variants.
    """

    kind: ClassVar[str] = "sobol_indices"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"quantities": QUANTITY}

    quantities: tuple[str, ...] = entry(Listed("default: all that are single numbers", Text("quantity")), None)
    count: int = entry(Count("base points, a power of two", lower=FEWEST, upper=2**22), 1024)
    seed: int = entry(Count("another seed draws other variants", lower=0, upper=2**32 - 1), 1)
    confidence: float = entry(Value("of the intervals", "1", exclusive=True, below=1), 0.95)

    def contradictions(self) -> list[Fault]:
        if self.count & (self.count - 1):
            return [Fault(f"base points are a power of two, as {1 << self.count.bit_length()}", ("count",))]
        return []

    def unfit(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, self.quantities, "quantities")
        yield from distribution_faults(study)
        if study.space.entries.correlation:
            text = "Sobol indices share out a variance among independent parameters, and these are correlated"
            yield Fault(f"{text}; rank correlations (type: scatter) take any", on_key=True)

    def variants(self, study: AskedStudy) -> int:
        return len(study.configurations) * self.count * (len(study.space.random_names) + 2)

    def found(self, study: AskedStudy, result: VariantValues | None = None) -> SobolFound:
        del result
        names = chosen_quantities(study, self.quantities)
        found: dict[tuple[str, str], SobolEstimates] = {}
        for case in answer_cases(study):
            found |= {(case.label, name): one for name, one in self._of_case(case, names).items()}
        return SobolFound(study.title, study.space.random_names, found, self.confidence)

    def _of_case(self, case: AnswerCase, names: tuple[str, ...]) -> Mapping[str, SobolEstimates]:
        points = sobol_points(len(case.space.random_names), self.count, self.seed)
        values = case.calculated(case.space.from_unit(points), names)
        return {name: estimates_of(values[name], self.count, self.seed, self.confidence) for name in names}


@dataclass(frozen=True, eq=False)
class SobolFound(PlainConclusion):
    """Indices of ``parameters`` by configuration and quantity."""

    title: str
    parameters: tuple[str, ...]
    indices: Mapping[tuple[str, str], SobolEstimates]
    confidence: float

    @property
    def sentences(self) -> tuple[str, ...]:
        return tuple(text for key, one in self.indices.items() for text in self._about(key, one))

    def _about(self, key: tuple[str, str], one: SobolEstimates) -> Iterator[str]:
        case, name = key
        order = sorted(range(len(self.parameters)), key=lambda place: -one.total[place])
        first = order[0]
        share = f"{100 * one.first[first]:.3g} % alone, {100 * one.total[first]:.3g} % with all it acts with"
        yield f"{name}, {case}: most of its variance comes from {self.parameters[first]} ({share})"
        idle = [self.parameters[place] for place in order if one.total_high[place] < 0.01]
        if idle:
            yield f"{name}, {case}: {', '.join(idle)} could as well be fixed (total indices below 0.01)"
        if one.without_value:
            yield f"{name}, {case}: {one.without_value} base points left out, as one of their variants has no value"

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("quantity"), Column("parameter"), Column("first order", digits=4),
            Column("from", digits=4), Column("to", digits=4), Column("total", digits=4), Column("from", digits=4),
            Column("to", digits=4), Column("variants"),
        )  # fmt: skip
        rows = tuple(
            (*key, name, *(float(array[place]) for array in _columns(one)), one.evaluations)
            for key, one in self.indices.items()
            for place, name in enumerate(self.parameters)
        )
        note = f"estimators of Saltelli and Jansen, bootstrap intervals {100 * self.confidence:g} %"
        return Table(f"{self.title}: Sobol indices", columns, rows, (note, *self.sentences))

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        return plot.sobol_indices(self, **look)  # type: ignore[no-any-return]


def _columns(one: SobolEstimates) -> tuple[FloatArray, ...]:
    return (one.first, one.first_low, one.first_high, one.total, one.total_low, one.total_high)
