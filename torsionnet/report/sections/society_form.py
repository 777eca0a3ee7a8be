"""Table of a report with the particulars that a classification society asks for, and where they stand."""

from __future__ import annotations

from torsionnet.base.phrases import phrase
from torsionnet.machinery.limits.society_rules import SOCIETIES
from torsionnet.report.document_tree import Block, Heading, Paragraph
from torsionnet.report.plan import SECTIONS
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital


def society_form(subject: ReportData) -> list[Block]:
    """Table of the particulars that the society in ``rules`` of the report asks for, with the sections that hold them.

    Empty where no society is named.
    """
    society = SOCIETIES.get(subject.request.plan.rules or "")
    if society is None:
        return []
    rows = [
        (paragraph, capital(asked), capital(as_words(name)) if subject.request.wants(name) else "not in this document")
        for paragraph, asked, name in society.asked_for
        if name in SECTIONS
    ]
    columns = (Heading("Paragraph"), Heading("Asked for", wide=True), Heading("Section"))
    notes = [f"{society.name}: {society.edition}."]
    notes += (
        [phrase("Barred speed ranges are marked by {marking}.", marking=society.marking)] if society.marking else []
    )
    notes += [f"{capital(society.remark)}."] if society.remark else []
    notes += _speeds_missing(subject, society.highest_critical_ratio)
    if not rows:
        return [Paragraph((" ".join(notes),))]
    return [table("Particulars by the rules of the society", columns, rows, notes)]


def _speeds_missing(subject: ReportData, highest: float | None) -> list[str]:
    """Sentence that speeds up to which critical speeds are asked for were not examined; empty where they were."""
    speeds = subject.model.definition.speeds
    if highest is None or speeds is None or speeds.rated is None:
        return []
    reached = max(speeds.values) / speeds.rated
    if reached >= highest * (1 - 1e-9):
        return []
    return [
        phrase(
            "Speeds are examined up to lambda = {reached:.3g}, critical speeds are asked for up to {highest:g}.",
            reached=reached,
            highest=highest,
        )
    ]
