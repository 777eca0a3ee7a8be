"""Section of a report on the response to all excitations over speed: each order, and all orders together."""

from __future__ import annotations

import numpy as np

from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_sums import lines_of_one_frequency, sum_name
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.report.document_tree import Block, Cell, Heading, Inline, Paragraph, Picture, Section, TableBlock
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_engines import engine_angle_tables, engine_remarks
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, symbol_or_words, unit

MOST_CURVES = 7
"""Largest number of configurations in one plot over speed, as more curves cannot be told apart."""
HALF_RANGE_NOTE = (
    "All orders act at once. The half range is (max − min)/2 of their sum with the phases they have, not the sum of "
    "their magnitudes; amplitudes of single orders are peak values."
)
"""Sentence that says what a half range is."""
NO_CYCLE_NOTE = " What has no short common cycle takes every position to each other: such half ranges are added."
"""Sentence on half ranges of excitations without a short common cycle."""


def orders_section(subject: ReportData) -> Section | None:
    """Section of a report on the response by order over speed; None for a model without excitations."""
    if not subject.has_excitations or not subject.order_outputs:
        return None
    blocks: list[Block] = [Paragraph(_introduction(subject)), *engine_remarks(subject)]
    for number, name in enumerate(subject.order_outputs, 1):
        blocks += _output(subject, name, number)
    return Section("orders", ("Response by order",), tuple(blocks))


def _introduction(subject: ReportData) -> tuple[Inline, ...]:
    has_cycle = all(run.revolutions is not None for run in subject.order_responses)
    return (*((HALF_RANGE_NOTE,) if has_cycle else (HALF_RANGE_NOTE, NO_CYCLE_NOTE)), *subject.coverage_note)


def _output(subject: ReportData, name: str, number: int) -> list[Block]:
    """Blocks of the report on one output over speed.

    Half ranges of all configurations, orders of the worst one, and the largest values.
    """
    from torsionnet.plot.order_response_plot import half_ranges, order_response

    runs = subject.order_responses
    place = runs[0].output(name)
    worst = int(np.argmax([run.half_range[:, place].max() for run in runs]))
    shown = name if not runs[worst].title else f"{name}, {subject.cases[worst].configuration}".rstrip(", ")
    blocks: list[Block] = []
    if len(runs) > 1:
        chosen = runs[:MOST_CURVES]
        labels = [case.configuration for case in subject.cases[:MOST_CURVES]]
        drawn = half_ranges(chosen, name, labels=labels, conventions=subject.conventions, title="")
        rest = (
            phrase("; the first {shown} of {count} configurations", shown=len(chosen), count=len(runs))
            if len(runs) > len(chosen)
            else ""
        )
        caption = (
            symbol_or_words(name),
            phrase(": half range of all orders over speed, by configuration{rest}.", rest=rest),
        )
        blocks.append(Picture(f"half_range_{number}", drawn, caption, f"Half range of {as_words(name)} over speed"))
    drawn = order_response(runs[worst], name, conventions=subject.conventions, title="")
    where = phrase(" in configuration {name}", name=subject.cases[worst].configuration) if len(runs) > 1 else ""
    caption = (symbol_or_words(name), phrase(": largest orders over speed{where}.", where=where))
    blocks.append(Picture(f"orders_{number}", drawn, caption, f"Orders of {shown} over speed"))
    return [*blocks, _worst_half_range(subject, name), *engine_angle_tables(subject, name)]


def _worst_half_range(subject: ReportData, name: str) -> TableBlock:
    """Table of the largest half range of an output in every configuration, and of the largest order there."""
    runs, place = subject.order_responses, subject.order_responses[0].output(name)
    scale = subject.conventions.scale(runs[0].outputs[place].unit)
    shown = unit(subject.conventions.unit(runs[0].outputs[place].unit))
    worst = [(run, int(np.argmax(run.half_range[:, place]))) for run in runs]
    sizes = [np.abs(run.by_frequency()[index, :, place]) for run, index in worst]
    columns = (
        Heading("Configuration"),
        Heading("Speed", "r/min", numeric=True),
        Heading("Half range", shown, numeric=True),
        Heading("RMS", shown, numeric=True),
        Heading("Largest order there"),
        Heading("its amplitude", shown, numeric=True),
    )
    cells: list[list[Cell]] = [
        [_condition(case, run, name, index) for case, (run, index) in zip(subject.cases, worst, strict=True)],
        list(aligned_numbers([float(run.rpm[index]) for run, index in worst])),
        list(aligned_numbers([float(run.half_range[index, place]) * scale for run, index in worst])),
        list(aligned_numbers([float(run.rms[index, place]) * scale for run, index in worst])),
        [as_words(_line_name(run, int(np.argmax(size)))) for run, size in zip(runs, sizes, strict=True)],
        list(aligned_numbers([float(size.max()) * scale for size in sizes])),
    ]
    return table((symbol_or_words(name), ": largest over the speeds"), columns, list(zip(*cells, strict=True)))


def _line_name(run: OrderResponse, number: int) -> str:
    """Name of all lines of a response that have the frequency with this number."""
    return sum_name([run.lines[place] for place in lines_of_one_frequency(run.lines)[number]])


def _condition(case: Case, run: OrderResponse, name: str, index: int) -> str:
    """Name of a configuration, with its worst case at a speed where the configuration has several cases."""
    if not isinstance(run, WorstResponse):
        return case.configuration
    return ": ".join(part for part in (case.configuration, as_words(run.cases(name)[index])) if part)
