"""The kinds of value an element can have: each knows how to read, bound, describe and write its value.

The metadata of a dataclass field holds one of these specifications. The model-file reader, the JSON Schema, the checks,
the documentation table and the nomenclature all use it, so that an element is described in one place only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, field
from fractions import Fraction
from numbers import Integral
from typing import Any

from torsionnet.core.damping import MEASURES, DampingMeasure
from torsionnet.core.errors import Fault, Path, did_you_mean
from torsionnet.core.expressions import Expression, ExpressionError, Number, scalar
from torsionnet.core.units import DIMENSIONS, UnitError, expected_unit, is_beyond_range
from torsionnet.model.elements.laws import GROUND
from torsionnet.model.elements.stiffness_table import StiffnessTable


class FieldError(ValueError):
    """A value that does not fit its field; ``path`` leads from the field to the offending entry."""

    def __init__(self, message: str | Fault, path: Path = ()) -> None:
        self.fault = message if isinstance(message, Fault) else Fault(message, path)
        super().__init__(self.fault.message)


@dataclass(frozen=True, eq=False, repr=False)
class Spec:
    """Base of the field specifications."""

    description: str

    def coerce(self, raw: Any) -> Any:
        """The value in its stored form; FieldError says what is wrong."""
        raise NotImplementedError

    def plain(self, value: Any) -> Any:
        """The value as a model file holds it."""
        return value

    def schema(self) -> dict[str, Any]:
        """JSON Schema of the value."""
        raise NotImplementedError

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        """(path, expression, dimension name) of every expression in the value, for the checks."""
        del value
        return ()


SCALAR_SCHEMA: dict[str, Any] = {"type": ["number", "string"]}


def read_scalar(raw: Any, dimension: str) -> Expression:
    """A number (SI), a quantity with unit or an expression of parameters; its written unit must fit ``dimension``."""
    if raw is None:
        msg = f"a value is missing; expected {_wanted(dimension)}"
        raise FieldError(msg)
    if isinstance(raw, (Mapping, list, tuple)):
        msg = f"expected {_wanted(dimension)}, got {_kind(raw)}"
        raise FieldError(msg)
    try:
        value = scalar(raw)
    except (ExpressionError, UnitError, TypeError, ValueError) as error:
        raise FieldError(_unit_hint(str(error), dimension)) from None
    return check_unit(value, dimension)


def check_unit(value: Expression, dimension: str) -> Expression:
    """A compliance where a stiffness is wanted is inverted; any other unit of a wrong dimension is refused."""
    if not isinstance(value, Number) or value.unit_dimension is None:
        return value
    wanted = DIMENSIONS[dimension]
    if value.unit_dimension == wanted:
        return value
    if dimension == "stiffness" and value.unit_dimension == DIMENSIONS["compliance"] and value.value != 0:
        return Number(1 / value.value, wanted, value.text)
    msg = f'"{value.text}" is not a value of {_label(dimension)}; expected a unit such as {expected_unit(dimension)}'
    if dimension in ("speed", "angular frequency") and value.unit_dimension == DIMENSIONS["frequency"]:
        msg += " (Hz counts cycles, not radians)"
    raise FieldError(msg)


def _label(dimension: str) -> str:
    return "a plain number" if dimension == "1" else dimension


def _wanted(dimension: str) -> str:
    return "a number" if dimension == "1" else f"{dimension} in {expected_unit(dimension)}, or an expression"


def _unit_hint(message: str, dimension: str) -> str:
    return message if dimension == "1" or "expected" in message else f"{message}; expected {_wanted(dimension)}"


def _kind(raw: Any) -> str:
    return "a mapping" if isinstance(raw, Mapping) else "a list"


@dataclass(frozen=True, eq=False, repr=False)
class PhysicalQuantity(Spec):
    """A physical scalar: number in SI, text with unit, or an expression of parameters.

    ``usual`` are sizes in SI outside of which the checks ask whether that is meant.
    """

    dimension: str
    symbol: str
    lower: float | None = 0.0
    exclusive: bool = False
    nonzero: bool = False
    usual: tuple[float, float] | None = None

    def coerce(self, raw: Any) -> Expression | DampingMeasure:
        return read_scalar(raw, self.dimension)

    def plain(self, value: Any) -> Any:
        return plain_scalar(value)

    def schema(self) -> dict[str, Any]:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [{expected_unit(self.dimension)}]"}

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        return (((), value, self.dimension),)

    def bound_fault(self, value: float) -> str | None:
        """What is wrong with the size of the value, or None."""
        if self.nonzero and value == 0:
            return "must not be zero"
        if self.lower is None:
            return None
        if value < self.lower or (self.exclusive and value == self.lower):
            return f"must {'be greater than' if self.exclusive else 'not be less than'} {self.lower:g}"
        return None


@dataclass(frozen=True, eq=False, repr=False)
class DampingQuantity(PhysicalQuantity):
    """A viscous coefficient, or a damping measure at a stated frequency: ``{zeta: 0.02, at: 12 Hz}``."""

    def coerce(self, raw: Any) -> Expression | DampingMeasure:
        if isinstance(raw, DampingMeasure):
            return raw
        if isinstance(raw, Mapping):
            return self._measure(raw)
        return read_scalar(raw, self.dimension)

    def _measure(self, raw: Mapping[str, Any]) -> DampingMeasure:
        given = [key for key in raw if key != "at"]
        for key in given:
            if key not in MEASURES:
                msg = (
                    f'"{key}" is no measure of damping{did_you_mean(str(key), MEASURES)}; known: {", ".join(MEASURES)}'
                )
                raise FieldError(Fault(msg, (key,), on_key=True))
        if len(given) != 1:
            msg = f"give one measure of damping ({', '.join(MEASURES)}) and at: the frequency where it holds"
            raise FieldError(msg)
        measure = given[0]
        if "at" not in raw and measure != "c":
            msg = f"{measure} gives a viscous coefficient only at a stated frequency; add at: 12 Hz"
            raise FieldError(msg)
        value = _within(raw[measure], "damping" if measure == "c" else "1", measure)
        at = _within(raw["at"], "frequency", "at") if "at" in raw else None
        return DampingMeasure(measure, value, at)

    def plain(self, value: Any) -> Any:
        if not isinstance(value, DampingMeasure):
            return plain_scalar(value)
        at = {} if value.at is None else {"at": plain_scalar(value.at)}
        return {value.measure: plain_scalar(value.value), **at}

    def schema(self) -> dict[str, Any]:
        keys = {**dict.fromkeys(MEASURES, SCALAR_SCHEMA), "at": SCALAR_SCHEMA}
        measure = {"type": "object", "properties": keys, "additionalProperties": False, "minProperties": 1}
        return {"anyOf": [SCALAR_SCHEMA, measure], "description": f"{self.description} [N*m*s/rad]"}

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        if not isinstance(value, DampingMeasure):
            return (((), value, self.dimension),)
        entries: list[tuple[Path, Expression, str]] = [
            ((value.measure,), value.value, "damping" if value.measure == "c" else "1")
        ]
        if value.at is not None:
            entries.append((("at",), value.at, "frequency"))
        return tuple(entries)


def _within(raw: Any, dimension: str, key: str) -> Expression:
    try:
        return read_scalar(raw, dimension)
    except FieldError as error:
        raise FieldError(error.fault.under(key)) from None


@dataclass(frozen=True, eq=False, repr=False)
class LossFactor(PhysicalQuantity):
    """A loss factor eta, or any frequency-free measure of damping: ``{zeta: 0.05}``, ``{psi: 0.6}``."""

    def coerce(self, raw: Any) -> Expression | DampingMeasure:
        if isinstance(raw, DampingMeasure):
            return raw
        if not isinstance(raw, Mapping):
            return read_scalar(raw, self.dimension)
        known = [name for name in MEASURES if name != "c"]
        if len(raw) != 1 or next(iter(raw)) not in known:
            msg = f"give a loss factor, or one measure of damping out of {', '.join(known)}"
            raise FieldError(msg)
        measure = next(iter(raw))
        return DampingMeasure(measure, _within(raw[measure], "1", measure), None)

    plain = DampingQuantity.plain

    def schema(self) -> dict[str, Any]:
        keys = {name: SCALAR_SCHEMA for name in MEASURES if name != "c"}
        measure = {"type": "object", "properties": keys, "additionalProperties": False, "minProperties": 1}
        return {"anyOf": [SCALAR_SCHEMA, measure], "description": self.description}

    def expressions(self, value: Any) -> tuple[tuple[Path, Expression, str], ...]:
        if isinstance(value, DampingMeasure):
            return (((value.measure,), value.value, "1"),)
        return (((), value, "1"),)


def plain_scalar(value: Expression) -> Any:
    """A number if nothing else was written, else the text."""
    if isinstance(value, Number) and value.text is None:
        return plain_number(value.value)
    return str(value)


def plain_number(value: Fraction | float) -> int | float | str:
    """The shortest exact way to write a number in a file; a fraction no decimal can hold stays a quotient."""
    if isinstance(value, Fraction):
        if value.denominator == 1 and abs(value) < 10**15:
            return int(value)
        if Fraction(repr(float(value))) != value:
            return f"{value.numerator}/{value.denominator}"
    return float(value)


@dataclass(frozen=True, eq=False, repr=False)
class NodeName(Spec):
    """The node an element's port is attached to."""

    allow_ground: bool = True

    def coerce(self, raw: Any) -> str:
        return read_node(raw, allow_ground=self.allow_ground)

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "description": self.description}


