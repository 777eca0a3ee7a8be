"""Section of a report with findings of the checks, and results calculated a second way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsionnet.base.errors import Fault, FreeTurningWarning, UsageError
from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import Block, Cell, Heading, Math, NumberText, Paragraph, Remark, Section
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import capital, pair_latex, sentence

COMPARED_FREQUENCIES = 40
"""Number of frequencies at which two ways of calculation are compared, as more take longer and show the same."""


PASSED = (
    "The model passed all checks without an error, a warning or a note: names, units and dimensions, connections, gear "
    "loops, positive values, in every configuration."
)
"""Sentence of the section on the checks where no check found anything."""


def findings(subject: ReportData) -> list[Fault]:
    """Faults that the checks find in the model as written, then in each configuration."""
    found = list(subject.model.check())
    for case in subject.judged_cases:
        known = {fault.message for fault in found}
        found += [
            replace(fault, configuration=fault.configuration or case.configuration)
            for fault in case.drivetrain.check()
            if fault.message not in known
        ]
    return found


def warned(subject: ReportData) -> list[Fault]:
    """Warnings of the calculation of a report, each once; that a free drivetrain drifts off at 0 Hz is no news."""
    told = (one for one in subject.warning_messages if not issubclass(one.category, FreeTurningWarning))
    return [Fault(text, severity="warning") for text in dict.fromkeys(str(one.message) for one in told)]


def checks_section(subject: ReportData) -> Section:
    """Section of a report with the findings of the checks and the comparison of two ways of calculation."""
    found = [*findings(subject), *warned(subject)]
    blocks: list[Block] = []
    if not found:
        blocks.append(Paragraph((PASSED,)))
    blocks += [Remark(fault.severity, sentence(capital(fault.text) + ".", subject.model)) for fault in found]
    rows = list(_comparisons(subject))
    if rows:
        columns = (Heading("Comparison", wide=True), Heading("Largest relative difference", numeric=True))
        blocks.append(table("Results calculated in two ways", columns, rows))
    return Section("checks", ("Checks",), tuple(blocks))


def _comparisons(subject: ReportData) -> Iterator[tuple[Cell, ...]]:
    """Table rows that compare transfer functions by elimination along the drivetrain with a matrix solution."""
    if subject.is_large:
        return
    frequencies = np.geomspace(*subject.band, COMPARED_FREQUENCIES)
    for pair in subject.pairs:
        worst = 0.0
        for case in subject.for_pair(pair).cases:
            try:
                first, second = (
                    case.drivetrain.frequency_response(
                        pair.output, pair.input, frequencies, excitation=pair.excitation or None, method=method
                    ).values
                    for method in ("graph", "dense")
                )
            except UsageError:
                return
            size = np.maximum(np.abs(second), 1e-300)
            worst = max(worst, float(np.max(np.abs(first - second) / size)))
        text = (
            Math(pair_latex(pair)),
            phrase(
                " at {count} frequencies: elimination along the drivetrain, and the matrices",
                count=COMPARED_FREQUENCIES,
            ),
        )
        yield text, NumberText(worst, 1)
