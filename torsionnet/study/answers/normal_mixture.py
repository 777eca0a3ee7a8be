"""The distribution that importance sampling draws from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray

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
