"""Writing of a report as one HTML page that holds all its pictures and formulas."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from torsionnet.base.atomic import write_text
from torsionnet.report.document_tree import Cell, Heading, NumberText, Picture, Report, TableBlock
from torsionnet.report.writers.html_text import escaped, inline, mathml, number
from torsionnet.report.writers.numbering import stays_whole
from torsionnet.report.writers.templating import Illustrations, TextFormat, render


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as an HTML page and return its path."""
    write_text(path, html_page(report))
    return (path,)


def html_page(report: Report, *, folds: bool = True) -> str:
    """Text of the HTML page of a report; a page for printing has ``folds=False``, so that nothing is folded away."""
    return render(report, FORMAT, Illustrations(_drawing, _data), folds=folds)


def _drawing(block: Picture, number: str) -> str:
    from torsionnet.plot.drawing.save import inline_svg

    svg = inline_svg(block.figure, f"f{number}-")
    return svg.replace("<svg ", f'<svg role=img aria-label="{escaped(block.alt)}" ', 1)


def _data(name: str, data: bytes) -> str:
    """Address (``data:``) with which an image becomes part of the HTML page."""
    return f"data:{MEDIA_TYPES[Path(name).suffix.lower()]};base64,{base64.b64encode(data).decode()}"


MEDIA_TYPES = {".svg": "image/svg+xml", ".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
"""Media type of an image by the ending of its file."""
FORMAT = TextFormat(
    ".html",
    inline,
    {
        "display": partial(mathml, block=True),
        "table": lambda block, number, word: _table_html(block, f"{word} {number}", f"table-{number.lower()}"),
    },
    tuple(MEDIA_TYPES),
)
"""File format HTML with the functions that turn the parts of a report into it."""


def _table_html(block: TableBlock, label: str, name: str) -> str:
    """HTML of a table with caption, repeated head and notes; it scrolls where the screen is narrow.

    ``label`` stands before the caption, ``name`` is the id of the caption.
    """
    decimals = [block.decimals(index) for index in range(len(block.columns))]
    head = "".join(f"<th{_class(column)} scope=col>{_heading(column)}</th>" for column in block.columns)
    body = "".join(_group(group.title, group.rows, block.columns, decimals) for group in block.groups)
    foot = "".join(f"<p class=note>{inline(note)}</p>" for note in block.foot_notes)
    keep = " keep" if stays_whole(block) else ""
    caption = f"<p class=caption id={name}><b>{escaped(label)}</b> {inline(block.caption)}</p>"
    return (
        f"<div class='table{keep}'>{caption}<div class=scroll tabindex=0 role=region aria-labelledby={name}>"
        f"<table aria-labelledby={name}><thead><tr>{head}</tr></thead>{body}</table></div>{foot}</div>"
    )


def _heading(column: Heading) -> str:
    unit = f"<span class=unit>{escaped(column.unit)}</span>" if column.bracket else ""
    return f"{inline(column.text)}{' ' if unit else ''}{unit}"


def _class(column: Heading) -> str:
    return " class=num" if column.numeric else " class=wide" if column.wide else ""


def _group(title: Cell, rows: Sequence[tuple[Cell, ...]], columns: Sequence[Heading], decimals: Sequence[int]) -> str:
    lead = f"<tr class=group><th colspan={len(columns)} scope=rowgroup>{inline(title)}</th></tr>" if title else ""
    body = "".join(f"<tr{_continued(row)}>{_cells(row, columns, decimals)}</tr>" for row in rows)
    return f"<tbody>{lead}{body}</tbody>\n"


def _continued(row: tuple[Cell, ...]) -> str:
    """HTML attribute of a row that continues what the row above is about, and has no line over it."""
    return " class=on" if row and row[0] == "" else ""


def _cells(row: tuple[Cell, ...], columns: Sequence[Heading], decimals: Sequence[int]) -> str:
    parts = []
    for cell, column, places in zip(row, columns, decimals, strict=True):
        content = number(cell, places) if isinstance(cell, NumberText) else inline(cell)
        parts.append(f"<td{_class(column)}>{content}</td>")
    return "".join(parts)
