"""Optimum of a design, its parameter values, its quantities, and checks of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.spec import Json
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.study.answers.answer import DrawnConclusion
from torsionnet.study.design.design_goals import DesignGoals, with_unit

TARGET_MET = 1e-8
"""Largest relative deviation from a target that counts as met, as less would call rounding a miss."""
SAME_QUANTITY = 1e-8
"""Largest relative difference of a quantity calculated in a batch and by a single model that counts as rounding."""


@dataclass(frozen=True, eq=False, repr=False)
class DesignOptimum(DrawnConclusion):
    """Best design found by an optimisation, with its quantities before and after.

    Attributes
    ----------
    parameters : tuple of DesignParameter
        Parameters with given value, bounds and best value, SI.
    goals : DesignGoals
    before, after : mapping
        Quantity -> values (n_points,) as given and with the values found.
    single : mapping
        Quantity -> values recomputed by a single model with the values found; empty where none was given.
    violation : float
        Sum of relative excess over limits; 0 where all are kept.
    alternatives : tuple of mapping
        Other designs that are as good.
    free_directions : int
        Number of independent changes of parameters that leave every target met.
    history : (n, 2) array
        Designs calculated so far, and the best merit by then.
    converged : bool
        Whether several searches found this design, or no design beside it is better.
    title : str
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.designs:design_optimum"

    parameters: tuple[DesignParameter, ...]
    goals: DesignGoals
    before: Mapping[str, FloatArray]
    after: Mapping[str, FloatArray]
    single: Mapping[str, FloatArray]
    violation: float
    alternatives: tuple[Mapping[str, float], ...]
    free_directions: int
    history: FloatArray
    converged: bool
    title: str = ""

    @property
    def values(self) -> dict[str, float]:
        """Value in SI of each design parameter, by its name, for :meth:`torsionnet.Drivetrain.configured`."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    @property
    def active_bounds(self) -> dict[str, str]:
        """Parameters that are at a bound, by name, with ``lower`` or ``upper`` as value."""
        return {parameter.name: parameter.bound for parameter in self.parameters if parameter.bound}

    @property
    def merit(self) -> float:
        """Sum of squared relative deviations from targets, or the value in SI of the objective's quantity."""
        size = float(self.goals.merit(_rows(self.after))[0])
        return size if self.goals.targets else self.goals.objectives[0].shown(size)

    @property
    def disagreement(self) -> float:
        """Largest relative difference between quantities calculated in a batch and by a single model."""
        apart = [
            float(np.max(np.abs(self.after[name] - alone) / max(float(np.abs(alone).max()), 1e-300)))
            for name, alone in self.single.items()
        ]
        return max(apart, default=0.0)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Result of the optimisation in sentences, on targets, objective, limits, bounds, uniqueness, verification."""
        return tuple(sentence for _, sentence in self.conclusions)

    @property
    def conclusions(self) -> tuple[tuple[str, str], ...]:
        """Sentences on the result of the optimisation, each with what it is about, as ``limits``."""
        said = {
            "targets": self._targets_said(), "objective": self._objective_said(), "limits": self._limits_said(),
            "bounds": self._bounds_said(), "uniqueness": self._uniqueness_said(),
            "verification": self._verification_said(),
        }  # fmt: skip
        return tuple((about, sentence) for about, sentences in said.items() for sentence in sentences)

    def _targets_said(self) -> list[str]:
        said = []
        for target in self.goals.targets:
            value, unit = self.after[target.quantity], self.goals.units.get(target.quantity, "")
            wanted = with_unit(target.value, unit)
            worst = float(value[np.argmax(np.abs(value - target.value))])
            if abs(worst - target.value) <= TARGET_MET * (abs(target.value) or 1.0):
                said.append(f"{target.quantity} has its target, {wanted}")
            else:
                text = f"its target {wanted} is not reached within the bounds"
                said.append(f"{target.quantity} comes to {with_unit(worst, unit)}: {text}")
        points = sum(self.after[target.quantity].size for target in self.goals.targets)
        if points > len(self.parameters):
            said.append(f"{points} targets and {len(self.parameters)} parameters: least squares of relative deviations")
        return said

    def _objective_said(self) -> list[str]:
        if not self.goals.objectives:
            return []
        objective = self.goals.objectives[0]
        first = objective.shown(float(objective.columns(_rows(self.before)).max()))
        reached = with_unit(self.merit, self.goals.unit_of(objective))
        return [f"{objective.name} goes from {first:.6g} to {reached} ({objective.sense}d)"]

    def _limits_said(self) -> list[str]:
        if not self.goals.limits:
            return []
        if self.violation > 0:
            over = [name for name, limit in self.goals.limits.items() if limit.exceeded(self.after[name]).any()]
            return [f"no design within the bounds was found that keeps all limits; this one exceeds {', '.join(over)}"]
        hold = [
            name
            for name, limit in self.goals.limits.items()
            for bound in (limit.below, limit.above)
            if bound is not None and np.abs(self.after[name] - bound).min() <= 1e-6 * (abs(bound) or 1.0)
        ]
        return [f"limits are kept; the optimum lies at the limit of {', '.join(hold)}" if hold else "limits are kept"]

    def _bounds_said(self) -> list[str]:
        return [f"{name} is at its {bound} bound" for name, bound in self.active_bounds.items()]

    def _uniqueness_said(self) -> list[str]:
        said = []
        if self.free_directions:
            many = "one combination" if self.free_directions == 1 else f"{self.free_directions} combinations"
            said.append(f"not unique: {many} of the parameters may change without a change of the targeted quantities")
        elif self.alternatives:
            others = "; ".join(
                ", ".join(f"{name} = {value:.6g}" for name, value in design.items()) for design in self.alternatives
            )
            said.append(f"not unique: equally good are {others}; this one is nearest to the values as given")
        if not self.converged:
            said.append("the search did not settle: designs beside this one go on being better")
        return said

    def _verification_said(self) -> list[str]:
        if not self.single:
            return []
        apart = self.disagreement
        if apart <= SAME_QUANTITY:
            return ["recomputed by a model with these values: the same"]
        return [f"recomputed by a model with these values: different by {apart:.2g} of themselves"]

    def table(self) -> Table:
        """Table of the design parameters, then of the quantities, as given and at the optimum."""
        rows: list[tuple[object, ...]] = [
            (p.name, p.unit, p.start, p.value, p.lower, p.upper, None) for p in self.parameters
        ]
        wanted = {target.quantity: target.value for target in self.goals.targets}
        for name, after in self.after.items():
            limit = self.goals.limits.get(name)
            low, high = (None, None) if limit is None else (limit.above, limit.below)
            top = int(np.argmax(after))
            unit = self.goals.units.get(name, "")
            rows.append((name, unit, float(self.before[name].max()), float(after[top]), low, high, wanted.get(name)))
        names = ("", "unit", "as given", "optimum", "lower", "upper", "target")
        return Table.of(self.title, "optimum", tuple(map(Column, names)), tuple(rows), self.sentences)

    def to_data(self) -> dict[str, Json]:
        """Optimum as JSON data in SI and full precision."""
        return {
            "values": self.values,
            "active_bounds": self.active_bounds,
            "merit": self.merit,
            "before": {name: before.tolist() for name, before in self.before.items()},
            "after": {name: after.tolist() for name, after in self.after.items()},
            "violation": self.violation,
            "alternatives": [dict(design) for design in self.alternatives],
            "free_directions": self.free_directions,
            "disagreement": self.disagreement,
            "evaluations": int(self.history[-1, 0]),
            "converged": self.converged,
            "sentences": list(self.sentences),
        }


def _rows(values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: row[None, :] for name, row in values.items()}
