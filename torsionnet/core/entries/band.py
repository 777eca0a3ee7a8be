"""Entries that hold frequency bands."""

from __future__ import annotations

import re
from dataclasses import dataclass

from torsionnet.core.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.core.entries.spec import EntryError, Plural, Schema, Spec, coerce_part

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
    low, high = (_FREQUENCY.coerce(edge) for edge in _edges(raw))
    is_at_zero = from_zero and low == 0
    if not (0 < low < high or (is_at_zero and high > 0)):
        above = "" if from_zero else ", both above 0"
        raise EntryError(f"a band goes from a lower to a higher frequency{above}, as in {BAND_FORMS}; got {raw!r}")
    if not ((low >= LOWEST_HZ or is_at_zero) and low < high <= HIGHEST_HZ):
        raise EntryError(f"a band lies between {LOWEST_HZ:g} and {HIGHEST_HZ:g} Hz, got {raw!r}")
    return low, high


def _edges(raw: object) -> tuple[object, object]:
    if isinstance(raw, (list, tuple)) and len(raw) == 2:
        return raw[0], raw[1]
    match = _BAND.fullmatch(raw) if isinstance(raw, str) else None
    if match is None:
        raise EntryError(f"expected a band such as {BAND_FORMS}, got {raw!r}")
    unit = match[4] or "Hz"
    return f"{match[1]} {match[2] or unit}", f"{match[3]} {unit}"


class Bands(Plural[tuple[tuple[float, float], ...]]):
    """Entry of a list of frequency bands, or of one band alone."""

    @property
    def absent(self) -> tuple[tuple[float, float], ...]:
        return ()

    def coerce(self, raw: object) -> tuple[tuple[float, float], ...]:
        one = Band(self.description, from_zero=True)
        if isinstance(raw, list | tuple) and all(_is_band(part) for part in raw):
            return tuple(coerce_part(index, one, part) for index, part in enumerate(raw))
        return (one.coerce(raw),)

    def plain(self, value: tuple[tuple[float, float], ...]) -> list[str]:
        return [Band("").plain(band) for band in value]

    def schema(self) -> Schema:
        return {"type": ["array", "string"], "description": f"{self.description}: {BAND_FORMS}, or a list of these"}

    @property
    def accepted(self) -> str:
        return "str | list[Scalar] | list[float] | list[str] | collections.abc.Sequence[object]"


def _is_band(raw: object) -> bool:
    return isinstance(raw, list | tuple) or (isinstance(raw, str) and _BAND.fullmatch(raw) is not None)
