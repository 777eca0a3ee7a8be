"""Section of a report on mass elastic."""

from __future__ import annotations

from torsionnet.report.document_tree import Section
from torsionnet.report.report_data import ReportData


def mass_elastic_section(subject: ReportData) -> Section | None:
    """Section of a report on mass elastic; None for a model without excitations."""
    del subject
    return None
