"""Search of design points, the points of the limit state nearest to the median variant (first-order reliability)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer_case import OfPoints

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

    @property
    def distances(self) -> FloatArray:
        """Reliability indices (m,), the distances of the design points from the origin in standard deviations."""
        return np.asarray(np.linalg.norm(self.points, axis=1))


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
        moving = moving[np.linalg.norm(points[moving] - here, axis=1) >= SLOPE_STEP]
        if not len(moving):
            break
    on_it, used = _on_the_limit(margin, points)
    return DesignPoints(distinct_points(on_it), count + used)


def values_and_slopes(margin: OfPoints, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Safety margins (m,) at points (m, d) in standard normal space, and their slopes (m, d) by central differences."""
    m, d = points.shape
    offsets = SLOPE_STEP * np.concatenate([np.zeros((1, d)), np.eye(d), -np.eye(d)])
    values = margin((points[:, None, :] + offsets).reshape(-1, d)).reshape(m, 2 * d + 1)
    slopes = (values[:, 1 : d + 1] - values[:, d + 1 :]) / (2 * SLOPE_STEP)
    return values[:, 0], np.nan_to_num(slopes)


def _towards(points: FloatArray, values: FloatArray, slopes: FloatArray) -> FloatArray:
    """Steps (m, d) of the searches to the nearest points of their linearised limit states, 0 if there is no slope."""
    steep = (slopes**2).sum(axis=1)
    level = ~(steep > 0) | ~np.isfinite(values)
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
    weight = 2 * np.maximum(np.linalg.norm(points, axis=1), 1) / steep + 1e-3
    before = (points**2).sum(axis=1) / 2 + weight * np.abs(values)
    merit = (tried**2).sum(axis=2) / 2 + weight * np.abs(np.where(np.isfinite(reached), reached, np.inf))
    better = merit < before
    chosen = np.where(better.any(axis=0), better.argmax(axis=0), merit.argmin(axis=0))
    return np.asarray(tried[chosen, np.arange(len(points))])


def _on_the_limit(margin: OfPoints, points: FloatArray) -> tuple[FloatArray, int]:
    """Points (k, d) moved along their rays to the limit state, if their rays fail at all, and variants used."""
    rays = margin((RAY[:, None, None] * points).reshape(-1, points.shape[1])).reshape(len(RAY), len(points))
    failed = ~(rays > 0)
    first = failed.argmax(axis=0)
    high = RAY[first]
    low = np.append(0.0, RAY)[first]
    for _ in range(20):
        middle = (low + high) / 2
        lost = ~(margin(middle[:, None] * points) > 0)
        low, high = np.where(lost, low, middle), np.where(lost, middle, high)
    found = (high[:, None] * points)[failed.any(axis=0)]
    return found[np.linalg.norm(found, axis=1) <= FARTHEST], (len(RAY) + 20) * len(points)


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
