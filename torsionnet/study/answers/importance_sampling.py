"""Importance sampling, the probability of a rare failure from variants drawn around the design points."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer_case import OfPoints
from torsionnet.study.answers.design_points import design_points, distinct_directions, distinct_points
from torsionnet.study.answers.rare_event import RareEvent, lognormal_interval
from torsionnet.study.answers.share_interval import counted_share
from torsionnet.study.answers.subset_sampling import SubsetLevels, subset_levels

WIDE_SHARE = 0.15
"""Share of variants drawn wide around the median, as more find missed failures sooner, fewer give a smaller error."""
LEAST_CENTRE_SHARE = 0.05
"""Smallest weight of a design point relative to that of the most likely one, so that none is sampled too rarely."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """Mixture of normal distributions around centres (m, d), nearest first, and of a wide one around the median."""

    centres: FloatArray

    @property
    def spread(self) -> float:
        """Standard deviation of the wide distribution, with half of its variants or more beyond the nearest centre."""
        return (
            max(1.0, float(np.linalg.norm(self.centres[0])) / self.centres.shape[1] ** 0.5)
            if len(self.centres)
            else 1.0
        )

    @property
    def shares(self) -> FloatArray:
        """Shares (m + 1,) of the variants drawn around each of m centres and, last, from the wide distribution."""
        from scipy.special import log_ndtr

        if not len(self.centres):
            return np.ones(1)
        size = log_ndtr(-np.linalg.norm(self.centres, axis=1))
        shares = np.maximum(np.exp(size - size.max()), LEAST_CENTRE_SHARE)
        return np.append((1 - WIDE_SHARE) * shares / shares.sum(), WIDE_SHARE)

    def draw(self, numbers: np.random.Generator, count: int) -> FloatArray:
        which = numbers.choice(len(self.centres) + 1, size=count, p=self.shares)
        points = numbers.standard_normal((count, self.centres.shape[1]))
        wide = which == len(self.centres)
        points[wide] *= self.spread
        return np.asarray(points + np.concatenate([self.centres, np.zeros((1, points.shape[1]))])[which])

    def log_weights(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Logarithms (n,) at n points of the density over the mixture's, and of the centres' over the wide one's."""
        from scipy.special import logsumexp

        shares, width = np.log(self.shares), self.spread
        plain = -(points**2).sum(axis=1) / 2
        wide = shares[-1] + plain / width**2 - points.shape[1] * np.log(width)
        near = [
            share - ((points - centre) ** 2).sum(axis=1) / 2
            for share, centre in zip(shares[:-1], self.centres, strict=True)
        ]
        around = np.asarray(logsumexp(near, axis=0)) if near else np.full(len(points), -np.inf)
        return np.asarray(plain - np.logaddexp(around, wide)), np.asarray(around - wide)


FEWEST_VARIANTS = 4000
"""Fewest variants of importance sampling, as with fewer the search for design points leaves too few for sampling."""
LEVEL_SHARE = 0.02
"""Share of all variants in each level of the run of subset simulation that looks for failures before sampling."""
FEWEST_IN_LEVEL = 200
"""Fewest variants in a level of the subset simulation, whose tenth begins the next level and must not be too small."""
MOST_STARTS = 10
"""Most searches for design points that are started in a round, each of which takes some hundred variants."""
BATCH = 2000
"""Variants drawn before the error is looked at again, as larger batches overshoot the accuracy, smaller run slower."""
MOST_ROUNDS = 6
"""Most rounds of searches for design points, each from failed variants that lie beyond no design point found so far."""
EXPECTED_STEPS = 8
"""Expected number of steps of a search for a design point, by which the number of searches is bounded."""
FEWEST_EFFECTIVE, HEAVIEST = 100, 0.05
"""Effective variants below which, and share of one variant above which, the probability is called uncertain."""
MOST_MISSED = 0.05
"""Share of the failure probability far from all design points above which the result is called uncertain."""
TANGENT_SLACK = 0.5
"""Standard deviations by which a failure may lie before a design point's tangent plane and still belong to it."""
FREQUENT_PROBABILITY = 0.02
"""Failure probability above which plain sampling is as good as importance sampling."""


