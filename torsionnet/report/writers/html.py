"""A report as one HTML page that needs nothing else: pictures and formulas are in it."""

from __future__ import annotations

import base64
from functools import partial
from pathlib import Path

from torsionnet.core.atomic import write_text
from torsionnet.report.document_tree import Picture, Report
from torsionnet.report.writers.html_table import table_html
from torsionnet.report.writers.html_text import escaped, inline
from torsionnet.report.writers.mathml import mathml
from torsionnet.report.writers.templating import Illustrations, TextFormat, written


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the page."""
    write_text(path, html_page(report))
    return (path,)


def html_page(report: Report, *, folds: bool = True) -> str:
    """The text of the page; one to be printed does not fold anything away."""
    return written(report, FORMAT, Illustrations(_drawing, _data), folds=folds)


def _drawing(block: Picture, number: str) -> str:
    from torsionnet.plot.drawing.rendering import inline_svg

    svg = inline_svg(block.drawn, f"f{number}-")
    return svg.replace("<svg ", f'<svg role=img aria-label="{escaped(block.alt)}" ', 1)


def _data(name: str, data: bytes) -> str:
    """An image as part of the page."""
    return f"data:{MEDIA_TYPES[Path(name).suffix.lower()]};base64,{base64.b64encode(data).decode()}"


MEDIA_TYPES = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
FORMAT = TextFormat(
    ".html",
    inline,
    {
        "display": partial(mathml, block=True),
        "table": lambda block, number, word: table_html(block, f"{word} {number}", f"table-{number.lower()}"),
    },
    tuple(MEDIA_TYPES),
)
