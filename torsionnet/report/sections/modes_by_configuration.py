"""Section of a report on the modes of every configuration: frequencies, damping, energies, shapes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.conventions import OSCILLATORY, counting_notes
from torsionnet.base.number_text import MISSING_TYPESET, aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Details,
    Heading,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Section,
    TableBlock,
    TableGroup,
    Text,
    inlines,
)
from torsionnet.report.report_data import FEW_CASES, MOST_MODES, ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, pair_latex, sentence, symbol_or_words

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.modes.modes import Modes

LEAST_SHARE, MOST_SHARES = 0.05, 4
"""Least share of the energy for which a mode's table names an element, and largest number of elements it names."""
MOST_DRAWN = 6
"""Largest number of configurations whose mode shapes a report draws."""
SHOWS_THESE = " shows these, not the modes of the whole drivetrain."
"""End of the sentence that says what the poles over a measured input are."""
KIND_WORDS = {"oscillatory": "vibration"}
"""Words of the report for kinds of modes where it has other words than the tables on the screen."""
COLUMNS = (
    Heading("Mode", numeric=True),
    Heading("Kind"),
    Heading((Math("f_{n}"),), "Hz", numeric=True),
    Heading((Math("f_{d}"),), "Hz", numeric=True),
    Heading((Math(r"\zeta"),), "%", numeric=True),
    Heading("Description", wide=True),
)


def modes_section(subject: ReportData) -> Section:
    """Section of a report on the modes: tables, energies and shapes, and poles against measured inputs."""
    blocks: list[Block] = [Paragraph(_introduction(subject))]
    caption = "Modes by configuration" if 1 < len(subject.cases) <= FEW_CASES else "Modes"
    if not any(map(len, subject.modes)):
        return Section("modes", ("Modes",), (Paragraph(("Nothing can move: there are no modes.",)),))
    blocks += listed_modes(subject, subject.modes, (caption,), energies=True)
    blocks.append(_shapes(subject))
    for pair in subject.pairs:
        part = subject.for_pair(pair)
        cut = part.cut_modes(pair)
        if cut is not None and len(cut[0]):
            blocks += _cut(part, pair_latex(pair), pair.input, cut)
    return Section("modes", ("Modes",), tuple(blocks))


def _introduction(subject: ReportData) -> Text:
    text: Text = (
        "Free vibration with damping: ", Math(r"f_{n} = \left|\lambda\right|/2\pi"), " is the natural frequency, ",
        Math(r"f_{d} = \mathrm{Im}\,\lambda/2\pi"), " the frequency of the damped vibration, ",
        Math(r"\zeta = -\mathrm{Re}\,\lambda/\left|\lambda\right|"), " the damping ratio.",
    )  # fmt: skip
    if subject.is_large or any(len(modes) == MOST_MODES < subject.n_coordinates for modes in subject.modes):
        text = (
            *text,
            phrase(
                " The model has {count} coordinates; the lowest {shown} modes are shown.",
                count=subject.n_coordinates,
                shown=MOST_MODES,
            ),
        )
    return text


def modes_table(subject: ReportData, modes_by_case: tuple[Modes, ...], caption: Text) -> TableBlock:
    """Table of modes with a group of rows for each configuration of the report."""
    groups = []
    for case, modes in zip(subject.cases, modes_by_case, strict=True):
        title = phrase("Configuration {name}", name=case.title) if len(subject.cases) > 1 else ""
        groups.append(TableGroup(_rows(modes, case.drivetrain), title))
    return TableBlock(caption, COLUMNS, tuple(groups), tuple(_notes(subject, modes_by_case)))


