"""Section of a report on forced response: stress or torque over speed in every condition, and orders of the peaks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import extended, phrase
from torsionnet.machinery.orders.order_line import lines_of_one_frequency, sum_name
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.machinery.verdicts.order_peaks import (
    vibratory_verdicts,
)
from torsionnet.motion.motion_record import energy_table, event_table, peak_table
from torsionnet.report.condition_tables import condition_cell, further_response, normal_response, orders_cell
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Inline,
    NumberText,
    Paragraph,
    Picture,
    Remark,
    Section,
    TableBlock,
)
from torsionnet.report.document_tree import TableGroup as Group
from torsionnet.report.report_cylinders import in_words_of
from torsionnet.report.report_data import FEW_CASES, MOST_OUTPUTS, Case, ReportData
from torsionnet.report.report_machines import engine_angle_tables, engine_remarks
from torsionnet.report.report_orders import highest_orders
from torsionnet.report.report_tables import results_table, table
from torsionnet.report.report_text import (
    DIGITS,
    as_words,
    capital,
    criterion_cell,
    limit_number,
    limit_unit,
    symbol_or_words,
    unit,
)

MOST_PANELS = 6
"""Largest number of components in one picture, three rows of two: more would not fit a page with their caption."""
INTRODUCTION = (
    "All orders act together with their phases (synthesis): the value shown is the half range, (max − min)/2, of their "
    "sum over a cycle. Amplitudes of single orders are peak values; they need not add up to the half range."
)
SUMS = "The speed is that at which the sum of all orders uses the limit most."
"""Note below the table of worst values."""
WORST_COLUMNS = (
    Heading("Component"),
    Heading("Condition", wide=True),
    Heading("Speed", "rpm", numeric=True),
    Heading("Value", numeric=True),
    Heading("Allowed", numeric=True),
    Heading("Unit"),
    Heading("Utilisation", "%", numeric=True),
    Heading("Largest orders there", wide=True),
)


def forced_response_section(subject: ReportData) -> Section | None:
    """Section of a report on forced response over speed against limits; None for a model without limits."""
    judged = subject.limit_conclusion
    if judged is None:
        return None
    tables = (normal_response(subject), *_worst(subject, judged), further_response(subject))
    blocks: list[Block] = [Paragraph((INTRODUCTION, " ", highest_orders(subject)))]
    blocks += [block for block in tables if block is not None]
    blocks += [_free_end(subject), *_families(subject, judged)]
    return Section("forced_response", ("Forced response",), tuple(blocks))


def _families(subject: ReportData, judged: LimitConclusion) -> list[Picture]:
    """Pictures of all components with limits on vibration, over speed in every condition."""
    from torsionnet.plot.limit_plot import families_of, limit_families

    names = list(dict.fromkeys(family.members[0][1][0].limit for family in families_of(judged.checks)))
    parts = [names[start : start + MOST_PANELS] for start in range(0, len(names), MOST_PANELS)]
    count = len(judged.checks)
    where = (
        phrase(" in all {count} conditions examined: the worst black and named, the others grey", count=count)
        if count > 1
        else ""
    )
    pictures = []
    for number, part in enumerate(parts, 1):
        drawn = limit_families(judged.checks, part, conventions=subject.conventions)
        those = ", ".join(map(as_words, part))
        caption = (
            phrase(
                "Vibratory stress or torque over speed{where}; limits red, speeds to be barred shaded.", where=where
            ),
        )
        pictures.append(
            Picture(
                f"forced_response_{number}",
                drawn,
                caption,
                phrase("{names} over speed with limits{where}", names=those, where=where),
            )
        )
    return pictures


def _worst(subject: ReportData, judged: LimitConclusion) -> list[TableBlock]:
    """Table of every limit on vibration in its worst condition, with all cylinders working and with one out."""
    groups = []
    excitations = subject.model.definition.excitations.values()
    for words, misfiring in (("All cylinders working", False), ("With a cylinder out", True)):
        title = in_words_of(excitations, words)
        worst: dict[tuple[str, str], tuple[LimitCheck, LimitVerdict]] = {}
        for check in judged.checks:
            for verdict in vibratory_verdicts(check) if check.misfiring is misfiring else ():
                # Of each limit the condition that uses it most, at its own worst speed.
                known = worst.get((verdict.limit, verdict.quantity))
                if verdict.worst is not None and (known is None or _use(verdict) > _use(known[1])):
                    worst[verdict.limit, verdict.quantity] = (check, verdict)
        if worst:
            groups.append(Group(tuple(_worst_row(subject, *pair) for pair in worst.values()), title))
    if not groups:
        return []
    # A group alone needs no title.
    shown = tuple(groups) if len(groups) > 1 else (Group(groups[0].rows),)
    return [
        TableBlock(
            ("Largest utilisation of every component, with the criterion that is used most",),
            WORST_COLUMNS,
            shown,
            ((SUMS,),),
        )
    ]


def _use(verdict: LimitVerdict) -> float:
    return -1.0 if verdict.worst is None else float(verdict.utilisation[verdict.worst])


def _worst_row(subject: ReportData, check: LimitCheck, verdict: LimitVerdict) -> tuple[Cell, ...]:
    """Row of a limit at its worst speed in one condition."""
    at = verdict.worst
    assert at is not None
    return (
        (as_words(verdict.limit), " ", criterion_cell(verdict.criterion)),
        condition_cell(subject, check, as_words(verdict.case)),
        NumberText(float(check.rpm[at]), 4),
        limit_number(float(verdict.values[at]), verdict.unit, subject.conventions),
        limit_number(float(verdict.allowed[at]), verdict.unit, subject.conventions),
        limit_unit(verdict.unit, subject.conventions),
        NumberText(100 * float(verdict.utilisation[at]), DIGITS),
        orders_cell(subject, check, verdict, at),
    )


def _free_end(subject: ReportData) -> Picture:
    """Picture of the amplitude at the free end of the engine over speed, as a torsiograph there measures it."""
    from torsionnet.plot.order_response_plot import order_response

    run, condition = subject.free_end_response, subject.normal_case.title
    node = run.outputs[0].name
    where = phrase(" in condition {name}", name=condition) if condition else ""
    drawn = order_response(run, most=5, conventions=subject.conventions, title="", milli=True)
    worst = int(np.argmax(run.half_range[:, 0]))
    caption = (
        phrase(
            "Amplitude at the free end, {node}{where}: largest orders and their sum.",
            node=as_words(node),
            where=where,
        ),
    )
    alt = phrase(
        "Angle of {node} over speed{where}, largest at {speed:.4g} rpm",
        node=as_words(node),
        where=where,
        speed=run.rpm[worst],
    )
    return Picture("free_end", drawn, caption, alt)


# Section of a report on the response to all excitations over speed: each order, and all orders together.

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
    # Orders are drawn where the half range is largest of all.
    worst = int(np.argmax([run.half_range[:, place].max() for run in runs]))
    shown = name if not runs[worst].title else f"{name}, {subject.cases[worst].title}".rstrip(", ")
    blocks: list[Block] = []
    if len(runs) > 1:
        chosen = runs[:MOST_CURVES]
        labels = [case.title for case in subject.cases[:MOST_CURVES]]
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
    where = phrase(" in configuration {name}", name=subject.cases[worst].title) if len(runs) > 1 else ""
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
        Heading("Speed", "rpm", numeric=True),
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
        return case.title
    return ": ".join(part for part in (case.title, as_words(run.cases(name)[index])) if part)


# Section of a report on the motion over time under the scenarios of the model.

MOST_SCENARIOS = 6
"""Largest number of scenarios that a report shows, each with a table and a picture."""
WHAT_IS_SHOWN = "Peaks are those of the samples, with the times at which they occur."
"""Sentence that says what the tables on scenarios hold."""


def scenarios_section(subject: ReportData) -> Section | None:
    """Section of a report on the motion under scenarios; None for a model without scenarios."""
    names = list(subject.model.definition.scenarios)[:MOST_SCENARIOS]
    blocks = [block for name in names for case in subject.cases[:FEW_CASES] for block in _scenario(subject, case, name)]
    if not blocks:
        return None
    return Section("scenarios", ("Motion over time",), (Paragraph((WHAT_IS_SHOWN,)), *blocks))


def _scenario(subject: ReportData, case: Case, name: str) -> Iterator[Block]:
    """Blocks of the report on one scenario: what happens, peaks, events and energies, and the signals drawn."""
    from torsionnet.plot.histories import scenario_motion

    several = case.title and len(subject.cases) > 1
    where = phrase(" in configuration {name}", name=case.title) if several else ""
    try:
        record = case.drivetrain.simulate(scenario=name)
    except TorsionnetError as error:
        yield Remark(
            "warning",
            (
                phrase(
                    "The scenario {name}{where} could not be simulated: {reason}", name=name, where=where, reason=error
                ),
            ),
        )
        return
    words = case.drivetrain.definition.scenarios[name].words
    yield Paragraph(tuple(extended(capital(str(words_or_note)), ". ") for words_or_note in (words, *record.notes)))
    yield results_table(
        peak_table(record, ""),
        phrase("Peaks in the scenario {name}{where}", name=name, where=where),
        notes=False,
        words=str,
    )
    if record.events:
        yield results_table(
            event_table(record.events),
            phrase("Events in the scenario {name}{where}", name=name, where=where),
            words=str,
        )
    energy = energy_table(record)
    if energy is not None and energy.rows:
        yield results_table(energy, phrase("Energies in the scenario {name}{where}", name=name, where=where), words=str)
    shown = list(dict.fromkeys((*record.names[:1], *record.names[-MOST_OUTPUTS:])))
    drawn = scenario_motion(record, shown, conventions=subject.conventions, title="")
    caption = phrase("The scenario {name}{where}: signals over time, events as dashed lines.", name=name, where=where)
    number = subject.cases.index(case) + 1
    yield Picture(f"scenario_{name}_{number}", drawn, (caption,), caption)
