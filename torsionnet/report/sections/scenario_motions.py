"""Section of a report on the motion over time under the scenarios of the model."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.phrases import extended, phrase
from torsionnet.motion.motion_summary import energy_table, event_table, peak_table
from torsionnet.report.document_tree import Block, Paragraph, Picture, Remark, Section
from torsionnet.report.report_data import FEW_CASES, MOST_OUTPUTS, Case, ReportData
from torsionnet.report.report_tables import results_table
from torsionnet.report.report_text import capital

MOST_SCENARIOS = 6
"""Largest number of scenarios that a report shows, each with a table and a picture."""
WHAT_IS_SHOWN = "Peaks are those of the samples, with the times at which they occur."
"""Sentence that says what the tables on scenarios hold."""


def scenarios_section(subject: ReportData) -> Section | None:
    """Section of a report on the motion under scenarios; None for a model without scenarios."""
    names = list(subject.model.definition.scenarios)[:MOST_SCENARIOS]
    blocks = [block for name in names for case in subject.cases[:FEW_CASES] for block in _scenario(subject, case, name)]
    if not blocks:
        return None
    return Section("scenarios", ("Motion over time",), (Paragraph((WHAT_IS_SHOWN,)), *blocks))


def _scenario(subject: ReportData, case: Case, name: str) -> Iterator[Block]:
    """Blocks of the report on one scenario: what happens, peaks, events and energies, and the signals drawn."""
    from torsionnet.plot.scenario_motion_plot import scenario_motion

    several = case.configuration and len(subject.cases) > 1
    where = phrase(" in configuration {name}", name=case.configuration) if several else ""
    try:
        record = case.drivetrain.simulate(scenario=name)
    except TorsionnetError as error:
        yield Remark(
            "warning",
            (
                phrase(
                    "The scenario {name}{where} could not be simulated: {reason}", name=name, where=where, reason=error
                ),
            ),
        )
        return
    words = case.drivetrain.definition.scenarios[name].words
    yield Paragraph(tuple(extended(capital(str(one)), ". ") for one in (words, *record.notes)))
    yield results_table(
        peak_table(record, ""),
        phrase("Peaks in the scenario {name}{where}", name=name, where=where),
        notes=False,
        words=str,
    )
    if record.events:
        yield results_table(
            event_table(record.events),
            phrase("Events in the scenario {name}{where}", name=name, where=where),
            words=str,
        )
    energy = energy_table(record)
    if energy is not None and energy.rows:
        yield results_table(energy, phrase("Energies in the scenario {name}{where}", name=name, where=where), words=str)
    shown = list(dict.fromkeys((*record.names[:1], *record.names[-MOST_OUTPUTS:])))
    drawn = scenario_motion(record, shown, conventions=subject.conventions, title="")
    caption = phrase("The scenario {name}{where}: signals over time, events as dashed lines.", name=name, where=where)
    number = subject.cases.index(case) + 1
    yield Picture(f"scenario_{name}_{number}", drawn, (caption,), caption)
