"""Holzer tables of modes as tables of a report, all quantities referred to one shaft."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.report.document_tree import TableBlock
from torsionnet.report.report_tables import results_table
from torsionnet.report.report_text import as_words
from torsionnet.response.holzer_table import HolzerTable
from torsionnet.response.table import Column

SHORT_HEADINGS = {"J referred": "J", "k referred": "k", "sum of torque": "sum"}
"""Shorter headings of a Holzer table in which all values are referred to one shaft."""
REAL_COLUMNS = ("J", "k")
"""Headings of the Holzer table's columns with values at a shaft's own speed, beside which it has referred ones."""


def holzer_blocks(holzer: HolzerTable, stress_unit: str = "MPa") -> list[TableBlock]:
    """Tables of a report with the stations of a Holzer table, one for each branch.

    ``stress_unit`` is the name of 10^6 Pa in the heading.
    """
    first = as_words(holzer.branches[0].stations[0].node)
    blocks = []
    for place, branch in enumerate(holzer.tables(referred=True), 1):
        part = f", branch {place}" if len(holzer.branches) > 1 else ""
        kept = branch.chosen([index for index, one in enumerate(branch.columns) if one.name not in REAL_COLUMNS])
        shown = replace(kept, columns=tuple(_column(one, stress_unit) for one in kept.columns))
        what = f"Holzer table of mode {holzer.mode}, {holzer.frequency:.5g} Hz{part}; 1 rad at {first}"
        blocks.append(results_table(shown, f"{what}, referred to {as_words(holzer.referred_to)}"))
    return blocks


def _column(one: Column, stress_unit: str) -> Column:
    return replace(
        one, name=SHORT_HEADINGS.get(one.name, one.name), unit=stress_unit if one.unit == "MPa" else one.unit
    )
