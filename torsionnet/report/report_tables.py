"""Tables of a report from rows of cells: what is equal stands once, columns in which nothing stands are left out."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.report.document_tree import Cell, Heading, Inline, NumberText, TableBlock, TableGroup, inlines


def table(
    caption: Cell,
    columns: Sequence[Heading],
    rows: Sequence[tuple[Cell, ...]],
    notes: Sequence[Cell] = (),
    most: int | None = None,
) -> TableBlock:
    """A table without groups, cut after ``most`` rows; columns in which nothing stands are left out."""
    merged = alike(rows)
    kept = merged[:most] if most else merged
    used = [index for index, _ in enumerate(columns) if any(row[index] not in ("", ()) for row in kept)]
    return TableBlock(
        inlines(caption),
        tuple(columns[index] for index in used),
        (TableGroup(tuple(tuple(row[index] for index in used) for row in kept)),),
        tuple(map(inlines, notes)),
        len(merged) - len(kept),
    )


def alike(rows: Sequence[tuple[Cell, ...]]) -> tuple[tuple[Cell, ...], ...]:
    """Rows that follow each other and differ in their first cell only as one row that names them all.

    Examples
    --------
    >>> [row[0] for row in alike([("dry", NumberText(1.0)), ("wet", NumberText(1.0)), ("warm", NumberText(2.0))])]
    ['dry, wet', 'warm']
    """
    found: list[tuple[Cell, ...]] = []
    for row in rows:
        named = found and len(row) > 1 and row[0] and found[-1][0]
        if named and as_shown(row[1:]) == as_shown(found[-1][1:]):
            found[-1] = ((*inlines(found[-1][0]), ", ", *inlines(row[0])), *found[-1][1:])
        else:
            found.append(row)
    return tuple((joined(row[0]), *row[1:]) if row else row for row in found)


def as_shown(row: Sequence[Cell]) -> list[tuple[object, ...]]:
    """The cells as a reader sees them: numbers by their digits."""
    return [
        tuple((part.mantissa, str(part.exponent)) if isinstance(part, NumberText) else part for part in inlines(cell))
        for cell in row
    ]


def joined(cell: Cell) -> Cell:
    """A cell whose neighbouring texts are one."""
    parts: list[Inline] = []
    for part in inlines(cell):
        if parts and isinstance(part, str) and isinstance(parts[-1], str):
            parts[-1] += part
        else:
            parts.append(part)
    return parts[0] if len(parts) == 1 else tuple(parts)
