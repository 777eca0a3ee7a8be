"""Entry for a characteristic whose rows may hold expressions of parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

from torsionnet.core.entries.number_table import NumberTable, RowColumn
from torsionnet.core.entries.scalars import PhysicalQuantity, read_scalar
from torsionnet.core.entries.spec import EntryError, Spec
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Expression, Number
from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.quantity_group import QuantityGroup, exact_or_value, shown

ExpressionRows: TypeAlias = tuple[tuple[Expression, ...], ...]
"""Type of the rows of expressions of a table."""
NumberRows: TypeAlias = tuple[tuple[Any, ...], ...]
"""Type of the rows of a table in numbers of one algebra."""


@dataclass(frozen=True, eq=False, repr=False)
class QuantityRows(NumberTable[ExpressionRows], QuantityGroup[ExpressionRows]):
    """Entry for rows ``[[0 rad, 0 N*m], [phi_1, T_1]]`` of numbers or expressions of parameters.

    Numbers of the first column rise from row to row; that expressions do :func:`row_order_faults` tells.
    """

    fewest: int = 2

    def coerce(self, raw: object) -> ExpressionRows:
        rows = tuple(self._row(row, index) for index, row in enumerate(self.listed(raw)))
        if not has_names(rows):
            faults = row_order_faults(self.columns[0], rows, Values({}))
            if faults:
                raise EntryError(faults)
        return rows

    def _cell(self, cell: object, index: int, place: int) -> Any:
        try:
            value = cell if isinstance(cell, Expression) else read_scalar(cell, self.columns[place].dimension)
        except EntryError as error:
            raise EntryError(error.fault.under(index, place)) from None
        return super()._cell(value, index, place) if isinstance(value, Number) else value

    def quantities(self, value: Any) -> Iterator[tuple[Path, Spec[object], Expression, str]]:
        specs = [_quantity(column) for column in self.columns]
        for index, row in enumerate(value):
            for place, cell in enumerate(row):
                yield (index, place), specs[place], cell, self.columns[place].dimension


def _quantity(column: RowColumn) -> PhysicalQuantity:
    """Specification of a single value in a column."""
    lower = None if column.negative else 0.0
    return PhysicalQuantity(column.name, column.dimension, lower=lower, exclusive=not column.zero)


def has_names(rows: ExpressionRows) -> bool:
    """Whether rows hold expressions of parameters, so that they are numbers only with the values of these."""
    return any(cell.names for row in rows for cell in row)


def numbers_of(rows: ExpressionRows, value: Values) -> NumberRows:
    """Rows as exact fractions, where a cell is an expression as a number of the algebra of ``value``."""
    return tuple(tuple(exact_or_value(cell, value) for cell in row) for row in rows)


def row_order_faults(column: RowColumn, rows: ExpressionRows, value: Values) -> list[Fault]:
    """Faults of rows whose first column does not rise, with their path in the table."""
    found = []
    for index, (row, following) in enumerate(pairwise(rows), 1):
        before, here = exact_or_value(row[0], value), exact_or_value(following[0], value)
        if not here > before:
            text = f"the {column.name} must increase from row to row"
            if row[0].names or following[0].names:
                text += f"; here it is {shown(following[0], here)} after {shown(row[0], before)}"
            found.append(Fault(text, (index, 0)))
    return found
