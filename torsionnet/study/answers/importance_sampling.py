"""Importance sampling, the probability of a rare failure from variants drawn around the design points."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import OfPoints
from torsionnet.study.answers.subset_sampling import (
    RareEvent,
    SubsetLevels,
    counted_share,
    lognormal_interval,
    subset_levels,
)

# Search of design points, the points of the limit state nearest to the median variant (first-order reliability).

SLOPE_STEP = 1e-3
"""Step of slopes in standard deviations, as larger ones miss curvature, and smaller ones amplify rounding."""
MOST_ITERATIONS = 25
"""Most steps of a search for a design point, as more take variants from the sampling."""
FARTHEST = 12.0
"""Largest distance of a design point in standard deviations, as failures beyond have a probability below 1e-32."""
STEP_SHARES = 0.5 ** np.arange(8)
"""Shares of a step tried together, down to 1/128, without which searches of a curved limit state may diverge."""
SAME_DIRECTION = 0.9
"""Cosine between the directions of two starts of searches above which one is left out, as both lead to one point."""
SAME_PLACE = 0.3
"""Distance between two design points in standard deviations below which they count as one, and one is left out."""
RAY = np.unique(
    np.concatenate([np.linspace(0, 1.5, 61)[1:], *(1 + sign * 10.0 ** np.arange(-5, -1) for sign in (-1, 1))])
)
"""Shares of the distance from the median to the end of a search at which failures are looked for.

All along the ray, and close to the end, where a region of failures thinner than the steps along the ray begins.
"""
FARTHER_THAN_NEAREST = 3.0
"""Standard deviations beyond the nearest design point up to which others count, as farther ones add hardly anything."""


@dataclass(frozen=True, eq=False)
class DesignPoints:
    """Design points (m, d) in standard normal space, nearest first, and the number of variants their search took."""

    points: FloatArray
    evaluations: int


def design_points(margin: OfPoints, starts: FloatArray) -> DesignPoints:
    """Search design points by the method of Hasofer, Lind, Rackwitz and Fiessler from ``starts`` (m, d).

    ``margin`` gives safety margins (n,) at points (n, d) in standard normal space; failure where not above 0. All
    searches go side by side: slopes by central differences, then eight lengths of the step at once, of which the
    longest that lessens the merit function of Zhang and Der Kiureghian is taken.
    """
    count = 0
    points = np.array(starts, dtype=float)
    moving = np.arange(len(points))
    for _ in range(MOST_ITERATIONS):
        here = points[moving]
        values, slopes = values_and_slopes(margin, here)
        count += len(here) * (2 * here.shape[1] + 1 + len(STEP_SHARES))
        points[moving] = _shortened(margin, here, values, slopes, _towards(here, values, slopes))
        # A search that moves by less than the step of its slopes has arrived.
        moving = moving[np.linalg.norm(points[moving] - here, axis=1) >= SLOPE_STEP]
        if not len(moving):
            break
    # A search may end beside the limit state; on the ray from the median through its point it is met exactly.
    on_it, used = _on_the_limit(margin, points)
    return DesignPoints(distinct_points(on_it), count + used)


def values_and_slopes(margin: OfPoints, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Safety margins (m,) at points (m, d) in standard normal space, and their slopes (m, d) by central differences."""
    m, d = points.shape
    # The point itself, and a step each way along every axis.
    offsets = SLOPE_STEP * np.concatenate([np.zeros((1, d)), np.eye(d), -np.eye(d)])
    values = margin((points[:, None, :] + offsets).reshape(-1, d)).reshape(m, 2 * d + 1)
    slopes = (values[:, 1 : d + 1] - values[:, d + 1 :]) / (2 * SLOPE_STEP)
    return values[:, 0], np.nan_to_num(slopes)


def _towards(points: FloatArray, values: FloatArray, slopes: FloatArray) -> FloatArray:
    """Steps (m, d) of the searches to the nearest points of their linearised limit states, 0 if there is no slope."""
    steep = (slopes**2).sum(axis=1)
    level = ~(steep > 0) | ~np.isfinite(values)
    # Hasofer, Lind, Rackwitz, Fiessler: u' = (g'.u - g) g'/|g'|^2 is the nearest zero of the linearised margin.
    lengths = ((slopes * points).sum(axis=1) - values) / np.where(level, 1.0, steep)
    target = np.where(level[:, None], points, lengths[:, None] * slopes)
    far = np.linalg.norm(target, axis=1, keepdims=True)
    return np.asarray(target * np.minimum(1, FARTHEST / np.maximum(far, 1e-300)) - points)


def _shortened(
    margin: OfPoints, points: FloatArray, values: FloatArray, slopes: FloatArray, steps: FloatArray
) -> FloatArray:
    """Points (m, d) after the longest of eight steps that lessens the merit function, else after the best of them."""
    tried = points + STEP_SHARES[:, None, None] * steps
    reached = margin(tried.reshape(-1, points.shape[1])).reshape(tried.shape[:2])
    steep = np.maximum(np.linalg.norm(slopes, axis=1), 1e-300)
    # Merit |u|^2/2 + c |g| of Zhang and Der Kiureghian, with c above |u|/|g'| so that steps go downhill in it.
    weight = 2 * np.maximum(np.linalg.norm(points, axis=1), 1) / steep + 1e-3
    before = (points**2).sum(axis=1) / 2 + weight * np.abs(values)
    merit = (tried**2).sum(axis=2) / 2 + weight * np.abs(np.where(np.isfinite(reached), reached, np.inf))
    better = merit < before
    # The first that is better is the longest, as the shares fall.
    chosen = np.where(better.any(axis=0), better.argmax(axis=0), merit.argmin(axis=0))
    return np.asarray(tried[chosen, np.arange(len(points))])


