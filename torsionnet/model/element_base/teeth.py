"""Entry for the teeth counts of a gear pair."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Integral
from typing import Any

from torsionnet.core.entries.spec import EntryError, Json, Schema, Spec

MOST_TEETH = 1_000_000
"""Largest teeth count of a gear, as a larger number is a slip or a ratio, which has an entry of its own."""


class Teeth(Spec[tuple[int, int]]):
    """Entry for the teeth counts of a gear pair.

    One negative count marks opposite senses of rotation (an external mesh).
    """

    def coerce(self, raw: object) -> tuple[int, int]:
        if isinstance(raw, str) or not isinstance(raw, Sequence) or len(raw) != 2:
            raise EntryError(f"expected two teeth counts [z1, z2], got {'nothing' if raw is None else repr(raw)}")
        for index, count in enumerate(raw):
            if isinstance(count, bool) or not isinstance(count, Integral) or count == 0:
                raise EntryError(f"a teeth count is a whole number other than zero, got {count!r}", (index,))
            if abs(int(count)) > MOST_TEETH:
                raise EntryError(f"no gear has more than {MOST_TEETH} teeth; for a ratio give ratio:", (index,))
        return (int(raw[0]), int(raw[1]))

    def plain(self, value: Any) -> Json:
        return list(value)

    def schema(self) -> Schema:
        return {
            "type": "array",
            "items": {"type": "integer"},
            "minItems": 2,
            "maxItems": 2,
            "description": self.description,
        }

    @property
    def accepted(self) -> str:
        return "tuple[int, int] | list[int]"
