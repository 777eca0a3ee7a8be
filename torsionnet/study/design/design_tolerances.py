"""Tolerances of the parameters of a design, and random draws from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray

LAWS = ("normal", "uniform")
"""Names of the distributions that a design tolerance can have."""
LEAST_TAIL = 1e-12
"""Smallest share of a distribution below or above a draw, since the tails of a normal one never end."""


@dataclass(frozen=True)
class DesignTolerance:
    """Tolerance of one parameter of a design, by its size and distribution.

    ``size`` is a standard deviation (``normal``) or half a width (``uniform``), of the design's value where
    ``relative``, else SI. ``centre`` is the value of a parameter that is not designed, SI.
    """

    name: str
    size: float
    law: str = "normal"
    relative: bool = True
    centre: float | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.size) and self.size >= 0):
            raise UsageError(f"the tolerance of {self.name} is a number from 0, got {self.size:g}")
        if self.law not in LAWS:
            raise UsageError(f"the tolerance of {self.name} is normal or uniform, got {self.law!r}")

    def scatter(self, centre: FloatArray, shares: FloatArray) -> FloatArray:
        """Values (n, count) in SI around centres (n,) at shares (count,) of the tolerance's distribution."""
        units = scipy.special.ndtri(shares) if self.law == "normal" else 2 * shares - 1
        width = centre[:, None] if self.relative else np.ones_like(centre)[:, None]
        return np.asarray(centre[:, None] + self.size * width * units)


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


@dataclass(frozen=True, eq=False)
class IndependentDraws:
    """Draws of independent tolerances of a design's parameters.

    Examples
    --------
    >>> around = IndependentDraws((DesignTolerance("k", 0.1, law="uniform"),), np.array([[0.5], [1.0]]))
    >>> around.around({"k": np.array([10.0, 20.0])})["k"].tolist()
    [10.0, 11.0, 20.0, 22.0]
    """

    each: tuple[DesignTolerance, ...]
    shares: FloatArray
    """Shares (count, n_tolerances), between 0 and 1, of the distributions below each draw."""

    @property
    def count(self) -> int:
        """Number of samples drawn around each design."""
        return len(self.shares)

    def around(self, designs: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n * count,) in SI of each parameter, by name, around n designs, the first design's samples first."""
        size = len(next(iter(designs.values())))
        found = {name: np.repeat(values, self.count) for name, values in designs.items()}
        for one, shares in zip(self.each, self.shares.T, strict=True):
            centre = designs[one.name] if one.name in designs else np.full(size, _centre(one))
            found[one.name] = one.scatter(centre, shares).ravel()
        return found


def _centre(one: DesignTolerance) -> float:
    if one.centre is None:
        raise UsageError(f"{one.name} is not designed: say around which value it lies")
    return one.centre


@dataclass(frozen=True)
class DesignTolerances:
    """Tolerances of several parameters of a design, independent of each other."""

    each: tuple[DesignTolerance, ...]

    def __post_init__(self) -> None:
        if not self.each:
            raise UsageError("a robust design needs the tolerance of at least one parameter")

    def even_draws(self, count: int, seed: int) -> IndependentDraws:
        """Quasi-random draws of the tolerances by a scrambled Sobol sequence.

        ``count`` is rounded up to a power of two.
        """
        return IndependentDraws(self.each, even_shares(len(self.each), count, seed))

    def random_draws(self, count: int, seed: int) -> IndependentDraws:
        """Independent random draws of the tolerances."""
        return IndependentDraws(self.each, random_shares(len(self.each), count, seed))


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
        raise UsageError(f"a robust design needs two samples or more of the tolerances, got {count}")
