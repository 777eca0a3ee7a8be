"""Section of a report on natural frequencies: one table, relative amplitudes with nodes, Holzer tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.phrases import phrase
from torsionnet.base.table import Table
from torsionnet.base.units import RPM
from torsionnet.machinery.holzer.holzer import CountedVibration, natural_frequency_table
from torsionnet.machinery.holzer.holzer_table import (
    DISTRIBUTED,
    NEGLIGIBLE_TORQUE,
    HolzerStation,
    HolzerTable,
    vibration_nodes,
)
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    NumberText,
    Paragraph,
    Picture,
    Section,
    TableBlock,
    TableGroup,
    Text,
)
from torsionnet.report.report_data import ReportData, held_drivetrain
from torsionnet.report.report_tables import merge_equal_rows, results_table, with_decimals
from torsionnet.report.report_text import as_words, operating_speed_sentence

# Holzer tables of modes as tables of a report, all quantities referred to one shaft.

SHORT_HEADINGS = {"J referred": "J", "k referred": "k", "sum of torque": "sum", DISTRIBUTED: "shafts"}
"""Shorter headings of a Holzer table in which all values are referred to one shaft."""
REAL_COLUMNS = ("J", "k")
"""Headings of the Holzer table's columns with values at a shaft's own speed, beside which it has referred ones."""
CLOSING_DIGITS, OWN_DIGITS = 7, 6
"""Digits of the largest angle or torque of a Holzer table, and of each other number, with which its sums close."""
ANGLES_AND_TORQUES = ("rad", "N·m", "kN·m", "MN·m")
"""Units of the columns of a Holzer table whose digits must close."""
DISTRIBUTED_NOTE = (
    "Shafts: torque of their own inertia, ω² times the sum of M θ over both ends, which J ω² θ leaves out; J is that "
    "of the masses alone. The sum of torques is k times the twist, and θ less the twist is that of the next station. "
    "The stress is the largest along a shaft."
)
CLOSING_NOTE = "The sum of torques is k times the twist, and θ less the twist is that of the next station."

ROUNDED_AMPLITUDE = 1e-9
"""Amplitude over the largest of a mode below which a mass stands still: rounding errors are smaller."""


def holzer_block(holzer: HolzerTable, stress_unit: str = "MPa") -> TableBlock:
    """Table of a report with the stations of a Holzer table, with a group of rows for each branch.

    Branches that stand still are left out; ``stress_unit`` is the name of 10^6 Pa in the heading. Numbers have the
    digits with which each row closes when it is calculated again from what is printed.
    """
    shown_table = _without_rounding(holzer.whole_shafts())
    moving = [branch for branch in shown_table.branches if any(column.amplitude for column in branch.stations)]
    shown_table = replace(shown_table, branches=tuple(moving) or shown_table.branches)
    made = _short(shown_table.table(referred=True))  # the number of the branch in front, for stations that look alike
    columns = tuple(replace(column, unit=stress_unit) if column.unit == "MPa" else column for column in made.columns)
    node = shown_table.branches[0].stations[0].node
    caption = phrase(
        "Holzer table of mode {number}, {frequency:.5g} Hz, ω² = {square:.7g} 1/s²; 1 rad at {first}, referred to "
        "{node}",
        number=shown_table.mode,
        frequency=shown_table.frequency,
        square=(2 * math.pi * shown_table.frequency) ** 2,
        first=phrase("the mass that moves most") if shown_table.first_rests else as_words(node),
        node=as_words(shown_table.referred_to),
    )
    explained = DISTRIBUTED_NOTE if shown_table.has_distributed else CLOSING_NOTE
    made = replace(made, columns=columns, notes=(explained, *shown_table.notes))
    block = _with_closing_digits(results_table(made, caption))
    cells = iter(row[1:] for row in block.groups[0].rows)
    several = len(shown_table.branches) > 1
    groups = [
        TableGroup(tuple(islice(cells, len(column.stations))), as_words(column.title) if several else "")
        for column in shown_table.branches
    ]
    return replace(block, columns=block.columns[1:], groups=tuple(groups))


def _with_closing_digits(block: TableBlock) -> TableBlock:
    """Copy of a Holzer table with decimals of angles and torques by the largest of them, others with their own."""
    (group,) = block.groups
    # A twist is small beside the angles, but k times the twist is the torque: it has digits of its own.
    places = {
        unit: [at for at, column in enumerate(block.columns) if column.unit == unit and column.text != "Twist"]
        for unit in ANGLES_AND_TORQUES
    }
    decimals: dict[int, int] = {}
    for columns in places.values():
        cells = [row[at] for row in group.rows for at in columns]
        sizes = [abs(cell.value) for cell in cells if isinstance(cell, NumberText) and cell.value]
        largest = math.floor(math.log10(max(sizes, default=1.0)))
        decimals |= dict.fromkeys(columns, max(0, CLOSING_DIGITS - 1 - largest))

    def closing(at: int, cell: Cell) -> Cell:
        if not isinstance(cell, NumberText) or block.columns[at].text == "Stress":
            return cell
        return replace(cell, digits=OWN_DIGITS, decimals=decimals.get(at) if cell.value else None)

    rows = tuple(tuple(closing(at, cell) for at, cell in enumerate(row)) for row in group.rows)
    return replace(block, groups=(replace(group, rows=rows),))


def _without_rounding(holzer: HolzerTable) -> HolzerTable:
    """Copy of a Holzer table in which masses that only rounding moves stand still."""
    stations = [station for branch in holzer.branches for station in branch.stations]
    least = ROUNDED_AMPLITUDE * max(abs(station.amplitude) for station in stations)
    # Where a branch ends, the sum of its torques is 0 but for rounding.
    torque = NEGLIGIBLE_TORQUE * max(abs(station.torque) for station in stations)

    def cleaned(station: HolzerStation) -> HolzerStation:
        link = station.link
        if link is not None and abs(station.torque) <= torque:
            link = replace(link, twist=0.0, stress=link.stress if math.isnan(link.stress) else 0.0)
        joined, distributed = (part if abs(part) > torque else 0.0 for part in (station.joined, station.distributed))
        moves = abs(station.amplitude) > least
        amplitude, inertia_torque = (station.amplitude, station.inertia_torque) if moves else (0.0, 0.0)
        return replace(
            station,
            link=link,
            joined=joined,
            distributed=distributed,
            amplitude=amplitude,
            inertia_torque=inertia_torque,
        )

    branches = tuple(replace(station, stations=tuple(map(cleaned, station.stations))) for station in holzer.branches)
    return replace(holzer, branches=branches)


def _short(branch: Table) -> Table:
    """Table of Holzer stations without values at a shaft's own speed, under short headings."""
    kept = branch.chosen([index for index, column in enumerate(branch.columns) if column.name not in REAL_COLUMNS])
    names = tuple(replace(column, name=SHORT_HEADINGS.get(column.name, column.name)) for column in kept.columns)
    return replace(kept, columns=names)


