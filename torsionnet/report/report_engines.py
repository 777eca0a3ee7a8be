"""Texts and tables of a report on several engines: unknown angles between them, and running on one of them."""

from __future__ import annotations

from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.machinery.excitations.engine_phases import conditions_running_alone
from torsionnet.machinery.orders.engine_angles import EngineAngle
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.report.document_tree import Block, Cell, Heading, Listing, TableBlock
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, symbol_or_words, unit


def engine_remarks(subject: ReportData) -> list[Block]:
    """Block with a list of sentences on angles between engines and on running on one engine.

    Empty for a model with one engine.
    """
    runs = subject.order_responses if subject.order_outputs else ()
    notes = dict.fromkeys(note for run in runs for note in run.engine_notes)
    conditions = [(case.configuration, case.drivetrain.definition.excitations) for case in subject.cases]
    found = [
        *(f"{note[0].upper()}{note[1:]}." for note in notes),
        *(
            phrase("Running on {engine} alone: examined in {names}.", engine=engine, names=", ".join(names))
            if names
            else phrase("Running on {engine} alone: not examined.", engine=engine)
            for engine, names in conditions_running_alone(conditions).items()
        ),
    ]
    return [Listing(tuple((as_words(one),) for one in found))] if found else []


def engine_angle_tables(subject: ReportData, name: str) -> list[TableBlock]:
    """Tables of the largest and smallest half range of an output by the angles between engines."""
    found = [
        (case.configuration, run, run.output(name), run.half_range[:, run.output(name)])
        for case, run in zip(subject.cases, subject.order_responses, strict=True)
        if isinstance(run, WorstResponse) and run.angles
    ]
    if not found:
        return []
    channel = found[0][1].outputs[found[0][2]]
    scale, shown = subject.conventions.scale(channel.unit), unit(subject.conventions.unit(channel.unit))
    columns = (
        Heading("Configuration"),
        Heading("Speed", "r/min", numeric=True),
        Heading("Largest half range", shown, numeric=True),
        Heading("Where it is largest"),
        Heading("Smallest half range", shown, numeric=True),
        Heading("Where it is smallest"),
    )
    worst = [int(sizes.argmax()) for _, _, _, sizes in found]
    least = [run.least_at(at, name) for (_, run, _, _), at in zip(found, worst, strict=True)]
    cells: list[list[Cell]] = [
        [configuration for configuration, _, _, _ in found],
        list(aligned_numbers([float(run.rpm[at]) for (_, run, _, _), at in zip(found, worst, strict=True)])),
        list(aligned_numbers([float(sizes[at]) * scale for (_, _, _, sizes), at in zip(found, worst, strict=True)])),
        [_words(run.angles, at, place) for (_, run, place, _), at in zip(found, worst, strict=True)],
        list(aligned_numbers([float(one.half_range[0, 0]) * scale for one in least])),
        [_words(one.angles, 0, 0) for one in least],
    ]
    return [table((symbol_or_words(name), ": by the angle between engines"), columns, list(zip(*cells, strict=True)))]


def _words(angles: tuple[EngineAngle, ...], speed: int, output: int) -> str:
    return as_words(", ".join(one.at(speed, output) for one in angles))
