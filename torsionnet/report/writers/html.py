"""A report as one HTML page that needs nothing else: pictures and formulas are in it."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from torsionnet.core.atomic import write_text
from torsionnet.report.document_tree import Picture, Report
from torsionnet.report.writers.html_table import table_html
from torsionnet.report.writers.html_text import escaped, inline
from torsionnet.report.writers.mathml import mathml
from torsionnet.report.writers.templating import TextFormat, written


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the page."""
    write_text(path, html_page(report))
    return (path,)


def html_page(report: Report, *, folds: bool = True) -> str:
    """The text of the page; one to be printed does not fold anything away."""
    return written(report, FORMAT, _drawing, folds=folds)


def _drawing(block: Picture, number: str) -> str:
    from torsionnet.plot.rendering import inline_svg

    svg = inline_svg(block.drawn, f"f{number}-")
    return svg.replace("<svg ", f'<svg role=img aria-label="{escaped(block.alt)}" ', 1)


FORMAT = TextFormat(
    ".html",
    inline,
    {
        "display": partial(mathml, block=True),
        "table": lambda block, number: table_html(block, f"Table {number}"),
    },
)
