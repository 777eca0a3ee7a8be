"""Table of a report with the separation margins of a train from shaft speeds and electrical frequencies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.machinery.verdicts.margin_rules import PRESETS
from torsionnet.report.document_tree import Block, Cell, Heading, NumberText, TableBlock
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, shared_choices

if TYPE_CHECKING:
    from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds
    from torsionnet.machinery.orders.order_line import OrderLine

MOST_DRIVETRAINS = 3
"""Largest number of drivetrains with other modes whose separation margins a report shows."""


def separation_margins(subject: ReportData) -> list[Block]:
    """Tables of the margins of all low modes from 1 and 2 times shaft speeds and line frequencies, by drivetrain.

    Empty unless the report's ``rules`` name a rule of separation margins and the model has speeds.
    """
    rule = subject.request.plan.rules
    if rule is None or rule not in PRESETS or subject.model.definition.speeds is None:
        return []
    several = len(subject.distinct_drivetrains) > 1
    return [_margins(rule, cases, several=several) for cases in subject.distinct_drivetrains[:MOST_DRIVETRAINS]]


def _margins(rule: str, cases: tuple[Case, ...], *, several: bool) -> TableBlock:
    from torsionnet.machinery.verdicts.shaft_margins import shaft_margins

    found = shaft_margins(cases[0].drivetrain, rule)
    where = (
        phrase(" in configuration {name}", name=shared_choices([case.configuration for case in cases]))
        if several
        else ""
    )
    columns = (
        Heading("Mode"),
        Heading("Natural frequency", "Hz", numeric=True),
        Heading("Compared with"),
        Heading("From", "Hz", numeric=True),
        Heading("To", "Hz", numeric=True),
        Heading("Margin", "%", numeric=True),
        Heading("Required", "%", numeric=True),
        Heading("Margin kept"),
    )
    pairs = zip(found.crossings, found.lines * len(found.modes), strict=True)
    rows = [_row(found, one, line) for one, line in pairs]
    first = range(0, len(rows), len(found.lines))
    rows = [row if place in first else ("", "", *row[2:]) for place, row in enumerate(rows)]
    notes = [
        "Margin: distance of the nearer of undamped and damped natural frequency from the frequencies compared, "
        "as a share of them; 0 where one of the speeds meets it.",
        phrase("Margins by {rule}.", rule=found.rule),
    ]
    if any(one.passes is False for one in found.crossings):
        notes.append("Where a margin is not kept, stresses at the critical speed have to show that it does no harm.")
    return table(phrase("Separation margins{where}", where=where), columns, rows, notes)


def _row(found: CriticalSpeeds, one: CriticalSpeed, line: OrderLine) -> tuple[Cell, ...]:
    low, high = np.abs(line.frequency(np.array(found.speed_range))).tolist()
    compared = (
        f"{one.order:g} x {as_words(one.excitation)}" if one.order else f"{one.fixed:g} Hz, {as_words(one.excitation)}"
    )
    required = "" if one.required is None else NumberText(100 * one.required, 3)
    kept = "" if one.passes is None else "yes" if one.passes else "no"
    return (
        str(one.mode.number), NumberText(one.mode.undamped_frequency, 4),
        compared, NumberText(low, 3), NumberText(high, 3),
        NumberText(100 * one.margin, 3), required, kept,
    )  # fmt: skip