# Section of a report on natural frequencies: one table, relative amplitudes with nodes, Holzer tables.

MOST_MODES_LISTED, MOST_DRAWN, MOST_HOLZER_TABLES = 10, 4, 3
"""Largest number of modes in the table of the document, in the picture, and with a Holzer table unless more are asked
for: what a reviewer reads on two pages."""
MOST_COMPARED = 8
"""Largest number of modes beside each other in the table of all drivetrains, as more columns do not fit a page."""
MOST_PLACES = 4
"""Largest number of nodes of vibration whose elements the table names; more stand in the Holzer table."""
FREQUENCY_DECIMALS, PER_MINUTE_DECIMALS, DAMPING_DECIMALS = 2, 1, 2
"""Decimals of frequencies in Hz and per minute, and of damping ratios in percent: finer ones are known of no plant."""
COUNTING = (
    "Mode 1 is the lowest vibration; rigid-body motion has no number, overdamped modes count behind all others. The "
    "numbers are the same in all sections. Nodes are counted in the undamped shape, that of the Holzer table."
)
AT_CRITICAL_SPEEDS = "Where critical speeds are listed, it is that of each of them."
"""Sentence behind the one on the speed at which damping is shown."""
BRANCHED = (
    "Nodes are not counted where an element ties three shafts; those along the branches, which it does not tie, are "
    "named."
)
"""Sentence below the table of natural frequencies of a drivetrain with planetary sets or the like."""
PICTURE_TEXT = (
    "Relative amplitudes referred to {node}, the first mass 1; lines as in the Holzer tables, gears dotted. Rings are "
    "nodes of vibration, with the share in percent of the twist between the two masses that lies before the node."
)