def read_node(raw: Any, *, allow_ground: bool = True) -> str:
    if not isinstance(raw, str) or not raw:
        msg = f"expected the name of a node, got {raw!r}"
        raise FieldError(msg)
    fault = node_name_fault(raw)
    if fault:
        raise FieldError(fault)
    if raw == GROUND and not allow_ground:
        msg = "ground does not move; attach this to a node"
        raise FieldError(msg)
    return raw


def node_name_fault(name: str) -> str | None:
    """Why ``name`` can be no name of a node or element, or None."""
    if name.isidentifier() and name.isascii() and not name.startswith("_"):
        return None
    return f'"{name}" is no name; use letters, digits and _, beginning with a letter'


@dataclass(frozen=True, eq=False, repr=False)
class NodePair(Spec):
    """Two nodes; the first defines the sign of the element's twist and torque."""

    def coerce(self, raw: Any) -> tuple[str, str]:
        if isinstance(raw, str) or not isinstance(raw, Sequence) or len(raw) != 2:  # noqa: PLR2004
            msg = f"expected two nodes [first, second], got {_shown(raw)}"
            raise FieldError(msg)
        names = tuple(self._one(entry, index) for index, entry in enumerate(raw))
        if names[0] == names[1]:
            msg = f'both ends are on node "{names[0]}"; the element would do nothing'
            raise FieldError(msg, (1,))
        return (names[0], names[1])

    @staticmethod
    def _one(entry: Any, index: int) -> str:
        try:
            return read_node(entry)
        except FieldError as error:
            raise FieldError(error.fault.under(index)) from None

    def plain(self, value: Any) -> Any:
        return list(value)

    def schema(self) -> dict[str, Any]:
        return {
            "type": "array",
            "items": {"type": "string"},
            "minItems": 2,
            "maxItems": 2,
            "description": self.description,
        }


