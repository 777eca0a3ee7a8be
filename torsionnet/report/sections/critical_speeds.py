"""Section of a report on critical speeds, with crossings of orders and modes and Holzer tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import Block, Details, Paragraph, Picture, Section
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_holzer import holzer_blocks
from torsionnet.report.report_tables import results_table
from torsionnet.report.report_text import distinct_choices, shared_choices

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds

MOST_DRAWN, MOST_HOLZER_TABLES = 3, 4
"""Largest number of drivetrains whose interference diagram is drawn, and of modes whose Holzer table is printed."""
MOST_ROWS = 30
"""Largest number of crossings of orders and modes in a table of the report; of more, those with the largest generalised
force are kept."""
LEFT_OUT_COLUMNS = ("on its shaft", "amplifi- cation")
"""Headings of columns that the report leaves out, as a page has no room for them."""
CROSSINGS = (
    "A critical speed is one at which an order meets a natural frequency. Damping shifts natural frequencies: both the "
    "undamped and the damped one are given. A crossing that is not excited in one condition may be in another, as with "
    "a misfire."
)


def critical_speeds_section(subject: ReportData) -> Section | None:
    """Section of a report on critical speeds, at which orders meet natural frequencies.

    None for a model without excitations.
    """
    if not subject.has_excitations:
        return None
    blocks: list[Block] = [Paragraph((CROSSINGS, *subject.coverage_note))]
    for number, cases in enumerate(subject.distinct_drivetrains, 1):
        blocks += _of_drivetrain(cases, number, several=len(subject.distinct_drivetrains) > 1)
    return Section("critical_speeds", ("Critical speeds",), tuple(blocks))


def _of_drivetrain(cases: tuple[Case, ...], number: int, *, several: bool) -> list[Block]:
    """Tables and diagram of critical speeds of one drivetrain, with the conditions that excite each crossing."""
    names = [case.configuration for case in cases]
    runs = [
        replace(case.drivetrain.critical_speeds(), condition=distinct_choices(case.configuration, names))
        for case in cases
    ]
    found = runs[0].in_conditions(runs) if len(runs) > 1 else runs[0]
    where = phrase(" in configuration {name}", name=shared_choices(names)) if several and names[0] else ""
    excited, others = _split(found, len(runs))
    blocks: list[Block] = [
        results_table(_reached(found), phrase("Natural frequencies without and with damping{where}", where=where))
    ]
    if number <= MOST_DRAWN:
        blocks.append(_crossings_diagram(found, number, where))
    chosen = _largest(excited, runs)
    few = (
        phrase(", the {count} with the largest generalised force", count=MOST_ROWS)
        if len(excited.crossings) > MOST_ROWS
        else ""
    )
    blocks.append(results_table(_narrow(chosen), phrase("Critical speeds{where}{few}", where=where, few=few)))
    if others.crossings:
        rest = results_table(
            _narrow(_largest(others, runs)),
            phrase("Crossings that no condition here excites{where}", where=where),
            notes=False,
        )
        count = len(others.crossings)
        instead = (phrase("{count} further crossings are not excited in these conditions.", count=count),)
        blocks.append(Details(("Crossings that are not excited",), (rest,), instead))
    if number == 1:
        blocks += _holzer_tables(cases[0], excited)
    return blocks


def _reached(found: CriticalSpeeds) -> Table:
    """Table of modes up to the highest that any order meets, and one more; of overdamped modes those that are met."""
    met = {one.mode.number for one in found.crossings}
    swings = [one.number for one in found.modes if not math.isnan(one.natural_frequency)]
    last = max(met.intersection(swings), default=MOST_HOLZER_TABLES) + 1
    kept = tuple(one for one in found.modes if one.number in met or (one.number in swings and one.number <= last))
    return replace(found, modes=kept).mode_table()


def _largest(found: CriticalSpeeds, runs: Sequence[CriticalSpeeds]) -> CriticalSpeeds:
    """Critical speeds with the largest generalised force in any condition, in the order of modes."""
    forces: dict[tuple[object, ...], float] = {}
    for one in (one for run in runs for one in run.crossings):
        forces[_place(one)] = max(forces.get(_place(one), 0.0), _force(one))
    sizes = sorted((forces[_place(one)] for one in found.crossings), reverse=True)
    least = sizes[MOST_ROWS - 1] if len(sizes) >= MOST_ROWS else 0.0
    return replace(found, crossings=tuple(one for one in found.crossings if forces[_place(one)] >= least))


def _force(one: CriticalSpeed) -> float:
    """Generalised force of a crossing in N m, infinite for an imposed motion, which has none and is never left out."""
    return math.inf if math.isnan(one.generalised_force) else one.generalised_force


def _place(one: CriticalSpeed) -> tuple[object, ...]:
    return one.mode.number, one.excitation, one.order, one.fixed


def _narrow(found: CriticalSpeeds) -> Table:
    table = found.table()
    return table.chosen([index for index, column in enumerate(table.columns) if column.name not in LEFT_OUT_COLUMNS])


def _split(found: CriticalSpeeds, conditions: int) -> tuple[CriticalSpeeds, CriticalSpeeds]:
    """Critical speeds that some condition excites, and critical speeds that none excites."""
    acts = [one.excited is not False or (conditions > 1 and bool(one.excited_in)) for one in found.crossings]
    pairs = list(zip(found.crossings, acts, strict=True))
    return (
        replace(found, crossings=tuple(one for one, excited in pairs if excited)),
        replace(found, crossings=tuple(one for one, excited in pairs if not excited)),
    )


def _crossings_diagram(found: CriticalSpeeds, number: int, where: str) -> Picture:
    from torsionnet.plot.interference_plot import interference_diagram

    caption = (phrase("Interference diagram{where}: natural frequencies and orders over speed.", where=where),)
    alt = f"Interference diagram{where}: {len(found.modes)} modes, {len(found.crossings)} crossings"
    return Picture(f"interference_{number}", interference_diagram(found, title=""), caption, alt)


def _holzer_tables(case: Case, excited: CriticalSpeeds) -> list[Block]:
    """Holzer tables of the lowest modes that any excitation reaches."""
    modes = sorted({one.mode.number for one in excited.crossings})[:MOST_HOLZER_TABLES]
    return [block for mode in modes for block in holzer_blocks(case.drivetrain.holzer_table(mode))]
