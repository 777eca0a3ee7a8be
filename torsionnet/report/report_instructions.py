"""Table of a report with the operating instructions, those of every condition by themselves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby

from torsionnet.base.phrases import joined, phrase
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.operating_instructions import Instruction, last_notes, operating_instructions
from torsionnet.report.document_tree import Block, Cell, Heading, NumberText, Paragraph, Strong, TableBlock, TableGroup
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_text import as_words, capital, unit
from torsionnet.report.report_units import limit_scale

COLUMNS = (
    Heading("From", "rpm", numeric=True),
    Heading("To", "rpm", numeric=True),
    Heading("Action", wide=True),
    Heading("Limits"),
    Heading("At", "rpm", numeric=True),
    Heading("Value", numeric=True),
    Heading("Allowed", numeric=True),
    Heading("In passing", numeric=True),
    Heading("Unit"),
)
DIGITS = 4
"""Significant digits of speeds and values, so that shares of what is allowed can be calculated from them."""
VALUES = (
    "Of the limits of a range the first decides; the value is its largest in the range, at the speed beside it, with "
    "what is allowed there in continuous operation and in passing."
)
"""Note on the numbers of the operating instructions."""


TOO_NEAR = "Separation margins are not kept, as the verdict says: no instruction makes up for that."
"""Note on natural frequencies that are too near to an excitation at speeds that no instruction bars."""


def instruction_blocks(subject: ReportData, judged: LimitConclusion, *, apart: bool = True) -> list[Block]:
    """Blocks of a report with the operating instructions; where nothing is restricted, a sentence that says so.

    ``apart`` tells whether separation margins are kept.
    """
    rows = operating_instructions(judged.checks, subject.titles.of)
    known = [check.configuration for check in judged.checks]
    last = last_notes(judged.checks, lambda names: subject.titles.several(names, known))
    last += [] if apart else [phrase(TOO_NEAR)]
    if not rows:
        said = (text for note in last for text in (" ", note))
        return [Paragraph((Strong("Operating instructions:"), *said))]
    groups = [
        TableGroup(tuple(_row(advice, subject) for advice in those), capital(title) if len(judged.checks) > 1 else "")
        for title, those in groupby(rows, key=lambda advice: advice.condition)
    ]
    notes = [_tachometer(rows), VALUES, *last]
    return [TableBlock(("Operating instructions",), COLUMNS, tuple(groups), tuple((note,) for note in notes))]


def _row(advice: Instruction, subject: ReportData) -> tuple[Cell, ...]:
    scale, shown = limit_scale(advice.unit, subject.conventions)
    sizes = (advice.value, advice.allowed, advice.allowed_in_passing)
    return (
        "" if advice.from_rpm is None else str(advice.from_rpm),
        "–" if advice.to_rpm is None else str(advice.to_rpm),
        advice.instruction,
        joined("; ", map(as_words, advice.limits)),
        NumberText(advice.rpm, DIGITS),
        *("–" if math.isnan(size) else NumberText(size * scale, DIGITS) for size in sizes),
        unit(shown),
    )


def _tachometer(rows: Sequence[Instruction]) -> str:
    """Sentence on the shaft whose speed is meant, and on the error of its tachometer that the ranges include."""
    speeds = phrase("Speeds are those of {shaft}, rounded outward to 1 rpm", shaft=as_words(rows[0].shaft))
    tolerance = max(advice.tolerance for advice in rows)
    if not tolerance:
        return joined("", (speeds, "."))
    error = phrase("; ranges are wider by {error:g} % for the tachometer.", error=100 * tolerance)
    return capital(joined("", (speeds, error)))
