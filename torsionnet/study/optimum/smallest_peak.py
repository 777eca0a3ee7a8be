"""Search of the smallest peak of transfer functions, in which peaks come to be equally high."""

from __future__ import annotations

from collections.abc import Callable

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import SolveError
from torsionnet.solve.design.damper_design import levels_of
from torsionnet.solve.design.minimax import searched
from torsionnet.solve.design.worst_levels import WorstLevels
from torsionnet.solve.sensitivity.unknowns import unknowns
from torsionnet.study.evaluator import Evaluator
from torsionnet.study.optimum.design_goals import DesignGoals
from torsionnet.study.optimum.design_problem import DesignProblem
from torsionnet.study.quantities.peak import PeakMagnitude

Polish = Callable[[FloatArray], FloatArray]


def peak_polish(problem: DesignProblem, evaluators: tuple[Evaluator, ...]) -> Polish | None:
    """What makes the largest of some peaks smallest near a place; None where something else is sought.

    Peaks of all quantities, in all configurations, become constraints at frequencies that follow the design, with
    exact derivatives.
    """
    levels = _levels(problem.goals, problem.names, evaluators)
    if levels is None:
        return None
    sought = problem.goals.objectives[0].quantities, [one.configuration for one in evaluators]
    what = f"smallest peak of {sought} within {problem.box.lower.tolist()} and {problem.box.upper.tolist()}"

    def polished(place: FloatArray) -> FloatArray:
        def found() -> FloatArray:
            try:
                return searched(levels, problem.box, place)
            except SolveError:
                return place

        return evaluators[0].once(what, dict(zip(problem.names, map(float, place), strict=True)), found)

    return polished


def _levels(goals: DesignGoals, names: tuple[str, ...], evaluators: tuple[Evaluator, ...]) -> WorstLevels | None:
    if goals.limits or goals.targets or len(goals.objectives) != 1 or goals.objectives[0].sense != "minimise":
        return None
    parts, highest = [], 0.0
    for one in evaluators:
        for name in goals.objectives[0].quantities:
            peak = one.quantities[name]
            if not isinstance(peak, PeakMagnitude) or peak.excitation is not None or not peak.band[0] > 0:
                return None
            low, high = float(peak.band[0]), float(peak.band[1])
            varied = unknowns(one.model, names)
            parts.append(levels_of(one.model, varied, peak.output, peak.input, (low, high), None, None, None))
            highest = max(highest, high)
    return WorstLevels(tuple(parts), highest)
