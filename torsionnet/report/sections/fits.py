"""Section of a report on fits, the parameters found and their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.base.number_text import digits_to_error
from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Listing,
    NumberText,
    Paragraph,
    Picture,
    Section,
    TableBlock,
)
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import capital, sentence, symbol_or_words, unit

if TYPE_CHECKING:
    from torsionnet.identification import Fit


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
