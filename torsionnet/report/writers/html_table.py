"""Tables in HTML."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.report.document_tree import Cell, Heading, NumberText, TableBlock
from torsionnet.report.writers.html_text import escaped, inline, number

FEW = 14
"""Rows of a table that stays on one page."""


def table_html(block: TableBlock, label: str, name: str) -> str:
    """A table with caption, repeated head and notes; it scrolls where the screen is narrow.

    ``label`` stands before the caption, ``name`` is the id of the caption.
    """
    decimals = [block.decimals(index) for index in range(len(block.columns))]
    head = "".join(f"<th{_class(column)} scope=col>{_heading(column)}</th>" for column in block.columns)
    body = "".join(_group(group.title, group.rows, block.columns, decimals) for group in block.groups)
    foot = "".join(f"<p class=note>{inline(note)}</p>" for note in block.ending)
    keep = " keep" if sum(len(group.rows) for group in block.groups) <= FEW else ""
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
    """Rows that go on with what the row above is about have no line over them."""
    return " class=on" if row and row[0] == "" else ""


def _cells(row: tuple[Cell, ...], columns: Sequence[Heading], decimals: Sequence[int]) -> str:
    parts = []
    for cell, column, places in zip(row, columns, decimals, strict=True):
        content = number(cell, places) if isinstance(cell, NumberText) else inline(cell)
        parts.append(f"<td{_class(column)}>{content}</td>")
    return "".join(parts)
