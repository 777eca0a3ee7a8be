"""Section of a report on the excitation: engines, propellers, and everything else that acts by order."""

from __future__ import annotations

from torsionnet.machinery.excitations.propeller_torque import PropellerTorque
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.report.document_tree import Block, Section
from torsionnet.report.report_cylinders import engine_blocks, state_table
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_orders import other_table, propeller_block


def harmonics_section(subject: ReportData) -> Section | None:
    """Section of a report on the harmonics of all excitations; None for a model without excitations."""
    if not subject.has_excitations or not subject.natural_frequencies:
        return None
    blocks: list[Block] = []
    others: list[tuple[Case, str]] = []
    for name in subject.model.definition.excitations:
        case = _first_acting(subject, name)
        if case is None:
            continue
        excitation = case.drivetrain.definition.excitations[name]
        if isinstance(excitation, ReciprocatingEngine):
            blocks += engine_blocks(subject, case, name, excitation)
        elif isinstance(excitation, PropellerTorque):
            blocks.append(propeller_block(case, name, excitation))
        else:
            others.append((case, name))
    if others:
        blocks.append(other_table(others))
    states = state_table(subject)
    if states is not None:
        blocks.append(states)
    return Section("harmonics", ("Excitation",), tuple(blocks)) if blocks else None


def _first_acting(subject: ReportData, name: str) -> Case | None:
    """First configuration in which an excitation acts; None where it never does."""
    return next((one for one in subject.judged_cases if one.drivetrain.definition.excitations[name].enabled), None)
