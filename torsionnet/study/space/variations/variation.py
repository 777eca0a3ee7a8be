"""Base classes of a parameter's variations, of distributions and of axes with given values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, plain_number, read_scalar
from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec
from torsionnet.base.expressions import Number
from torsionnet.base.registers import TypeRegister
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader


class Marginal:
    """Base class of the distributions of one parameter, with cumulative shares and their inverses.

    Both tails are exact: what is close to the upper end is asked for by the share above it.

    Attributes
    ----------
    low, high : float
        Where the values end; infinite where they tail off.
    """

    low: float
    high: float

    def cdf(self, values: ArrayLike) -> FloatArray:
        """Share of the variants below each of the values in SI (cumulative distribution function)."""
        raise NotImplementedError

    def sf(self, values: ArrayLike) -> FloatArray:
        """Share of the variants above each of the values in SI (survival function)."""
        raise NotImplementedError

    def ppf(self, shares: ArrayLike) -> FloatArray:
        """Values in SI with given shares of the variants below them (inverse of :meth:`cdf`)."""
        raise NotImplementedError

    def isf(self, shares: ArrayLike) -> FloatArray:
        """Values in SI with given shares of the variants above them (inverse of :meth:`sf`)."""
        raise NotImplementedError

    def log_density(self, values: ArrayLike) -> FloatArray:
        """Logarithm of the probability density at values in SI; minus infinity where no value is possible."""
        raise NotImplementedError

    def from_normal(self, normal: ArrayLike) -> FloatArray:
        """Parameter values in SI at the same shares as values of a standard normal variable."""
        u = np.asarray(normal, dtype=float)
        from scipy.special import ndtr

        tail = ndtr(-np.abs(u))
        return np.where(u < 0, self.ppf(tail), self.isf(tail))

    def to_normal(self, values: ArrayLike) -> FloatArray:
        """Values of a standard normal variable at the same shares as parameter values in SI."""
        below, above = self.cdf(values), self.sf(values)
        from scipy.special import ndtri

        return np.asarray(np.where(below < above, ndtri(below), -ndtri(above)))


Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class GridAxis:
    """Axis of the grid of variants, which gives values of a parameter by index, calculated when needed.

    Attributes
    ----------
    count : int
    at : callable
        Indices (n,) -> values (n,) in SI.
    low, high : float
        Lowest and highest value.
    """

    count: int
    at: Callable[[Indices], FloatArray]
    low: float
    high: float

    @property
    def values(self) -> FloatArray:
        """All values (count,) of the axis in SI."""
        return self.at(np.arange(self.count))


MIDDLE, SPREAD, LOWEST_VALUE, HIGHEST_VALUE = "mean", "standard deviation", "lowest", "highest"
MOST_FREQUENT = "most frequent"
"""Keys of the mean, spread, bounds and most frequent value of a variation in :meth:`Variation.sizes`."""

V = TypeVar("V", bound="type[Variation]")


class ParameterValue(Spec[Number]):
    """Entry for a value of a parameter, with unit, in SI, or in percent of the value in the model."""

    def coerce(self, raw: object) -> Number:
        value = raw if isinstance(raw, Number) else read_scalar(raw)
        if not isinstance(value, Number):
            raise EntryError(f'expected a number with unit or in percent; "{value}" is an expression of parameters')
        return value

    def plain(self, value: Any) -> Json:
        return plain_number(value.value) if value.text is None else value.text

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [unit of the parameter, or %]"}


@dataclass(frozen=True, kw_only=True)
class Variation(Declared):
    """Base class of a parameter's variations, one subclass for each ``type`` (:func:`register_variation`)."""

    article: ClassVar[str] = "a variation"
    is_random: ClassVar[bool] = True
    """Whether the variation is a distribution that values are drawn from."""

    @property
    def words(self) -> str:
        """Words for the variation in reports, such as "normal, truncated"."""
        return self.kind

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        """Numbers of the variation in SI by name (:data:`MIDDLE`, ...), where its entries have no faults."""
        raise NotImplementedError

    def bound(self, reader: NominalReader) -> Marginal | GridAxis | None:
        """Distribution or axis of the parameter's values in SI, None where the reader found faults."""
        raise NotImplementedError


VARIATIONS: TypeRegister[type[Variation]] = TypeRegister(
    "torsionnet.study.space.variations",
    {"list_of_values": ("list",), "range_of_values": ("range",), "triangle": ("triangular",)},
)
"""Classes of variations by the word that a study file writes as their ``type``."""


def register_variation(cls: V) -> V:
    """Class decorator that registers a class of variations by its ``kind``, the ``type`` in a study file."""
    VARIATIONS[cls.kind] = cls
    return cls
