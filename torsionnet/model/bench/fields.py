"""The values in the description of a test bench: numbers with units, no expressions of parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, dataclass, fields
from functools import cache
from typing import Any, ClassVar

import numpy as np

from torsionnet.core.errors import Fault, ModelError
from torsionnet.core.expressions import Expression, ExpressionError, Number, scalar
from torsionnet.core.units import UnitError, expected_unit, is_beyond_range
from torsionnet.model.elements.fields import SCALAR_SCHEMA, FieldError, Spec, plain_number, read_scalar, spec_of


@dataclass(frozen=True, eq=False, repr=False)
class Value(Spec):
    """A number of a dimension, in SI (frequencies in Hz)."""

    dimension: str
    lower: float | None = 0.0
    exclusive: bool = False

    def coerce(self, raw: Any) -> float:
        number = _finite(_number(read_scalar(raw, self.dimension)))
        if self.lower is not None and (number < self.lower or (self.exclusive and number == self.lower)):
            msg = f"must {'be greater than' if self.exclusive else 'not be less than'} {self.lower:g}, got {raw!r}"
            raise FieldError(msg)
        return number

    def plain(self, value: Any) -> Any:
        return plain_number(value)

    def schema(self) -> dict[str, Any]:
        unit = f" [{expected_unit(self.dimension)}]" if self.dimension != "1" else ""
        return {**SCALAR_SCHEMA, "description": f"{self.description}{unit}"}


@dataclass(frozen=True, eq=False, repr=False)
class BenchEntries(Spec):
    """A number in the unit of what a channel measures, which only the model can tell."""

    lower: float | None = 0.0
    exclusive: bool = False

    def coerce(self, raw: Any) -> Number:
        if isinstance(raw, Number):
            return raw
        try:
            number = scalar(raw)
        except (ExpressionError, UnitError, TypeError, ValueError) as error:
            raise FieldError(str(error)) from None
        Value(self.description, "1", self.lower, self.exclusive).coerce(_number(number))
        assert isinstance(number, Number)
        return number

    def plain(self, value: Any) -> Any:
        return plain_number(value.value) if value.text is None else value.text

    def schema(self) -> dict[str, Any]:
        return {**SCALAR_SCHEMA, "description": f"{self.description} [unit of what is measured]"}


@dataclass(frozen=True, eq=False, repr=False)
class Shares(Spec):
    """Order to share: ``{2: 2 %, 3: 1 %}``."""

    highest: int = 20

    def coerce(self, raw: Any) -> dict[int, float]:
        if not isinstance(raw, Mapping):
            msg = f"expected {{2: 2 %, 3: 1 %}}, got {raw!r}"
            raise FieldError(msg)
        shares = {}
        for key, share in raw.items():
            order = str(key)
            if not (order.isascii() and order.isdigit() and 2 <= int(order) <= self.highest):  # noqa: PLR2004
                msg = f'an order is a whole number from 2 to {self.highest}, got "{key}"'
                raise FieldError(Fault(msg, (key,), on_key=True))
            try:
                shares[int(order)] = Value(self.description, "1").coerce(share)
            except FieldError as error:
                raise FieldError(error.fault.under(key)) from None
        return shares

    def plain(self, value: Any) -> Any:
        return {str(order): plain_number(share) for order, share in value.items()}

    def schema(self) -> dict[str, Any]:
        names = {"pattern": "^[0-9]+$"}
        return {
            "type": "object",
            "propertyNames": names,
            "additionalProperties": SCALAR_SCHEMA,
            "description": self.description,
        }


def _number(value: Expression) -> Any:
    if not isinstance(value, Number):
        msg = f'a bench is described by numbers with units, not by expressions such as "{value}"'
        raise FieldError(msg)
    return value.value


def _finite(value: Any) -> float:
    number = float(value)
    if not np.isfinite(number):
        msg = f"expected a finite number, got {value!r}"
        raise FieldError(msg)
    if is_beyond_range(number):
        msg = f"{number:g} is no size that anything on a test bench has"
        raise FieldError(msg)
    return number


@dataclass(frozen=True, kw_only=True)
class BenchPart:
    """A part of a test bench whose fields carry specifications."""

    kind: ClassVar[str] = ""

    def __post_init__(self) -> None:
        faults = []
        for declared in self.declared():
            raw = getattr(self, declared.name)
            if raw is None and declared.default is None:
                continue
            try:
                object.__setattr__(self, declared.name, spec_of(declared).coerce(raw))
            except FieldError as error:
                faults.append(error.fault.under(declared.name))
        faults = faults or self.contradictions()
        if faults:
            raise ModelError(faults, self.kind)

    def contradictions(self) -> list[Fault]:
        """Faults of fields that are fine alone but not together."""
        return []

    @classmethod
    @cache
    def declared(cls) -> tuple[Field[Any], ...]:
        return tuple(declared for declared in fields(cls) if "spec" in declared.metadata)

    def to_data(self) -> dict[str, Any]:
        """The entry of a model file that makes this part."""
        data: dict[str, Any] = {}
        for declared in self.declared():
            current = getattr(self, declared.name)
            if current is not None and current != declared.default:
                data[declared.name] = spec_of(declared).plain(current)
        return data
