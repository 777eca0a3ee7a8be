"""Section of a report on passage."""

from __future__ import annotations

from torsionnet.report.document_tree import Section
from torsionnet.report.report_data import ReportData


def passage_section(subject: ReportData) -> Section | None:
    """Section of a report on passage; None for a model without excitations."""
    del subject
    return None
