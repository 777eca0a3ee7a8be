"""Entry for a characteristic, rows of plain numbers interpolated linearly over the first column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import NumberTable
from torsionnet.base.expressions import Rows


@dataclass(frozen=True, eq=False, repr=False)
class Characteristic(NumberTable[Rows]):
    """Entry for a function of an operating value, given by rows of plain numbers.

    There are two rows or more, interpolated linearly.
    """

    is_read_off: ClassVar[bool] = True

    fewest: int = 2

    def coerce(self, raw: object) -> Rows:
        return self.rows(raw)
