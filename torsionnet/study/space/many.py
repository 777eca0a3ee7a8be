"""A number of variants, which may be large."""

from __future__ import annotations

from torsionnet.core.entries.words import Count


class Many(Count):
    """A whole number in a range, which may be written as 1e6."""

    def coerce(self, raw: object) -> int:
        return super().coerce(int(raw) if isinstance(raw, float) and raw.is_integer() else raw)
