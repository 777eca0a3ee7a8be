"""One frequency or several as an entry of a quantity."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from torsionnet.core.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.core.entries.spec import EntryError, Schema, Spec, under

_FREQUENCY = Value("a frequency", "frequency", below=1e9)


class FrequencyList(Spec):
    """A frequency, or a list of them that rises; stored in Hz."""

    def coerce(self, raw: Any) -> tuple[float, ...]:
        if not isinstance(raw, list | tuple):
            return (_FREQUENCY.coerce(raw),)
        found = tuple(under(place, _FREQUENCY, one) for place, one in enumerate(raw))
        if not found or any(second <= first for first, second in pairwise(found)):
            raise EntryError(f"expected a frequency or a list of frequencies that rises, got {raw!r}")
        return found

    def plain(self, value: Any) -> Any:
        return [f"{one!r} Hz" for one in value] if len(value) > 1 else f"{value[0]!r} Hz"

    def schema(self) -> Schema:
        one_or_more = [SCALAR_SCHEMA, {"type": "array", "items": SCALAR_SCHEMA, "minItems": 1}]
        return {"description": f"{self.description} [Hz]", "anyOf": one_or_more}
