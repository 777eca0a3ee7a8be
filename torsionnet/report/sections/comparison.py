"""Section of a report on tests, with measured responses over those of the model."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.notes import Note
from torsionnet.base.phrases import phrase
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.report.document_tree import Block, Heading, Math, NumberText, Paragraph, Picture, Section, TableBlock
from torsionnet.report.plan import Pair
from torsionnet.report.report_data import Case, ReportData, cases_of
from torsionnet.report.report_request import Measured
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import capital, channel_latex, sentence, unit
from torsionnet.report.sections.responses import label_axes
from torsionnet.signals.agreement import agreement


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
        raise UsageError(f"a test is of one configuration; choose it: {names}")
    return subject.cases[0]


def _test(subject: ReportData, test: Measured, number: int) -> list[Block]:
    from torsionnet.plot.comparison_plot import comparison

    case, measured = _case(subject, test), test.response
    model = calculated(case, measured, test.excitation)
    shown = subject.conventions
    where = phrase(", configuration {name}", name=case.configuration) if case.configuration else ""
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
    found = case.drivetrain.frequency_response(output, into, measured.frequencies, excitation=excitation)
    return replace(found, outputs=_renamed(found, measured, "outputs"), inputs=_renamed(found, measured, "inputs"))


def _renamed(found: FrequencyResponse, measured: FrequencyResponse, side: str) -> tuple:  # type: ignore[type-arg]
    pairs = zip(getattr(found, side), getattr(measured, side), strict=True)
    return tuple(replace(mine, name=theirs.name) for mine, theirs in pairs)


def _agreement(
    measured: FrequencyResponse, model: FrequencyResponse, shown: Conventions, pair: str, where: str
) -> TableBlock:
    found = agreement(measured, model, shown)
    columns = (Heading("Quantity"), Heading("At", "Hz", numeric=True), Heading("Value", numeric=True), Heading("Unit"))
    rows = [
        (capital(row[0]), NumberText(row[1]) if row[1] is not None else "", NumberText(row[2]), unit(row[3]))
        for row in found.rows
    ]
    notes = [capital(note) + "." for note in found.notes]
    return table((Math(pair), phrase(", how far test and model are apart{where}", where=where)), columns, rows, notes)
