"""Subset simulation, the probability of a rare failure as a product of larger conditional ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import OfPoints

# Small probability of a failure with its confidence interval and the reasons that make it uncertain.


@dataclass(frozen=True)
class RareEvent:
    """Probability of a failure with its confidence interval, its error and the number of variants calculated.

    Attributes
    ----------
    probability, low, high : float
        Probability and ends of its interval; NaN where nothing failed.
    variation : float
        Standard error over the probability.
    evaluations : int
        Variants calculated.
    doubts : tuple of str
        Reasons why the probability is uncertain; empty where there are none.
    method : {"importance", "subset"}
    """

    probability: float
    low: float
    high: float
    variation: float
    evaluations: int
    doubts: tuple[str, ...]
    method: str

    @property
    def index(self) -> float:
        """Reliability index beta, with which the failure probability is Phi(-beta), of the normal distribution."""
        from scipy.special import ndtri

        return float(-ndtri(self.probability))

    @property
    def words(self) -> str:
        """Failure probability in words, with its interval and the number of variants."""
        between = f"{self.low:.3g} to {self.high:.3g}; " if np.isfinite(self.low) else ""
        return f"{self.probability:.3g} ({between}{self.evaluations} variants)"


def lognormal_interval(probability: float, variation: float, quantile: float) -> tuple[float, float]:
    """Ends of the confidence interval of a small probability whose logarithm is normally distributed."""
    if not probability or not np.isfinite(variation):
        return float("nan"), float("nan")
    factor = float(np.exp(quantile * np.sqrt(np.log1p(variation**2))))
    return probability / factor, min(1.0, probability * factor)


LEVEL_PROBABILITY = 0.1
"""Share of a level's variants that begin the Markov chains of the next, the usual choice of subset simulation."""
CHAIN_LENGTH = 10
"""Variants in a Markov chain, the inverse of the share that begins chains, so that levels have equal size."""
MOST_LEVELS = 30
"""Most levels of subset simulation, for probabilities down to 1e-30, so that it ends if the margin stops falling."""
FIRST_SPREAD = 0.6
"""Spread of the moves of the first Markov chains in standard deviations, which is adapted afterwards."""
ACCEPTANCE = 0.44
"""Share of a Markov chain's moves that should be accepted (Papaioannou and others, 2015)."""


@dataclass(frozen=True, eq=False)
class SubsetLevels:
    """Levels of subset simulation and the failures found by its first run.

    Attributes
    ----------
    bounds, spreads : tuple of float
        Upper margin of each subset, and spread of the moves in it; the last bound is 0 where failures were found.
    failures : (m, d) array
        Points that failed, distributed approximately as failures are.
    on_the_way : tuple of arrays
        Points (m, d) with which each further subset began.
    probability : float
        Rough estimate of the failure probability.
    evaluations : int
    """

    bounds: tuple[float, ...]
    spreads: tuple[float, ...]
    failures: FloatArray
    on_the_way: tuple[FloatArray, ...]
    probability: float
    evaluations: int


def subset_levels(margin: OfPoints, count: int, d: int, numbers: np.random.Generator) -> SubsetLevels:
    """Run subset simulation once, with levels such that a tenth of the ``count`` variants of each is in the next."""
    points = numbers.standard_normal((1, count, d))
    values = margins_of(margin, points)
    bounds: list[float] = []
    spreads: list[float] = []
    on_the_way: list[FloatArray] = []
    used, spread = count, FIRST_SPREAD
    while len(bounds) < MOST_LEVELS:
        # The bound of the next level is the 10 % quantile of the margins, and 0 at the last.
        order = np.argsort(values[0], kind="stable")[: round(LEVEL_PROBABILITY * count)]
        bound = max(0.0, float(values[0, order[-1]]))
        # Margins that are all alike have no lower level.
        if bound > 0 and values.max() <= bound:
            break
        bounds.append(bound)
        spreads.append(spread)
        if bound == 0:
            break
        on_the_way.append(points[0, order])
        chains = Chains(margin, points[:, order], values[:, order], bound, numbers)
        points, values = chains.walk(spread, adapt=True)
        spreads[-1] = spread = chains.spread
        used += count - len(order)
    failed = values[0] <= 0
    # p = 0.1^(levels - 1) times the share of failures in the last level.
    probability = LEVEL_PROBABILITY ** (len(bounds) - 1) * float(failed.mean()) if bounds else 0.0
    return SubsetLevels(tuple(bounds), tuple(spreads), points[0][failed], tuple(on_the_way), probability, used)


