"""Model text from a mass-elastic table that was copied from a spreadsheet or a paper."""

from __future__ import annotations

import re
from typing import Any

from torsionnet.base.delimited.cell_grid import parse_grid
from torsionnet.base.errors import ModelError, TorsionnetError
from torsionnet.model.sheets.mass_elastic_sheet import parse_sheet
from torsionnet.model.sheets.meanings import BY_KEY
from torsionnet.model.sheets.sheet_columns import is_inertia_heading

TABLE = "pasted table"
"""Name of a pasted table in messages."""
_MODEL = re.compile(r"^\s*(torsionnet|elements|parameters|nodes?)\s*:|\{\s*type\s*:|^\s*type\s*:", re.MULTILINE)
"""Expression of what only texts of models hold, whose words of inertias would be taken for headings."""


def pasted_model(table: str) -> dict[str, Any]:
    """Text of a model from a table of masses and shafts with a heading, as JSON data.

    Cells stand between tabs, semicolons or commas. ``no_table`` where the text is no such table, ``refused`` with
    reasons where it is one with faults.

    Examples
    --------
    >>> found = pasted_model("mass\\tJ [kg m²]\\tk [MNm/rad]\\ncyl 1\\t0,45\\t2,1\\nflywheel\\t14\\t")
    >>> found["text"].splitlines()[4]
    '  cyl_1: {type: inertia, node: cyl_1, inertia: 0.45 kg m², description: cyl 1}'
    >>> pasted_model("elements:\\n  a: {type: inertia}")
    {'no_table': True}
    """
    if _MODEL.search(table):
        return {"no_table": True}
    try:
        grid = parse_grid(table.splitlines(), TABLE)
    except ModelError:
        return {"no_table": True}
    if not any(is_inertia_heading(cell) for row in grid.rows for cell in row):
        return {"no_table": True}
    from torsionnet.io.mass_elastic_reading import sheet_drivetrain

    try:
        sheet = parse_sheet(grid)
        text = sheet_drivetrain(sheet).to_yaml().replace(f"mass-elastic sheet {TABLE}", "pasted mass-elastic table", 1)
    except ModelError as error:
        return {
            "refused": [f"line {one.position.line}: {one.text}" if one.position else one.text for one in error.faults]
        }
    except TorsionnetError as error:
        return {"refused": [str(error)]}
    notes = [f'"{one.heading}": {BY_KEY[one.meaning].shown}' for one in sheet.columns if one.meaning]
    return {"text": text, "notes": [*notes, *sheet.notes]}
