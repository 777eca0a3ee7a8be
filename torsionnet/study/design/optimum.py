"""Optimum, an answer of a study, the values of parameters for targets or one objective."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.entries.spec import Count, entry
from torsionnet.base.errors import EntryPath, Fault, ModelError
from torsionnet.linear.dynamic_stiffness.quotient import compiled_works
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.study.answers.answer import (
    PARAMETER,
    QUANTITY,
    AskedStudy,
    StudyAnswer,
    VariantValues,
    measure_of,
    register_answer,
)
from torsionnet.study.design.design_goals import (
    DESIGN,
    NAMES,
    TARGETS,
    DesignBounds,
    DesignGoals,
    DesignObjective,
    DesignOptimum,
    DesignTarget,
    OneOrSeveral,
    TargetEntry,
    chosen_parameters,
    design_parameters,
)
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.design.design_quantities import DesignQuantities, peak_curves
from torsionnet.study.quantities.quantity import QuantityLimit, wrong_unit

# Base class of the answers on designs, with their parameters, limits, and the design problem of a study.


@dataclass(frozen=True, kw_only=True)
class DesignAnswer(StudyAnswer):
    """Base class of a study's answers on designs (optimum, Pareto front, robust design).

    Every configuration of the study counts.
    """

    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {
        "design": PARAMETER, "limits": QUANTITY, "targets": QUANTITY, "minimise": QUANTITY, "maximise": QUANTITY,
    }  # fmt: skip

    design: Mapping[str, DesignBounds | None] = entry(DESIGN, None)
    limits: Mapping[str, QuantityLimit] = entry(
        Named(
            "limits of quantities, beside those of the study",
            Nested("a limit", lambda: QuantityLimit, "quantity_limit"),
        ),
        None,
    )
    seed: int = entry(Count("of the search; the same seed gives the same answer", lower=0, upper=2**31 - 1), 0)

    def goals(self, limits: Mapping[str, QuantityLimit]) -> DesignGoals:
        """Targets or objectives of the design, together with these limits."""
        raise NotImplementedError

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        known = study.quantities
        _, faults = design_parameters(study.model, self.design)
        yield from (fault.under("design") for fault in faults)
        for name, value, path in self.with_values():
            if name in known:
                unit = known[name].measured(study.model_in(study.configurations[0]), known).unit
                yield from wrong_unit(value, name, unit, path)

    def with_values(self) -> Iterator[tuple[str, float | None, EntryPath]]:
        """Yield the quantities with the values of their limits or targets in SI, and the paths of these in the file."""
        for name, limit in self.limits.items():
            yield name, limit.below, ("limits", name, "below")
            yield name, limit.above, ("limits", name, "above")

    def parameters(self, study: AskedStudy) -> tuple[DesignParameter, ...]:
        """Design parameters of the study with bounds in SI."""
        parameters, faults = chosen_parameters(study, self.design)
        if faults:
            raise ModelError([fault.under("design") for fault in faults], "the design")
        return tuple(parameters)

    def problem(self, study: AskedStudy, names: tuple[str, ...] = ()) -> tuple[DesignProblem, DesignQuantities]:
        """Design problem of the study, and the function that calculates its quantities.

        Parameters ``names`` vary beside those designed.
        """
        parameters = self.parameters(study)
        goals = self.goals({**study.limits, **self.limits})
        units = {name: measure_of(study, name).unit for name in goals.quantities if name in study.quantities}
        goals = replace(goals, units=units)
        varied = tuple(dict.fromkeys([*(parameter.name for parameter in parameters), *names]))
        method = "compiled" if compiled_works() else "graph"
        evaluators = tuple(study.evaluator(configuration, varied, method) for configuration in study.configurations)
        quantities = DesignQuantities(evaluators, goals.quantities)
        acted_on = any(evaluator.model.assembly.kinematics.actions for evaluator in evaluators)
        if names or acted_on:  # no derivatives, neither of samples nor where a torque follows another motion
            return DesignProblem(parameters, goals, quantities), quantities
        # Peaks of curves have kinks where the highest one changes; the curves themselves are smooth.
        curves = peak_curves(goals.quantities, varied, evaluators)
        return DesignProblem(parameters, goals, quantities, quantities.slopes, curves), quantities


@dataclass(frozen=True, kw_only=True)
class SingleDesign(DesignAnswer):
    """Base class of a study's answers on designs with targets or one objective."""

    targets: Mapping[str, TargetEntry] = entry(TARGETS, None)
    minimise: tuple[str, ...] = entry(OneOrSeveral("what is to be small; of several the worst", NAMES), ())
    maximise: tuple[str, ...] = entry(OneOrSeveral("what is to be large; of several the smallest", NAMES), ())

    def contradictions(self) -> list[Fault]:
        given = [name for name in ("targets", "minimise", "maximise") if getattr(self, name)]
        if not given and self.needs_goal:
            return [Fault("say what is sought: targets, minimise or maximise", on_key=True, kind="missing-entry")]
        if len(given) > 1:
            return [
                Fault(
                    f"either {' or '.join(given)}; make one a limit, or ask for a front (type: pareto)",
                    (given[1],),
                    kind="contradicting-entries",
                )
            ]
        return []

    @property
    def needs_goal(self) -> bool:
        """Whether the answer needs targets or an objective beside limits."""
        return True

    def with_values(self) -> Iterator[tuple[str, float | None, EntryPath]]:
        yield from super().with_values()
        yield from ((name, target.value, ("targets", name)) for name, target in self.targets.items())

    def goals(self, limits: Mapping[str, QuantityLimit]) -> DesignGoals:
        targets = tuple(DesignTarget(name, target.value, target.weight) for name, target in self.targets.items())
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
