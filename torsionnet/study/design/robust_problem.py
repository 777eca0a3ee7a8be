"""Design problem under tolerances, whose quantities are robust measures over samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import scipy

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.design.design_goals import DesignGoals, DesignObjective, Found
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.quantities.quantity import QuantityLimit

# Tolerances of the parameters of a design, and random draws from them.

LEAST_TAIL = 1e-12
"""Smallest share of a distribution below or above a draw, since the tails of a normal one never end."""


class DrawnTolerances(Protocol):
    """Draws of tolerances that are the same around every design, so that designs are compared alike."""

    @property
    def count(self) -> int:
        """Number of samples drawn around each design."""
        ...

    def around(self, designs: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n * count,) in SI of each parameter, by name, around n designs, the first design's samples first."""
        ...


class Tolerances(Protocol):
    """Tolerances of all parameters of a design, from which draws are made."""

    def even_draws(self, count: int, seed: int) -> DrawnTolerances:
        """Quasi-random draws of the tolerances that fill the space evenly; ``count`` may be rounded up."""
        ...

    def random_draws(self, count: int, seed: int) -> DrawnTolerances:
        """Independent random draws of the tolerances, for which confidence intervals hold."""
        ...


def even_shares(size: int, count: int, seed: int) -> FloatArray:
    """Points (n, size) of the unit cube from a scrambled Sobol sequence, n being the next power of two."""
    _enough(count)
    shares = scipy.stats.qmc.Sobol(size, scramble=True, seed=seed).random_base2(int(np.ceil(np.log2(count))))
    return np.asarray(np.clip(shares, LEAST_TAIL, 1 - LEAST_TAIL))


def random_shares(size: int, count: int, seed: int) -> FloatArray:
    """Independent random points (count, size) of the unit cube."""
    _enough(count)
    return np.asarray(np.clip(np.random.default_rng(seed).random((count, size)), LEAST_TAIL, 1 - LEAST_TAIL))


def _enough(count: int) -> None:
    if count < 2:
        raise UsageError(
            f"a robust design needs two samples or more of the tolerances, got {count}", kind="out-of-range"
        )


class RobustMeasure(Protocol):
    """Robust measure, one number for the samples of a design, on their bad side."""

    def name(self, quantity: str, sign: float) -> str:
        """Name of the robust measure of a quantity.

        ``sign`` is 1 where large values are bad, -1 where small ones are.
        """
        ...

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        """Robust measures (n,) of samples (n, count) of n designs."""
        ...


@dataclass(frozen=True)
class MeanAndDeviation:
    """Robust measure of a design's samples, their mean plus or minus ``k`` standard deviations.

    >>> MeanAndDeviation(2.0).of(np.array([[1.0, 3.0]]), 1.0).tolist()
    [4.0]
    """

    k: float = 3.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.k) and self.k >= 0):
            raise UsageError(f"mean and k standard deviations need a k from 0, got {self.k:g}", kind="out-of-range")

    def name(self, quantity: str, sign: float) -> str:
        more = f" {'+' if sign > 0 else '-'} {self.k:g} sigma" if self.k else ""
        return f"mean{more} of {quantity}"

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        return np.asarray(samples.mean(axis=1) + sign * self.k * samples.std(axis=1))


@dataclass(frozen=True)
class SamplePercentile:
    """Robust measure of a design's samples, the percentile than which so many per cent of them are not worse.

    >>> SamplePercentile(75.0).of(np.array([[0.0, 1.0, 2.0, 3.0, 4.0]]), -1.0).tolist()
    [1.0]
    """

    percent: float = 95.0

    def __post_init__(self) -> None:
        if not 0 < self.percent < 100:
            raise UsageError(f"a percentile lies between 0 and 100 %, got {self.percent:g}", kind="out-of-range")

    def name(self, quantity: str, sign: float) -> str:
        return f"{self.percent if sign > 0 else 100 - self.percent:g} % percentile of {quantity}"

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        share = self.percent / 100 if sign > 0 else 1 - self.percent / 100
        return np.asarray(np.quantile(samples, share, axis=1))


@dataclass(frozen=True)
class Rejects:
    """Robust measure of a design's samples, the share that exceeds a limit, from their largest excess.

    Designs with equally many rejects are ranked by how far these exceed limits, which counts less than half a sample.

    >>> Rejects().of(np.array([[-1.0, -1.0, -1.0, 0.1]]), 1.0).round(3).tolist()
    [0.253]
    """

    def name(self, quantity: str, sign: float) -> str:
        del quantity, sign
        return "share of rejects"

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        over = np.maximum(np.nan_to_num(sign * samples, nan=np.inf), 0.0)
        far = np.where(np.isinf(over), 1.0, over / (1 + over)).mean(axis=1)
        return np.asarray((over > 0).mean(axis=1) + far / (2 * samples.shape[1]))


