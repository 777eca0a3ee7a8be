"""Entries that hold numbers with units, or expressions of parameters.

Here as well: entries that hold frequency bands; entries that hold rows of numbers, whose first column rises from row to
row.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, ClassVar, NamedTuple

from torsionnet.base.entries.spec import EntryError, Json, Plural, Schema, Spec, Stored_co, coerce_part
from torsionnet.base.errors import IN_UNIT, WRITE, EntryPath, Fault, Remedy, fault_of, got
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression, Number, Rows, is_beyond_range
from torsionnet.base.units import DIMENSIONS, expected_unit, parse_quantity, with_forces

SCALAR_SCHEMA: Schema = {"type": ["number", "string"]}


def read_scalar(raw: object, dimension: str | None = None) -> Expression:
    """Expression in SI units, read from a number, a text with unit or an expression of parameters.

    Its written unit must fit ``dimension``, if there is one.
    """
    if raw is None or isinstance(raw, (Mapping, list, tuple)):
        raise EntryError(_no_scalar(raw, dimension), kind="empty-entry" if raw is None else "not-a-number")
    try:
        value = scalar(raw)
    except (TypeError, ValueError) as error:
        fault = fault_of(error, "not-a-number")
        if dimension not in (None, "1") and fault.kind != "not-a-number":
            fault = replace(fault, message=f"{fault.message}; expected {_wanted(dimension)}")
        raise EntryError(fault) from None
    # Not even squares of some numbers can be calculated.
    if isinstance(value, Number) and is_beyond_range(value.value):
        raise EntryError(
            f"{value} is far outside the sizes of drivetrains and their tests; check its unit", kind="implausible-size"
        )
    return value if dimension is None else check_unit(value, dimension)


def _no_scalar(raw: object, dimension: str | None) -> str:
    """Message that an entry holds no single value."""
    if dimension is None:
        return f"expected a number, a quantity with unit or an expression, {got(raw)}"
    if raw is None:
        return f"a value is missing; expected {_wanted(dimension)}"
    return f"expected {_wanted(dimension)}, got {'a mapping' if isinstance(raw, Mapping) else 'a list'}"


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
    written = value.text or ""
    remedy = Remedy(IN_UNIT, expected_unit(dimension), old=written)
    if dimension in ("speed", "angular frequency") and value.unit_dimension == DIMENSIONS["frequency"]:
        msg += " (Hz counts cycles, not radians)"
        if value.unit_written == "Hz":
            remedy = Remedy(WRITE, f"{float(value.value) * 60:.15g} rpm", old=written)
    forces = with_forces(written)
    if forces != value.text and parse_quantity(forces).dimension == wanted:
        msg += f"; lb, oz and kg are masses, lbf, ozf and kgf forces: write {forces}"
        remedy = Remedy(WRITE, forces, old=written)
    raise EntryError(Fault(msg, remedy=remedy, kind="wrong-unit"))


def _wanted(dimension: str) -> str:
    return "a number" if dimension == "1" else f"{dimension} in {expected_unit(dimension)}, or an expression"


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
        return raw if isinstance(raw, Expression) else read_scalar(raw)

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

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
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


def is_quantity(raw: object, dimension: str) -> bool:
    """Whether an entry is a number with a unit of a dimension, whatever its size.

    Examples
    --------
    >>> is_quantity("-0.04 bar", "pressure"), is_quantity("-0.04", "pressure"), is_quantity("2 N*m", "pressure")
    (True, True, False)
    """
    try:
        return isinstance(raw, str) and isinstance(read_scalar(raw, dimension), Number)
    except EntryError:
        return False


@dataclass(frozen=True, eq=False, repr=False)
class Value(Spec[float]):
    """Entry of a number with unit, not an expression; stored in SI (frequencies in Hz)."""

    dimension: str
    lower: float | None = 0.0
    exclusive: bool = False
    below: float | None = None

    def coerce(self, raw: object) -> float:
        value = read_scalar(raw, self.dimension)
        if not isinstance(value, Number):
            raise EntryError(
                f'expected a number with unit; "{value}" is an expression of parameters', kind="expression-not-allowed"
            )
        number = float(value.value)
        if self.below is not None and number >= self.below:
            share = f" ({100 * self.below:g} %)" if self.dimension == "1" else ""
            raise EntryError(f"must be less than {self.below:g}{share}, {got(raw)}", kind="out-of-range")
        if self.lower is not None and (number < self.lower or (self.exclusive and number == self.lower)):
            raise EntryError(
                f"must {'be greater than' if self.exclusive else 'not be less than'} {self.lower:g}, {got(raw)}",
                kind="out-of-range",
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
        except (TypeError, ValueError) as error:
            raise EntryError(fault_of(error, "not-a-number")) from None
        if not isinstance(number, Number):
            raise EntryError(
                f'expected a number with unit; "{number}" is an expression of parameters', kind="expression-not-allowed"
            )
        Value(self.description, "1", self.lower, self.exclusive).coerce(Fraction(number.value))
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
        value = read_scalar(raw)
        if not isinstance(value, Number):
            raise EntryError(f"expected a number with unit, {got(raw)}", kind="not-a-number")
        return float(value.value)

    def plain(self, value: float) -> int | float | str:
        return plain_number(value)

    def schema(self) -> Schema:
        return {**SCALAR_SCHEMA, "description": self.description}

    @property
    def accepted(self) -> str:
        return "Scalar"


_BAND = re.compile(r"\s*([-+\d.eE]+?)\s*([A-Za-z/]*)\s*\.\.\s*([-+\d.eE]+)\s*([A-Za-z/]*)\s*")
_FREQUENCY = Value("a frequency", "frequency", lower=None)
BAND_FORMS = "0.3..40 Hz or [0.3 Hz, 40 Hz]"
"""Example of how a band is written, for messages and schemas."""


LOWEST_HZ, HIGHEST_HZ = 1e-9, 1e9
"""Smallest and largest frequency of a band in Hz, as no shaft train vibrates slower or faster."""


@dataclass(frozen=True, eq=False, repr=False)
class Band(Spec[tuple[float, float]]):
    """Entry of a frequency band: two frequencies, the lower one first, stored in Hz."""

    from_zero: bool = False
    """Whether the band may begin at 0 Hz."""

    def coerce(self, raw: object) -> tuple[float, float]:
        return parse_band(raw, from_zero=self.from_zero)

    def plain(self, value: tuple[float, float]) -> str:
        return "..".join(repr(edge).removesuffix(".0") for edge in value) + " Hz"

    def schema(self) -> Schema:
        pair: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 2, "maxItems": 2}
        return {"description": f"{self.description}: {BAND_FORMS}", "anyOf": [{"type": "string"}, pair]}

    @property
    def accepted(self) -> str:
        return "str | tuple[Scalar, Scalar] | list[Scalar] | list[float] | list[str]"


def parse_band(raw: object, *, from_zero: bool = False) -> tuple[float, float]:
    """Lower and upper frequency in Hz, read from a text ``0.3..40 Hz`` or a list of two.

    >>> parse_band("18..2400 cpm"), parse_band(["0.3 Hz", 40])
    ((0.3, 40.0), (0.3, 40.0))
    """
    if isinstance(raw, (list, tuple)) and len(raw) == 2:
        edges: tuple[object, object] = (raw[0], raw[1])
    else:
        match = _BAND.fullmatch(raw) if isinstance(raw, str) else None
        if match is None:
            raise EntryError(f"expected a band such as {BAND_FORMS}, {got(raw)}", kind="wrong-form")
        unit = match[4] or "Hz"  # that of the upper frequency holds for both
        edges = f"{match[1]} {match[2] or unit}", f"{match[3]} {unit}"
    low, high = (_FREQUENCY.coerce(edge) for edge in edges)
    is_at_zero = from_zero and low == 0
    if not (0 < low < high or (is_at_zero and high > 0)):
        above = "" if from_zero else ", both above 0"
        raise EntryError(
            f"a band goes from a lower to a higher frequency{above}, as in {BAND_FORMS}; {got(raw)}",
            kind="unordered-rows",
        )
    if not ((low >= LOWEST_HZ or is_at_zero) and low < high <= HIGHEST_HZ):
        raise EntryError(f"a band lies between {LOWEST_HZ:g} and {HIGHEST_HZ:g} Hz, {got(raw)}", kind="out-of-range")
    return low, high


class Bands(Plural[tuple[tuple[float, float], ...]]):
    """Entry of a list of frequency bands, or of one band alone."""

    absent: ClassVar[Any] = ()

    def coerce(self, raw: object) -> tuple[tuple[float, float], ...]:
        band = Band(self.description, from_zero=True)
        if isinstance(raw, list | tuple) and all(_is_band(part) for part in raw):
            return tuple(coerce_part(index, band, part) for index, part in enumerate(raw))
        return (band.coerce(raw),)

    def plain(self, value: tuple[tuple[float, float], ...]) -> list[str]:
        return [Band("").plain(band) for band in value]

    def schema(self) -> Schema:
        return {"type": ["array", "string"], "description": f"{self.description}: {BAND_FORMS}, or a list of these"}

    @property
    def accepted(self) -> str:
        return "str | list[Scalar] | list[float] | list[str] | collections.abc.Sequence[object]"


def _is_band(raw: object) -> bool:
    return isinstance(raw, list | tuple) or (isinstance(raw, str) and _BAND.fullmatch(raw) is not None)


class RowColumn(NamedTuple):
    """Name, dimension and allowed signs of the values in one column of a table of numbers."""

    name: str
    dimension: str = "1"
    negative: bool = True
    zero: bool = True


@dataclass(frozen=True, eq=False, repr=False)
class NumberTable(Spec[Stored_co]):
    """Entry of rows ``[[0 rad/s, 40 N*m], [10 rad/s, 36 N*m]]`` whose first column rises."""

    columns: tuple[RowColumn, ...] = ()
    fewest: int = 1

    @property
    def example(self) -> str:
        return f"rows {self._row_text}" + (f", at least {self.fewest}" if self.fewest > 1 else "")

    @property
    def _row_text(self) -> str:
        return f"[{', '.join(column.name for column in self.columns)}]"

    def rows(self, raw: object) -> Rows:
        """Rows of numbers that an entry gives, one number for each column, exact and in SI units."""
        rows = tuple(self._row(row, index) for index, row in enumerate(self.listed(raw)))
        for index, (row, following) in enumerate(pairwise(rows), 1):
            if following[0].value <= row[0].value:
                raise EntryError(
                    f"the {self.columns[0].name} must increase from row to row", (index, 0), kind="unordered-rows"
                )
        return rows

    def listed(self, raw: object) -> Sequence[object]:
        """Rows of an entry as they are written, of which there are as many as the table needs."""
        raw = raw.tolist() if hasattr(raw, "tolist") else raw
        if isinstance(raw, str | Mapping) or not isinstance(raw, Sequence) or len(raw) < self.fewest:
            written = _as_rows(raw) if isinstance(raw, Mapping) else ""
            raise EntryError(f"expected {self.example}{written}; {got(raw)}", kind="wrong-form")
        return raw

    def _row(self, row: object, index: int) -> tuple[Number, ...]:
        if isinstance(row, str) or not isinstance(row, Sequence) or len(row) != len(self.columns):
            raise EntryError(f"a row is {self._row_text}, {got(row)}", (index,), kind="wrong-form")
        return tuple(self._cell(cell, index, place) for place, cell in enumerate(row))

    def _cell(self, cell: object, index: int, place: int) -> Number:
        column = self.columns[place]
        try:
            value = cell if isinstance(cell, Number) else read_scalar(cell, column.dimension)
        except EntryError as error:
            raise EntryError(error.fault.under(index, place)) from None
        if not isinstance(value, Number):
            raise EntryError("a table holds numbers, not expressions", (index, place), kind="expression-not-allowed")
        if not column.negative and value.value < 0:
            raise EntryError(f"{column.name} must not be negative", (index, place), kind="out-of-range")
        if not column.zero and value.value == 0:
            raise EntryError(f"{column.name} must be greater than 0", (index, place), kind="out-of-range")
        if is_beyond_range(float(value.value)):
            text = f"{float(value.value):g} is far outside the sizes of drivetrains; check its unit"
            raise EntryError(text, (index, place), kind="implausible-size")
        return value

    def plain(self, value: Any) -> Json:
        return [[plain_scalar(cell) for cell in row] for row in value]

    def schema(self) -> Schema:
        count = len(self.columns)
        row: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": count, "maxItems": count}
        return {"type": "array", "items": row, "minItems": self.fewest, "description": self.description}

    @property
    def accepted(self) -> str:
        return "NumberRows"


def _as_rows(raw: Mapping[object, object]) -> str:
    """Words that tell the first pairs of a mapping as rows, which other entries with a value over another one take."""
    first = [f"[{key}, {value}]" for key, value in [*raw.items()][:2]]
    return f", as [{', '.join(first)}{', ...' if len(raw) > len(first) else ''}]" if first else ""
