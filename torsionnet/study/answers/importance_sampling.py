"""Probability of a rare failure from variants drawn around the design points."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.study.answers.answer_case import OfPoints
from torsionnet.study.answers.design_points import design_points, in_own_directions, points_apart
from torsionnet.study.answers.rare_event import RareEvent, between
from torsionnet.study.answers.share_interval import counted_share
from torsionnet.study.answers.subset_sampling import SubsetLevels, subset_levels

WIDE_SHARE = 0.15
"""Of the variants, drawn wide around the median to meet failures away from the design points."""
LEAST_SHARE = 0.05


@dataclass(frozen=True, eq=False)
class Mixture:
    """Normal distributions around centres (m, d), nearest first, and a wide one around the median."""

    centres: FloatArray

    @property
    def spread(self) -> float:
        """Standard deviation of the wide one: as many variants beyond the nearest centre as within."""
        return (
            max(1.0, float(np.linalg.norm(self.centres[0])) / self.centres.shape[1] ** 0.5)
            if len(self.centres)
            else 1.0
        )

    @property
    def shares(self) -> FloatArray:
        """Of every centre and, last, of the wide one."""
        from scipy.special import log_ndtr

        if not len(self.centres):
            return np.ones(1)
        size = log_ndtr(-np.linalg.norm(self.centres, axis=1))
        shares = np.maximum(np.exp(size - size.max()), LEAST_SHARE)
        return np.append((1 - WIDE_SHARE) * shares / shares.sum(), WIDE_SHARE)

    def draw(self, numbers: np.random.Generator, count: int) -> FloatArray:
        which = numbers.choice(len(self.centres) + 1, size=count, p=self.shares)
        points = numbers.standard_normal((count, self.centres.shape[1]))
        wide = which == len(self.centres)
        points[wide] *= self.spread
        return np.asarray(points + np.concatenate([self.centres, np.zeros((1, points.shape[1]))])[which])

    def log_weights(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Of points (n, d): logarithm of their density over that of the mixture, and over that around the centres."""
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


FEWEST = 4000
SCOUTED = 0.02
"""Of all variants, those of each level of the run of subset simulation that looks for failures."""
FEWEST_SCOUTED = 200
STARTS = 10
TOGETHER = 2000
ROUNDS = 6
STEPS = 8
"""Of a search for a design point, as they are expected."""
FEWEST_EFFECTIVE, HEAVIEST = 100, 0.05
MISSED = 0.05
"""Share of the probability that may lie away from all design points."""
SLACK = 0.5
"""By which a failure may lie before the tangent plane of a design point and still belong to it."""
FREQUENT = 0.02
"""A probability from which plain sampling is as good."""


def importance_sampling(
    margin: OfPoints, n_parameters: int, *, count: int, seed: int, accuracy: float = 0.01, confidence: float = 0.95
) -> RareEvent:
    """Probability that ``margin`` is lost under independent standard normal parameters.

    A run of subset simulation meets failures of every kind; from these design points are sought until each failure
    lies beyond one of them. Variants are then drawn from a mixture of normal distributions around the design points and
    a wide one around the median, each with the weight by which it was preferred, until the standard error is the share
    ``accuracy`` of the probability or ``count`` variants were calculated.

    Parameters
    ----------
    margin : callable
        (n,) at points (n, d); failed where it is not above 0.
    n_parameters : int
    count : int
        Most variants, those of the search included.
    seed : int
    accuracy, confidence : float
    """
    if count < FEWEST:
        raise UsageError(f"importance sampling needs {FEWEST} variants or more, got {count}")
    numbers = np.random.default_rng(seed)
    size = max(FEWEST_SCOUTED, 10 * round(SCOUTED * count / 10))
    scouted = subset_levels(margin, size, n_parameters, numbers)
    if scouted.probability > FREQUENT:
        plain = _drawn(margin, Mixture(scouted.failures[:0]), numbers, count - scouted.evaluations, accuracy)
        share = counted_share(sum(map(len, plain.points)), plain.count, confidence)
        used = plain.count + scouted.evaluations
        return RareEvent(share.value, share.low, share.high, plain.variation, used, (), "importance")
    centres, left, used = _centres(margin, scouted, count - scouted.evaluations)
    used += scouted.evaluations
    drawn = _drawn(margin, Mixture(centres), numbers, max(TOGETHER, count - used), accuracy)
    doubts = []
    if len(left) > MISSED * len(scouted.failures):
        percent = 100 * len(left) / len(scouted.failures)
        doubts.append(f"{percent:.0f} % of the failures lie beyond none of the {len(centres)} design points")
    found = drawn.told(confidence, used, len(centres), tuple(doubts))
    factor = 1 + 100 / size**0.5
    if found.probability and not 1 / factor < scouted.probability / found.probability < factor:
        text = f"the run before it came to {scouted.probability:.2g}"
        return replace(found, doubts=(*found.doubts, text))
    return found


def _centres(margin: OfPoints, scouted: SubsetLevels, most: int) -> tuple[FloatArray, FloatArray, int]:
    """Design points beyond which failures lie, the failures (m, d) that are left, and the variants that they took.

    Searches begin at failures, and at points on the way to them: some kinds of failure may have been lost there.
    """
    failures = scouted.failures
    centres, left, used = failures[:0], failures, 0
    starts = [in_own_directions(points, STARTS) for points in (failures, *reversed(scouted.on_the_way))]
    for _ in range(ROUNDS):
        able = int((most / 2 - used) / (STEPS * (2 * failures.shape[1] + 10) + 80))
        if not len(left) or able < 1:
            break
        found = design_points(margin, np.concatenate(starts)[:able])
        used += found.evaluations
        centres = points_apart(np.concatenate([centres, found.points]))
        distances = np.linalg.norm(centres, axis=1)
        beyond = failures @ centres.T / distances > distances - SLACK
        left = failures[~beyond.any(axis=1)]
        starts = [in_own_directions(left, STARTS)]
    return centres, left, used


@dataclass(eq=False)
class _Drawn:
    """Sums over what was drawn, and the failures themselves."""

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
        """Standard error over the estimate."""
        total, squares = self.sums
        if total == 0:
            return float("inf")
        mean = total / self.count
        return float(np.sqrt(max(squares / self.count - mean**2, 0) / (self.count - 1)) / mean)

    @property
    def missed(self) -> float:
        """Share of the weight of failures that lie away from all centres."""
        weights, nearness = np.concatenate(self.weights), np.concatenate(self.nearness)
        return float(weights[nearness < 0].sum() / weights.sum())

    def told(self, confidence: float, used: int, n_points: int, known: tuple[str, ...]) -> RareEvent:
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
        if n_points and total and self.missed > MISSED:
            doubts.append(f"failures away from the {n_points} design points matter")
        probability, variation = total / self.count, self.variation
        low, high = between(probability, variation, float(ndtri((1 + confidence) / 2)))
        return RareEvent(probability, low, high, variation, self.count + used, tuple(doubts), "importance")


def _drawn(margin: OfPoints, mixture: Mixture, numbers: np.random.Generator, count: int, accuracy: float) -> _Drawn:
    drawn = _Drawn()
    while drawn.count < count:
        drawn.add(margin, mixture, mixture.draw(numbers, min(TOGETHER, count - drawn.count)))
        if drawn.variation < accuracy:
            break
    return drawn
