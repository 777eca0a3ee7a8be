"""Entry of a study file for a whole number that may be large."""

from __future__ import annotations

from torsionnet.base.entries.spec import Count


class Many(Count):
    """Entry for a whole number within bounds that may be written as 1e6."""

    def coerce(self, raw: object) -> int:
        return super().coerce(int(raw) if isinstance(raw, float) and raw.is_integer() else raw)
