"""Tables of a study's results in the units in which its author wrote the numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from torsionnet.base.table import Column, Table
from torsionnet.study.shown_units import ShownUnits

UNIT = "unit"
"""Heading of a table's column of units, which belong to the numbers beside it."""


def in_shown_units(found: Table, units: ShownUnits) -> Table:
    """Table of a study's results in the units of its author, by the names in its headings or in its rows.

    Examples
    --------
    >>> table = Table("peaks", (Column("theta", "rad"), Column("mode")), ((0.5, 1),))
    >>> shown = in_shown_units(table, ShownUnits({"theta": "mrad"}, {"theta": "rad"}))
    >>> shown.columns[0].unit, shown.rows[0]
    ('mrad', (500.0, 1))
    """
    scales = _column_scales(found.columns, units)
    columns = tuple(replace(one, unit=unit) for one, (_, unit) in zip(found.columns, scales, strict=True))
    rows = tuple(
        tuple(_scaled(value, scale) for value, (scale, _) in zip(row, scales, strict=True)) for row in found.rows
    )
    places = [place for place, one in enumerate(found.columns) if one.name == UNIT]
    if places:
        rows = tuple(_row(row, places, units) for row in rows)
    return _units_in_headings(replace(found, columns=columns, rows=rows), places)


def _units_in_headings(found: Table, places: Sequence[int]) -> Table:
    """Table in which a unit that is the same in all rows stands in the headings instead of a column of its own."""
    same = {place: found.rows[0][place] for place in places if len({row[place] for row in found.rows}) == 1}
    columns = list(found.columns)
    for place, one in enumerate(columns):
        at = _unit_of(place, places)
        if at in same and any(isinstance(row[place], float) for row in found.rows):
            columns[place] = replace(one, unit=same[at])
    kept = [place for place in range(len(columns)) if place not in same]
    return replace(found, columns=tuple(columns)).chosen(kept)


def _unit_of(place: int, places: Sequence[int]) -> int:
    """Index of the column of units that belongs to a column of numbers, -1 without any.

    The next one, behind all of them the last.
    """
    return next((one for one in places if one >= place), places[-1]) if places else -1


def _column_scales(columns: Sequence[Column], units: ShownUnits) -> list[tuple[float, str]]:
    """Factor and unit in which every column of a table is shown.

    A column without a unit of its own name takes the one of equal SI unit.
    """
    named = {one.unit: one.name for one in columns if one.unit and units.si.get(one.name) == one.unit}
    found = []
    for one in columns:
        name = one.name if units.si.get(one.name) == one.unit else named.get(one.unit)
        known = bool(one.unit) and name is not None
        found.append((units.scale(name), units.unit(name)) if known and name else (1.0, one.unit))
    return found


def _row(row: tuple[Any, ...], places: Sequence[int], units: ShownUnits) -> tuple[Any, ...]:
    """Row of a table with units in it, converted to the units of the study."""
    names = [value for value in row if isinstance(value, str) and value in units.si]
    shown = list(row)
    for place, value in enumerate(row):
        at = _unit_of(place, places)
        meant = {(units.unit(one), units.scale(one)) for one in names if units.si[one] == row[at]}
        if len(meant) == 1:  # otherwise it is open which of them the numbers are of
            unit, scale = meant.pop()
            shown[place] = unit if place in places else _scaled(value, scale)
    return tuple(shown)


def _scaled(value: Any, scale: float) -> Any:
    return value * scale if isinstance(value, float) else value
