"""Sections of a report on frequency responses, calculated and measured, and on fits to them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.notes import Note
from torsionnet.base.number_text import aligned_numbers, digits_to_error
from torsionnet.base.phrases import phrase
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.linear.phase import phase_at_zero_frequency
from torsionnet.linear.responses.grid import Peak, peaks, static_value
from torsionnet.model.channels import Pair
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Section,
    TableBlock,
    TableGroup,
    Text,
)
from torsionnet.report.report_data import FEW_CASES, Case, ReportData, cases_of, is_damped
from torsionnet.report.report_request import Measured
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import capital, channel_latex, pair_latex, sentence, symbol_or_words, unit
from torsionnet.signals.comparison import agreement

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.identification import Fit


# Section of a report on frequency responses: Bode plots by configuration, static values and peaks.

MOST_PEAKS, FEW_PEAKS = 6, 3
"""Number of peaks listed of each configuration where configurations are few, and where they are many."""
LEAST_PROMINENCE = 1.001
"""Least ratio of a listed peak to the higher valley beside it, as smaller ones are ripples."""
MOST_CURVES = 7
"""Largest number of curves in one plot of responses, as more cannot be told apart."""


def responses_section(subject: ReportData) -> Section | None:
    """Section of a report on the frequency responses; None for a model without transfer functions."""
    if not subject.pairs:
        return None
    blocks: list[Block] = []
    for number, pair in enumerate(subject.pairs, 1):
        part = subject.for_pair(pair)
        responses = part.responses(pair)
        listing = peaks_table if len(part.cases) <= FEW_CASES else highest_peaks
        blocks += [_picture(part, pair, responses, number), listing(part, pair, responses), *left_out(subject, pair)]
    return Section("responses", ("Frequency responses",), tuple(blocks))


def left_out(subject: ReportData, pair: Pair) -> Iterator[Block]:
    """Paragraphs on configurations that lack the transfer function, and why they do."""
    part = subject.for_pair(pair)
    if part is not subject:
        for case in subject.cases:
            refusal = subject.why_left_out(case, pair)
            if refusal is not None:
                yield Paragraph(
                    sentence(
                        phrase("Not in configuration {name}: {reason}.", name=case.title, reason=refusal),
                        subject.model,
                    )
                )


def _picture(subject: ReportData, pair: Pair, responses: tuple[FrequencyResponse, ...], number: int) -> Picture:
    from torsionnet.plot.bode_plot import bode

    shown = responses[:MOST_CURVES]
    labels = [case.title for case in subject.cases[:MOST_CURVES]] if len(shown) > 1 else None
    drawn = bode(shown, conventions=subject.conventions, labels=labels, title="")
    label_axes(drawn, pair)
    rest = (
        phrase("; the first {shown} of {count} configurations", shown=len(shown), count=len(responses))
        if len(responses) > len(shown)
        else ""
    )
    overlaid = ", by configuration" if len(responses) > 1 else ""
    kind = responses[0].kind()
    extent = [text for text in (overlaid, rest) if text]
    caption: Text = (Math(pair_latex(pair)), phrase(" ({kind}): magnitude and phase", kind=phrase(kind)), *extent, ".")
    low, high = subject.band
    alt = f"Bode plot of {pair}, {low:g} to {high:g} Hz{overlaid}"
    return Picture(f"bode_{number}", drawn, caption, alt)


def label_axes(figure: Figure, pair: Pair) -> None:
    """Write output and input on the axis as symbols, and remove ticks without a number, which take long to draw."""
    from torsionnet.plot.drawing.labels import symbol

    for panel in figure.axes:
        panel.minorticks_off()
    axes = figure.axes[0]
    shown = "/".join(symbol(name) for name in (pair.output, pair.input))
    axes.set_ylabel(axes.get_ylabel().replace(str(pair), shown))


def peaks_table(subject: ReportData, pair: Pair, responses: tuple[FrequencyResponse, ...]) -> TableBlock:
    """Table of static value and peaks of a transfer function in every configuration of the report."""
    scale, shown = responses[0].scale(subject.conventions), unit(responses[0].unit(conventions=subject.conventions))
    groups = []
    for case, response in zip(subject.cases, responses, strict=True):
        points = static_value_and_peaks(subject, pair, response, list(subject.cases).index(case))
        groups.append((case.title, points))
    several = len(groups) > 1
    columns = (
        *([Heading("Configuration")] if several else []),
        Heading("At"),
        Heading("Frequency", "Hz", numeric=True),
        Heading("Magnitude", shown, numeric=True),
        Heading("Phase", "deg", numeric=True),
    )
    flat = [(name, what, peak) for name, points in groups for what, peak in points]
    cells = zip(
        aligned_numbers([peak.frequency for *_, peak in flat]),
        aligned_numbers([peak.magnitude * scale for *_, peak in flat]),
        [NumberText(peak.phase, 4, 1) for *_, peak in flat],
        strict=True,
    )
    rows: list[tuple[Cell, ...]] = []
    for (name, what, _), row in zip(flat, cells, strict=True):
        # The static value begins the rows of a configuration, whose name stands there alone.
        first = not rows or what == "static value"
        rows.append((*([name if first else ""] if several else []), what, *row))
    notes = (("A negative phase is a lag. Torques are positive as their signs are given with the sensors.",),)
    caption = ("Static values and peaks of ", Math(pair_latex(pair)))
    return TableBlock(caption, columns, (TableGroup(tuple(rows)),), notes)


def highest_peaks(subject: ReportData, pair: Pair, responses: tuple[FrequencyResponse, ...]) -> TableBlock:
    """Table of static value and highest peaks of a transfer function, with a row for each configuration."""
    scale, shown = responses[0].scale(subject.conventions), unit(responses[0].unit(conventions=subject.conventions))
    read = [static_value_and_peaks(subject, pair, response, index) for index, response in enumerate(responses)]
    columns = [Heading("Configuration"), Heading("Static value", shown, numeric=True)]
    lists: list[list[Cell]] = [[case.title for case in subject.cases]]
    lists.append(list(aligned_numbers([points[0][1].magnitude * scale for points in read])))
    best = [sorted(sorted((peak for _, peak in points[1:]), key=lambda peak: -peak.magnitude)[:FEW_PEAKS],
                   key=lambda peak: peak.frequency) for points in read]  # fmt: skip
    for place in range(max(map(len, best))):
        picked = [peaks_[place] if place < len(peaks_) else None for peaks_ in best]
        columns += [
            Heading(phrase("Peak {number}", number=place + 1), "Hz", numeric=True),
            Heading("magnitude", shown, numeric=True),
        ]
        lists.append(list(aligned_numbers([None if peak is None else peak.frequency for peak in picked])))
        lists.append(list(aligned_numbers([None if peak is None else peak.magnitude * scale for peak in picked])))
    caption = ("Static values of ", Math(pair_latex(pair)), phrase(" and its {count} highest peaks", count=FEW_PEAKS))
    return table(caption, columns, list(zip(*lists, strict=True)))


def _stands_out(response: FrequencyResponse, frequency: float) -> bool:
    """Whether the response falls by a thousandth or more to either side before it rises above the peak."""
    size = response.magnitude[:, 0, 0]
    place = int(np.argmin(np.abs(response.frequencies - frequency)))
    window = slice(max(place - 1, 0), place + 2)
    top = int(np.argmax(size[window])) + window.start
    valleys = []
    for side in (size[top::-1], size[top:]):
        higher = np.flatnonzero(side > size[top])
        valleys.append(float(side[: higher[0] if higher.size else None].min()))
    return bool(size[top] > LEAST_PROMINENCE * max(valleys))


def static_value_and_peaks(
    subject: ReportData, pair: Pair, response: FrequencyResponse, index: int
) -> list[tuple[str, Peak]]:
    """Static value and highest peaks of a response, each with its name, in the order of frequency."""
    solve = subject.solver(subject.cases[index], pair)
    value = static_value(solve, 0, 0)
    found_peaks = [peak for peak in peaks(response, solve, 0, 0) if _stands_out(response, peak.frequency)]
    if not is_damped(subject.cases[index]):
        found_peaks = [replace(peak, magnitude=math.inf, phase=math.nan) for peak in found_peaks]
    highest = sorted(
        sorted(found_peaks, key=lambda peak: -peak.magnitude)[:MOST_PEAKS], key=lambda peak: peak.frequency
    )
    rest = [(phrase("peak {number}", number=number), peak) for number, peak in enumerate(highest, 1)]
    return [("static value", Peak(0.0, abs(value), phase_at_zero_frequency(value))), *rest]


# Section of a report on tests, with measured responses over those of the model.


def comparison_section(subject: ReportData) -> Section:
    """Section of a report that compares each measured response with the model."""
    blocks: list[Block] = []
    for number, test in enumerate(subject.request.tests, 1):
        blocks += _test(subject, test, number)
    return Section("test", ("Test and model",), tuple(blocks))


def _case(subject: ReportData, test: Measured) -> Case:
    if test.configuration:
        return cases_of(subject.model, (test.configuration,))[0]
    if len(subject.cases) > 1:
        names = ", ".join(case.configuration for case in subject.cases)
        raise UsageError(f"a test is of one configuration; choose it: {names}", kind="unknown-configuration")
    return subject.cases[0]


def _test(subject: ReportData, test: Measured, number: int) -> list[Block]:
    from torsionnet.plot.comparison_plot import comparison

    case, measured = _case(subject, test), test.response
    model = calculated(case, measured, test.excitation)
    shown = subject.conventions
    where = phrase(", configuration {name}", name=case.title) if case.title else ""
    pair = f"{channel_latex(measured.outputs[0].name)} / {channel_latex(measured.inputs[0].name)}"
    caption = (Math(pair), phrase(", test and model{where}. Differences are test minus model.", where=where))
    alt = f"Test over model of {measured.outputs[0].name}/{measured.inputs[0].name}{where}"
    notes = [capital(note.named if isinstance(note, Note) else note) + "." for note in measured.notes]
    drawn = comparison(measured, model, conventions=shown, title="")
    label_axes(drawn, Pair(measured.outputs[0].name, measured.inputs[0].name))
    return [
        Picture(f"test_{number}", drawn, caption, alt),
        _agreement(measured, model, shown, pair, where),
        *([Paragraph(sentence(" ".join(notes), case.drivetrain))] if notes else []),
    ]


def calculated(case: Case, measured: FrequencyResponse, excitation: str | None = None) -> FrequencyResponse:
    """Response of the model at the frequencies of a test, under the test's names of output and input."""
    output, into = measured.outputs[0].name, measured.inputs[0].name
    response = case.drivetrain.frequency_response(output, into, measured.frequencies, driven_by=excitation)
    return replace(
        response, outputs=_renamed(response, measured, "outputs"), inputs=_renamed(response, measured, "inputs")
    )