def margins_of(margin: OfPoints, points: FloatArray) -> FloatArray:
    """Safety margins (...) of points (..., d), minus infinity, which is a failure, where the margin has no value."""
    values = margin(points.reshape(-1, points.shape[-1])).reshape(points.shape[:-1])
    return np.where(np.isnan(values), -np.inf, values)


@dataclass(eq=False)
class Chains:
    """Markov chains from points (runs, chains, d) with margins (runs, chains), which stay within ``bound``."""

    margin: OfPoints
    points: FloatArray
    values: FloatArray
    bound: float
    numbers: np.random.Generator
    spread: float = FIRST_SPREAD

    def walk(self, spread: float, *, adapt: bool = False) -> tuple[FloatArray, FloatArray]:
        """Points (runs, variants, d) of all chains, their first ones included, and their margins (runs, variants)."""
        points, values, self.spread = self.points, self.values, spread
        all_points, all_values = [points], [values]
        for _ in range(CHAIN_LENGTH - 1):
            moves = self.numbers.standard_normal(points.shape)
            # Conditional sampling: u' = sqrt(1 - s^2) u + s xi is standard normal as u is.
            tried = np.sqrt(1 - self.spread**2) * points + self.spread * moves
            reached = margins_of(self.margin, tried)
            inside = reached <= self.bound
            points = np.where(inside[:, :, None], tried, points)
            values = np.where(inside, reached, values)
            all_points.append(points)
            all_values.append(values)
            if adapt:
                # Larger moves where more than the wanted share is accepted, smaller ones where less.
                self.spread = float(np.clip(self.spread * np.exp(inside.mean() - ACCEPTANCE), 0.02, 0.999))
        return np.concatenate(all_points, axis=1), np.concatenate(all_values, axis=1)


INDEPENDENT_RUNS = 20
"""Number of independent runs of subset simulation, whose scatter gives the error, uncertain if there were fewer."""
FEWEST_VARIANTS_OF_LEVEL = 200
"""Fewest variants in a level of a run, as with fewer less than 20 Markov chains begin in it."""


def subset_sampling(
    margin: OfPoints, n_parameters: int, *, count: int, seed: int, confidence: float = 0.95
) -> RareEvent:
    """Estimate the probability of failure (``margin`` not above 0) under independent standard normal parameters.

    A first run finds the levels and how far chains move, by conditional sampling (Papaioannou, Betz, Zwirglmaier and
    Straub, Probabilistic Engineering Mechanics 41, 2015). Then 20 independent runs go side by side through the levels,
    which are fixed now, so that each estimate is unbiased. Variants of a chain depend on each other and on the level
    before, and formulas for the error that neglect that promise too much; the interval here rests on the scatter of the
    runs alone.

    Parameters
    ----------
    margin : callable
        Points (n, d) -> safety margins (n,); failure where not above 0.
    n_parameters : int
    count : int
        Variants in each level of each of the 20 runs, a multiple of 10.
    seed : int
    confidence : float
    """
    if count < FEWEST_VARIANTS_OF_LEVEL or count % CHAIN_LENGTH:
        text = (
            f"the variants of a level are a multiple of {CHAIN_LENGTH}, {FEWEST_VARIANTS_OF_LEVEL} or more; got {count}"
        )
        raise UsageError(text, kind="out-of-range")
    numbers = np.random.default_rng(seed)
    levels = subset_levels(margin, 2 * count, n_parameters, numbers)
    probabilities, used = _runs(margin, levels, (INDEPENDENT_RUNS, count, n_parameters), numbers)
    probability = float(probabilities.mean())
    doubts = [] if 0 in levels.bounds else ["the margin stops falling before it is lost"]
    if (empty := int((probabilities == 0).sum())) and not doubts:
        doubts.append(f"{empty} of {INDEPENDENT_RUNS} runs met no failure; take more variants")
    low, high = _interval(probabilities, confidence) if not empty else (np.nan, np.nan)
    error = float(probabilities.std(ddof=1) / np.sqrt(INDEPENDENT_RUNS))
    variation = error / probability if probability else float("inf")
    return RareEvent(probability, low, high, variation, levels.evaluations + used, tuple(doubts), "subset")


