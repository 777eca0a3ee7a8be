"""Characteristics: rows of plain numbers over one of them, straight between the rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.core.entries.number_table import NumberTable
from torsionnet.core.piecewise_linear import Rows


@dataclass(frozen=True, eq=False, repr=False)
class Characteristic(NumberTable[Rows]):
    """A function of an operating value: two rows or more, read by :mod:`torsionnet.core.piecewise_linear`."""

    is_read_off: ClassVar[bool] = True

    fewest: int = 2

    def coerce(self, raw: object) -> Rows:
        return self.rows(raw)
