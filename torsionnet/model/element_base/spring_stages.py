"""Entry for the stages of a spring, and for a characteristic whose rows may hold expressions of parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from torsionnet.base.entries.composite import Composite, Listed, Nested
from torsionnet.base.entries.scalars import (
    NumberTable,
    PhysicalQuantity,
    RowColumn,
    read_scalar,
)
from torsionnet.base.entries.spec import EntryError, Json, Plural, Renaming, Schema, Spec
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.packages import imported
from torsionnet.model.element_base.element_entries import QuantityGroup, exact_or_value, shown
from torsionnet.model.element_base.laws import Values

if TYPE_CHECKING:
    from torsionnet.model.element_base.spring_stage import SpringStage

STAGE = "torsionnet.model.element_base.spring_stage:SpringStage"
"""Place of the class of one stage, imported where a spring has stages."""


class SpringStages(
    Composite[tuple["SpringStage", ...]], QuantityGroup[tuple["SpringStage", ...]], Plural[tuple["SpringStage", ...]]
):
    """Entry for the stages of a spring from zero torque on.

    ``[{stiffness: 6 N*m/deg, to: 120 N*m}, {stiffness: 14 N*m/deg}]``.
    """

    is_read_off: ClassVar[bool] = True

    absent: ClassVar[Any] = ()

    @property
    def _listed(self) -> Listed[SpringStage]:
        return Listed(
            self.description,
            Nested("a stage", partial(imported, STAGE), "spring_stage"),
            form="stages as [{stiffness: 6 N*m/deg, to: 120 N*m}, {stiffness: 14 N*m/deg}]",
        )

    def read(self, raw: object) -> tuple[tuple[SpringStage, ...], list[Fault]]:
        stages, faults = self._listed.read(raw)
        if faults or not stages:
            return (), faults or [Fault("expected at least one stage", kind="missing-entry")]
        text = "every stage but the last needs its end; give it as to: with a torque or an angle"
        faults = [
            Fault(text, (place,), on_key=True, kind="missing-entry")
            for place, stage in enumerate(stages[:-1])
            if stage.end is None
        ]
        if not faults and not any(expression.names for _, _, expression, _ in self.quantities(stages)):
            from torsionnet.model.element_base.spring_stage import stage_faults

            faults = stage_faults(stages, Values({}))
        return stages if not faults else (), faults

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return self._listed.entry_specs(raw)

    def renamed(self, value: Any, names: Renaming) -> Any:
        return self._listed.renamed(value, names)

    def quantities(self, value: Any) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        for place, stage in enumerate(value):
            for path, spec, expression, dimension in stage.quantities():
                yield (place, *path), spec, expression, dimension

    def plain(self, value: Any) -> Json:
        return self._listed.plain(value)

    def schema(self) -> Schema:
        return self._listed.schema()

    def definitions(self) -> Schema:
        return self._listed.definitions()

    @property
    def accepted(self) -> str:
        return self._listed.accepted


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

    def quantities(self, value: Any) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
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
    faults = []
    for index, (row, following) in enumerate(pairwise(rows), 1):
        before, here = exact_or_value(row[0], value), exact_or_value(following[0], value)
        if not here > before:
            text = f"the {column.name} must increase from row to row"
            if row[0].names or following[0].names:
                text += f"; here it is {shown(following[0], here)} after {shown(row[0], before)}"
            faults.append(Fault(text, (index, 0), kind="unordered-rows"))
    return faults
