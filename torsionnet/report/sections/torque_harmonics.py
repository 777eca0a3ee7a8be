"""Section of a report on harmonics."""

from __future__ import annotations

from torsionnet.report.document_tree import Section
from torsionnet.report.report_data import ReportData


def harmonics_section(subject: ReportData) -> Section | None:
    """Section of a report on harmonics; None for a model without excitations."""
    del subject
    return None
