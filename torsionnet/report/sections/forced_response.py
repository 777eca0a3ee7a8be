"""Section of a report on forced response: stress or torque over speed in every condition, and orders of the peaks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from torsionnet.base.equal_remarks import condition_words
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.machinery.verdicts.governing_peaks import GoverningPeaks, line_name
from torsionnet.machinery.verdicts.limit_check import LimitCheck, LimitVerdict
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.order_peaks import OrderPeak, largest_orders, vibratory_verdicts
from torsionnet.report.document_tree import Block, Cell, Heading, NumberText, Paragraph, Picture, Section, TableBlock
from torsionnet.report.document_tree import TableGroup as Group
from torsionnet.report.limit_values import DIGITS, component, limit_number, limit_unit, order_list
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_text import as_words, symbol_or_words

MOST_PANELS = 6
"""Largest number of components in one picture, three rows of two: more would not fit a page with their caption."""
MOST_ORDERS = 3
"""Number of largest orders that are named at a peak."""
INTRODUCTION = (
    "All orders act together with their phases (synthesis): the value shown is the half range, (max − min)/2, of their "
    "sum over a cycle. Amplitudes of single orders are peak values; they need not add up to the half range."
)
PEAKS = (
    "The speed is that at which the order alone is largest in this component. Damping moves it off the critical speed, "
    "where order and natural frequency meet, and the sum of all orders is largest at a speed of its own."
)
"""Note below the table of peaks that tells apart the speeds of one resonance."""
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
CRITICAL_COLUMNS = (
    Heading("Peak at", "rpm", numeric=True),
    Heading("Peak of"),
    Heading("Component"),
    Heading("All orders", numeric=True),
    Heading("Unit"),
    Heading("Largest orders there", wide=True),
)


def forced_response_section(subject: ReportData) -> Section | None:
    """Section of a report on forced response over speed against limits; None for a model without limits."""
    found = subject.limit_conclusion
    if found is None:
        return None
    # Pictures of many components fill a page of their own: what fits in front of them comes first.
    blocks: list[Block] = [Paragraph((INTRODUCTION,)), *_worst(subject, found), _free_end(subject)]
    blocks += _families(subject, found)
    if subject.governing_peaks is not None and subject.governing_peaks.peaks:
        blocks.append(_at_critical_speeds(subject, subject.governing_peaks))
    return Section("forced_response", ("Forced response",), tuple(blocks))


def _families(subject: ReportData, found: LimitConclusion) -> list[Picture]:
    """Pictures of all components with limits on vibration, over speed in every condition."""
    from torsionnet.plot.limit_family_plot import families_of, limit_families

    names = list(dict.fromkeys(family.members[0][1][0].limit for family in families_of(found.checks)))
    parts = [names[start : start + MOST_PANELS] for start in range(0, len(names), MOST_PANELS)]
    count = len(found.checks)
    where = (
        phrase(" in all {count} conditions examined: the worst black and named, the others grey", count=count)
        if count > 1
        else ""
    )
    pictures = []
    for number, part in enumerate(parts, 1):
        drawn = limit_families(found.checks, part, conventions=subject.conventions)
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


def _worst(subject: ReportData, found: LimitConclusion) -> list[TableBlock]:
    """Table of every limit on vibration in its worst condition, with all cylinders working and with one out."""
    groups = []
    for title, misfiring in (("All cylinders working", False), ("With a cylinder out", True)):
        worst: dict[tuple[str, str], tuple[LimitCheck, LimitVerdict]] = {}
        for check in found.checks:
            for one in vibratory_verdicts(check) if check.misfiring is misfiring else ():
                known = worst.get((one.limit, one.quantity))
                if one.worst is not None and (known is None or _use(one) > _use(known[1])):
                    worst[one.limit, one.quantity] = (check, one)
        if worst:
            groups.append(Group(tuple(_worst_row(subject, *pair) for pair in worst.values()), title))
    if not groups:
        return []
    shown = tuple(groups) if len(groups) > 1 else (Group(groups[0].rows),)
    return [
        TableBlock(
            ("Largest utilisation of every component, with the criterion that is used most",),
            WORST_COLUMNS,
            shown,
            ((SUMS,),),
        )
    ]


def _use(one: LimitVerdict) -> float:
    return -1.0 if one.worst is None else float(one.utilisation[one.worst])


def _worst_row(subject: ReportData, check: LimitCheck, one: LimitVerdict) -> tuple[Cell, ...]:
    """Row of a limit at its worst speed in one condition."""
    at = one.worst
    assert at is not None
    return (
        (component(one), " ", symbol_or_words(one.criterion)),
        condition_words(check.configuration),
        NumberText(float(check.rpm[at]), 4),
        limit_number(float(one.values[at]), one.unit, subject.conventions),
        limit_number(float(one.allowed[at]), one.unit, subject.conventions),
        limit_unit(one.unit, subject.conventions),
        NumberText(100 * float(one.utilisation[at]), DIGITS),
        order_list(largest_orders(check, one, at, MOST_ORDERS), one, subject.conventions),
    )


def _free_end(subject: ReportData) -> Picture:
    """Picture of the amplitude at the free end of the engine over speed, as a torsiograph there measures it."""
    from torsionnet.plot.order_response_plot import order_response

    run, condition = subject.free_end_response, condition_words(subject.judged_cases[0].configuration)
    node = run.outputs[0].name
    where = phrase(" in condition {name}", name=condition) if condition else ""
    drawn = order_response(run, most=5, conventions=subject.conventions, title="", milli=True)
    worst = int(np.argmax(run.half_range[:, 0]))
    caption = (
        phrase(
            "Amplitude at the free end of the engine, {node},{where}: largest orders and their sum.",
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


def _at_critical_speeds(subject: ReportData, found: GoverningPeaks) -> TableBlock:
    """Table of the largest orders at each critical speed that matters, in the component that it uses most."""
    groups = []
    for configuration, some in groupby(found.peaks, key=lambda one: one.check.configuration):
        peaks = sorted(some, key=lambda one: (one.at, one.verdict.limit))
        alike = [list(those) for _, those in groupby(peaks, key=lambda one: (one.at, one.verdict.limit))]
        speeds = aligned_numbers([those[0].rpm for those in alike])
        rows = [_critical_row(subject, speed, those) for speed, those in zip(speeds, alike, strict=True)]
        groups.append(Group(tuple(rows), condition_words(configuration) if len(subject.judged_cases) > 1 else ""))
    return TableBlock(
        ("Orders at the peaks of single orders that matter",), CRITICAL_COLUMNS, tuple(groups), ((PEAKS,),)
    )


def _critical_row(subject: ReportData, speed: Cell, those: Sequence[OrderPeak]) -> tuple[Cell, ...]:
    """Row of one speed at which one or several orders have a peak in one component."""
    one = those[0]
    limit = one.verdict
    return (
        speed,
        "; ".join(
            phrase("{order}, mode {mode}", order=as_words(line_name(peak)), mode=peak.critical.mode.number)
            for peak in those
        ),
        component(limit),
        limit_number(float(limit.values[one.at]), limit.unit, subject.conventions),
        limit_unit(limit.unit, subject.conventions),
        order_list(largest_orders(one.check, limit, one.at, MOST_ORDERS), limit, subject.conventions),
    )
