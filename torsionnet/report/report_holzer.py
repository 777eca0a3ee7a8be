"""Holzer tables of modes as tables of a report, all quantities referred to one shaft."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice

from torsionnet.base.phrases import phrase
from torsionnet.base.table import Table
from torsionnet.machinery.holzer.holzer_table import DISTRIBUTED, NEGLIGIBLE_TORQUE, HolzerStation, HolzerTable
from torsionnet.report.document_tree import Cell, NumberText, TableBlock, TableGroup
from torsionnet.report.report_tables import results_table
from torsionnet.report.report_text import as_words

SHORT_HEADINGS = {"J referred": "J", "k referred": "k", "sum of torque": "sum", DISTRIBUTED: "shafts"}
"""Shorter headings of a Holzer table in which all values are referred to one shaft."""
REAL_COLUMNS = ("J", "k")
"""Headings of the Holzer table's columns with values at a shaft's own speed, beside which it has referred ones."""
CLOSING_DIGITS, OWN_DIGITS = 7, 6
"""Digits of the largest angle or torque of a Holzer table, and of each other number, with which its sums close."""
ANGLES_AND_TORQUES = ("rad", "N·m", "kN·m", "MN·m")
"""Units of the columns of a Holzer table whose digits must close."""
DISTRIBUTED_NOTE = (
    "Shafts: torque of their own inertia, ω² times the sum of M θ over both ends, which J ω² θ leaves out; J is that "
    "of the masses alone. The sum of torques is k times the twist, and θ less the twist is that of the next station. "
    "The stress is the largest along a shaft."
)
CLOSING_NOTE = "The sum of torques is k times the twist, and θ less the twist is that of the next station."

ROUNDED_AMPLITUDE = 1e-9
"""Amplitude over the largest of a mode below which a mass stands still: rounding errors are smaller."""


def holzer_block(holzer: HolzerTable, stress_unit: str = "MPa") -> TableBlock:
    """Table of a report with the stations of a Holzer table, with a group of rows for each branch.

    Branches that stand still are left out; ``stress_unit`` is the name of 10^6 Pa in the heading. Numbers have the
    digits with which each row closes when it is calculated again from what is printed.
    """
    shown_table = _without_rounding(holzer.whole_shafts())
    moving = [branch for branch in shown_table.branches if any(column.amplitude for column in branch.stations)]
    shown_table = replace(shown_table, branches=tuple(moving) or shown_table.branches)
    made = _short(shown_table.table(referred=True))  # the number of the branch in front, for stations that look alike
    columns = tuple(replace(column, unit=stress_unit) if column.unit == "MPa" else column for column in made.columns)
    node = shown_table.branches[0].stations[0].node
    caption = phrase(
        "Holzer table of mode {number}, {frequency:.5g} Hz, ω² = {square:.7g} 1/s²; 1 rad at {first}, referred to "
        "{node}",
        number=shown_table.mode,
        frequency=shown_table.frequency,
        square=(2 * math.pi * shown_table.frequency) ** 2,
        first=phrase("the mass that moves most") if shown_table.first_rests else as_words(node),
        node=as_words(shown_table.referred_to),
    )
    explained = DISTRIBUTED_NOTE if shown_table.has_distributed else CLOSING_NOTE
    made = replace(made, columns=columns, notes=(explained, *shown_table.notes))
    block = _with_closing_digits(results_table(made, caption))
    cells = iter(row[1:] for row in block.groups[0].rows)
    several = len(shown_table.branches) > 1
    groups = [
        TableGroup(tuple(islice(cells, len(column.stations))), as_words(column.title) if several else "")
        for column in shown_table.branches
    ]
    return replace(block, columns=block.columns[1:], groups=tuple(groups))


def _with_closing_digits(block: TableBlock) -> TableBlock:
    """Copy of a Holzer table with decimals of angles and torques by the largest of them, others with their own."""
    (group,) = block.groups
    # A twist is small beside the angles, but k times the twist is the torque: it has digits of its own.
    places = {
        unit: [at for at, column in enumerate(block.columns) if column.unit == unit and column.text != "Twist"]
        for unit in ANGLES_AND_TORQUES
    }
    decimals: dict[int, int] = {}
    for columns in places.values():
        cells = [row[at] for row in group.rows for at in columns]
        sizes = [abs(cell.value) for cell in cells if isinstance(cell, NumberText) and cell.value]
        largest = math.floor(math.log10(max(sizes, default=1.0)))
        decimals |= dict.fromkeys(columns, max(0, CLOSING_DIGITS - 1 - largest))

    def closing(at: int, cell: Cell) -> Cell:
        if not isinstance(cell, NumberText) or block.columns[at].text == "Stress":
            return cell
        return replace(cell, digits=OWN_DIGITS, decimals=decimals.get(at) if cell.value else None)

    rows = tuple(tuple(closing(at, cell) for at, cell in enumerate(row)) for row in group.rows)
    return replace(block, groups=(replace(group, rows=rows),))


def _without_rounding(holzer: HolzerTable) -> HolzerTable:
    """Copy of a Holzer table in which masses that only rounding moves stand still."""
    stations = [station for branch in holzer.branches for station in branch.stations]
    least = ROUNDED_AMPLITUDE * max(abs(station.amplitude) for station in stations)
    # Where a branch ends, the sum of its torques is 0 but for rounding.
    torque = NEGLIGIBLE_TORQUE * max(abs(station.torque) for station in stations)

    def cleaned(station: HolzerStation) -> HolzerStation:
        link = station.link
        if link is not None and abs(station.torque) <= torque:
            link = replace(link, twist=0.0, stress=link.stress if math.isnan(link.stress) else 0.0)
        joined, distributed = (part if abs(part) > torque else 0.0 for part in (station.joined, station.distributed))
        moves = abs(station.amplitude) > least
        amplitude, inertia_torque = (station.amplitude, station.inertia_torque) if moves else (0.0, 0.0)
        return replace(
            station,
            link=link,
            joined=joined,
            distributed=distributed,
            amplitude=amplitude,
            inertia_torque=inertia_torque,
        )

    branches = tuple(replace(station, stations=tuple(map(cleaned, station.stations))) for station in holzer.branches)
    return replace(holzer, branches=branches)


def _short(branch: Table) -> Table:
    """Table of Holzer stations without values at a shaft's own speed, under short headings."""
    kept = branch.chosen([index for index, column in enumerate(branch.columns) if column.name not in REAL_COLUMNS])
    names = tuple(replace(column, name=SHORT_HEADINGS.get(column.name, column.name)) for column in kept.columns)
    return replace(kept, columns=names)