def natural_frequencies_section(subject: ReportData) -> Section | None:
    """Section of a report on natural frequencies; None for a model without excitations or without vibrations."""
    if not subject.has_excitations or not all(subject.natural_frequencies) or subject.highest_line is None:
        return None
    listed = [_listed(rows, subject.highest_line[1]) for rows in subject.natural_frequencies]
    blocks: list[Block] = [Paragraph((_range(subject),)), _first_table(subject, listed[0])]
    if len(listed) > 1:
        blocks.append(_compared(subject, listed))
    blocks += _shapes(subject)
    return Section("natural_frequencies", ("Natural frequencies",), tuple(blocks))


def _listed(rows: Sequence[CountedVibration], highest: float) -> tuple[CountedVibration, ...]:
    """Natural frequencies below the highest excitation, in Hz, and the next one, which shows the margin above."""
    above = min((row.lowest for row in rows if row.lowest > highest), default=highest)
    return tuple(row for row in rows if row.lowest <= above)


def _range(subject: ReportData) -> str:
    speeds = subject.model.definition.speeds
    assert subject.highest_line is not None
    assert speeds is not None
    line, highest = subject.highest_line
    what = (
        phrase("order {order:g} of {excitation}", order=line.order, excitation=as_words(line.excitation))
        if line.order
        else as_words(str(line))
    )
    count = len(subject.excited_modes)
    modes = (
        phrase("one natural frequency lies") if count == 1 else phrase("{count} natural frequencies lie", count=count)
    )
    above = any(row.lowest > highest for row in subject.natural_frequencies[0])
    return phrase(
        "The highest excitation is {what}, {frequency:.4g} Hz at {speed:.6g} rpm of {node}; {modes} below{beyond}.",
        what=what,
        frequency=highest,
        speed=speeds.values[-1] * RPM,
        node=as_words(speeds.of),
        modes=modes,
        beyond=phrase(", and the next one is given" if above else ", and none above"),
    )


def _where(subject: ReportData, place: int) -> str:
    cases = subject.judged_drivetrains[place]
    return subject.titles.shared([case.configuration for case in cases]) if cases[0].configuration else ""


def _first_table(subject: ReportData, rows: tuple[CountedVibration, ...]) -> TableBlock:
    several = len(subject.judged_drivetrains) > 1
    where = phrase(" in configuration {name}", name=_where(subject, 0)) if several else ""
    placed = _placed(subject, rows)
    short = tuple(row if len(row.nodes) <= MOST_PLACES else replace(row, nodes=()) for row in placed)
    speed = operating_speed_sentence(subject.judged_drivetrains[0][0].drivetrain)
    notes = (COUNTING, *([BRANCHED] if placed != rows else []), *speed, *([AT_CRITICAL_SPEEDS] if speed else []))
    made = natural_frequency_table("", short, notes)
    block = results_table(made, phrase("Natural frequencies{where}", where=where), most=MOST_MODES_LISTED)
    shown = {subject.conventions.frequency: FREQUENCY_DECIMALS, "1/min": PER_MINUTE_DECIMALS, "%": DAMPING_DECIMALS}
    return with_decimals(block, shown)


def _placed(subject: ReportData, rows: tuple[CountedVibration, ...]) -> tuple[CountedVibration, ...]:
    """Natural frequencies with the nodes on each line of the Holzer table where they cannot be counted as a whole."""
    open_ones = [row.mode for row in rows[:MOST_MODES_LISTED] if row.n_nodes is None]
    tables, _ = _holzer_tables(subject, open_ones)
    places = {
        mode: tuple(
            phrase("in {element}", element=", ".join(node.elements))
            if node.elements
            else phrase("at {node}", node=node.first)
            for node in nodes
        )
        for mode, nodes in ((mode, vibration_nodes(table)) for mode, table in tables.items())
    }
    return tuple(replace(row, nodes=places.get(row.mode, row.nodes)) for row in rows)


