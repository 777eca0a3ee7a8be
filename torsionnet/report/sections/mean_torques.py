"""Section of a report on mean torques, stresses and power under the load."""

from __future__ import annotations

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.report.cylinders_out import all_working
from torsionnet.report.document_tree import Block, Section
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import results_table

MOST_LOADS = 3
"""Largest number of loads whose mean torques a report lists."""


def mean_torques_section(subject: ReportData) -> Section | None:
    """Section of a report on mean torques and stresses under the load; None for a model without a load."""
    definition = subject.model.definition
    if definition.load is None or definition.speeds is None:
        return None
    blocks: list[Block] = []
    shown: list[object] = []
    for case in all_working(subject.cases):
        try:
            state = case.drivetrain.static_state()
        except UsageError:  # what drives or absorbs is switched off in this configuration
            continue
        if state.loads not in shown and len(shown) < MOST_LOADS:
            where = (
                phrase(" in configuration {name}", name=case.configuration)
                if case.configuration and len(subject.cases) > 1
                else ""
            )
            shown.append(state.loads)
            blocks.append(
                results_table(
                    state.table(subject.conventions), phrase("Mean torques of the elements{where}", where=where)
                )
            )
    return Section("mean_torques", ("Mean torques and stresses",), tuple(blocks)) if blocks else None
