"""Entries that hold numbers without units as a program has written them, infinite ones and NaN among them."""

from __future__ import annotations

from typing import Any, ClassVar

from torsionnet.base.entries.spec import EntryError, Json, Plural, Schema, Spec
from torsionnet.base.errors import BRACKET, Fault, Remedy, got


class PlainNumber(Spec[float]):
    """Entry of a number without unit, which may be infinite (``.inf``) or missing (``.nan``)."""

    def coerce(self, raw: object) -> float:
        if isinstance(raw, bool) or not isinstance(raw, int | float | str):
            raise EntryError(f"expected a number, {got(raw)}", kind="not-a-number")
        try:
            return float(raw)
        except (ValueError, OverflowError):
            raise EntryError(f"expected a number, {got(raw)}", kind="not-a-number") from None

    def schema(self) -> Schema:
        return {"type": "number", "description": self.description}

    @property
    def accepted(self) -> str:
        return "float"


class PlainNumbers(Plural[tuple[float, ...]]):
    """Entry of a list of numbers without units, each of which may be infinite (``.inf``) or missing (``.nan``)."""

    absent: ClassVar[Any] = ()

    def coerce(self, raw: object) -> tuple[float, ...]:
        raw = raw.tolist() if hasattr(raw, "tolist") else raw
        if not isinstance(raw, list | tuple):
            remedy = Remedy(BRACKET) if isinstance(raw, str) else None
            raise EntryError(Fault(f"expected a list of numbers, {got(raw)}", remedy=remedy, kind="wrong-form"))
        number, values = PlainNumber(self.description), []
        for index, part in enumerate(raw):
            try:
                values.append(number.coerce(part))
            except EntryError as error:
                raise EntryError(error.fault.under(index)) from None
        return tuple(values)

    def plain(self, value: tuple[float, ...]) -> Json:
        return list(value)

    def schema(self) -> Schema:
        return {"type": "array", "items": {"type": "number"}, "description": self.description}

    @property
    def accepted(self) -> str:
        return "tuple[float, ...] | list[float]"
