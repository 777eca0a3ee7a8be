"""Section of a report on transfer functions in symbols: mechanical form, polynomials, limits."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.channels import Pair
from torsionnet.report.document_tree import (
    Block,
    BreakableMath,
    Cell,
    Code,
    Details,
    Formula,
    Heading,
    Math,
    NumberText,
    Paragraph,
    Section,
    Strong,
    TableBlock,
    Text,
)
from torsionnet.report.report_data import FEW_CASES, MOST_SYMBOLIC, Case, ReportData, SymbolicEquations, titles_of
from torsionnet.report.report_tables import WIDEST_FORMULA, formula_letters, table
from torsionnet.report.report_text import capital, first_names, pair_latex, quotient_latex, sentence, unit
from torsionnet.symbolic.algebra.delay import delays_of
from torsionnet.symbolic.equations import sum_terms
from torsionnet.symbolic.formula_text import latex, polynomial_latex
from torsionnet.symbolic.rational import rational
from torsionnet.symbolic.symbol_names import symbol_latex

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.symbolic.simplified import Simplified
    from torsionnet.symbolic.transfer_function import TransferFunction


FORMULA_OPERATIONS, MOST_OPERATIONS = 70, 420
"""Largest number of operations of a transfer function written in one formula, and of one written as table of steps."""
MOST_UNFOLDED_STEPS = 24
"""Number of steps of a formula up to which a reader sees all of them; more are folded away."""

MOST_ORDER = 10
"""Order up to which a report writes out the coefficients of a transfer function's polynomials."""
MOST_TERMS = 14
"""Largest number of terms of a coefficient that a report writes out."""


def formulas_section(subject: ReportData) -> Section | None:
    """Section of a report with the transfer functions in symbols; None without any."""
    if not subject.pairs:
        return None
    blocks: list[Block] = []
    for number, pair in enumerate(subject.pairs, 1):
        inner: list[Block] = []
        part = subject.for_pair(pair)
        for form in _forms(part):
            if len(form.cases) < len(part.cases):
                names = titles_of(form.cases)
                inner.append(Paragraph((Strong(phrase("Configuration {name}", name=names)),)))
            inner += _function(part, pair, form)
        blocks.append(Section(f"formula-{number}", (Math(pair_latex(pair)),), tuple(inner)))
    return Section("formulas", ("Transfer functions in symbols",), tuple(blocks))


def _forms(subject: ReportData) -> tuple[SymbolicEquations, ...]:
    """Equations in symbols of all configurations if they are few, else those of the first configuration."""
    if subject.n_coordinates <= MOST_SYMBOLIC and len(subject.symbolic_equations) <= FEW_CASES:
        return subject.symbolic_equations
    return (SymbolicEquations(subject.cases[:1], subject.cases[0].drivetrain.symbolic()),)


def _function(subject: ReportData, pair: Pair, form: SymbolicEquations) -> list[Block]:
    try:
        function = form.system.transfer_function(pair.output, pair.input, pair.excitation or None)
        operations = function.program.operations
    except UsageError as error:
        return [Paragraph((phrase("Not written in symbols: {reason}.", reason=error),))]
    rig = form.cases[0].drivetrain
    blocks: list[Block] = [Paragraph(_introduction(function, rig))]
    asked = pair in subject.request.pairs
    if operations > (MOST_OPERATIONS if asked else FORMULA_OPERATIONS):
        text = phrase("Written out it takes {count} additions, multiplications and divisions", count=operations)
        how = f"--tf {pair.output}/{pair.input}" if operations <= MOST_OPERATIONS else (
            f'model.symbolic().transfer_function("{pair.output}", "{pair.input}").python_code()'
        )  # fmt: skip
        lead = "; " if operations <= MOST_OPERATIONS else ", which would fill pages; in Python "
        return [*blocks, Paragraph((text, lead, Code(how), " gives them."))]
    # The formula of a large drivetrain can take hours to write, however few operations its steps have.
    small = subject.n_coordinates <= MOST_SYMBOLIC
    if (
        small
        and operations <= FORMULA_OPERATIONS
        and function.nested_leaves <= 10 * FORMULA_OPERATIONS
        and formula_letters(function.mechanical) <= WIDEST_FORMULA
    ):
        blocks.append(Formula(rf"{quotient_latex(pair)} = {latex(function.mechanical)}"))
        blocks += [*_polynomial(function, pair, form.cases), _limits(function, pair)]
        return blocks
    return [*blocks, *_steps(function, pair, limits=small)]


def _introduction(function: TransferFunction, rig: Drivetrain) -> Text:
    output, into = function.channels
    response = FrequencyResponse(np.empty(0), np.empty((0, 1, 1), dtype=complex), (output,), (into,))
    kind = phrase(capital(response.kind()))
    lead = phrase("{kind} in {unit}.", kind=kind, unit=unit(response.unit())) if response.unit() != "1" else f"{kind}."
    notes = [inline for note in function.notes for inline in (" ", *sentence(capital(note), rig), ".")]
    return (lead, *notes)


def _polynomial(function: TransferFunction, pair: Pair, cases: tuple[Case, ...]) -> list[Block]:
    if delays_of(function.used_tables):  # which are no polynomials in s
        return []
    quotient = rational(function)  # of any length; what is too long is not written
    order = len(quotient.denominator) - 1
    if order > MOST_ORDER or max(map(_terms, (*quotient.numerator, *quotient.denominator))) > MOST_TERMS:
        text = phrase(
            "As a quotient of polynomials in s it has order {order}; the coefficients are too long to be read.",
            order=order,
        )
        return [Paragraph((text,))]
    above, below = (
        polynomial_latex(
            [sympy.Symbol(f"{letter}_{k}") if value != 0 else sympy.Integer(0) for k, value in enumerate(part)]
        )
        for letter, part in zip("ba", quotient.ascending, strict=True)
    )
    where = list(quotient.where.items())
    rows = [(Math(symbol_latex(str(name))), BreakableMath(_terms_of(value))) for name, value in where]
    columns = (Heading("Coefficient"), Heading("Expression", wide=True))
    return [
        Paragraph(("As a quotient of polynomials in ", Math("s"), ":")),
        Formula(rf"{quotient_latex(pair)} = \frac{{{above}}}{{{below}}}"),
        table(("Coefficients of ", Math(pair_latex(pair))), columns, rows),
        _numbers(where, pair, cases),
    ]


