"""What every variation has: it is written relative to a model, and bound to the values of one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import SCALAR_SCHEMA, plain_number, read_value
from torsionnet.core.entries.spec import EntryError, Json, Schema, Spec
from torsionnet.core.expressions import Number
from torsionnet.core.number_range import is_beyond_range
from torsionnet.core.type_register import TypeRegister
from torsionnet.response.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader


class Marginal:
    """Base of the distributions of one parameter.

    Both tails are exact: what is close to the upper end is asked for by the share above it.

    Attributes
    ----------
    low, high : float
        Where the values end; infinite where they tail off.
    """

    low: float
    high: float

    def cdf(self, values: ArrayLike) -> FloatArray:
        """Share of the variants below."""
        raise NotImplementedError

    def sf(self, values: ArrayLike) -> FloatArray:
        """Share of the variants above."""
        raise NotImplementedError

    def ppf(self, shares: ArrayLike) -> FloatArray:
        """Value with a share of the variants below it."""
        raise NotImplementedError

    def isf(self, shares: ArrayLike) -> FloatArray:
        """Value with a share of the variants above it."""
        raise NotImplementedError

    def log_density(self, values: ArrayLike) -> FloatArray:
        """Logarithm of the probability density; minus infinity where no value is possible."""
        raise NotImplementedError

    def from_normal(self, normal: ArrayLike) -> FloatArray:
        """Values at the same shares as those of a standard normal variable."""
        u = np.asarray(normal, dtype=float)
        from scipy.special import ndtr

        tail = ndtr(-np.abs(u))
        return np.where(u < 0, self.ppf(tail), self.isf(tail))

    def to_normal(self, values: ArrayLike) -> FloatArray:
        """Inverse of :meth:`from_normal`."""
        below, above = self.cdf(values), self.sf(values)
        from scipy.special import ndtri

        return np.asarray(np.where(below < above, ndtri(below), -ndtri(above)))


Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class GridAxis:
    """Values by index, of which only those that are asked for exist.

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
        """All, (count,)."""
        return self.at(np.arange(self.count))


MIDDLE, SPREAD, LOWEST_VALUE, HIGHEST_VALUE = "mean", "standard deviation", "lowest", "highest"
MOST_FREQUENT = "most frequent"
"""Numbers of variations."""

V = TypeVar("V", bound="type[Variation]")


class ParameterValue(Spec[Number]):
    """A value of a parameter: with unit, in SI, or in percent of the value in the model."""

    def coerce(self, raw: object) -> Number:
        value = raw if isinstance(raw, Number) else read_value(raw)
        if not isinstance(value, Number):
            raise EntryError(f'expected a number with unit or in percent; "{value}" is an expression of parameters')
        if is_beyond_range(float(value.value)):
            raise EntryError(f"{float(value.value):g} is no size that anything in a drivetrain has")
        return value

    def plain(self, value: Any) -> Json:
        return plain_number(value.value) if value.text is None else value.text

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [unit of the parameter, or %]"}


@dataclass(frozen=True, kw_only=True)
class Variation(Declared):
    """Base of the variations; a class of its own for each ``type:``, registered by :func:`register_variation`."""

    article: ClassVar[str] = "a variation"
    is_random: ClassVar[bool] = True
    """Whether it is a distribution that values are drawn from."""

    @property
    def words(self) -> str:
        """What it is, as a reader of a report is told."""
        return self.kind

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        """The numbers that it is made of, in SI, by what they are: :data:`MIDDLE`, ...; of faultless entries."""
        raise NotImplementedError

    def bound(self, reader: NominalReader) -> Marginal | GridAxis | None:
        """The distribution or the values in SI; None where the reader found faults."""
        raise NotImplementedError


VARIATIONS: TypeRegister[type[Variation]] = TypeRegister("torsionnet.study.space.variations", ("triangle",))
"""By the word in ``type:``."""


def register_variation(cls: V) -> V:
    """Make a variation known by its ``kind``."""
    VARIATIONS[cls.kind] = cls
    return cls
