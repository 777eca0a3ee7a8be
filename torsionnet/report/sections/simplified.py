"""Section of a report on transfer functions of drivetrains with fewer elements, and their errors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import Block, Cell, Code, Formula, Heading, Math, NumberText, Paragraph, Section
from torsionnet.report.formula_widths import WIDEST_FORMULA, formula_letters
from torsionnet.report.report_data import MOST_SYMBOLIC, ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import first_names, pair_latex, quotient_latex
from torsionnet.symbolic.formula_text import latex

if TYPE_CHECKING:
    from torsionnet.report.plan import Pair
    from torsionnet.symbolic.simplified import Simplified

COLUMNS = (
    Heading("Configuration"),
    Heading("Left out", wide=True),
    Heading("Frequencies off", "%", numeric=True),
    Heading("Damping off", "%", numeric=True),
    Heading("Magnitude off", "dB", numeric=True),
)


DEFAULT_TOLERANCE = 0.01
"""Relative amount by which simplifying may move frequencies and damping of modes, unless another is given."""


def simplified_section(subject: ReportData) -> Section | None:
    """Section of a report on simplified transfer functions; None for a model without transfer functions."""
    if not subject.pairs:
        return None
    tolerance = subject.request.plan.simplify or DEFAULT_TOLERANCE
    if subject.n_coordinates > MOST_SYMBOLIC:
        text = phrase(
            "With {count} coordinates the formulas would not be short enough to be read.", count=subject.n_coordinates
        )
        return Section("simplified", ("Simplified transfer functions",), (Paragraph((text,)),))
    low, high = subject.band
    lead = phrase(
        "Springs become rigid and dampers are left out, the least important first, as long as every "
        "mode up to {high:g} Hz keeps its natural frequency and its damping ratio within {tolerance:g} "
        "%. The magnitude is compared from {first:g} to {last:g} Hz.",
        high=high,
        tolerance=100 * tolerance,
        first=low,
        last=high,
    )
    inner = [
        Section(
            f"simplified-{number}", (Math(pair_latex(pair)),), tuple(_pair(subject.for_pair(pair), pair, tolerance))
        )
        for number, pair in enumerate(subject.pairs, 1)
    ]
    return Section("simplified", ("Simplified transfer functions",), (Paragraph((lead,)), *inner))


def _pair(subject: ReportData, pair: Pair, tolerance: float) -> list[Block]:
    try:
        found = {
            case.configuration: _simplified(subject, number, pair, tolerance)
            for number, case in enumerate(subject.cases)
        }
    except UsageError as error:
        return [Paragraph((phrase("Not simplified: {reason}.", reason=error),))]
    rows: list[tuple[Cell, ...]] = [
        (
            configuration,
            "; ".join(short.changes) or "nothing",
            *(
                NumberText(error, decimals=3)
                for error in (100 * short.errors.omega, 100 * short.errors.zeta, short.errors.decibels)
            ),
        )
        for configuration, short in found.items()
    ]
    formulas: dict[str, list[str]] = {}
    for configuration, short in found.items():
        written = short.transfer_function.mechanical
        text = latex(written) if formula_letters(written) <= WIDEST_FORMULA else ""
        formulas.setdefault(text, []).append(configuration)
    blocks: list[Block] = [table(("What is left out of ", Math(pair_latex(pair))), COLUMNS, rows)]
    for text, names in formulas.items():
        if len(formulas) > 1:
            blocks.append(Paragraph((phrase("Configuration {names}:", names=first_names(names, len(names))),)))
        how = f'model.symbolic().simplified("{pair.output}", "{pair.input}", tolerance={tolerance:g})'
        blocks.append(
            Formula(rf"{quotient_latex(pair)} = {text}")
            if text
            else Paragraph(("The formula is still too long to be read; in Python ", Code(how), " gives it."))
        )
    return blocks


def _simplified(subject: ReportData, number: int, pair: Pair, tolerance: float) -> Simplified:
    low, high = subject.band
    system = subject.cases[number].drivetrain.symbolic()
    return system.simplified(
        pair.output, pair.input, pair.excitation or None, tolerance=tolerance, band=(low or high / 1000, high)
    )
