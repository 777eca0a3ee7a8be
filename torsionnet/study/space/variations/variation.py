"""Base classes of a parameter's variations, of distributions and of axes with given values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import erfc, nan, sqrt
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, QuantityKind, plain_number, read_scalar
from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Name, Number
from torsionnet.base.registers import TypeRegister
from torsionnet.base.units import DIMENSIONS, Dimension, expected_unit
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.model.model import Model
from torsionnet.model.parameters import dimensions

# Value and unit of a parameter in the model, to which a variation is relative.


@dataclass(frozen=True)
class ParameterUse:
    """Use of a parameter as the value of an element's entry, with its kind of quantity and its dimension."""

    quantity: QuantityKind[object]
    dimension: str


def parameter_uses(model: Model) -> dict[str, list[ParameterUse]]:
    """Uses of every parameter, by name, as the value of an element's entry without an expression, one of each kind."""
    by_kind: dict[str, dict[object, ParameterUse]] = {}
    for element in model.definition.elements.values():
        for _, spec, expression, dimension in element.expressions():
            if isinstance(expression, Name) and isinstance(spec, QuantityKind):
                kind = dimension, spec.lower, spec.exclusive, spec.nonzero
                by_kind.setdefault(expression.name, {}).setdefault(kind, ParameterUse(spec, dimension))
    return {name: list(uses.values()) for name, uses in by_kind.items()}


LEAST_BARE_DEVIATION = 1e-3
"""Share of a mean below which a deviation without unit is refused, as 0.05 usually means 5 %, not 0.05 N m/rad."""


def is_share(number: Number) -> bool:
    """Whether a number of a study file was written in percent."""
    return number.unit_dimension == DIMENSIONS["1"] and (number.text or "").rstrip().endswith("%")


@dataclass(frozen=True)
class Nominal:
    """Value in SI and unit of a parameter in the model.

    Attributes
    ----------
    name : str
    value : float or None
        SI; None where it follows the operating point.
    dimension : Dimension or None
        None of a bare number.
    unit : str
        SI; empty of a plain number.
    in_percent : bool
        Whether the model writes it in percent.
    """

    name: str
    value: float | None
    dimension: Dimension | None = None
    unit: str = ""
    in_percent: bool = False


def nominals(model: Model, names: Iterable[str]) -> dict[str, Nominal]:
    """Value in SI and unit in the model of each of the named parameters, by name."""
    known, _ = dimensions(model.definition.parameters)
    uses = parameter_uses(model)
    return {name: _nominal(model, name, known.get(name), uses.get(name, [])) for name in names}


def _nominal(model: Model, name: str, dimension: Dimension | None, uses: Sequence[ParameterUse]) -> Nominal:
    unit = "" if dimension is None else str(dimension).removeprefix("1")
    if uses and uses[0].dimension:
        unit = expected_unit(uses[0].dimension).removeprefix("1")
        dimension = dimension or DIMENSIONS[uses[0].dimension]
    parameter = model.parameter_definitions[name]
    written = parameter.value
    in_percent = isinstance(written, Number) and is_share(written)
    return Nominal(name, model.parameters[name] if parameter.by is None else None, dimension, unit, in_percent)


