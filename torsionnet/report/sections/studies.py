"""Section of a report on studies, what varied, what was asked of every variant, and the conclusions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
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
from torsionnet.report.report_tables import results_table, table
from torsionnet.report.report_text import capital, sentence, symbol_or_words, unit
from torsionnet.report.sections.varied_parameters import correlations, varied_parameters
from torsionnet.report.shown_numbers import in_shown_units
from torsionnet.study.run.answering import study_for_answers
from torsionnet.study.shown_units import ShownUnits, shown_units
from torsionnet.study.study_result import read_notes

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.study.study import Study
    from torsionnet.study.study_result import StudyResult

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
        kept = numbers.chosen([place for place, one in enumerate(numbers.columns) if one.name not in LEFT_OUT_COLUMNS])
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
        one = space.sampling
        yield (
            "Draws",
            (phrase("{count}: {method}, seed {seed}", count=one.count, method=METHODS[one.method], seed=one.seed),),
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
    import torsionnet.plot as plot

    answer, title = study.answers[name], (capital(name.replace("_", " ")),)
    try:
        found = answer.conclude(study, result)
    except SolveError as error:
        text = sentence(f"{answer.kind.replace('_', ' ')}: {error}", subject.model)
        return Section(file, title, (Remark("warning", text),))
    numbers = found.table()
    about = capital(numbers.short_title or numbers.title)
    caption = _phrase(subject, study, about + ".")
    blocks: list[Block] = []
    if found.sentences:
        blocks.append(Listing(tuple(_said(subject, study, text) for text in found.sentences)))
    blocks.append(Picture(file, found.figure(plot, units=units, title=""), caption, about + "."))
    if len(numbers.rows) <= MOST_ANSWER_ROWS:
        blocks.append(_results(subject, study, numbers, about, units))
    return Section(file, title, tuple(blocks))


def _results(subject: ReportData, study: Study, found: Table, caption: str, units: ShownUnits) -> TableBlock:
    """Table of a study's results in the units of the study.

    A quantity that all rows have in common is named in the caption.
    """

    def shown(text: str) -> Cell:
        is_name = text in study.quantities or text in study.space.names
        return symbol_or_words(text) if is_name else _phrase(subject, study, capital(text))

    results = in_shown_units(found, units)
    place = next((place for place, one in enumerate(results.columns) if one.name == "quantity"), None)
    if place is not None and len({row[place] for row in results.rows}) == 1:
        caption = f"{caption}: {results.rows[0][place]}"
        results = results.chosen([one for one in range(len(results.columns)) if one != place])
    return results_table(results, _phrase(subject, study, caption), notes=False, words=shown, heads=shown)


def _said(subject: ReportData, study: Study, text: str) -> Text:
    return _phrase(subject, study, capital(text) + ".")


def _phrase(subject: ReportData, study: Study, text: str) -> Text:
    """Text of a study in which names of the model and of quantities are words and symbols."""
    return sentence(typeset_unit(text), subject.model, (*study.quantities, *study.space.names))