def _interval(probabilities: FloatArray, confidence: float) -> tuple[float, float]:
    """Confidence interval of the mean of runs whose logarithms are about normal, Cox's, with Student's factor."""
    from scipy.special import stdtrit

    logarithms = np.log(probabilities)
    scatter = logarithms.var(ddof=1)
    # Cox: a lognormal variable has the mean exp(m + s^2/2), and this exponent the variance s^2/n + s^4/(2 (n - 1)).
    middle = logarithms.mean() + scatter / 2
    half = stdtrit(INDEPENDENT_RUNS - 1, (1 + confidence) / 2) * np.sqrt(
        scatter / INDEPENDENT_RUNS + scatter**2 / (2 * (INDEPENDENT_RUNS - 1))
    )
    return float(np.exp(middle - half)), min(1.0, float(np.exp(middle + half)))


def _runs(
    margin: OfPoints, levels: SubsetLevels, shape: tuple[int, int, int], numbers: np.random.Generator
) -> tuple[FloatArray, int]:
    """Failure probability (n_runs,) that each independent run estimates, and the number of variants calculated."""
    points = numbers.standard_normal(shape)
    values = margins_of(margin, points)
    probabilities, used, kept = np.ones(len(points)), values.size, shape[1] // CHAIN_LENGTH
    for bound, spread in zip(levels.bounds, levels.spreads, strict=True):
        inside = values <= bound
        # Each run multiplies its own shares of the levels.
        probabilities *= inside.mean(axis=1)
        if bound == 0 or not probabilities.any():
            return probabilities, used
        chosen = np.array([_begun(row, kept, numbers) for row in inside])
        points = np.take_along_axis(points, chosen[:, :, None], axis=1)
        chains = Chains(margin, points, np.take_along_axis(values, chosen, axis=1), bound, numbers)
        points, values = chains.walk(spread)
        used += values.size - chosen.size
    return np.zeros(len(points)), used


def _begun(inside: NDArray[np.bool_], count: int, numbers: np.random.Generator) -> NDArray[np.intp]:
    """Indices (count,) of the variants from which chains begin, each drawn about as often as another."""
    able = np.flatnonzero(inside)
    return np.resize(numbers.permutation(able), count) if len(able) else np.zeros(count, dtype=np.intp)


# Share of random draws with the confidence interval of Clopper and Pearson.


@dataclass(frozen=True)
class Share:
    """Share of draws between 0 and 1 with its confidence interval, and the number of draws counted."""

    value: float
    low: float
    high: float
    count: int

    @property
    def percent(self) -> str:
        """Text of the share in percent with its interval, with as many digits as the interval's width allows.

        >>> counted_share(31, 1000).percent
        '3.1 % (2.1 to 4.4 %)'
        """
        width = max(self.high - self.value, self.value - self.low) * 100
        decimals = next((digits for digits in range(9) if 2 * 10.0**-digits <= width), 9)
        value, low, high = (f"{100 * number:.{decimals}f}" for number in (self.value, self.low, self.high))
        return f"{value} % ({low} to {high} %)"


def counted_share(hits: float, count: int, confidence: float = 0.95) -> Share:
    """Share from 0 to 1 of independent draws that are hits, with the confidence interval of Clopper and Pearson.

    The interval contains the true share at least as often as ``confidence`` says, also where nothing was hit. Draws of
    a Latin hypercube or a Sobol sequence spread more evenly, which makes it wider than needed.

    Parameters
    ----------
    hits : float
        Sum over the draws of 1 for a hit and 0 otherwise; a mean over several conditions of a draw lies
        between, and varies less than a count of the same mean, so that the interval is on the safe side.
    count : int
        Number of draws.
    confidence : float

    Examples
    --------
    >>> none = counted_share(0, 100)
    >>> round(none.high, 5) == round(1 - 0.025 ** (1 / 100), 5)
    True
    """
    from scipy.special import betaincinv

    if not 0 <= hits <= count or count < 1:
        raise UsageError(
            f"a share needs hits between 0 and the number of draws, got {hits} of {count}", kind="out-of-range"
        )
    tail = (1 - confidence) / 2
    # Clopper and Pearson: quantiles of Beta(h, n - h + 1) and of Beta(h + 1, n - h).
    low = float(betaincinv(hits, count - hits + 1, tail)) if hits else 0.0
    high = float(betaincinv(hits + 1, count - hits, 1 - tail)) if hits < count else 1.0
    return Share(hits / count, low, high, count)
