"""Worst case, an answer of a study, the largest and smallest value of a quantity within the tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answers.answer_case import AnswerCase, answer_cases
from torsionnet.study.answers.answer_inputs import QUANTITY, measure_of, quantity_faults, units_of
from torsionnet.study.answers.conclusion_data import PlainConclusion
from torsionnet.study.answers.worst_case_search import largest
from torsionnet.study.space.space import COVERAGE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CONFIRMED_DIFFERENCE = 1e-6
"""Largest relative difference of the worst value from that of the same variant as a single model, to be confirmed."""


@dataclass(frozen=True, eq=False)
class WorstVariant:
    """Variant of one configuration in which a quantity is largest or smallest, with the bounds that it lies on.

    Attributes
    ----------
    configuration, direction : str
    value, nominal : float
        Value of the quantity in this variant and in the model as given.
    variant, tolerance : mapping
        Values of the parameters, and the bounds of their tolerances.
    at_lower, at_upper : tuple of str
        Parameters at a bound of their tolerance.
    singly : float
        Value of this variant built and solved as a single model.
    best_at_random : float
        The worst value among ``tried`` random variants.
    evaluations : int
        Variants calculated.
    """

    configuration: str
    direction: str
    value: float
    variant: Mapping[str, float]
    tolerance: Mapping[str, tuple[float, float]]
    nominal: float
    at_lower: tuple[str, ...]
    at_upper: tuple[str, ...]
    singly: float
    best_at_random: float
    tried: int
    evaluations: int

    @property
    def confirmed(self) -> bool:
        """Whether the worst variant, solved as a single model, gives the same value."""
        return abs(self.singly - self.value) <= CONFIRMED_DIFFERENCE * abs(self.value)


@dataclass(frozen=True, eq=False)
class WorstCaseResult(PlainConclusion):
    """Worst variants of a quantity in all configurations, with units.

    ``correlated`` are the pairs of parameters that a study correlates.
    """

    title: str
    quantity: str
    unit: str
    parameter_units: Mapping[str, str]
    variants: tuple[WorstVariant, ...]
    correlated: tuple[tuple[str, str], ...] = ()

    @property
    def sentences(self) -> tuple[str, ...]:
        said = [text for one in self.variants for text in self._about(one)]
        if self.correlated:
            pairs = ", ".join(" and ".join(pair) for pair in self.correlated)
            said.append(
                f"correlation is left out ({pairs}): each parameter lies anywhere within its tolerance, whatever the "
                "others are, so that a worst case may be a variant that hardly occurs"
            )
        return tuple(said)

    def _about(self, one: WorstVariant) -> list[str]:
        values = f"{one.value:.5g} {self.unit}".rstrip() + f" (as given {one.nominal:.5g})"
        inside = [name for name in one.variant if name not in one.at_lower + one.at_upper]
        places = [("at the lower bound", one.at_lower), ("at the upper bound", one.at_upper), ("between", inside)]
        where = ", ".join(f"{' and '.join(names)} {place}" for place, names in places if names)
        said = [f"{one.direction} {self.quantity}, {one.configuration}: {values}, {where}"]
        said.append(
            f"{one.configuration}: none of {one.tried} random variants beats it; their best is {one.best_at_random:.5g}"
        )
        if not one.confirmed:
            said.append(
                f"{one.configuration}: solved as a model of its own this variant has {one.singly:.8g}: not confirmed"
            )
        return said

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("sought"), Column(self.quantity, self.unit), Column("as given", self.unit),
            *(Column(name, unit, digits=5) for name, unit in self.parameter_units.items()),
            Column("best at random", self.unit), Column("singly", self.unit), Column("variants"),
        )  # fmt: skip
        rows = tuple(
            (one.configuration, one.direction, one.value, one.nominal,
             *(one.variant[name] for name in self.parameter_units), one.best_at_random, one.singly, one.evaluations)
            for one in self.variants
        )  # fmt: skip
        return Table.of(self.title, f"worst case of {self.quantity}", columns, rows, self.sentences)

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        return plot.worst_variants(self, **look)  # type: ignore[no-any-return]


BOTH = "both"
SIGNS = {"largest": (1,), "smallest": (-1,), BOTH: (1, -1)}


@register_answer
@dataclass(frozen=True, kw_only=True)
class WorstCase(StudyAnswer):
    """Largest and smallest value of a quantity within the tolerances of all parameters, in each configuration.

    Tolerances are the limits of distributions, lists and ranges; a distribution without limits ends where all but the
    share ``coverage`` of its values lies within. Correlation is left out. Sought in corners, by differential evolution
    and along slopes; what is found is solved again as a model of its own, and random variants are tried to beat it.
    """

    kind: ClassVar[str] = "worst_case"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"quantity": QUANTITY}

    quantity: str = entry(Text("quantity"))
    direction: str = entry(OneOf("which value is sought", tuple(SIGNS)), BOTH)
    coverage: float = entry(
        Value(
            "share of the values within the tolerance, where a distribution has no limits", "1", exclusive=True, below=1
        ),
        COVERAGE,
    )
    tried: int = entry(Count("random variants that try to beat what was found", upper=10**9), 10_000)
    seed: int = entry(Count("another seed searches otherwise", lower=0, upper=2**32 - 1), 1)

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, (self.quantity,), "quantity")

    def conclude(self, study: AskedStudy, result: VariantValues | None = None) -> WorstCaseResult:
        del result
        found = [self._of_case(case, sign) for case in answer_cases(study) for sign in SIGNS[self.direction]]
        unit, pairs = measure_of(study, self.quantity).unit, study.space.entries.correlation
        correlated = tuple((str(first), str(second)) for first, second in (one.between for one in pairs))
        return WorstCaseResult(study.title, self.quantity, unit, units_of(study), tuple(found), correlated)

    def _of_case(self, case: AnswerCase, sign: int) -> WorstVariant:
        box = case.space.box(self.coverage)
        low, high = (np.array(side) for side in zip(*box.values(), strict=True))

        def values(points: FloatArray) -> dict[str, FloatArray]:
            return dict(zip(box, (low + points * (high - low)).T, strict=True))

        def signed(points: FloatArray) -> FloatArray:
            return sign * case.calculated(values(points), (self.quantity,))[self.quantity]

        found = largest(signed, len(box), seed=self.seed, tried=self.tried)
        variant = {name: float(column[0]) for name, column in values(found.point[None]).items()}
        nominal = sign * float(signed(self._nominal(case, low, high))[0])
        return WorstVariant(
            case.label, "largest" if sign > 0 else "smallest", sign * found.value, variant, box, nominal,
            tuple(list(box)[place] for place in found.at_lower), tuple(list(box)[place] for place in found.at_upper),
            case.singly(variant, self.quantity), sign * found.best_at_random, found.tried_at_random, found.evaluations,
        )  # fmt: skip

    def _nominal(self, case: AnswerCase, low: FloatArray, high: FloatArray) -> FloatArray:
        """Point (1, d) of the unit cube at which the d parameters have the model's own values.

        0.5 where a parameter has no value.
        """
        own = np.array([case.space.nominal[name] for name in case.space.names])
        return np.where(np.isnan(own), 0.5, (own - low) / np.where(high > low, high - low, 1.0))[None]
