"""Studies: what varied, what every variant was asked, and what is concluded."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from torsionnet.core.errors import UsageError
from torsionnet.model.checks.units_in_use import parameter_units
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
    Text,
)
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import of_results, table
from torsionnet.report.report_words import capital, named, sentence, unit

if TYPE_CHECKING:
    from torsionnet.study.answer import StudyAnswer
    from torsionnet.study.study_result import StudyResult

LEFT_OUT = ("variants", "smallest", "largest", "largest at variant")
"""Columns that a page has no room for."""
LONGEST = 60
"""Rows up to which a table of an answer stands in a report; a map has thousands, and a picture."""


def studies_section(subject: ReportData) -> Section:
    blocks = (_study(subject, result, number) for number, result in enumerate(subject.request.studies, 1))
    return Section("study", ("Studies",), tuple(blocks))


def _study(subject: ReportData, result: StudyResult, number: int) -> Section:
    study = result.study
    if study.model.name != subject.model.name:
        raise UsageError(
            f"the study {study.title} is of {study.model.name}, and the report of {subject.model.name}; a report shows "
            "studies of its own model"
        )
    blocks: list[Block] = [Paragraph((_extent(result),)), _varied(subject, result)]
    numbers = result.table()
    kept = numbers.chosen([place for place, one in enumerate(numbers.columns) if one.name not in LEFT_OUT])
    blocks.append(of_results(kept, "Quantities over all variants", notes=False))
    if result.notes:
        blocks.append(Listing(tuple(_said(subject, note) for note in result.notes)))
    for place, (name, answer) in enumerate(study.answers.items(), 1):
        blocks += _answer(subject, result, answer, f"study_{number}_{place}", name)
    return Section(f"study_{number}", sentence(study.title, subject.model), tuple(blocks))


def _extent(result: StudyResult) -> str:
    study = result.study
    cases = [name for name in study.configurations if name]
    where = f" in configurations {', '.join(cases)}" if len(cases) > 1 else ""
    where = f" in configuration {cases[0]}" if len(cases) == 1 else where
    sampling = study.space.sampling
    drawn = ""
    if sampling is not None and study.space.random_names:
        drawn = f" Drawn: {sampling.method.replace('_', ' ')}, {sampling.count} draws, seed {sampling.seed}."
    return f"{study.count} variants{where}.{drawn}"


def _varied(subject: ReportData, result: StudyResult) -> TableBlock:
    space = result.study.space
    known = subject.model.parameters
    units = parameter_units(subject.model.definition)
    rows: list[tuple[Cell, ...]] = [
        (
            named(name),
            NumberText(known[name]) if name in known else "",
            unit(units[name]) if name in units else "",
            _words(variation.kind, variation.to_data()),
        )
        for name, variation in space.entries.vary.items()
    ]
    notes: list[Cell] = [
        f"Correlation of {' and '.join(one.between)}: {one.coefficient:g}" for one in space.entries.correlation
    ]
    columns = (
        Heading("Parameter"),
        Heading("In the model", numeric=True),
        Heading("Unit"),
        Heading("Varied", wide=True),
    )
    return table("What varies", columns, rows, notes)


def _words(kind: str, data: dict[str, Any]) -> str:
    """How a parameter varies, as its file says it."""
    return ", ".join([kind, *(f"{key} {value}" for key, value in data.items())])


def _answer(subject: ReportData, result: StudyResult, answer: StudyAnswer, file: str, name: str) -> Iterator[Block]:
    import torsionnet.plot as plot

    found = answer.found(result.study, result)
    numbers = found.table()
    caption = capital(name.replace("_", " ")) + "."
    yield Picture(file, found.figure(plot), (caption,), caption)
    if found.sentences:
        yield Listing(tuple(_said(subject, text) for text in found.sentences))
    if len(numbers.rows) <= LONGEST:
        yield of_results(numbers, sentence(capital(numbers.title), subject.model), notes=False)


def _said(subject: ReportData, text: str) -> Text:
    return sentence(capital(text) + ".", subject.model)