def importance_sampling(
    margin: OfPoints, n_parameters: int, *, count: int, seed: int, accuracy: float = 0.01, confidence: float = 0.95
) -> RareEvent:
    """Estimate the probability of failure (``margin`` not above 0) under independent standard normal parameters.

    A run of subset simulation finds failures of every kind; from these design points are sought until each failure
    lies beyond one of them. Variants are then drawn from a mixture of normal distributions around the design points and
    a wide one around the median, each weighted by its density over the mixture's, until the standard error is the
    share ``accuracy`` of the probability or ``count`` variants were calculated.

    Parameters
    ----------
    margin : callable
        Points (n, d) -> safety margins (n,); failure where not above 0.
    n_parameters : int
    count : int
        Largest number of variants, those of the search included.
    seed : int
    accuracy, confidence : float
    """
    if count < FEWEST_VARIANTS:
        raise UsageError(f"importance sampling needs {FEWEST_VARIANTS} variants or more, got {count}")
    numbers = np.random.default_rng(seed)
    size = max(FEWEST_IN_LEVEL, 10 * round(LEVEL_SHARE * count / 10))
    scouted = subset_levels(margin, size, n_parameters, numbers)
    if scouted.probability > FREQUENT_PROBABILITY:
        plain = _drawn(margin, Mixture(scouted.failures[:0]), numbers, count - scouted.evaluations, accuracy)
        share = counted_share(sum(map(len, plain.points)), plain.count, confidence)
        used = plain.count + scouted.evaluations
        return RareEvent(share.value, share.low, share.high, plain.variation, used, (), "importance")
    centres, left, used = _centres(margin, scouted, count - scouted.evaluations)
    used += scouted.evaluations
    drawn = _drawn(margin, Mixture(centres), numbers, max(BATCH, count - used), accuracy)
    doubts = []
    if len(left) > MOST_MISSED * len(scouted.failures):
        percent = 100 * len(left) / len(scouted.failures)
        doubts.append(f"{percent:.0f} % of the failures lie beyond none of the {len(centres)} design points")
    found = drawn.result(confidence, used, len(centres), tuple(doubts))
    factor = 1 + 100 / size**0.5
    if found.probability and not 1 / factor < scouted.probability / found.probability < factor:
        text = f"the run before it came to {scouted.probability:.2g}"
        return replace(found, doubts=(*found.doubts, text))
    return found


def _centres(margin: OfPoints, scouted: SubsetLevels, most: int) -> tuple[FloatArray, FloatArray, int]:
    """Design points (m, d), failures (k, d) that lie beyond none of them, and number of variants of the search.

    Searches begin at failures, and at points of the levels before them, as levels may have lost some kinds of failure.
    """
    failures = scouted.failures
    centres, left, used = failures[:0], failures, 0
    starts = [distinct_directions(points, MOST_STARTS) for points in (failures, *reversed(scouted.on_the_way))]
    for _ in range(MOST_ROUNDS):
        able = int((most / 2 - used) / (EXPECTED_STEPS * (2 * failures.shape[1] + 10) + 80))
        if not len(left) or able < 1:
            break
        found = design_points(margin, np.concatenate(starts)[:able])
        used += found.evaluations
        centres = distinct_points(np.concatenate([centres, found.points]))
        distances = np.linalg.norm(centres, axis=1)
        beyond = failures @ centres.T / distances > distances - TANGENT_SLACK
        left = failures[~beyond.any(axis=1)]
        starts = [distinct_directions(left, MOST_STARTS)]
    return centres, left, used


@dataclass(eq=False)
class _Drawn:
    """Failures among the variants drawn so far by importance sampling, with their weights."""

    count: int = 0
    points: list[FloatArray] = field(default_factory=list)
    weights: list[FloatArray] = field(default_factory=list)
    nearness: list[FloatArray] = field(default_factory=list)

    def add(self, margin: OfPoints, mixture: Mixture, points: FloatArray) -> None:
        failed = ~(margin(points) > 0)
        weights, nearness = mixture.log_weights(points[failed])
        self.count += len(points)
        self.points.append(points[failed])
        self.weights.append(np.exp(weights))
        self.nearness.append(nearness)

    @property
    def sums(self) -> tuple[float, float]:
        weights = np.concatenate(self.weights)
        return float(weights.sum()), float((weights**2).sum())

    @property
    def variation(self) -> float:
        """Standard error of the failure probability as a share of the probability."""
        total, squares = self.sums
        if total == 0:
            return float("inf")
        mean = total / self.count
        return float(np.sqrt(max(squares / self.count - mean**2, 0) / (self.count - 1)) / mean)

    @property
    def missed(self) -> float:
        """Share of the weight of all failures drawn that lie away from all design points."""
        weights, nearness = np.concatenate(self.weights), np.concatenate(self.nearness)
        return float(weights[nearness < 0].sum() / weights.sum())

    def result(self, confidence: float, used: int, n_points: int, known: tuple[str, ...]) -> RareEvent:
        from scipy.special import ndtri

        total, squares = self.sums
        weights = np.concatenate(self.weights)
        doubts = list(known)
        if not total:
            doubts.append("no failure was met")
        elif (effective := total**2 / squares) < FEWEST_EFFECTIVE:
            doubts.append(f"the result rests on as few as {effective:.0f} effective variants")
        if total and weights.max() > HEAVIEST * total:
            doubts.append(f"one variant carries {100 * weights.max() / total:.0f} % of it")
        if n_points and total and self.missed > MOST_MISSED:
            doubts.append(f"failures away from the {n_points} design points matter")
        probability, variation = total / self.count, self.variation
        low, high = lognormal_interval(probability, variation, float(ndtri((1 + confidence) / 2)))
        return RareEvent(probability, low, high, variation, self.count + used, tuple(doubts), "importance")


def _drawn(margin: OfPoints, mixture: Mixture, numbers: np.random.Generator, count: int, accuracy: float) -> _Drawn:
    drawn = _Drawn()
    while drawn.count < count:
        drawn.add(margin, mixture, mixture.draw(numbers, min(BATCH, count - drawn.count)))
        if drawn.variation < accuracy:
            break
    return drawn