def _on_the_limit(margin: OfPoints, points: FloatArray) -> tuple[FloatArray, int]:
    """Points (k, d) moved along their rays to the limit state, if their rays fail at all, and variants used."""
    rays = margin((RAY[:, None, None] * points).reshape(-1, points.shape[1])).reshape(len(RAY), len(points))
    failed = ~(rays > 0)
    # The first failure on a ray and the point before it bracket the limit state.
    first = failed.argmax(axis=0)
    high = RAY[first]
    low = np.append(0.0, RAY)[first]
    # 20 halvings leave 1e-6 of the bracket.
    for _ in range(20):
        middle = (low + high) / 2
        lost = ~(margin(middle[:, None] * points) > 0)
        low, high = np.where(lost, low, middle), np.where(lost, middle, high)
    on_limit = (high[:, None] * points)[failed.any(axis=0)]
    return on_limit[np.linalg.norm(on_limit, axis=1) <= FARTHEST], (len(RAY) + 20) * len(points)


def distinct_points(points: FloatArray) -> FloatArray:
    """Points (k, d) that are not beside a nearer one, the nearest of the m points first."""
    order = np.argsort(np.linalg.norm(points, axis=1), kind="stable")
    taken: list[FloatArray] = []
    for point in points[order]:
        if all(np.linalg.norm(point - other) > SAME_PLACE for other in taken):
            taken.append(point)
    kept = [point for point in taken if np.linalg.norm(point) <= np.linalg.norm(taken[0]) + FARTHER_THAN_NEAREST]
    return np.array(kept).reshape(-1, points.shape[1])


def distinct_directions(points: FloatArray, most: int) -> FloatArray:
    """Points (k, d) of m whose directions from the origin differ, the nearest ones first, ``most`` of them at most."""
    away = np.linalg.norm(points, axis=1)
    taken: list[int] = []
    for index in np.argsort(away, kind="stable").tolist():
        if all(points[index] @ points[other] < SAME_DIRECTION * away[index] * away[other] for other in taken):
            taken.append(index)
        if len(taken) == most:
            break
    return points[taken]


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
        # In d dimensions |u|^2 is about d sigma^2: sigma = |c|/sqrt(d) reaches the nearest centre c.
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
        # The half-space beyond a centre has the probability Phi(-|c|), small numbers in logarithms.
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
        # Densities without their common factor (2 pi)^(-d/2).
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
        raise UsageError(
            f"importance sampling needs {FEWEST_VARIANTS} variants or more, got {count}", kind="out-of-range"
        )
    numbers = np.random.default_rng(seed)
    # A multiple of ten, as a tenth of a level begins the next.
    size = max(FEWEST_IN_LEVEL, 10 * round(LEVEL_SHARE * count / 10))
    scouted = subset_levels(margin, size, n_parameters, numbers)
    if scouted.probability > FREQUENT_PROBABILITY:
        # Without centres the mixture is the normal distribution itself, and failures are counted.
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
    event = drawn.result(confidence, used, len(centres), tuple(doubts))
    # Subset simulation of so few variants is rough: only a difference by a factor is a reason for doubt.
    factor = 1 + 100 / size**0.5
    if event.probability and not 1 / factor < scouted.probability / event.probability < factor:
        text = f"the run before it came to {scouted.probability:.2g}"
        return replace(event, doubts=(*event.doubts, text))
    return event


def _centres(margin: OfPoints, scouted: SubsetLevels, most: int) -> tuple[FloatArray, FloatArray, int]:
    """Design points (m, d), failures (k, d) that lie beyond none of them, and number of variants of the search.

    Searches begin at failures, and at points of the levels before them, as levels may have lost some kinds of failure.
    """
    failures = scouted.failures
    centres, left, used = failures[:0], failures, 0
    starts = [distinct_directions(points, MOST_STARTS) for points in (failures, *reversed(scouted.on_the_way))]
    for _ in range(MOST_ROUNDS):
        # Searches take half of the variants at most, with slopes, trial steps and bisection on a ray.
        able = int((most / 2 - used) / (EXPECTED_STEPS * (2 * failures.shape[1] + 10) + 80))
        if not len(left) or able < 1:
            break
        designs = design_points(margin, np.concatenate(starts)[:able])
        used += designs.evaluations
        centres = distinct_points(np.concatenate([centres, designs.points]))
        distances = np.linalg.norm(centres, axis=1)
        # Beyond the plane that touches the limit state at the centre c: u.c/|c| > |c|, less a slack.
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
        # p is the mean of the weights of failures: its variance is (mean w^2 - p^2)/(N - 1).
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
        # (sum w)^2 / sum w^2 variants of equal weight would tell as much.
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
