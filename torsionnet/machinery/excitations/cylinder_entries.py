"""Entries that name cylinders by number."""

from __future__ import annotations

from typing import Any

from torsionnet.base.entries.composite import Listed, Named
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, Json, Schema
from torsionnet.base.errors import Fault, got

CYLINDER = Count("number of a cylinder", 1, 99)
EACH = "each"


def number_fault(name: str) -> str | None:
    """Message if a text is no cylinder number from 1 to 99, else None."""
    return None if name.isdecimal() and 0 < int(name) <= 99 else f'cylinders have numbers from 1 to 99, not "{name}"'


class CylindersEntry(Listed[int]):
    """Entry for a list of cylinders, or for ``each``: every cylinder in turn, as a condition of its own."""

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        if raw == EACH:
            return EACH, []
        if isinstance(raw, str):
            return (), [Fault(f"expected {self.form}, {got(raw)}")]
        return super().read(raw)

    def plain(self, value: Any) -> Json:
        return value if value == EACH else super().plain(value)

    def schema(self) -> Schema:
        return {"description": self.description, "anyOf": [{"const": EACH}, super().schema()]}


GAS_FACTOR = Value("gas torque of a cylinder over that of a sound one", "1", below=10)
MISFIRE_SHARE = Value("share of the injection that a cylinder has lost", "1")


def by_cylinder(description: str, of: Value, form: str) -> Named[float]:
    """Entry for a table of values by cylinder number."""
    return Named(description, of, refused=number_fault, form=form)
