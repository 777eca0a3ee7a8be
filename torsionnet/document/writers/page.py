"""A report as a file of HTML."""

from __future__ import annotations

from pathlib import Path

from torsionnet.atomic import write_text
from torsionnet.document.tree import Report
from torsionnet.document.writers.html import html_page


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the page."""
    write_text(path, html_page(report))
    return (path,)