def _shown(raw: Any) -> str:
    return "nothing" if raw is None else f"{raw!r}"


MOST_TEETH = 1_000_000


@dataclass(frozen=True, eq=False, repr=False)
class Teeth(Spec):
    """Two teeth counts; one negative count marks opposite senses of rotation (an external mesh)."""

    def coerce(self, raw: Any) -> tuple[int, int]:
        if isinstance(raw, str) or not isinstance(raw, Sequence) or len(raw) != 2:  # noqa: PLR2004
            msg = f"expected two teeth counts [z1, z2], got {_shown(raw)}"
            raise FieldError(msg)
        for index, count in enumerate(raw):
            if isinstance(count, bool) or not isinstance(count, Integral) or count == 0:
                msg = f"a teeth count is a whole number other than zero, got {count!r}"
                raise FieldError(msg, (index,))
            if abs(int(count)) > MOST_TEETH:
                msg = f"no gear has more than {MOST_TEETH} teeth; for a ratio give ratio:"
                raise FieldError(msg, (index,))
        return (int(raw[0]), int(raw[1]))

    def plain(self, value: Any) -> Any:
        return list(value)

    def schema(self) -> dict[str, Any]:
        return {
            "type": "array",
            "items": {"type": "integer"},
            "minItems": 2,
            "maxItems": 2,
            "description": self.description,
        }


@dataclass(frozen=True, eq=False, repr=False)
class OneOf(Spec):
    """One word out of a few."""

    options: tuple[str, ...]

    def coerce(self, raw: Any) -> str:
        if raw not in self.options:
            hint = did_you_mean(raw, self.options) if isinstance(raw, str) else ""
            msg = f"expected {' or '.join(self.options)}, got {raw!r}{hint}"
            raise FieldError(msg)
        return str(raw)

    def schema(self) -> dict[str, Any]:
        return {"enum": list(self.options), "description": self.description}


