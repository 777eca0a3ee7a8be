"""The frequencies of a stepped sine, also as an entry."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from torsionnet.core.entries.scalars import SCALAR_SCHEMA, Value, plain_number
from torsionnet.core.entries.spec import EntryError, Schema, Spec, under
from torsionnet.core.entries.words import Count
from torsionnet.core.errors import UsageError

_FREQUENCY = Value("frequency", "frequency")


class Frequencies(Spec[tuple[float, ...]]):
    """A list of frequencies, or ``{from: 1 Hz, to: 40 Hz, count: 60}`` at equal factors."""

    def coerce(self, raw: object) -> tuple[float, ...]:
        if isinstance(raw, Mapping):
            return self._between(raw)
        if isinstance(raw, str) or not hasattr(raw, "__iter__"):
            raise EntryError(f"expected a list of frequencies or {{from: 1 Hz, to: 40 Hz, count: 60}}, got {raw!r}")
        return tuple(under(index, _FREQUENCY, value) for index, value in enumerate(raw))

    def _between(self, raw: Mapping[str, Any]) -> tuple[float, ...]:
        specs: dict[str, Spec[float]] = {
            "from": _FREQUENCY,
            "to": _FREQUENCY,
            "count": Count("", lower=2, upper=100_000),
        }
        if raw.keys() != specs.keys():
            raise EntryError(f"expected from, to and count, got {', '.join(map(str, raw)) or 'nothing'}")
        start, stop, count = (under(key, spec, raw[key]) for key, spec in specs.items())
        try:
            return steps_between(start, stop, int(count))
        except UsageError as error:
            raise EntryError(str(error)) from None

    def plain(self, value: Any) -> Any:
        return [plain_number(frequency) for frequency in value]

    def schema(self) -> Schema:
        listed: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 1}
        keys: Schema = {"from": SCALAR_SCHEMA, "to": SCALAR_SCHEMA, "count": {"type": "integer", "minimum": 2}}
        between: Schema = {"type": "object", "properties": keys, "required": list(keys), "additionalProperties": False}
        return {"anyOf": [listed, between], "description": self.description}


def steps_between(start: float, stop: float, count: int) -> tuple[float, ...]:
    """So many frequencies in Hz at equal factors, for a stepped sine.

    Examples
    --------
    >>> steps_between(1, 100, 3)
    (1.0, 10.0, 100.0)
    """
    if not (0 < start < stop and count > 1):
        raise UsageError(f"steps go from a frequency > 0 to a higher one, at least two: got {start}, {stop}, {count}")
    return tuple(np.geomspace(start, stop, count).tolist())