def _renamed(response: FrequencyResponse, measured: FrequencyResponse, side: str) -> tuple:  # type: ignore[type-arg]
    pairs = zip(getattr(response, side), getattr(measured, side), strict=True)
    return tuple(replace(mine, name=theirs.name) for mine, theirs in pairs)


def _agreement(
    measured: FrequencyResponse, model: FrequencyResponse, shown: Conventions, pair: str, where: str
) -> TableBlock:
    apart = agreement(measured, model, shown)
    columns = (Heading("Quantity"), Heading("At", "Hz", numeric=True), Heading("Value", numeric=True), Heading("Unit"))
    rows = [
        (capital(row[0]), NumberText(row[1]) if row[1] is not None else "", NumberText(row[2]), unit(row[3]))
        for row in apart.rows
    ]
    notes = [capital(note) + "." for note in apart.notes]
    return table((Math(pair), phrase(", how far test and model are apart{where}", where=where)), columns, rows, notes)


# Section of a report on fits, the parameters found and their intervals.


def fit_section(subject: ReportData) -> Section:
    """Section of a report with table, comparison and correlations of each fit."""
    blocks: list[Block] = []
    for number, fit in enumerate(subject.request.fits, 1):
        blocks += _fit(subject, fit, number)
    return Section("fit", ("Fitted parameters",), tuple(blocks))


