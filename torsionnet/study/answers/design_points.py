"""Points of the limit state nearest to the median variant: where failures are most likely (FORM)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.answer_case import OfPoints

STEP = 1e-3
"""Of numerical slopes, in standard deviations."""
ITERATIONS = 25
FARTHEST = 12.0
"""Distance beyond which nothing is sought; what lies there has a probability below 1e-32."""
SHORTER = 0.5 ** np.arange(8)
ALIKE = 0.9
"""Cosine between the directions of two starts above which one is enough."""
SAME_PLACE = 0.3
"""Distance between two design points below which they are one."""
RAY = np.unique(
    np.concatenate([np.linspace(0, 1.5, 61)[1:], *(1 + sign * 10.0 ** np.arange(-5, -1) for sign in (-1, 1))])
)
"""Shares of the way to where a search ended, at which failures are looked for: all along it, and close to its end,
where a region of failures that is thinner than the steps along the way begins."""
REACH = 3.0
"""Of a distance beyond the nearest: points that lie farther add hardly anything."""


@dataclass(frozen=True, eq=False)
class DesignPoints:
    """Points (m, d), nearest first, and how many variants finding them took."""

    points: FloatArray
    evaluations: int

    @property
    def distances(self) -> FloatArray:
        """Reliability indices (m,)."""
        return np.asarray(np.linalg.norm(self.points, axis=1))


def design_points(margin: OfPoints, starts: FloatArray) -> DesignPoints:
    """Where the searches of Hasofer, Lind, Rackwitz and Fiessler end that begin at ``starts`` (m, d), each but once.

    ``margin`` (n,) of points (n, d) in standard normal space is lost where it is not above 0.
    All searches go side by side: slopes by central differences, then eight lengths of the step at once, of which the
    longest that lessens the merit function of Zhang and Der Kiureghian is taken.
    """
    count = 0
    points = np.array(starts, dtype=float)
    moving = np.arange(len(points))
    for _ in range(ITERATIONS):
        here = points[moving]
        values, slopes = values_and_slopes(margin, here)
        count += len(here) * (2 * here.shape[1] + 1 + len(SHORTER))
        points[moving] = _shortened(margin, here, values, slopes, _towards(here, values, slopes))
        moving = moving[np.linalg.norm(points[moving] - here, axis=1) >= STEP]
        if not len(moving):
            break
    on_it, used = _on_the_limit(margin, points)
    return DesignPoints(points_apart(on_it), count + used)


def values_and_slopes(margin: OfPoints, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Margins (m,) and their slopes (m, d)."""
    m, d = points.shape
    offsets = STEP * np.concatenate([np.zeros((1, d)), np.eye(d), -np.eye(d)])
    values = margin((points[:, None, :] + offsets).reshape(-1, d)).reshape(m, 2 * d + 1)
    slopes = (values[:, 1 : d + 1] - values[:, d + 1 :]) / (2 * STEP)
    return values[:, 0], np.nan_to_num(slopes)


def _towards(points: FloatArray, values: FloatArray, slopes: FloatArray) -> FloatArray:
    """Step of each search to the nearest point of its linearised limit state; none where there is no slope."""
    steep = (slopes**2).sum(axis=1)
    level = ~(steep > 0) | ~np.isfinite(values)
    lengths = ((slopes * points).sum(axis=1) - values) / np.where(level, 1.0, steep)
    target = np.where(level[:, None], points, lengths[:, None] * slopes)
    far = np.linalg.norm(target, axis=1, keepdims=True)
    return np.asarray(target * np.minimum(1, FARTHEST / np.maximum(far, 1e-300)) - points)


def _shortened(
    margin: OfPoints, points: FloatArray, values: FloatArray, slopes: FloatArray, steps: FloatArray
) -> FloatArray:
    """The longest of eight steps that is better by the merit function, else the best of them."""
    tried = points + SHORTER[:, None, None] * steps
    reached = margin(tried.reshape(-1, points.shape[1])).reshape(tried.shape[:2])
    steep = np.maximum(np.linalg.norm(slopes, axis=1), 1e-300)
    weight = 2 * np.maximum(np.linalg.norm(points, axis=1), 1) / steep + 1e-3
    before = (points**2).sum(axis=1) / 2 + weight * np.abs(values)
    merit = (tried**2).sum(axis=2) / 2 + weight * np.abs(np.where(np.isfinite(reached), reached, np.inf))
    better = merit < before
    chosen = np.where(better.any(axis=0), better.argmax(axis=0), merit.argmin(axis=0))
    return np.asarray(tried[chosen, np.arange(len(points))])


def _on_the_limit(margin: OfPoints, points: FloatArray) -> tuple[FloatArray, int]:
    """Points moved along their rays to where the margin is lost; those whose rays never lose it are left out."""
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


def points_apart(points: FloatArray) -> FloatArray:
    """The nearest point, and others in turn that are not beside one that was taken."""
    order = np.argsort(np.linalg.norm(points, axis=1), kind="stable")
    taken: list[FloatArray] = []
    for point in points[order]:
        if all(np.linalg.norm(point - other) > SAME_PLACE for other in taken):
            taken.append(point)
    kept = [point for point in taken if np.linalg.norm(point) <= np.linalg.norm(taken[0]) + REACH]
    return np.array(kept).reshape(-1, points.shape[1])


def in_own_directions(points: FloatArray, most: int) -> FloatArray:
    """The nearest of some points, and others in turn whose directions differ from those taken."""
    away = np.linalg.norm(points, axis=1)
    taken: list[int] = []
    for index in np.argsort(away, kind="stable").tolist():
        if all(points[index] @ points[other] < ALIKE * away[index] * away[other] for other in taken):
            taken.append(index)
        if len(taken) == most:
            break
    return points[taken]
