"""Section of a report on measurement plan."""

from __future__ import annotations

from torsionnet.report.document_tree import Section
from torsionnet.report.report_data import ReportData


def measurement_plan_section(subject: ReportData) -> Section | None:
    """Section of a report on measurement plan; None for a model without excitations."""
    del subject
    return None