def _fit(subject: ReportData, fit: Fit, number: int) -> list[Block]:
    from torsionnet.plot.fits import correlation
    from torsionnet.plot.fits import fit as drawing

    blocks: list[Block] = [_table(subject, fit)]
    if fit.verdicts:
        blocks.append(Listing(tuple(sentence(capital(verdict) + ".", subject.model) for verdict in fit.verdicts)))
    if fit.notes:
        blocks.append(Paragraph((" ".join(capital(note) + "." for note in fit.notes),)))
    if fit.comparisons:
        caption = "Test, fitted model estimated alike, and what is left over in units of its noise."
        drawn = drawing(fit, conventions=subject.conventions, title="")
        blocks.append(Picture(f"fit_{number}", drawn, (caption,), caption))
    if len(fit.values) > 1:
        caption = "Correlation of the fitted parameters; near 1 or −1 the data cannot tell two of them apart."
        blocks.append(Picture(f"correlation_{number}", correlation(fit, title=""), (caption,), caption))
    return blocks


def _table(subject: ReportData, fit: Fit) -> TableBlock:
    intervals = fit.intervals()
    columns = (
        Heading("Parameter"),
        Heading("In the model", numeric=True),
        Heading("Fitted", numeric=True),
        Heading("Standard error", numeric=True),
        Heading("95 % from", numeric=True),
        Heading("to", numeric=True),
        Heading("Unit"),
    )
    known = subject.model.parameters
    rows: list[tuple[Cell, ...]] = [
        (
            symbol_or_words(name),
            NumberText(known[name]) if name in known else "",
            NumberText(value, shown := digits_to_error(value, fit.standard_errors[name])),
            NumberText(fit.standard_errors[name], 2),
            *(NumberText(edge, shown) for edge in intervals[name]),
            unit(fit.units.get(name, "")),
        )
        for name, value in fit.values.items()
    ]
    chi = phrase(
        "Chi squared {value:.4g}. Neighbouring lines share noise: together they are worth {count} "
        "degrees of freedom, with which the intervals are made.",
        value=fit.chi_squared,
        count=fit.degrees_of_freedom,
    )
    return table(fit.title or "Fitted parameters", columns, rows, [chi])
