"""Section of a report on forced response."""

from __future__ import annotations

from torsionnet.report.document_tree import Section
from torsionnet.report.report_data import ReportData


def forced_response_section(subject: ReportData) -> Section | None:
    """Section of a report on forced response; None for a model without excitations."""
    del subject
    return None