def _terms(expression: Any) -> int:
    return max(len(expression.args) if expression.is_Add else 1, int(sympy.count_ops(expression)) // 8)


def _terms_of(expression: Any) -> tuple[str, ...]:
    r"""LaTeX terms of a sum between which lines may break; one too wide for a line breaks in its brackets, too.

    >>> a, b, *c = sympy.symbols("a b mass_1:15")
    >>> _terms_of(a * (b + c[0]))
    ('a \\left(b + \\mathrm{mass}_{1}\\right)',)
    >>> [_terms_of(a * (b + sum(c)))[place] for place in (0, 1, -1)]
    ['a (b', '+ \\mathrm{mass}_{1}', '+ \\mathrm{mass}_{9})']
    """
    if max(map(formula_letters, sympy.Add.make_args(expression))) <= WIDEST_FORMULA:
        return tuple(sum_terms(expression))
    text = " ".join(sum_terms(expression)).replace(r"\left(", "(").replace(r"\right)", ")")
    terms = [""]
    for piece in re.split(r" (?=[+-] )", text):
        # Within braces, as those of a fraction, a line does not break.
        if terms[-1].count("{") > terms[-1].count("}"):
            terms[-1] += f" {piece}"
        else:
            terms.append(piece)
    return tuple(terms[1:])


def _numbers(where: list[tuple[Any, Any]], pair: Pair, cases: tuple[Case, ...]) -> TableBlock:
    columns = [Heading("Coefficient")]
    columns += [Heading(case.title or "Value", numeric=True) for case in cases]
    values = [
        {
            sympy.Symbol(n): sympy.Rational(str(v)) if _exact(v) else sympy.Float(v)
            for n, v in case.drivetrain.exact_values.items()
        }
        for case in cases
    ]
    rows: list[tuple[Cell, ...]] = []
    for name, expression in where:
        numbers = [_number(expression.xreplace(known)) for known in values]
        rows.append((Math(symbol_latex(str(name))), *numbers))
    return table(("Coefficients of ", Math(pair_latex(pair)), " in numbers, SI units"), columns, rows)


def _number(value: Any) -> Cell:
    """Coefficient of a polynomial as a cell.

    One with a tabulated stiffness depends on the frequency and has no number.
    """
    return NumberText(float(value), 5) if value.is_number else "depends on frequency"


def _exact(value: Any) -> bool:
    return not isinstance(value, float)


def _limits(function: TransferFunction, pair: Pair) -> TableBlock:
    arrow = {"low": r"s \to 0", "high": r"s \to \infty"}
    static, low = function.static_gain, function.low_frequency
    rows: list[tuple[Cell, ...]] = [("Static value", _limit(static))]
    rows += [(("Low frequency, ", Math(arrow["low"])), _limit(low))] if low != static else []
    if not delays_of(function.used_tables):  # with a delay there is no leading term
        rows.append((("High frequency, ", Math(arrow["high"])), _limit(function.high_frequency)))
    return table(("Limits of ", Math(pair_latex(pair))), (Heading("Limit"), Heading("Leading term", wide=True)), rows)


def _limit(expression: Any) -> Cell:
    if expression in (sympy.oo, sympy.zoo):
        return "infinite: nothing holds the drivetrain"
    if (
        sympy.count_ops(expression) > MOST_OPERATIONS
        or max(map(formula_letters, sympy.Add.make_args(expression))) > WIDEST_FORMULA
    ):
        return "too long to be read"
    return BreakableMath(_terms_of(expression))


def _steps(function: TransferFunction, pair: Pair, *, limits: bool) -> list[Block]:
    names, result = function.program.where()
    above, below = sympy.fraction(result)
    names = {**names, sympy.Symbol("N"): above, sympy.Symbol("D"): below}
    rows = [(Math(symbol_latex(str(name))), BreakableMath(_terms_of(value))) for name, value in names.items()]
    columns = (Heading("Step"), Heading("Expression", wide=True))
    steps: list[Block] = [
        table(("Steps of ", Math(pair_latex(pair))), columns, rows),
        Formula(rf"{quotient_latex(pair)} = \frac{{N}}{{D}}"),
    ]
    after: list[Block] = [_limits(function, pair)] if limits else []
    if len(rows) <= MOST_UNFOLDED_STEPS:
        return [Paragraph(("Written in steps, each of which uses those before it:",)), *steps, *after]
    title: Text = (phrase("{count} steps, each of which uses those before it", count=len(rows)),)
    code = Code(f'model.symbolic().transfer_function("{pair.output}", "{pair.input}").python_code()')
    instead: Text = (
        phrase("Written in symbols it takes {count} steps: the report as HTML has them, in Python ", count=len(rows)),
        code,
        ".",
    )
    return [Details(title, tuple(steps), instead), *after]


# Section of a report on transfer functions of drivetrains with fewer elements, and their errors.

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
        simplified = {
            case.title: _simplified(subject, number, pair, tolerance) for number, case in enumerate(subject.cases)
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
        for configuration, short in simplified.items()
    ]
    formulas: dict[str, list[str]] = {}
    for configuration, short in simplified.items():
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
