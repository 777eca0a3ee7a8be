"""Excitation by a recorded torque or motion of a node."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed, Nested
from torsionnet.base.entries.declared import Declared, nearby_file
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, Json, Schema, Text, entry
from torsionnet.base.errors import EntryPath, Fault, ModelError, UsageError
from torsionnet.machinery.excitations.measured_columns import FORM, POWERS, MeasuredLines, measured_lines
from torsionnet.machinery.excitations.order_excitation import (
    FloatArray,
    OrderTorques,
    ReactingExcitation,
    register_excitation,
)
from torsionnet.machinery.excitations.order_table_file import read_order_table
from torsionnet.machinery.excitations.speed_table import not_covered
from torsionnet.model.element_base.element_entries import NodeName

_NUMBER = Value("a number in the unit of its column", "1", lower=None)


@dataclass(frozen=True, kw_only=True)
class OrderTable(Declared):
    """Rows of recorded values by order or frequency, with or without speeds, under headings with units."""

    kind: ClassVar[str] = "table"
    article: ClassVar[str] = "a table"
    form: ClassVar[str] = f"{{columns: [{FORM}], rows: [[2, 35, 0], [4, 8, 90]]}}"

    columns: tuple[str, ...] = entry(
        Listed(
            "headings: order or frequency, speed; amplitude, rms or peak_to_peak, phase; or real and imag",
            Text("a heading", "a heading"),
            "a list of headings",
        )
    )
    rows: tuple[tuple[float, ...], ...] = entry(
        Listed("rows of numbers", Listed("numbers", _NUMBER, "a row of numbers"), "a list of rows")
    )

    def contradictions(self) -> list[Fault]:
        if not self.rows:
            return [Fault(f"a table has rows: {self.form}", ("rows",), on_key=True)]
        for index, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                text = f"the row has {len(row)} numbers, there are {len(self.columns)} columns"
                return [Fault(text, ("rows", index))]
        try:
            self.lines  # noqa: B018
        except UsageError as error:
            return [Fault(str(error), ("columns",), on_key=True)]
        return []

    @cached_property
    def lines(self) -> MeasuredLines:
        """Lines of the table by order or frequency, with their peak values over speed."""
        return measured_lines(self.columns, np.array(self.rows, dtype=float))


class OrderTableEntry(Nested[OrderTable]):
    """Entry for a table of orders or for the name of its file; written models hold the numbers."""

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        if not isinstance(raw, str | Path):
            return super().read(raw)
        try:
            columns, rows = read_order_table(raw if isinstance(raw, Path) else nearby_file(raw))
        except EntryError as error:
            return None, error.faults
        except ModelError as error:
            return None, list(error.faults)
        return OrderTable(columns=columns, rows=rows), []

    def definitions(self) -> Schema:
        found = super().definitions()
        either: list[Json] = [{"type": "string"}, found[self.name]]
        return {**found, self.name: {"description": self.description, "anyOf": either}}


@register_excitation
@dataclass(frozen=True, kw_only=True)
class MeasuredExcitation(ReactingExcitation):
    """A torque or a motion on a node as it was recorded, by order or by frequency.

    Amplitudes are peak values unless the column says ``rms`` or ``peak_to_peak``; phases are those of a cosine,
    amplitude * cos(order * phi + phase). A recorded motion is imposed on the node. Without a column of speeds the table
    holds at all of them; with it, amplitude and phase run straight between the speeds of each order.

    Examples
    --------
    >>> pump = MeasuredExcitation(node="pump", table={"columns": ["order", "speed [rpm]", "amplitude [N*m]"],
    ...     "rows": [[7, 600, 10], [7, 900, 40]]})
    >>> pump.torques(np.array([750 * np.pi / 30])).amplitudes.real.round(9).tolist()
    [[[25.0]]]
    """

    kind: ClassVar[str] = "measured"

    node: str = entry(NodeName("the node it acts on", allow_ground=False))
    speed_of: str | None = entry(
        NodeName("the shaft of the orders and speeds; default: node", allow_ground=False), None
    )
    table: OrderTable = entry(
        OrderTableEntry(
            "the recording: a file such as orders.csv, or its numbers",
            lambda: OrderTable,
            "order_table",
            shown="orders.csv",
        )
    )

    @property
    def shaft(self) -> str:
        return str(self.speed_of or self.node)

    @property
    def quantity(self) -> str:
        return "torque" if self.table.lines.quantity == "torque" else "angle"

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        return ((("node",), self.node),)

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        lines = self.table.lines
        for key, at in zip(lines.keys.tolist(), lines.speeds, strict=bool(lines.speeds)):
            named = ("table", "rows", f"{'frequency' if lines.by_frequency else 'order'} {key:g}")
            faults = not_covered({named: tuple((float(speed), 0.0) for speed in at)}, speeds)
            if faults:
                return [Fault(faults[0].message, ("table", "rows"), on_key=True)]
        return []

    def torques(self, speeds: FloatArray) -> OrderTorques:
        faults = self.remarks(speeds)
        if faults:
            raise UsageError(faults[0].message)
        lines = self.table.lines
        none = np.zeros(len(lines.keys))
        orders, fixed = (none, lines.keys) if lines.by_frequency else (lines.keys, none)
        omega = speeds[:, None] * orders + 2 * np.pi * fixed
        found = np.stack([lines.at(place, speeds) for place in range(len(lines.keys))], axis=1)
        amplitudes = found / (1j * omega) ** POWERS[lines.quantity]
        return OrderTorques(orders, self.nodes, amplitudes[:, :, None], fixed=fixed)
