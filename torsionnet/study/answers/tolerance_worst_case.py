"""The answer ``type: worst_case``: the largest and smallest value of a quantity within the tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Count, OneOf, Text
from torsionnet.core.errors import Fault
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answers.answer_names import QUANTITY
from torsionnet.study.answers.answer_case import AnswerCase, answer_cases
from torsionnet.study.answers.asking import measure_of, quantity_faults, units_of
from torsionnet.study.answers.worst_case_found import WorstCaseFound, WorstVariant
from torsionnet.study.answers.worst_case_search import largest
from torsionnet.study.space.space import COVERAGE

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

    def unfit(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, (self.quantity,), "quantity")

    def found(self, study: AskedStudy, result: VariantValues | None = None) -> WorstCaseFound:
        del result
        found = [self._of_case(case, sign) for case in answer_cases(study) for sign in SIGNS[self.direction]]
        unit, pairs = measure_of(study, self.quantity).unit, study.space.entries.correlation
        correlated = tuple((str(first), str(second)) for first, second in (one.between for one in pairs))
        return WorstCaseFound(study.title, self.quantity, unit, units_of(study), tuple(found), correlated)

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
        """The model itself in the unit cube; the middle, where a parameter has no value."""
        own = np.array([case.space.nominal[name] for name in case.space.names])
        return np.where(np.isnan(own), 0.5, (own - low) / np.where(high > low, high - low, 1.0))[None]
