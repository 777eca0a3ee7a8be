"""The few numbers a reader looks for first."""

from __future__ import annotations

from torsionnet.document.sections.responses import read_off
from torsionnet.document.subject import Subject, is_damped
from torsionnet.document.tree import Block, Cell, Heading, Math, Paragraph, Section, Table, table
from torsionnet.document.words import aligned, pair_latex, unit
from torsionnet.outline import Pair
from torsionnet.response.modes import OSCILLATORY

MOST_VIBRATIONS, MOST_PAIRS = 3, 4


def summary_section(subject: Subject) -> Section:
    blocks: list[Block] = [_vibrations(subject)] if any(OSCILLATORY in modes.kinds for modes in subject.modes) else []
    blocks += [_response(subject.about(pair), pair) for pair in subject.pairs[:MOST_PAIRS]]
    if not blocks:
        blocks.append(Paragraph(("No vibration and no transfer function.",)))
    return Section("summary", ("Results at a glance",), tuple(blocks))


def _vibrations(subject: Subject) -> Table:
    found = [
        [index for index, kind in enumerate(modes.kinds) if kind == OSCILLATORY][:MOST_VIBRATIONS]
        for modes in subject.modes
    ]
    columns = [Heading("Configuration")]
    cells: list[list[Cell]] = [[case.configuration for case in subject.cases]]
    for place in range(max(map(len, found))):
        picked = [indices[place] if place < len(indices) else None for indices in found]
        pairs = list(zip(subject.modes, picked, strict=True))
        columns += [
            Heading((Math(f"f_{{{place + 1}}}"),), "Hz", numeric=True),
            Heading((Math(rf"\zeta_{{{place + 1}}}"),), "%", numeric=True),
        ]
        cells.append(list(aligned([None if i is None else float(m.natural_frequencies[i]) for m, i in pairs])))
        cells.append(list(aligned([None if i is None else 100 * float(m.damping_ratios[i]) for m, i in pairs], 3)))
    rows = list(zip(*cells, strict=True))
    damped = "Damped vibrations" if any(map(is_damped, subject.cases)) else "Vibrations"
    note = f"{damped} of the whole drivetrain; rigid-body motion and overdamped modes are in the section Modes."
    return table("Lowest natural frequencies and damping ratios", columns, rows, [note])


def _response(subject: Subject, pair: Pair) -> Table:
    """Static value and highest peak."""
    found = subject.responses(pair)
    scale, shown = found[0].scale(subject.conventions), unit(found[0].unit(conventions=subject.conventions))
    points = [read_off(subject, pair, response, index) for index, response in enumerate(found)]
    static = [entries[0][1].magnitude * scale for entries in points]
    highest = [
        max((peak for _, peak in entries[1:]), key=lambda peak: peak.magnitude, default=None) for entries in points
    ]
    columns = (
        Heading("Configuration"),
        Heading("Static value", shown, numeric=True),
        Heading("Highest peak", shown, numeric=True),
        Heading("at", "Hz", numeric=True),
        Heading("Phase there", "deg", numeric=True),
    )
    rows = zip(
        [case.configuration for case in subject.cases],
        aligned(static),
        aligned([None if peak is None else peak.magnitude * scale for peak in highest]),
        aligned([None if peak is None else peak.frequency for peak in highest]),
        aligned([None if peak is None else peak.phase for peak in highest], 3),
        strict=True,
    )
    low, high = subject.band
    return table((Math(pair_latex(pair)), f" between {low:g} and {high:g} Hz"), columns, list(rows))
