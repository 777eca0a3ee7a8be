"""Shares of the multiples of a frequency as an entry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.core.entries.scalars import SCALAR_SCHEMA, Value, plain_number
from torsionnet.core.entries.spec import EntryError, Schema, Spec, under
from torsionnet.core.errors import Fault


@dataclass(frozen=True, eq=False, repr=False)
class Shares(Spec[dict[int, float]]):
    """Order to share: ``{2: 2 %, 3: 1 %}``."""

    highest: int = 20

    def coerce(self, raw: object) -> dict[int, float]:
        if not isinstance(raw, Mapping):
            raise EntryError(f"expected {{2: 2 %, 3: 1 %}}, got {raw!r}")
        shares = {}
        for key, share in raw.items():
            order = str(key)
            if not (order.isascii() and order.isdigit() and 2 <= int(order) <= self.highest):
                raise EntryError(
                    Fault(f'an order is a whole number from 2 to {self.highest}, got "{key}"', (key,), on_key=True)
                )
            shares[int(order)] = under(key, Value(self.description, "1"), share)
        return shares

    def plain(self, value: Any) -> Any:
        return {str(order): plain_number(share) for order, share in value.items()}

    def schema(self) -> Schema:
        names = {"pattern": "^[0-9]+$"}
        return {
            "type": "object",
            "propertyNames": names,
            "additionalProperties": SCALAR_SCHEMA,
            "description": self.description,
        }
