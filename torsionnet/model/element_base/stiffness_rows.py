"""Entry for the rows of a measured dynamic stiffness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from torsionnet.base.entries.scalars import NumberTable, RowColumn
from torsionnet.base.entries.spec import Json, full_name
from torsionnet.model.element_base.stiffness_table import StiffnessTable


@dataclass(frozen=True, eq=False, repr=False)
class TableEntry(NumberTable[StiffnessTable]):
    """Entry for rows [frequency, stiffness, damping] of a measured dynamic stiffness."""

    columns: tuple[RowColumn, ...] = (
        RowColumn("frequency", "frequency", negative=False),
        RowColumn("stiffness", "stiffness", negative=False),
        RowColumn("damping", "damping"),
    )

    def coerce(self, raw: object) -> StiffnessTable:
        if isinstance(raw, StiffnessTable):
            return raw
        columns = zip(*self.rows(raw), strict=True)
        return StiffnessTable(*(tuple(float(cell.value) for cell in column) for column in columns))

    def plain(self, value: Any) -> Json:
        return [list(row) for row in zip(value.frequencies, value.stiffness, value.damping, strict=True)]

    @property
    def accepted(self) -> str:
        return f"{full_name(StiffnessTable)} | {super().accepted}"