def listed_modes(
    subject: ReportData, modes_by_case: tuple[Modes, ...], caption: Text, *, energies: bool = False
) -> list[Block]:
    """Tables of the modes of every configuration of the report.

    Of many cases the first in full, and how frequencies and damping vary.
    """

    def full(part: ReportData, modes: tuple[Modes, ...], said: Text) -> list[Block]:
        return [modes_table(part, modes, said), *([_energies(part, modes)] if energies else [])]

    if len(subject.cases) <= FEW_CASES:
        return full(subject, modes_by_case, caption)
    first, rest = replace(subject, cases=subject.cases[:1]), replace(subject, cases=subject.cases[1:])
    where = phrase(", configuration {name}", name=subject.cases[0].title)
    folded = Details(
        (phrase("Modes of the other {count} configurations in full", count=len(rest.cases)),),
        tuple(full(rest, modes_by_case[1:], caption)),
        ("The report as HTML has the modes of the other configurations in full.",),
    )
    compared = [_compared(subject, modes_by_case, caption, damping=damping) for damping in (False, True)]
    return [*full(first, modes_by_case[:1], (*caption, where)), *[each for each in compared if each], folded]


def _compared(
    subject: ReportData, modes_by_case: tuple[Modes, ...], caption: Text, *, damping: bool
) -> TableBlock | None:
    """Table of natural frequencies (Hz) or damping ratios with a row for each configuration of the report.

    None without vibrations.
    """
    swings = [[index for index, kind in enumerate(modes.kinds) if kind == OSCILLATORY] for modes in modes_by_case]
    letter, shown = (r"\zeta", "%") if damping else ("f", "Hz")
    columns = [Heading("Configuration")]
    lists: list[list[Cell]] = [[case.title for case in subject.cases]]
    for place in range(max(map(len, swings))):
        values = [
            (100 * float(modes.damping_ratios[at[place]]) if damping else float(modes.natural_frequencies[at[place]]))
            if place < len(at)
            else None
            for modes, at in zip(modes_by_case, swings, strict=True)
        ]
        columns.append(Heading((Math(f"{letter}_{{{place + 1}}}"),), shown, numeric=True))
        lists.append(list(aligned_numbers(values, 3 if damping else 4)))
    if len(columns) == 1:
        return None
    ratios, frequencies = ": damping ratios", ": natural frequencies"
    said = (*caption, ratios if damping else frequencies, " of the vibrations in every configuration")
    return table(said, columns, list(zip(*lists, strict=True)))