class NominalReader:
    """Conversion of the values of one variation to SI numbers, with the faults found.

    A faulty value becomes NaN, with which no further comparison fails.
    """

    def __init__(self, nominal: Nominal) -> None:
        self.nominal = nominal
        self.faults: list[Fault] = []

    def fault(self, text: str, *path: str | int, kind: str) -> float:
        self.faults.append(Fault(text, path, kind=kind))
        return nan

    def value(self, number: Number | None, *path: str | int) -> float:
        """Value in SI of a number, of a signed percentage of the model's value, or, for None, the model's value."""
        nominal = self.nominal
        if number is None:
            if nominal.value is None:
                self.faults.append(
                    Fault(f"{self._without_value}; give {path[-1]}:", path[:-1], on_key=True, kind="missing-entry")
                )
                return nan
            return nominal.value
        if not is_share(number):
            return self._absolute(number, path)
        if self._is_ambiguous(number, path):
            return nan
        text = (number.text or "").strip()
        if number.value and text[0] not in "+-":
            return self.fault(
                f'"{text}" leaves open what is meant; write "+{text}" for a change from the value in the model',
                *path,
                kind="ambiguous-number",
            )
        if nominal.value is None:
            return self.fault(f'{self._without_value}; "{text}" is relative to none', *path, kind="missing-entry")
        if nominal.value == 0 and number.value:
            return self.fault(
                f'{nominal.name} is 0 in the model, and so is "{text}" of it; give a value', *path, kind="out-of-range"
            )
        # A percentage is of the size: +5 % raises a negative value, too.
        return nominal.value + float(number.value) * abs(nominal.value)

    def spread(self, number: Number, of: float, *path: str | int) -> float:
        """Standard deviation in SI, above 0, from a number or a percentage ``of`` a value."""
        if number.value <= 0:
            return self.fault(f"must be greater than 0, got {number}", *path, kind="out-of-range")
        if not is_share(number):
            return self._no_slip(self._absolute(number, path), number, of, path)
        if self._is_ambiguous(number, path):
            return nan
        if of == 0:
            return self.fault(
                f'the mean is 0, and so is "{number}" of it; give a value with unit', *path, kind="out-of-range"
            )
        return float(number.value) * abs(of)

    def _no_slip(self, deviation: float, number: Number, of: float, path: tuple[str | int, ...]) -> float:
        """Refuse a small bare number as deviation, which is more often meant as a share than in SI."""
        nominal = self.nominal
        if number.unit_dimension is None and nominal.unit and deviation < min(1, LEAST_BARE_DEVIATION * abs(of)):
            text = f"{deviation:g} {nominal.unit} is only {deviation / abs(of):.1g} of {nominal.name}"
            return self.fault(
                f'{text}; write "{deviation * 100:g} %" for a share, or "{deviation:g} {nominal.unit}"',
                *path,
                kind="implausible-size",
            )
        return deviation

    def _absolute(self, number: Number, path: tuple[str | int, ...]) -> float:
        wanted, written = self.nominal.dimension, number.unit_dimension
        if None not in (wanted, written) and wanted != written:
            expected = f"expected a unit such as {self.nominal.unit}, or percent"
            return self.fault(f'"{number}" is not a value of {self.nominal.name}; {expected}', *path, kind="wrong-unit")
        return float(number.value)

    def _is_ambiguous(self, number: Number, path: tuple[str | int, ...]) -> bool:
        if self.nominal.in_percent:
            text = f'{self.nominal.name} is itself in percent: "{number}" could be its value or a share of it'
            self.fault(f"{text}; write {float(number.value):g} for the value", *path, kind="ambiguous-number")
        return self.nominal.in_percent

    @property
    def _without_value(self) -> str:
        return f"{self.nominal.name} follows the operating point and has no value of its own"


def share_below(normal: FloatArray) -> FloatArray:
    """Share of a standard normal variable below each value; one alone, as checks of entries ask, needs no scipy."""
    if not normal.ndim:
        return np.asarray(erfc(-float(normal) / sqrt(2)) / 2)
    from scipy.special import ndtr

    return np.asarray(ndtr(normal))


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
        tail = share_below(-np.abs(u))
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
            raise EntryError(
                f'expected a number with unit or in percent; "{value}" is an expression of parameters',
                kind="expression-not-allowed",
            )
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
    {"uniform": ("list", "range", "triangular"), "normal": ("lognormal",)},
)
"""Classes of variations by the word that a study file writes as their ``type``."""


def register_variation(cls: V) -> V:
    """Class decorator that registers a class of variations by its ``kind``, the ``type`` in a study file."""
    VARIATIONS[cls.kind] = cls
    return cls
