"""The best compromises between several objectives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Count
from torsionnet.core.errors import Fault
from torsionnet.study.answers.answer import AskedStudy, VariantValues, register_answer
from torsionnet.study.design.design_answer import DesignAnswer
from torsionnet.study.design.design_entries import NAMES, OneOrSeveral
from torsionnet.study.design.design_goals import DesignGoals, DesignObjective
from torsionnet.study.design.pareto_front import ParetoFront
from torsionnet.study.quantities.quantity_limit import QuantityLimit


@register_answer
@dataclass(frozen=True, kw_only=True)
class Pareto(DesignAnswer):
    """Designs none of which is better in every quantity than another, by non-dominated sorting (pymoo)."""

    kind: ClassVar[str] = "pareto"

    minimise: tuple[str, ...] = entry(OneOrSeveral("what is to be small, each for itself", NAMES), ())
    maximise: tuple[str, ...] = entry(OneOrSeveral("what is to be large, each for itself", NAMES), ())
    population: int = entry(Count("designs of a generation", lower=4, upper=100_000), 100)
    generations: int = entry(Count("how often they evolve", lower=1, upper=100_000), 100)

    def require_extras(self) -> None:
        from torsionnet.study.design.non_dominated import require_pymoo

        require_pymoo()

    def contradictions(self) -> list[Fault]:
        if len(self.minimise) + len(self.maximise) < 2:
            text = "a front needs two quantities or more under minimise and maximise; for one there is type: optimum"
            return [Fault(text, on_key=True)]
        return []

    def goals(self, limits: Mapping[str, QuantityLimit]) -> DesignGoals:
        objectives = [DesignObjective((name,)) for name in self.minimise]
        objectives += [DesignObjective((name,), "maximise") for name in self.maximise]
        return DesignGoals(objectives=tuple(objectives), limits=limits)

    def found(self, study: AskedStudy, result: VariantValues) -> ParetoFront:
        del result
        from torsionnet.study.design.non_dominated import pareto_front

        problem, quantities = self.problem(study)
        return pareto_front(
            problem,
            population=self.population,
            generations=self.generations,
            single=quantities.singly,
            seed=self.seed,
            title=study.title,
        )