def _rows(modes: Modes, rig: Drivetrain) -> tuple[tuple[Cell, ...], ...]:
    swings = [kind == OSCILLATORY for kind in modes.kinds]

    def column(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[NumberText]:
        return aligned_numbers(
            [float(value) if shown else None for value, shown in zip(values, swings, strict=True)], 5
        )

    natural, damped = column(modes.natural_frequencies), column(modes.damped_frequencies)
    ratios = aligned_numbers(
        [100 * float(value) if shown else None for value, shown in zip(modes.damping_ratios, swings, strict=True)], 3
    )
    return tuple(
        (
            _number(modes, index), KIND_WORDS.get(modes.kinds[index], modes.kinds[index]), natural[index],
            damped[index], ratios[index], sentence(capital(modes.descriptions[index]), rig),
        )
        for index in range(len(modes))
    )  # fmt: skip


def _number(modes: Modes, index: int) -> Cell:
    number = modes.numbers[index]
    return MISSING_TYPESET if number is None else str(number)


def _notes(subject: ReportData, modes_by_case: tuple[Modes, ...]) -> list[Text]:
    """Texts of the notes under a table of modes: undamped natural frequencies, and notes of the calculation."""
    notes: list[Text] = []
    for case, modes in zip(subject.cases, modes_by_case, strict=True):
        where = f"{case.title}: " if len(subject.cases) > 1 else ""
        undamped = [f"{value:.4g}" for value in modes.undamped_natural_frequencies[:MOST_MODES] if value > 0]
        notes.append((f"{where}{', '.join(undamped)} Hz",))
    listed = "; ".join(str(note[0]) for note in notes)
    remarks = dict.fromkeys(note for modes in modes_by_case for note in modes.notes)
    lead = ("Undamped natural frequencies: ", listed)
    counted = counting_notes([number for modes in modes_by_case for number in modes.numbers])
    counting: list[Text] = [(capital(note), ".") for note in counted]
    return [*counting, lead, *((*sentence(capital(note), subject.model), ".") for note in remarks)]


def _energies(subject: ReportData, modes_by_case: tuple[Modes, ...]) -> TableBlock:
    columns = (
        Heading("Mode"),
        Heading("Kinetic energy", wide=True),
        Heading("Strain energy", wide=True),
        Heading("Dissipated power", wide=True),
    )
    groups = []
    for case, modes in zip(subject.cases, modes_by_case, strict=True):
        rows = tuple((modes.names[index], *_energy(modes, index)) for index in range(len(modes)))
        groups.append(
            TableGroup(rows, phrase("Configuration {name}", name=case.title) if len(subject.cases) > 1 else "")
        )
    note = phrase("Shares of at least {share:.0f} %, the {count} largest.", share=100 * LEAST_SHARE, count=MOST_SHARES)
    return TableBlock(("Where the energy of each mode is",), columns, tuple(groups), ((note,),))


def _energy(modes: Modes, index: int) -> tuple[str, str, str]:
    """Texts on where the kinetic energy, strain energy and dissipated power of a mode are."""
    return (
        _energy_shares_text(modes.elements, modes.kinetic[:, index]),
        _energy_shares_text(modes.elements, modes.strain[:, index]),
        _energy_shares_text(modes.elements, modes.dissipated[:, index]),
    )


def _energy_shares_text(elements: tuple[str, ...], shares: np.ndarray[tuple[int], np.dtype[np.float64]]) -> str:
    """Text of the elements of a mode with their shares of the energy: ``dmf 79 %, half shaft 21 %``."""
    order = np.argsort(-np.round(shares, 9), kind="stable")[:MOST_SHARES]
    kept = [index for index in order if shares[index] >= LEAST_SHARE]
    if not kept and shares.any():
        largest = as_words(elements[order[0]])
        return f"spread over many, at most {100 * shares[order[0]]:.1f}\N{NO-BREAK SPACE}% in {largest}"
    return (
        ", ".join(f"{as_words(elements[index])} {100 * shares[index]:.0f}\N{NO-BREAK SPACE}%" for index in kept) or "–"
    )


def _shapes(subject: ReportData) -> Picture:
    from torsionnet.plot.shape_grid import shape_grid
    from torsionnet.plot.shapes import shape_view

    cases, modes = subject.cases[:MOST_DRAWN], subject.modes[:MOST_DRAWN]
    drawn = shape_grid(modes, [case.drivetrain for case in cases], [case.title for case in cases])
    rest = len(subject.cases) - len(cases)
    views = [shape_view(modes_of_case, case.drivetrain) for modes_of_case, case in zip(modes, cases, strict=True)]
    # The caption explains dotted lines only where a shape runs across a gear.
    geared = any(join.kind == "gear" for view in views for join in view.axis.joins)
    caption = (
        phrase(
            "Mode shapes: {what}, the largest 1. Filled dots are the real part; open dots the imaginary "
            "part, where the nodes do not move in phase or against each other.",
            what=views[0].label,
        ),
        *([" Dotted lines are gears."] if geared else []),
        *(
            [phrase(" The first {shown} of {count} configurations.", shown=len(cases), count=len(subject.cases))]
            if rest
            else []
        ),
    )
    alt = "Mode shapes of " + "; ".join(modes[index].title for index in range(len(modes)))
    return Picture("mode_shapes", drawn, caption, alt)


def _cut(subject: ReportData, pair: str, measured: str, cut: tuple[Modes, ...]) -> list[Block]:
    poles = " the poles are others: those of the drivetrain cut where it is measured. A test of "
    text: Text = ("Against the measured ", *inlines(symbol_or_words(measured)), poles, Math(pair), SHOWS_THESE)
    caption: Text = ("Poles of ", Math(pair), ", the drivetrain cut at ", *inlines(symbol_or_words(measured)))
    return [Paragraph(text), *listed_modes(subject, cut, caption)]
