"""Probability of a rare failure as a product of larger ones, each sampled within the subset of the one before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.study.answers.point_functions import OfPoints
from torsionnet.study.answers.rare_event import RareEvent
from torsionnet.study.answers.subset_levels import LENGTH, Chains, SubsetLevels, margins_of, subset_levels

RUNS = 20
"""Independent repetitions, whose scatter is the error."""
FEWEST = 200


def subset_sampling(
    margin: OfPoints, n_parameters: int, *, count: int, seed: int, confidence: float = 0.95
) -> RareEvent:
    """Probability that ``margin`` is lost under independent standard normal parameters, by subset simulation.

    A first run finds the levels and how far chains move, by conditional sampling (Papaioannou, Betz, Zwirglmaier and
    Straub, Probabilistic Engineering Mechanics 41, 2015). Then 20 independent runs go side by side through the levels,
    which are fixed now, so that each estimate is unbiased. Variants of a chain depend on each other and on the level
    before, and formulas for the error that neglect that promise too much; the interval here rests on the scatter of the
    runs alone.

    Parameters
    ----------
    margin : callable
        (n,) at points (n, d); failed where it is not above 0.
    n_parameters : int
    count : int
        Variants in each level of each of the 20 runs, a multiple of 10.
    seed : int
    confidence : float
    """
    if count < FEWEST or count % LENGTH:
        raise UsageError(f"the variants of a level are a multiple of {LENGTH}, {FEWEST} or more; got {count}")
    numbers = np.random.default_rng(seed)
    levels = subset_levels(margin, 2 * count, n_parameters, numbers)
    found, used = _runs(margin, levels, (RUNS, count, n_parameters), numbers)
    probability = float(found.mean())
    doubts = [] if 0 in levels.bounds else ["the margin stops falling before it is lost"]
    if (empty := int((found == 0).sum())) and not doubts:
        doubts.append(f"{empty} of {RUNS} runs met no failure; take more variants")
    low, high = _interval(found, confidence) if not empty else (np.nan, np.nan)
    variation = float(found.std(ddof=1) / np.sqrt(RUNS) / probability) if probability else float("inf")
    return RareEvent(probability, low, high, variation, levels.evaluations + used, tuple(doubts), "subset")


def _interval(found: FloatArray, confidence: float) -> tuple[float, float]:
    """Of the mean of runs whose logarithms are about normal, as those of products are: Cox's, with Student's factor."""
    from scipy.special import stdtrit

    logarithms = np.log(found)
    scatter = logarithms.var(ddof=1)
    middle = logarithms.mean() + scatter / 2
    half = stdtrit(RUNS - 1, (1 + confidence) / 2) * np.sqrt(scatter / RUNS + scatter**2 / (2 * (RUNS - 1)))
    return float(np.exp(middle - half)), min(1.0, float(np.exp(middle + half)))


def _runs(
    margin: OfPoints, levels: SubsetLevels, shape: tuple[int, int, int], numbers: np.random.Generator
) -> tuple[FloatArray, int]:
    """The estimate of every run, and the variants calculated."""
    points = numbers.standard_normal(shape)
    values = margins_of(margin, points)
    found, used, kept = np.ones(len(points)), values.size, shape[1] // LENGTH
    for bound, spread in zip(levels.bounds, levels.spreads, strict=True):
        inside = values <= bound
        found *= inside.mean(axis=1)
        if bound == 0 or not found.any():
            return found, used
        chosen = np.array([_begun(row, kept, numbers) for row in inside])
        points = np.take_along_axis(points, chosen[:, :, None], axis=1)
        chains = Chains(margin, points, np.take_along_axis(values, chosen, axis=1), bound, numbers)
        points, values = chains.walked(spread)
        used += values.size - chosen.size
    return np.zeros(len(points)), used


def _begun(inside: NDArray[np.bool_], count: int, numbers: np.random.Generator) -> NDArray[np.intp]:
    """Indices of the variants from which chains begin, each as likely and about as often as another."""
    able = np.flatnonzero(inside)
    return np.resize(numbers.permutation(able), count) if len(able) else np.zeros(count, dtype=np.intp)
