"""Section of a report on studies, what varied, what was asked of every variant, and the conclusions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from torsionnet.base.errors import SolveError
from torsionnet.base.number_text import typeset_unit
from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Facts,
    Heading,
    Listing,
    NumberText,
    Picture,
    Remark,
    Section,
    TableBlock,
    Text,
)
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import in_shown_units, results_table, table
from torsionnet.report.report_text import capital, first_names, sentence, symbol_or_words, unit
from torsionnet.study.run.answering import study_for_answers
from torsionnet.study.space.variations.variation import NominalReader, nominals
from torsionnet.study.study import ShownUnits, shown_units
from torsionnet.study.study_result import read_notes

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.study.study import Study
    from torsionnet.study.study_result import StudyResult


# Tables of a report on what varies in a study: distributions, values and correlations.

SIGNIFICANT_DIGITS = 5
"""Number of significant digits that a report writes of the numbers in a distribution."""
MOST_NAMES = 4
"""Largest number of configurations that a row of a study's table names."""


@dataclass(frozen=True)
class EqualVariation:
    """Variation of a parameter in the configurations in which it varies in the same way; numbers in SI."""

    cases: tuple[str, ...]
    given: float | None
    sizes: dict[str, float]


def varied_parameters(study: Study, units: ShownUnits) -> TableBlock:
    """Table of the parameters that a study varies.

    Unit, value in the model, distribution, and its text in the study.
    """
    alike = {name: list(_by_configuration(study, name)) for name in study.space.names}
    columns = (
        Heading("Parameter"),
        Heading("Configuration"),
        Heading("Unit"),
        Heading("In the model", numeric=True),
        Heading("Distribution"),
        Heading("Numbers", wide=True),
        Heading("As written"),
    )
    rows: list[tuple[Cell, ...]] = []
    for name, variation in study.space.entries.vary.items():
        written = ", ".join(f"{key} {_plain(value)}" for key, value in variation.written_entries().items())
        for equal in alike[name]:
            where = first_names(equal.cases, MOST_NAMES) if len(alike[name]) > 1 else ""
            given = "" if equal.given is None else NumberText(equal.given * units.scale(name), SIGNIFICANT_DIGITS)
            numbers = _distribution_text(equal.sizes, units.scale(name))
            rows.append(
                (symbol_or_words(name), where, unit(units.unit(name)), given, variation.words, numbers, written)
            )
    return table("What varies", columns, rows)


def correlations(study: Study) -> Iterator[TableBlock]:
    """Table of a study's correlated parameters and their coefficients of correlation.

    Nothing where none are correlated.
    """
    rows: list[tuple[Cell, ...]] = [
        (_names(correlation.between), NumberText(correlation.coefficient))
        for correlation in study.space.entries.correlation
    ]
    if rows:
        columns = (Heading("Parameters"), Heading("Coefficient", numeric=True))
        note = "Linear correlation of the values, of every two where more are named (Gaussian copula)."
        yield table("Correlation of the parameters", columns, rows, [note])


def _names(names: tuple[str, ...]) -> Text:
    first, *others = names
    return (symbol_or_words(first), *(part for name in others for part in (", ", symbol_or_words(name))))


def _by_configuration(study: Study, name: str) -> Iterator[EqualVariation]:
    """Variations of a parameter in a study, configurations with the same value in the model together."""
    by_values: dict[tuple[float | None, ...], EqualVariation] = {}
    for case in study.configurations:
        nominal = nominals(study.model_in(case), [name])[name]
        sizes = study.space.entries.vary[name].sizes(NominalReader(nominal))
        key = (nominal.value, *sizes.values())
        cases = (*by_values[key].cases, case) if key in by_values else (case,)
        by_values[key] = EqualVariation(cases, nominal.value, sizes)
    yield from by_values.values()


def _distribution_text(sizes: Mapping[str, float], scale: float) -> Text:
    """Text of the numbers of a distribution, such as its mean and standard deviation.

    ``mean 0.46, standard deviation 0.018``.
    """
    parts = [
        part for what, size in sizes.items() for part in (f", {what} ", NumberText(size * scale, SIGNIFICANT_DIGITS))
    ]
    return (str(parts[0]).removeprefix(", "), *parts[1:])


def _plain(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(_plain, value))
    return typeset_unit(str(value)).replace("-", "−").replace(" %", "\N{NO-BREAK SPACE}%")


LEFT_OUT_COLUMNS = ("variants", "smallest", "largest", "largest at variant")
"""Headings of a study's columns that the report leaves out, as a page has no room for them."""
MOST_ANSWER_ROWS = 60
"""Largest number of rows of an answer's table in a report, as a map has thousands, and a picture."""
METHODS = {
    "random": "independent random draws",
    "latin_hypercube": "Latin hypercube",
    "sobol": "scrambled Sobol sequence",
}
"""Words of a report for the methods by which a study draws random values."""


def studies_section(subject: ReportData) -> Section:
    """Section of a report with a subsection for each study."""
    blocks = (_study(subject, result, number) for number, result in enumerate(subject.request.studies, 1))
    return Section("study", ("Studies",), tuple(blocks))


