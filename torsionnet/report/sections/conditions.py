"""Section of a report on conditions."""

from __future__ import annotations

from torsionnet.report.document_tree import Section
from torsionnet.report.report_data import ReportData


def conditions_section(subject: ReportData) -> Section | None:
    """Section of a report on conditions; None for a model without excitations."""
    del subject
    return None