@dataclass(frozen=True, eq=False, repr=False)
class Count(Spec):
    """A whole number in a range."""

    lower: int = 1
    upper: int = 1000

    def coerce(self, raw: Any) -> int:
        if isinstance(raw, bool) or not isinstance(raw, Integral) or not self.lower <= int(raw) <= self.upper:
            msg = f"expected a whole number from {self.lower} to {self.upper}, got {raw!r}"
            raise FieldError(msg)
        return int(raw)

    def schema(self) -> dict[str, Any]:
        return {"type": "integer", "minimum": self.lower, "maximum": self.upper, "description": self.description}


@dataclass(frozen=True, eq=False, repr=False)
class Flag(Spec):
    """true or false."""

    def coerce(self, raw: Any) -> bool:
        if not isinstance(raw, bool):
            msg = f"expected true or false, got {raw!r}"
            raise FieldError(msg)
        return raw

    def schema(self) -> dict[str, Any]:
        return {"type": "boolean", "description": self.description}


@dataclass(frozen=True, eq=False, repr=False)
class Text(Spec):
    """Free text."""

    def coerce(self, raw: Any) -> str:
        if not isinstance(raw, str):
            msg = f"expected text, got {raw!r}"
            raise FieldError(msg)
        return raw

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "description": self.description}


_COLUMNS = (("frequency", "frequency"), ("stiffness", "stiffness"), ("damping", "damping"))


@dataclass(frozen=True, eq=False, repr=False)
class TableEntry(Spec):
    """Rows [frequency, stiffness, damping] of a measured dynamic stiffness."""

    def coerce(self, raw: Any) -> StiffnessTable:
        if isinstance(raw, StiffnessTable):
            return raw
        raw = raw.tolist() if hasattr(raw, "tolist") else raw
        if isinstance(raw, str) or not isinstance(raw, Sequence) or not raw:
            msg = f"expected rows [frequency, stiffness, damping], got {_shown(raw)}"
            raise FieldError(msg)
        rows = [self._row(row, index) for index, row in enumerate(raw)]
        for index in range(1, len(rows)):
            if rows[index][0] <= rows[index - 1][0]:
                msg = "the frequencies of the table must increase from row to row"
                raise FieldError(msg, (index, 0))
        return StiffnessTable(*(tuple(column) for column in zip(*rows, strict=True)))

    def _row(self, row: Any, index: int) -> tuple[float, ...]:
        if isinstance(row, str) or not isinstance(row, Sequence) or len(row) != len(_COLUMNS):
            msg = f"a row of the table is [frequency, stiffness, damping], got {_shown(row)}"
            raise FieldError(msg, (index,))
        return tuple(self._cell(cell, index, column) for column, cell in enumerate(row))

    @staticmethod
    def _cell(cell: Any, index: int, column: int) -> float:
        try:
            value = read_scalar(cell, _COLUMNS[column][1])
        except FieldError as error:
            raise FieldError(error.fault.under(index, column)) from None
        if not isinstance(value, Number):
            msg = "a table holds numbers, not expressions"
            raise FieldError(msg, (index, column))
        if column < 2 and value.value < 0:  # noqa: PLR2004
            msg = f"{_COLUMNS[column][0]} must not be negative"
            raise FieldError(msg, (index, column))
        size = float(value.value)
        if is_beyond_range(size):
            msg = f"{size:g} is no size that anything in a drivetrain has"
            raise FieldError(msg, (index, column))
        return size

    def plain(self, value: Any) -> Any:
        return [list(row) for row in zip(value.frequencies, value.stiffness, value.damping, strict=True)]

    def schema(self) -> dict[str, Any]:
        row = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 3, "maxItems": 3}
        return {"type": "array", "items": row, "minItems": 1, "description": self.description}


def spec_of(declared: Field[Any]) -> Spec:
    """The specification in a dataclass field's metadata."""
    spec = declared.metadata["spec"]
    if not isinstance(spec, Spec):
        msg = f"field {declared.name} has no specification"
        raise TypeError(msg)
    return spec


def entry(spec: Spec, default: Any = MISSING, *, kw_only: Any = MISSING) -> Any:
    """Dataclass field described by ``spec``; without ``default`` it must be given."""
    if default is MISSING:
        return field(metadata={"spec": spec}, kw_only=kw_only)
    return field(default=default, metadata={"spec": spec}, kw_only=kw_only)