def _study(subject: ReportData, result: StudyResult, number: int) -> Section:
    study = result.study
    units = shown_units(study, subject.conventions)
    blocks: list[Block] = [
        Facts(tuple(_facts(study))),
        varied_parameters(study, units),
        *correlations(study),
        _asked(subject, result, units),
    ]
    numbers = result.table()
    if numbers.rows:
        kept = numbers.chosen(
            [place for place, column in enumerate(numbers.columns) if column.name not in LEFT_OUT_COLUMNS]
        )
        blocks.append(_results(subject, study, kept, "Quantities over all variants", units))
    if result.notes:
        blocks.append(Listing(tuple(_said(subject, study, note) for note in result.notes)))
    with study_for_answers(study, result.folder) as (asked, calculator):
        for place, name in enumerate(study.answers, 1):
            calculator.read.clear()
            answer = _answer(subject, asked, result, f"study_{number}_{place}", name, units)
            notes = tuple(_said(subject, study, text) for text in read_notes(study, calculator.read))
            blocks.append(replace(answer, blocks=(*answer.blocks, Listing(notes))) if notes else answer)
    return Section(f"study_{number}", sentence(study.title, subject.model), tuple(blocks))


def _facts(study: Study) -> Iterator[tuple[str, Text]]:
    """Terms and texts on the configurations of a study, its number of variants, and how they were drawn."""
    space, cases = study.space, [name for name in study.configurations if name]
    yield "Configurations", (", ".join(cases) or "the model as it stands",)
    if space.grid:
        counts = " × ".join(str(axis.count) for axis in space.grid.values())
        yield "Values in turn", (phrase("{counts}, every combination", counts=counts),)
    if space.random_names and space.sampling is not None:
        sampling = space.sampling
        yield (
            "Draws",
            (
                phrase(
                    "{count}: {method}, seed {seed}",
                    count=sampling.count,
                    method=METHODS[sampling.method],
                    seed=sampling.seed,
                ),
            ),
        )
    if study.count:
        total, each = str(study.count), "{total}, {count} in each configuration"
        yield "Variants", (phrase(each, total=total, count=space.count) if len(cases) > 1 else total,)


def _asked(subject: ReportData, result: StudyResult, units: ShownUnits) -> TableBlock:
    study = result.study
    columns = (
        Heading("Quantity"),
        Heading("What it is", wide=True),
        Heading("Unit"),
        Heading("Not below", numeric=True),
        Heading("Not above", numeric=True),
    )
    rows: list[tuple[Cell, ...]] = []
    for name, quantity in study.quantities.items():
        limit = study.limits.get(name)
        sides = (None, None) if limit is None else (limit.above, limit.below)
        scale = units.scale(name)
        limits = ["" if side is None else NumberText(side * scale, 5) for side in sides]
        rows.append((symbol_or_words(name), _phrase(subject, study, quantity.words), unit(units.unit(name)), *limits))
    return table("What is asked of every variant, and its limits", columns, rows)


def _answer(subject: ReportData, study: Study, result: StudyResult, file: str, name: str, units: ShownUnits) -> Section:

    answer, title = study.answers[name], (capital(name.replace("_", " ")),)
    try:
        conclusion = answer.conclude(study, result)
    except SolveError as error:
        text = sentence(f"{answer.kind.replace('_', ' ')}: {error}", subject.model)
        return Section(file, title, (Remark("warning", text),))
    numbers = conclusion.table()
    about = capital(numbers.short_title or numbers.title)
    caption = _phrase(subject, study, about + ".")
    blocks: list[Block] = []
    if conclusion.sentences:
        blocks.append(Listing(tuple(_said(subject, study, text) for text in conclusion.sentences)))
    blocks.append(Picture(file, conclusion.figure(units=units, title=""), caption, about + "."))
    if len(numbers.rows) <= MOST_ANSWER_ROWS:
        blocks.append(_results(subject, study, numbers, about, units))
    return Section(file, title, tuple(blocks))


def _results(subject: ReportData, study: Study, numbers: Table, caption: str, units: ShownUnits) -> TableBlock:
    """Table of a study's results in the units of the study.

    A quantity that all rows have in common is named in the caption.
    """

    def shown(text: str) -> Cell:
        is_name = text in study.quantities or text in study.space.names
        return symbol_or_words(text) if is_name else _phrase(subject, study, capital(text))

    results = in_shown_units(numbers, units)
    place = next((place for place, index in enumerate(results.columns) if index.name == "quantity"), None)
    if place is not None and len({row[place] for row in results.rows}) == 1:
        caption = f"{caption}: {results.rows[0][place]}"
        results = results.chosen([index for index in range(len(results.columns)) if index != place])
    return results_table(results, _phrase(subject, study, caption), notes=False, words=shown, heads=shown)


def _said(subject: ReportData, study: Study, text: str) -> Text:
    return _phrase(subject, study, capital(text) + ".")


def _phrase(subject: ReportData, study: Study, text: str) -> Text:
    """Text of a study in which names of the model and of quantities are words and symbols."""
    return sentence(typeset_unit(text), subject.model, (*study.quantities, *study.space.names))
