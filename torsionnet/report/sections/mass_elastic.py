"""Section of a report with the mass-elastic table: masses, shafts, damping, as they are and referred to the engine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import accumulate

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.phrases import phrase
from torsionnet.base.table import Table
from torsionnet.machinery.holzer.mass_elastic_table import MassElasticTable
from torsionnet.report.document_tree import Cell, Math, NumberText, Section, TableBlock, TableGroup, Text
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_machines import quantity_text
from torsionnet.report.report_tables import HEADING_SYMBOLS, results_table
from torsionnet.report.report_text import as_words, capital, choices_of_some, unit

SHORT_HEADINGS: dict[str, Cell] = {
    "absolute damping": Math(r"c_{\mathrm{abs}}"),
    "speed ratio": Math("n"),
    "shaft to the next": "Shaft to the next",
    "outer diameter": Math("D"),
    "inner diameter": Math("d"),
    "length": Math("L"),
    "section modulus": Math("W_{p}"),
    "relative damping": Math(r"c_{\mathrm{rel}}"),
    "loss factor": Math(r"\eta"),
}
"""Headings of the columns of a mass-elastic table that are short enough for all of them to stand side by side."""
REFERRED = ("speed ratio", "J referred", "k referred")
"""Names of the columns that say nothing where all masses turn at one speed."""
OF_MASSES = ("J", "absolute damping", "speed ratio")
"""Names of the columns with values of masses; the others have those of shafts."""
DIMENSIONS = {"k": "stiffness", "absolute damping": "damping", "relative damping": "damping"}
"""Dimension of the columns whose values have a prefix that suits their size."""
MOST_CHANGES = 10
"""Largest number of notes on values of other conditions, about as many as fit below a table of twenty masses."""


def mass_elastic_section(subject: ReportData) -> Section | None:
    """Section of a report with the mass-elastic table; None for a model without speeds or with controllers."""
    if subject.model.definition.speeds is None:
        return None
    try:
        tables = [case.drivetrain.mass_elastic_table() for case in subject.cases]
    except TorsionnetError:  # a controller acts, for which the table has no column
        return None
    names = [case.configuration for case in subject.cases]
    block = _block(tables[0], f", {names[0]}" if len(names) > 1 else "")
    changes = list(_changes(tables, names))
    more = [(phrase("… and {count} more", count=len(changes) - MOST_CHANGES),)] if len(changes) > MOST_CHANGES else []
    notes = (*block.notes, *changes[:MOST_CHANGES], *more)
    return Section("mass_elastic", ("Mass-elastic data",), (replace(block, notes=notes),))


def _block(found: MassElasticTable, where: str) -> TableBlock:
    """Table of all masses, each with the shaft to the next one, with a group of rows for every branch, and sums."""
    whole, materials = _with_letters(found.table())
    if found.has_one_speed:
        whole = whole.chosen([place for place, one in enumerate(whole.columns) if one.name not in REFERRED])
    reference = as_words(found.referred_to)
    speed = (
        phrase("all turn at the speed of {node}", node=reference)
        if found.has_one_speed
        else phrase("referred to {node}", node=reference)
    )
    caption = phrase("Masses and shafts{where}; {speed}", where=where, speed=speed)
    block = results_table(whole, caption, notes=False, heads=lambda name: SHORT_HEADINGS.get(name, capital(name)))
    rows = [tuple(map(_plain, row)) for row in block.groups[0].rows]
    ends = [0, *accumulate(len(line.rows) for line in found.lines)]
    titles = [capital(as_words(line.title)) if len(found.lines) > 1 else "" for line in found.lines]
    groups = [
        TableGroup(tuple(rows[first:last]), title) for title, first, last in zip(titles, ends, ends[1:], strict=False)
    ]
    groups[-1] = replace(groups[-1], rows=(*groups[-1].rows, _sum_row(found, block)))
    return replace(block, groups=tuple(groups), notes=tuple(_notes(found, block, materials)))


def _with_letters(whole: Table) -> tuple[Table, dict[str, str]]:
    """Table in which letters stand for the materials, and the letters by material."""
    letters: dict[str, str] = {}
    for row in whole.rows:
        if row[-1]:
            letters.setdefault(row[-1], chr(ord("a") + len(letters)))
    rows = tuple((*row[:-1], letters.get(row[-1], "")) for row in whole.rows)
    return replace(whole, rows=rows), letters


def _plain(cell: Cell) -> Cell:
    """Cell with as many decimals as its own number needs, and empty where there is no number."""
    if not isinstance(cell, NumberText):
        return cell
    return "" if cell.value is None else NumberText(cell.value, cell.digits)


def _sum_row(found: MassElasticTable, block: TableBlock) -> tuple[Cell, ...]:
    """Row with the sum of the inertias below the column that is referred to one shaft."""
    wanted = HEADING_SYMBOLS["J" if found.has_one_speed else "J referred"]
    place = next(at for at, one in enumerate(block.columns) if one.text == wanted)
    cells: list[Cell] = [""] * len(block.columns)
    cells[1], cells[place] = "Sum", NumberText(found.total_inertia, 5)
    return tuple(cells)


def _notes(found: MassElasticTable, block: TableBlock, materials: dict[str, str]) -> Iterator[Text]:
    shown = {one.text for one in block.columns}
    meanings = (
        (Math(r"c_{\mathrm{abs}}"), ": absolute damping, against the ground"),
        (Math(r"c_{\mathrm{rel}}"), ": relative damping, between a mass and the next one"),
        (Math(r"\eta"), ": its loss factor"),
        (Math("W_{p}"), ": polar section modulus"),
        (Math("n"), phrase(": speed over that of {node}", node=as_words(found.referred_to))),
    )
    legend = [part for symbol, text in meanings if symbol in shown for part in ("; ", symbol, text)]
    if legend:
        yield (*legend[1:], ".")
    for line in found.lines:
        if line.flexibility:
            where = f", {as_words(line.title)}" if len(found.lines) > 1 else ""
            size = NumberText(line.flexibility, 5)
            stiffness = NumberText(1e-6 / line.flexibility, 5)
            yield (
                phrase("Sum of 1/k, referred{where}: ", where=where),
                size,
                " rad/(N·m), as one shaft of ",
                stiffness,
                " MN·m/rad.",
            )
    if materials:
        yield ("; ".join(f"{letter}: {material}" for material, letter in materials.items()) + ".",)
    for note in (*found.divided(), *found.notes):
        yield (f"{capital(as_words(note))}.",)


def _changes(tables: Sequence[MassElasticTable], names: Sequence[str]) -> Iterator[Text]:
    """Sentences on the values that other conditions have, one for all values that the same conditions share."""
    written = _values(tables[0])
    places: dict[str, list[str]] = {}
    values: dict[tuple[str, str, str], list[str]] = {}
    for other, name in zip(tables[1:], names[1:], strict=True):
        now = _values(other)
        absent = dict.fromkeys(about for _, about in written if (_, about) not in now)
        added = dict.fromkeys(about for _, about in now if (_, about) not in written)
        for text in [f"Without {as_words(one)}" for one in absent] + [f"With {as_words(one)}" for one in added]:
            places.setdefault(text, []).append(name)
        for (quantity, about), text in now.items():
            if written.get((quantity, about), text) != text:
                values.setdefault((quantity, about, text), []).append(name)
    for text, where in places.items():
        yield (f"{text} in {choices_of_some(where, names)}.",)
    shared: dict[tuple[str, ...], dict[str, dict[str, list[str]]]] = {}
    for (quantity, about, text), changed_in in values.items():
        shared.setdefault(tuple(changed_in), {}).setdefault(quantity, {}).setdefault(text, []).append(as_words(about))
    for conditions, quantities in shared.items():
        parts = "; ".join(_change(quantity, found) for quantity, found in quantities.items())
        yield (f"{parts if parts[1] == ' ' else capital(parts)} in {choices_of_some(conditions, names)}.",)


def _change(quantity: str, found: dict[str, list[str]]) -> str:
    """Clause with the values of one quantity, each with all masses or shafts that have it."""
    return f"{quantity} " + "; ".join(f"of {', '.join(about)}: {text}" for text, about in found.items())


def _values(found: MassElasticTable) -> dict[tuple[str, str], str]:
    """Text of every value of a mass-elastic table, by its column and the mass or shaft it is of."""
    texts: dict[tuple[str, str], str] = {}
    whole = found.table()
    for row in whole.rows:
        for column, value in zip(whole.columns[2:], row[2:], strict=True):
            about = str(row[1] if column.name in OF_MASSES else row[6])
            if about and column.name not in (*REFERRED[1:], "shaft to the next", "material"):
                dimension = DIMENSIONS.get(column.name)
                number = "none" if value is None else f"{value:.4g} {unit(column.unit) if column.unit else ''}".strip()
                texts[column.name, about] = quantity_text(value, dimension) if dimension and value else number
    return texts
