"""Section of a report on the installation: its machines with their data, and power, speed and torque along the line."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import accumulate

from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.base.number_text import prefix_of
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.table import Table
from torsionnet.base.units import RPM
from torsionnet.machinery.checks.rating_mismatches import rating_mismatches
from torsionnet.machinery.holzer.mass_elastic_table import MassElasticTable
from torsionnet.machinery.mean.static_state import PowerBalance
from torsionnet.model.condition_titles import ConditionTitles
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Section,
    Strong,
    TableBlock,
    TableGroup,
    Text,
)
from torsionnet.report.report_cylinders import all_working
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_machines import machines
from torsionnet.report.report_tables import HEADING_SYMBOLS, results_table, table
from torsionnet.report.report_text import as_words, capital, first_names, operating_speed_sentence, quantity_text, unit

MOST_LOADS = 3
"""Largest number of unlike loads whose torques along the line are listed, half a page each."""
LEAST_TORQUE_SHARE = 1e-9
"""Share of the largest torque below which an element passes none but rounding, and has no row."""
LEAST_POWER_SHARE = 1e-6
"""Share of the power below which a difference is rounding: of six digits, as files give them."""
COLUMNS = ("element", "at", "speed", "torque", "stress", "power")
"""Names of the columns of mean torques that the table along the line shows."""


def installation_section(subject: ReportData) -> Section | None:
    """Section of a report on the installation; None for a model without excitations."""
    if not subject.has_excitations:
        return None
    model = subject.model
    rows = list(machines(model))
    columns = (Heading("Machine"), Heading("Data", wide=True), Heading("Source or remark", wide=True))
    notes = [phrase("Where no source is named: {source}.", source=model.source.strip())] if model.source else []
    blocks: list[Block] = [table("Machines, couplings and dampers", columns, rows, notes)] if rows else []
    for case, balance in _balances(subject):
        several = len(subject.cases) > 1 and case.configuration
        blocks += [
            _rated(balance, case),
            _line(subject, case, balance, f", {case.title}" if several else ""),
        ]
    blocks += _ratings(subject)
    return Section("installation", ("Installation",), tuple(blocks)) if blocks else None


def _balances(subject: ReportData) -> list[tuple[Case, PowerBalance]]:
    """Balances of power of configurations without a cylinder out, each once, at rated speed where it is known."""
    balances: list[tuple[Case, PowerBalance]] = []
    shown: list[object] = []
    for case in all_working(subject.cases):
        balance = _balance(case)
        if balance is None or balance.taken <= LEAST_POWER_SHARE * balance.given:  # as with a brake on
            continue
        torques = [(load.element, load.port, round(load.torque or 0.0, 6)) for load in balance.state.loads]
        if torques not in shown and len(balances) < MOST_LOADS:
            shown.append(torques)
            balances.append((case, balance))
    return balances


def _balance(case: Case) -> PowerBalance | None:
    """Balance of power at the rated speed, else at the operating point; None where neither is known.

    A condition that does not reach the rated speed, as one engine of two, has it at its highest.
    """
    speeds = case.drivetrain.definition.speeds
    highest = min(speeds.rated, speeds.values[-1]) if speeds and speeds.rated else None
    for speed in dict.fromkeys([highest, None]):
        try:
            return case.drivetrain.power_balance(speed)
        except UsageError:  # no load over speed, or what drives is switched off in this configuration
            continue
    return None


def _rated(powers: PowerBalance, case: Case) -> Paragraph:
    """Paragraph with power and torque at the speed of the reference shaft, and the sums of power given and taken."""
    state = powers.state
    speed = quantity_text(abs(state.speed), "speed")
    balance = phrase(
        "given {power}, absorbed {other}",
        power=quantity_text(powers.given, "power"),
        other=quantity_text(powers.taken, "power"),
    )
    if abs(powers.given - powers.taken) <= LEAST_POWER_SHARE * powers.given:
        more = phrase(": in balance")
    else:
        more = phrase(", a difference of {power}", power=quantity_text(powers.given - powers.taken, "power"))
    text = phrase(
        "{power} at {speed} of {node}, torque there {torque} (T = P/ω). Powers: {balance}.",
        power=quantity_text(powers.taken, "power"),
        speed=speed,
        node=as_words(state.reference),
        torque=quantity_text(powers.torque, "torque"),
        balance=joined("", (balance, more)),
    )
    speeds = case.drivetrain.definition.speeds
    words = "Rated torque"
    if speeds is not None and speeds.rated is not None and abs(state.speed) < speeds.rated * (1 - 1e-9):
        is_highest = abs(state.speed) >= speeds.values[-1] * (1 - 1e-9)
        words = "Torque at the highest speed" if is_highest else "Torque at the operating point"
    return Paragraph((Strong(words), ": ", text))


def _line(subject: ReportData, case: Case, balance: PowerBalance, where: str) -> TableBlock:
    """Table of speed, mean torque, stress and power of every element that passes torque on, along the line."""
    state = balance.state
    largest = max((abs(load.torque or 0.0) for load in state.loads), default=0.0)
    whole = state.table(subject.conventions)
    order = _order(case)
    kept = [
        (order.get(load.port, len(order)), row)
        for load, row in zip(state.loads, whole.rows, strict=True)
        if abs(load.torque or 0.0) > LEAST_TORQUE_SHARE * largest
    ]
    rows = tuple(row for _, row in sorted(kept, key=lambda pair: pair[0]))
    names = [column.name for column in whole.columns]
    chosen = replace(whole, rows=rows).chosen([names.index(name) for name in COLUMNS])
    caption = phrase(
        "Speed, mean torque and power along the line at {speed:.6g} rpm{where}",
        speed=abs(state.speed) * RPM,
        where=where,
    )
    block = results_table(chosen, caption, notes=False)
    return replace(block, notes=((_outside(balance),), _checked(balance)))


def _order(case: Case) -> dict[str, int]:
    """Number of every node in the mass-elastic table, by node; empty where a controller acts."""
    try:
        return {row.node: row.number for row in case.drivetrain.mass_elastic_table().rows}
    except TorsionnetError:
        return {}


def _outside(balance: PowerBalance) -> str:
    """Sentence on the torques that act from outside, equal ones together."""
    equal: dict[str, list[str]] = {}
    for node, torque in balance.state.external.items():
        equal.setdefault(quantity_text(torque, "torque"), []).append(as_words(node))
    each = (
        phrase("{torque} each", torque=f"{first_names(nodes)} {text}") if len(nodes) > 1 else f"{nodes[0]} {text}"
        for text, nodes in equal.items()
    )
    return phrase("From outside act: {torques}.", torques=joined("; ", each))


def _checked(balance: PowerBalance) -> Text:
    """Sentence on the powers along the line: P = T omega, and whether gears pass on what they get."""
    loads, text = balance.state.loads, "P = T ω at every place."
    if len({load.element for load in loads}) == len(loads):
        return (text,)
    loss, share = balance.largest_loss, balance.largest_loss / (balance.given or 1.0)
    if share <= LEAST_POWER_SHARE:
        return text, " Every gear gives as much power as it takes."
    return text, phrase(" A gear gives {power} less or more than it takes.", power=quantity_text(loss, "power"))


def _ratings(subject: ReportData) -> list[Block]:
    """Blocks on whether the ratings that machines and load state agree with each other."""
    external = subject.cases[0].drivetrain.external_torques
    stated = [
        excitation.rating for excitation in external.definition.excitations.values() if excitation.rating is not None
    ]
    if not stated or not external.rated_speed or external.definition.load is None:
        return []
    faults = [f"{capital(as_words(fault.message))}." for fault in rating_mismatches(external)]
    if faults:
        return [Paragraph(("Ratings that differ:",)), Listing(tuple((text,) for text in faults))]
    text = (
        "The ratings of machines and load agree: speeds through the gear ratios within 0.5 %, powers within 5 %; of an "
        "indicated power 75 to 100 % arrive at the shaft."
    )
    return [Paragraph((text,))]


# Section of a report with the mass-elastic table: masses, shafts, damping, as they are and referred to the engine.

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
    block = _block(tables[0], f", {subject.cases[0].title}" if len(names) > 1 else "")
    changes = list(_changes(tables, names, subject.titles))
    more = [(phrase("… and {count} more", count=len(changes) - MOST_CHANGES),)] if len(changes) > MOST_CHANGES else []
    speed = [(text,) for text in operating_speed_sentence(subject.cases[0].drivetrain)]
    notes = (*block.notes, *speed, *changes[:MOST_CHANGES], *more)
    return Section("mass_elastic", ("Mass-elastic data",), (replace(block, notes=notes),))


def _block(sheet: MassElasticTable, where: str) -> TableBlock:
    """Table of all masses, each with the shaft to the next one, with a group of rows for every branch, and sums."""
    whole, materials = _with_letters(sheet.table())
    if sheet.has_one_speed:
        whole = whole.chosen([place for place, column in enumerate(whole.columns) if column.name not in REFERRED])
    reference = as_words(sheet.referred_to)
    speed = (
        phrase("all turn at the speed of {node}", node=reference)
        if sheet.has_one_speed
        else phrase("referred to {node}", node=reference)
    )
    caption = phrase("Masses and shafts{where}; {speed}", where=where, speed=speed)
    block = results_table(whole, caption, notes=False, heads=lambda name: SHORT_HEADINGS.get(name, capital(name)))
    rows = [tuple(map(_plain, row)) for row in block.groups[0].rows]
    ends = [0, *accumulate(len(line.rows) for line in sheet.lines)]
    titles = [capital(as_words(line.title)) if len(sheet.lines) > 1 else "" for line in sheet.lines]
    groups = [
        TableGroup(tuple(rows[first:last]), title) for title, first, last in zip(titles, ends, ends[1:], strict=False)
    ]
    groups[-1] = replace(groups[-1], rows=(*groups[-1].rows, _sum_row(sheet, block)))
    return replace(block, groups=tuple(groups), notes=tuple(_notes(sheet, block, materials)))


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


def _sum_row(sheet: MassElasticTable, block: TableBlock) -> tuple[Cell, ...]:
    """Row with the sum of the inertias below the column that is referred to one shaft."""
    wanted = HEADING_SYMBOLS["J" if sheet.has_one_speed else "J referred"]
    place = next(at for at, column in enumerate(block.columns) if column.text == wanted)
    cells: list[Cell] = [""] * len(block.columns)
    cells[1], cells[place] = "Sum", NumberText(sheet.total_inertia, 5)
    return tuple(cells)


def _notes(sheet: MassElasticTable, block: TableBlock, materials: dict[str, str]) -> Iterator[Text]:
    shown = {column.text for column in block.columns}
    meanings = (
        (Math(r"c_{\mathrm{abs}}"), ": absolute damping, against the ground"),
        (Math(r"c_{\mathrm{rel}}"), ": relative damping, between a mass and the next one"),
        (Math(r"\eta"), ": its loss factor"),
        (Math("W_{p}"), ": polar section modulus"),
        (Math("n"), phrase(": speed over that of {node}", node=as_words(sheet.referred_to))),
    )
    legend = [part for symbol, text in meanings if symbol in shown for part in ("; ", symbol, text)]
    if legend:
        yield (*legend[1:], ".")
    for line in sheet.lines:
        if line.flexibility:
            where = joined("", (", ", as_words(line.title))) if len(sheet.lines) > 1 else ""
            size = NumberText(line.flexibility, 5)
            # The unit of the table's columns of stiffness.
            shafts = [(row.shaft.stiffness, row.referred_stiffness) for row in sheet.rows if row.shaft is not None]
            prefix, factor = prefix_of(
                "N*m/rad", max(size for shaft in shafts for size in shaft if math.isfinite(size))
            )
            stiffness = NumberText(1 / line.flexibility / factor, 5)
            yield (
                phrase("Sum of 1/k, referred{where}: ", where=where),
                size,
                " rad/(N·m), as one shaft of ",
                stiffness,
                f" {unit(prefix + 'N*m/rad')}.",
            )
    if materials:
        each = (
            phrase("{letter}: {material}", letter=letter, material=material) for material, letter in materials.items()
        )
        yield (joined("; ", each), ".")
    for note in (*sheet.shares_of_shafts(), *sheet.divided(), *sheet.notes):
        yield (capital(as_words(note)), ".")


def _changes(tables: Sequence[MassElasticTable], names: Sequence[str], titles: ConditionTitles) -> Iterator[Text]:
    """Sentences on the values that other conditions have, one for all values that the same conditions share."""
    written = _mass_elastic_values(tables[0])
    places: dict[str, list[str]] = {}
    values: dict[tuple[str, str, str], list[str]] = {}
    sums: dict[str, list[str]] = {}
    # Against the first table: masses that went or came, and values that differ.
    for other, name in zip(tables[1:], names[1:], strict=True):
        now = _mass_elastic_values(other)
        absent = dict.fromkeys(about for _, about in written if (_, about) not in now)
        added = dict.fromkeys(about for _, about in now if (_, about) not in written)
        for text in [f"Without {as_words(part)}" for part in absent] + [f"With {as_words(part)}" for part in added]:
            places.setdefault(text, []).append(name)
        if (total := _inertia_text(other)) != _inertia_text(tables[0]):
            sums.setdefault(total, []).append(name)
        for (quantity, about), text in now.items():
            if written.get((quantity, about), text) != text:
                values.setdefault((quantity, about, text), []).append(name)
    for text, where in places.items():
        yield (f"{text} in {titles.several(where, names)}.",)
    for total, where in sums.items():
        yield (phrase("Sum of J: {sum} in {conditions}.", sum=total, conditions=titles.several(where, names)),)
    # The other way round, by conditions, then quantity and value: a sentence says all that they share.
    shared: dict[tuple[str, ...], dict[str, dict[str, list[str]]]] = {}
    for (quantity, about, text), changed_in in values.items():
        shared.setdefault(tuple(changed_in), {}).setdefault(quantity, {}).setdefault(text, []).append(as_words(about))
    for conditions, quantities in shared.items():
        parts = joined("; ", (_change(quantity, values_now) for quantity, values_now in quantities.items()))
        said = parts if parts[1] == " " else capital(parts)
        yield (phrase("{changes} in {conditions}.", changes=said, conditions=titles.several(conditions, names)),)


def _inertia_text(sheet: MassElasticTable) -> str:
    """Text of the sum of all inertias, in as many digits as in its row of the table."""
    return f"{NumberText(sheet.total_inertia, 5)} {unit('kg*m^2')}"


def _change(quantity: str, places_of_values: dict[str, list[str]]) -> str:
    """Clause with the values of one quantity, each with all masses or shafts that have it."""
    each = (
        phrase("of {names}: {value}", names=", ".join(about), value=text) for text, about in places_of_values.items()
    )
    return joined(" ", (phrase(quantity), joined("; ", each)))


def _mass_elastic_values(sheet: MassElasticTable) -> dict[tuple[str, str], str]:
    """Text of every value of a mass-elastic table, by its column and the mass or shaft it is of."""
    texts: dict[tuple[str, str], str] = {}
    whole = sheet.table()
    for row in whole.rows:
        for column, value in zip(whole.columns[2:], row[2:], strict=True):
            about = str(row[1] if column.name in OF_MASSES else row[6])
            if about and column.name not in (*REFERRED[1:], "shaft to the next", "material"):
                dimension = DIMENSIONS.get(column.name)
                shown = unit(column.unit) if column.unit else ""
                number = "none" if value is None else f"{NumberText(value)} {shown}".strip()
                texts[column.name, about] = quantity_text(value, dimension) if dimension and value else number
    return texts


# Section of a report on mean torques, stresses and power under the load.


def mean_torques_section(subject: ReportData) -> Section | None:
    """Section of a report on mean torques and stresses under the load; None for a model without a load."""
    definition = subject.model.definition
    if definition.load is None or definition.speeds is None:
        return None
    blocks: list[Block] = []
    shown: list[object] = []
    for case in all_working(subject.cases):
        try:
            state = case.drivetrain.static_state()
        except UsageError:  # what drives or absorbs is switched off in this configuration
            continue
        if state.loads not in shown and len(shown) < MOST_LOADS:
            where = (
                phrase(" in configuration {name}", name=case.title)
                if case.configuration and len(subject.cases) > 1
                else ""
            )
            shown.append(state.loads)
            blocks.append(
                results_table(
                    state.table(subject.conventions), phrase("Mean torques of the elements{where}", where=where)
                )
            )
    return Section("mean_torques", ("Mean torques and stresses",), tuple(blocks)) if blocks else None