def _compared(subject: ReportData, listed: Sequence[tuple[CountedVibration, ...]]) -> TableBlock:
    """Table of the natural frequencies of all drivetrains, a column for each mode."""
    shown = [rows[:MOST_COMPARED] for rows in listed]
    count = max(map(len, shown))
    columns = (
        Heading("Configuration"),
        *(Heading(phrase("Mode {number}", number=place), numeric=True) for place in range(1, count + 1)),
    )
    names = [_where(subject, place) for place in range(len(shown))]
    values: dict[str, list[list[Cell]]] = {
        "Undamped natural frequency, Hz": [
            [NumberText(vibration.undamped_frequency, 4, FREQUENCY_DECIMALS) for vibration in rows] for rows in shown
        ],
        "Undamped vibrations per minute": [
            [NumberText(vibration.per_minute, 4, PER_MINUTE_DECIMALS) for vibration in rows] for rows in shown
        ],
        "Damping ratio, %": [
            [NumberText(100 * vibration.damping_ratio, 4, DAMPING_DECIMALS) for vibration in rows] for rows in shown
        ],
    }
    counts: list[list[Cell]] = [[str(vibration.n_nodes) for vibration in rows] for rows in shown]
    # Numbers of nodes are mostly those of the modes in every drivetrain, and then not said.
    if any(row != counts[0] for row in counts):
        values["Number of nodes"] = counts
    groups = []
    for title, cells in values.items():
        padded = [(name, *row, *([""] * (count - len(row)))) for name, row in zip(names, cells, strict=True)]
        groups.append(TableGroup(merge_equal_rows(padded), title))
    return TableBlock(("Natural frequencies of all drivetrains, by number of the mode",), columns, tuple(groups))


def _shapes(subject: ReportData) -> list[Block]:
    """Picture of relative amplitudes, and Holzer tables of the first drivetrain."""
    excited = subject.excited_modes
    asked = subject.request.plan.holzer
    wanted = (
        excited[:MOST_HOLZER_TABLES] if asked is None else [row.mode for row in subject.natural_frequencies[0]][:asked]
    )
    tables, missing = _holzer_tables(subject, list(dict.fromkeys([*excited[:MOST_DRAWN], *wanted])))
    blocks: list[Block] = []
    drawn = [tables[mode] for mode in excited[:MOST_DRAWN] if mode in tables]
    where = phrase(" Configuration {name}.", name=_where(subject, 0)) if len(subject.judged_drivetrains) > 1 else ""
    if drawn:
        from torsionnet.plot.shapes import relative_amplitudes

        text = phrase(PICTURE_TEXT, node=as_words(drawn[0].referred_to))
        alt = phrase("Relative amplitudes of modes {numbers}", numbers=", ".join(str(row.mode) for row in drawn))
        blocks.append(Picture("relative_amplitudes", relative_amplitudes(drawn), (text, where), alt))
    blocks += [holzer_block(tables[mode], "N/mm^2") for mode in wanted if mode in tables]
    if missing:
        blocks.append(
            Paragraph((phrase("There is no Holzer table of mode {reasons}.", reasons="; of mode ".join(missing)),))
        )
    more = len(excited) - len(wanted)
    if asked is None and more > 0:
        blocks.append(Paragraph(_more(more, len(excited))))
    return blocks


def _more(more: int, count: int) -> Text:
    modes = "One further mode lies" if more == 1 else phrase("{count} further modes lie", count=more)
    return modes, phrase(" below the highest excitation; their Holzer tables follow with holzer: {count}.", count=count)


def _holzer_tables(subject: ReportData, modes: Sequence[int]) -> tuple[dict[int, HolzerTable], list[str]]:
    """Holzer tables of modes of the first drivetrain, by number, and those that have none with the reason."""
    from torsionnet.machinery.holzer.holzer import holzer_table

    held = held_drivetrain(subject.judged_drivetrains[0][0])
    tables, missing = {}, []
    for mode in modes:
        try:
            tables[mode] = holzer_table(held, mode, segments=True)
        except TorsionnetError as error:
            missing.append(f"{mode}: {error}")
    return tables, missing
