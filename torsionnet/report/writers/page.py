"""A report as a file of HTML."""

from __future__ import annotations

from pathlib import Path

from torsionnet.core.atomic import write_text
from torsionnet.report.document_tree import Report
from torsionnet.report.writers.html import html_page


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the page."""
    write_text(path, html_page(report))
    return (path,)
