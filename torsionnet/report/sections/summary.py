"""Section of a report with the results at a glance: lowest modes, peaks and verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.linear.modes.modes import OSCILLATORY
from torsionnet.report.document_tree import Block, Cell, Heading, Inline, Math, Paragraph, Section, TableBlock, Text
from torsionnet.report.plan import Pair
from torsionnet.report.report_data import Case, ReportData, is_damped
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import pair_latex, symbol_or_words, unit
from torsionnet.report.sections.limits import conclusion, verdict
from torsionnet.report.sections.responses import static_value_and_peaks

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.identification import Fit
    from torsionnet.linear.modes.modes import Modes

MOST_VIBRATIONS, MOST_PAIRS = 3, 4
"""Largest number of vibrations and of transfer functions that the summary of a report shows."""


def summary_section(subject: ReportData) -> Section:
    """Section of a report with verdict, lowest natural frequencies, fitted models and highest peaks."""
    judged = subject.limit_conclusion if subject.request.wants("limits") else None
    blocks: list[Block] = [] if judged is None else [verdict(judged)]
    blocks += _of_model(subject.by_drivetrain)
    blocks += [found for fit in subject.request.fits if (found := _fitted(subject, fit)) is not None]
    blocks += [_response(subject.by_drivetrain.for_pair(pair), pair) for pair in subject.pairs[:MOST_PAIRS]]
    if judged is not None:
        blocks.append(conclusion(judged))
    if not blocks:
        blocks.append(Paragraph(("No vibration and no transfer function.",)))
    return Section("summary", ("Results at a glance",), tuple(blocks))


def _fitted(subject: ReportData, fit: Fit) -> TableBlock | None:
    """Table of the lowest natural frequencies in Hz with the fitted values of the parameters.

    None where nothing vibrates.
    """
    modes = tuple(_with_values(fit, case).modes() for case in subject.cases)
    if not any(OSCILLATORY in one.kinds for one in modes):
        return None
    plain = dict.fromkeys(name.partition("[")[0] for name in fit.values)
    names = [name for name in plain if name in subject.model.parameter_definitions]
    note: list[Inline] = ["With the fitted "]
    for name in names:
        note += [", "] * (name != names[0]) + [symbol_or_words(name)]
    title = f" ({fit.title})" if len(subject.request.fits) > 1 and fit.title else ""
    caption = phrase("Lowest natural frequencies and damping ratios of the fitted model{title}", title=title)
    return _vibrations(subject, modes, caption, (*note, "; the values are in the section Fitted parameters."))


def _with_values(fit: Fit, case: Case) -> Drivetrain:
    """Drivetrain of a configuration with the fitted values, those of all configurations and its own."""
    rig = fit.configured(case.drivetrain)
    own = {name.removesuffix(f"[{case.configuration}]"): value for name, value in fit.values.items()}
    return rig.configured(**{name: value for name, value in own.items() if name in rig.parameter_definitions})


def _vibrations(subject: ReportData, shown: tuple[Modes, ...], caption: str, note: Text) -> TableBlock:
    found = [
        [index for index, kind in enumerate(modes.kinds) if kind == OSCILLATORY][:MOST_VIBRATIONS] for modes in shown
    ]
    columns = [Heading("Configuration")]
    cells: list[list[Cell]] = [[case.configuration for case in subject.cases]]
    for place in range(max(map(len, found))):
        picked = [indices[place] if place < len(indices) else None for indices in found]
        pairs = list(zip(shown, picked, strict=True))
        columns += [
            Heading((Math(f"f_{{{place + 1}}}"),), "Hz", numeric=True),
            Heading((Math(rf"\zeta_{{{place + 1}}}"),), "%", numeric=True),
        ]
        cells.append(list(aligned_numbers([None if i is None else float(m.natural_frequencies[i]) for m, i in pairs])))
        cells.append(
            list(aligned_numbers([None if i is None else 100 * float(m.damping_ratios[i]) for m, i in pairs], 3))
        )
    rows = list(zip(*cells, strict=True))
    return table(caption, columns, rows, [note])


def _of_model(subject: ReportData) -> list[TableBlock]:
    if not any(OSCILLATORY in modes.kinds for modes in subject.modes):
        return []
    damped = "Damped vibrations" if any(map(is_damped, subject.cases)) else "Vibrations"
    note = (damped, " of the whole drivetrain; rigid-body motion and overdamped modes are in the section Modes.")
    return [_vibrations(subject, subject.modes, "Lowest natural frequencies and damping ratios", note)]


def _response(subject: ReportData, pair: Pair) -> TableBlock:
    """Table of static value and highest peak of a transfer function in every configuration."""
    found = subject.responses(pair)
    scale, shown = found[0].scale(subject.conventions), unit(found[0].unit(conventions=subject.conventions))
    points = [static_value_and_peaks(subject, pair, response, index) for index, response in enumerate(found)]
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
        aligned_numbers(static),
        aligned_numbers([None if peak is None else peak.magnitude * scale for peak in highest]),
        aligned_numbers([None if peak is None else peak.frequency for peak in highest]),
        aligned_numbers([None if peak is None else peak.phase for peak in highest], 3),
        strict=True,
    )
    low, high = subject.band
    return table(
        (Math(pair_latex(pair)), phrase(" between {low:g} and {high:g} Hz", low=low, high=high)),
        columns,
        list(rows),
    )