DEVIATION = "squared deviation from targets"
EXCESS = "excess over limits"


@dataclass(frozen=True, eq=False)
class RobustQuantities:
    """Function from designs to robust measures over their samples (``Evaluate`` of a design problem)."""

    problem: DesignProblem
    tolerances: DrawnTolerances
    measure: RobustMeasure

    def __call__(self, designs: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n,) of each robust measure, by its name, for n designs."""
        samples = self.samples(designs)
        measured = {}
        for name, sign, measure in self.wanted():
            measured[measure.name(name, sign)] = measure.of(samples[name], sign)
        for name, limit in self.problem.goals.limits.items():
            for sign in _sides(limit, self.measure):
                measured[self.measure.name(name, sign)] = self.measure.of(samples[_side(name, sign)], sign)
        return measured

    def samples(self, designs: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Worst values (n, count) in SI over the points of objectives, deviations and limits in n designs' samples."""
        goals, count = self.problem.goals, self.tolerances.count
        at_samples = self._at(designs)
        worst: dict[str, FloatArray] = {}
        for objective in goals.objectives:
            # The worst point of a sample, with the sign that makes large bad.
            worst[objective.name] = objective.sign * objective.columns(at_samples).max(axis=1)
        if goals.targets:
            worst[DEVIATION] = np.sum(goals.deviations(at_samples) ** 2, axis=1)
        if goals.limits:
            worst[EXCESS] = goals.excess(at_samples).max(axis=1)
        for name in goals.limits:
            worst |= {_side(name, sign): sign * (sign * at_samples[name]).max(axis=1) for sign in (1.0, -1.0)}
        return {name: values.reshape(-1, count) for name, values in worst.items()}

    def _at(self, designs: Mapping[str, FloatArray]) -> Found:
        # All samples of all designs in one batch, design by design.
        values = self.problem.evaluate(self.tolerances.around(designs))
        self.problem.goals.check(values)
        size = len(next(iter(designs.values()))) * self.tolerances.count
        return {name: np.asarray(values[name], float).reshape(size, -1) for name in self.problem.goals.quantities}

    def wanted(self) -> list[tuple[str, float, RobustMeasure]]:
        """List of the objectives of a robust design, each with name, sign of the bad side, and robust measure."""
        goals = self.problem.goals
        if isinstance(self.measure, Rejects):
            return [(EXCESS, 1.0, self.measure)]
        if goals.targets:
            # Targets have one measure: the mean of the squared deviation.
            return [(DEVIATION, 1.0, MeanAndDeviation(0.0))]
        return [(objective.name, objective.sign, self.measure) for objective in goals.objectives]


def robust_problem(problem: DesignProblem, tolerances: DrawnTolerances, measure: RobustMeasure) -> DesignProblem:
    """Design problem whose quantities are robust measures over samples; limits hold for the measures."""
    if isinstance(measure, Rejects) and not problem.goals.limits:
        raise UsageError("rejects are what exceeds limits: give limits", kind="missing-entry")
    if not isinstance(measure, Rejects):
        problem.goals.require_merit()
    robustly = RobustQuantities(problem, tolerances, measure)
    objectives = tuple(
        DesignObjective((how.name(name, sign),), "minimise" if sign > 0 else "maximise")
        for name, sign, how in robustly.wanted()
    )
    limits = {
        measure.name(name, sign): QuantityLimit(**{side: getattr(limit, side)})
        for name, limit in problem.goals.limits.items()
        for sign in _sides(limit, measure)
        for side in ["below" if sign > 0 else "above"]
    }
    # Measures over samples have neither exact slopes nor curves over frequency.
    return replace(
        problem,
        goals=DesignGoals(objectives=objectives, limits=limits, units=_units(problem.goals, robustly)),
        evaluate=robustly,
        slopes=None,
        curves={},
        _asked=[],
    )


def _units(goals: DesignGoals, robustly: RobustQuantities) -> dict[str, str]:
    """SI units of robust measures and of their quantities, by name; shares and squares have none."""
    if isinstance(robustly.measure, Rejects):
        return {}
    known = {**goals.units, **{objective.name: goals.unit_of(objective) for objective in goals.objectives}}
    measured = {how.name(name, sign): known.get(name, "") for name, sign, how in robustly.wanted()}
    limited = {robustly.measure.name(name, sign): known.get(name, "") for name in goals.limits for sign in (1.0, -1.0)}
    return known | limited | measured


def _sides(limit: QuantityLimit, measure: RobustMeasure) -> tuple[float, ...]:
    """Signs of the sides of a limit, 1 for upper, -1 for lower; none where rejects are counted over all limits."""
    if isinstance(measure, Rejects):
        return ()
    return (*((1.0,) if limit.below is not None else ()), *((-1.0,) if limit.above is not None else ()))


def _side(name: str, sign: float) -> str:
    return f"{'largest' if sign > 0 else 'smallest'} {name}"
