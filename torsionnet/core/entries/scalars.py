"""Entries that hold numbers with units, or expressions of parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from torsionnet.core.entries.spec import EntryError, Json, Schema, Spec, Stored_co
from torsionnet.core.errors import Path
from torsionnet.core.expression_reading import scalar
from torsionnet.core.expressions import Expression, ExpressionError, Number
from torsionnet.core.number_range import is_beyond_range
from torsionnet.core.units import DIMENSIONS, UnitError, expected_unit, parse_quantity, with_forces

SCALAR_SCHEMA: Schema = {"type": ["number", "string"]}


def read_scalar(raw: object, dimension: str) -> Expression:
    """Expression in SI units, read from a number, a text with unit or an expression of parameters.

    Its written unit must fit ``dimension``.
    """
    if raw is None:
        raise EntryError(f"a value is missing; expected {_wanted(dimension)}")
    if isinstance(raw, (Mapping, list, tuple)):
        raise EntryError(f"expected {_wanted(dimension)}, got {'a mapping' if isinstance(raw, Mapping) else 'a list'}")
    try:
        value = scalar(raw)
    except (ExpressionError, UnitError, TypeError, ValueError) as error:
        raise EntryError(_unit_hint(str(error), dimension)) from None
    return check_unit(_within_range(value), dimension)


def read_value(raw: object) -> Expression:
    """Expression of any dimension in SI units, read from a number or a text."""
    if raw is None or isinstance(raw, (Mapping, list, tuple)):
        raise EntryError(
            f"expected a number, a quantity with unit or an expression, got {'nothing' if raw is None else repr(raw)}"
        )
    try:
        return _within_range(scalar(raw))
    except (ExpressionError, UnitError, TypeError, ValueError) as error:
        raise EntryError(str(error)) from None


def _within_range(value: Expression) -> Expression:
    """Expression unchanged, or an EntryError that refuses a number of which not even squares can be calculated."""
    if isinstance(value, Number) and is_beyond_range(value.value):
        raise EntryError(f"{value} is far outside the sizes of drivetrains and their tests; check its unit")
    return value


def check_unit(value: Expression, dimension: str) -> Expression:
    """Scalar in the wanted dimension, or an EntryError that refuses its unit.

    Compliances are inverted to stiffnesses.
    """
    if not isinstance(value, Number) or value.unit_dimension is None:
        return value
    wanted = DIMENSIONS[dimension]
    if value.unit_dimension == wanted:
        return value
    if dimension == "stiffness" and value.unit_dimension == DIMENSIONS["compliance"] and value.value != 0:
        return Number(1 / value.value, wanted, value.text)
    label = "a plain number" if dimension == "1" else dimension
    msg = f'"{value.text}" is not a value of {label}; expected a unit such as {expected_unit(dimension)}'
    if dimension in ("speed", "angular frequency") and value.unit_dimension == DIMENSIONS["frequency"]:
        msg += " (Hz counts cycles, not radians)"
    forces = with_forces(value.text or "")
    if forces != value.text and parse_quantity(forces).dimension == wanted:
        msg += f"; lb, oz and kg are masses, lbf, ozf and kgf forces: write {forces}"
    raise EntryError(msg)


def _wanted(dimension: str) -> str:
    return "a number" if dimension == "1" else f"{dimension} in {expected_unit(dimension)}, or an expression"


def _unit_hint(message: str, dimension: str) -> str:
    return message if dimension == "1" or "expected" in message else f"{message}; expected {_wanted(dimension)}"


def plain_scalar(value: Expression) -> int | float | str:
    """Scalar as plain data for a file: a number if no text was written, else the text."""
    if isinstance(value, Number) and value.text is None:
        return plain_number(value.value)
    return str(value)


def plain_number(value: Fraction | float) -> int | float | str:
    """Number as a file holds it, written in the shortest exact way.

    A fraction that no decimal can hold stays a quotient.
    """
    if isinstance(value, Fraction):
        if value.denominator == 1 and abs(value) < 10**15:
            return int(value)
        if Fraction(repr(float(value))) != value:
            return f"{value.numerator}/{value.denominator}"
    return float(value)


class AnyQuantity(Spec[Expression]):
    """Entry of a scalar whose dimension follows from where it is used."""

    @property
    def example(self) -> str:
        return "a number with unit, as 0.46 kN*m/rad"

    def coerce(self, raw: object) -> Expression:
        return raw if isinstance(raw, Expression) else read_value(raw)

    def plain(self, value: Any) -> Json:
        return plain_scalar(value)

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": self.description}

    @property
    def accepted(self) -> str:
        return "Scalar"


@dataclass(frozen=True, eq=False, repr=False)
class QuantityKind(Spec[Stored_co]):
    """Base of entries of a physical scalar: a value, or another way to give it, as damping by a measure.

    ``usual`` are sizes in SI outside of which the checks ask whether that is meant.
    """

    dimension: str
    symbol: str = ""
    lower: float | None = 0.0
    exclusive: bool = False
    nonzero: bool = False
    usual: tuple[float, float] | None = None

    def plain(self, value: Any) -> Json:
        return plain_scalar(value)

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [{expected_unit(self.dimension)}]"}

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        return (((), value, self.dimension),)

    def bound_fault(self, value: float) -> str | None:
        """Message that a value is outside the bounds of the entry, or None."""
        if self.nonzero and value == 0:
            return "must not be zero"
        if self.lower is None:
            return None
        if value < self.lower or (self.exclusive and value == self.lower):
            return f"must {'be greater than' if self.exclusive else 'not be less than'} {self.lower:g}"
        return None

    @property
    def accepted(self) -> str:
        return "Scalar"


class PhysicalQuantity(QuantityKind[Expression]):
    """Entry of a physical scalar: number in SI, text with unit, or an expression of parameters."""

    def coerce(self, raw: object) -> Expression:
        return read_scalar(raw, self.dimension)


@dataclass(frozen=True, eq=False, repr=False)
class Value(Spec[float]):
    """Entry of a number with unit, not an expression; stored in SI (frequencies in Hz)."""

    dimension: str
    lower: float | None = 0.0
    exclusive: bool = False
    below: float | None = None

    def coerce(self, raw: object) -> float:
        number = _finite(_number(read_scalar(raw, self.dimension)))
        if self.below is not None and number >= self.below:
            share = f" ({100 * self.below:g} %)" if self.dimension == "1" else ""
            raise EntryError(f"must be less than {self.below:g}{share}, got {raw!r}")
        if self.lower is not None and (number < self.lower or (self.exclusive and number == self.lower)):
            raise EntryError(
                f"must {'be greater than' if self.exclusive else 'not be less than'} {self.lower:g}, got {raw!r}"
            )
        return number

    def plain(self, value: float) -> int | float | str:
        return plain_number(value)

    def schema(self) -> Schema:
        unit = f" [{expected_unit(self.dimension)}]" if self.dimension != "1" else ""
        return {**SCALAR_SCHEMA, "description": f"{self.description}{unit}"}

    @property
    def accepted(self) -> str:
        return "Scalar"


@dataclass(frozen=True, eq=False, repr=False)
class ValueInUnitOfUse(Spec[Number]):
    """Entry of a number whose unit depends on the quantity it is used for, as a threshold of a channel."""

    lower: float | None = 0.0
    exclusive: bool = False

    def coerce(self, raw: object) -> Number:
        if isinstance(raw, Number):
            return raw
        try:
            number = scalar(raw)
        except (ExpressionError, UnitError, TypeError, ValueError) as error:
            raise EntryError(str(error)) from None
        Value(self.description, "1", self.lower, self.exclusive).coerce(_number(number))
        assert isinstance(number, Number)
        return number

    def plain(self, value: Number) -> int | float | str:
        return plain_number(value.value) if value.text is None else value.text

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [unit of what is measured]"}

    @property
    def accepted(self) -> str:
        return "Scalar"


class AnyNumber(Spec[float]):
    """Entry of a number with unit, of any dimension; stored in SI."""

    def coerce(self, raw: object) -> float:
        value = read_value(raw)
        if not isinstance(value, Number):
            raise EntryError(f"expected a number with unit, got {raw!r}")
        return float(value.value)

    def plain(self, value: float) -> int | float | str:
        return plain_number(value)

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": self.description}

    @property
    def accepted(self) -> str:
        return "Scalar"


def _number(value: Expression) -> Fraction:
    if not isinstance(value, Number):
        raise EntryError(f'expected a number with unit; "{value}" is an expression of parameters')
    return Fraction(value.value)


def _finite(value: Fraction) -> float:
    number = float(value)
    if not float("-inf") < number < float("inf"):
        raise EntryError(f"expected a finite number, got {value!r}")
    return number
