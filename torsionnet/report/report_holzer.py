"""Holzer tables of modes as tables of a report, all quantities referred to one shaft."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice

from torsionnet.base.phrases import phrase
from torsionnet.base.table import Table
from torsionnet.machinery.holzer.holzer_table import NEGLIGIBLE_TORQUE, HolzerStation, HolzerTable
from torsionnet.report.document_tree import TableBlock, TableGroup
from torsionnet.report.report_tables import results_table
from torsionnet.report.report_text import as_words

SHORT_HEADINGS = {"J referred": "J", "k referred": "k", "sum of torque": "sum"}
"""Shorter headings of a Holzer table in which all values are referred to one shaft."""
REAL_COLUMNS = ("J", "k")
"""Headings of the Holzer table's columns with values at a shaft's own speed, beside which it has referred ones."""


ROUNDED_AMPLITUDE = 1e-9
"""Amplitude over the largest of a mode below which a mass stands still: rounding errors are smaller."""


def holzer_blocks(holzer: HolzerTable) -> list[TableBlock]:
    """Tables of a report with the stations of a Holzer table, one for each branch."""
    first = as_words(holzer.branches[0].stations[0].node)
    blocks = []
    for place, branch in enumerate(holzer.tables(referred=True), 1):
        part = phrase(", branch {number}", number=place) if len(holzer.branches) > 1 else ""
        caption = phrase(
            "Holzer table of mode {number}, {frequency:.5g} Hz{branch}; 1 rad at {first}, referred to {node}",
            number=holzer.mode,
            frequency=holzer.frequency,
            branch=part,
            first=first,
            node=as_words(holzer.referred_to),
        )
        blocks.append(results_table(_short(branch), caption))
    return blocks


def holzer_block(holzer: HolzerTable, stress_unit: str = "MPa") -> TableBlock:
    """Table of a report with the stations of a Holzer table, with a group of rows for each branch.

    Branches that stand still are left out; ``stress_unit`` is the name of 10^6 Pa in the heading.
    """
    found = _without_rounding(holzer)
    moving = [branch for branch in found.branches if any(one.amplitude for one in branch.stations)]
    found = replace(found, branches=tuple(moving) or found.branches)
    made = _short(found.table(referred=True))  # the number of the branch in front, for stations that look alike
    columns = tuple(replace(one, unit=stress_unit) if one.unit == "MPa" else one for one in made.columns)
    node = found.branches[0].stations[0].node
    caption = phrase(
        "Holzer table of mode {number}, {frequency:.5g} Hz; 1 rad at {first}, referred to {node}",
        number=found.mode,
        frequency=found.frequency,
        first=phrase("the mass that moves most") if found.first_rests else as_words(node),
        node=as_words(found.referred_to),
    )
    made = replace(made, columns=columns, notes=found.notes)
    block = results_table(made, caption)
    cells = iter(row[1:] for row in block.groups[0].rows)
    several = len(found.branches) > 1
    groups = [
        TableGroup(tuple(islice(cells, len(one.stations))), as_words(one.title) if several else "")
        for one in found.branches
    ]
    return replace(block, columns=block.columns[1:], groups=tuple(groups))


def _without_rounding(holzer: HolzerTable) -> HolzerTable:
    """Copy of a Holzer table in which masses that only rounding moves stand still."""
    stations = [one for branch in holzer.branches for one in branch.stations]
    least = ROUNDED_AMPLITUDE * max(abs(one.amplitude) for one in stations)
    torque = NEGLIGIBLE_TORQUE * max(abs(one.torque) for one in stations)

    def cleaned(one: HolzerStation) -> HolzerStation:
        link = one.link
        if link is not None and abs(one.torque) <= torque:
            link = replace(link, twist=0.0, stress=link.stress if math.isnan(link.stress) else 0.0)
        joined = one.joined if abs(one.joined) > torque else 0.0
        moves = abs(one.amplitude) > least
        amplitude, inertia_torque = (one.amplitude, one.inertia_torque) if moves else (0.0, 0.0)
        return replace(one, link=link, joined=joined, amplitude=amplitude, inertia_torque=inertia_torque)

    branches = tuple(replace(one, stations=tuple(map(cleaned, one.stations))) for one in holzer.branches)
    return replace(holzer, branches=branches)


def _short(branch: Table) -> Table:
    """Table of Holzer stations without values at a shaft's own speed, under short headings."""
    kept = branch.chosen([index for index, one in enumerate(branch.columns) if one.name not in REAL_COLUMNS])
    names = tuple(replace(one, name=SHORT_HEADINGS.get(one.name, one.name)) for one in kept.columns)
    return replace(kept, columns=names)
