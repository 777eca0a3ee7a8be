"""Optimum, an answer of a study, the values of parameters for targets or one objective."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.study.answers.answer import AskedStudy, VariantValues, register_answer
from torsionnet.study.design.design_answer import DesignAnswer
from torsionnet.study.design.design_entries import NAMES, TARGETS, OneOrSeveral, TargetEntry
from torsionnet.study.design.design_goals import DesignGoals, DesignObjective, DesignTarget
from torsionnet.study.design.design_optimum import DesignOptimum
from torsionnet.study.quantities.quantity_limit import QuantityLimit


@dataclass(frozen=True, kw_only=True)
class SingleDesign(DesignAnswer):
    """Base class of a study's answers on designs with targets or one objective."""

    targets: Mapping[str, TargetEntry] = entry(TARGETS, None)
    minimise: tuple[str, ...] = entry(OneOrSeveral("what is to be small; of several the worst", NAMES), ())
    maximise: tuple[str, ...] = entry(OneOrSeveral("what is to be large; of several the smallest", NAMES), ())

    def contradictions(self) -> list[Fault]:
        given = [name for name in ("targets", "minimise", "maximise") if getattr(self, name)]
        if not given and self.needs_goal:
            return [Fault("say what is sought: targets, minimise or maximise", on_key=True)]
        if len(given) > 1:
            return [
                Fault(f"either {' or '.join(given)}; make one a limit, or ask for a front (type: pareto)", (given[1],))
            ]
        return []

    @property
    def needs_goal(self) -> bool:
        """Whether the answer needs targets or an objective beside limits."""
        return True

    def with_values(self) -> Iterator[tuple[str, float | None, EntryPath]]:
        yield from super().with_values()
        yield from ((name, one.value, ("targets", name)) for name, one in self.targets.items())

    def goals(self, limits: Mapping[str, QuantityLimit]) -> DesignGoals:
        targets = tuple(DesignTarget(name, one.value, one.weight) for name, one in self.targets.items())
        objectives = tuple(
            DesignObjective(names, sense)
            for sense, names in (("minimise", self.minimise), ("maximise", self.maximise))
            if names
        )
        return DesignGoals(targets, objectives, limits)


@register_answer
@dataclass(frozen=True, kw_only=True)
class Optimum(SingleDesign):
    """Values of parameters that meet targets, or with which the worst of some quantities is smallest or largest.

    Searched everywhere within bounds, then nearby with exact derivatives where there are some, and recomputed by a
    model with the values found. In several configurations the worst counts.
    """

    kind: ClassVar[str] = "optimum"

    def conclude(self, study: AskedStudy, result: VariantValues) -> DesignOptimum:
        del result
        from torsionnet.study.design.optimise import optimise

        problem, quantities = self.problem(study)
        return optimise(problem, single=quantities.singly, seed=self.seed, title=study.title)
