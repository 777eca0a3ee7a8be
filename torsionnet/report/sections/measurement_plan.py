"""Section of a report on measurements on board: where, expected amplitudes, and measured ones beside them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import NumberText, aligned_numbers
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.io.tracked_order_tables import is_tracked_table, read_tracked_orders, tracked_channel
from torsionnet.machinery.checks.section_checks import limit_subject
from torsionnet.machinery.criticals.speed_peaks import (
    SAME_SPEED,
    PlannedAmplitude,
    PlannedSpeed,
    critical_peaks,
    measured_at,
    merged_speeds,
    planned_amplitudes,
)
from torsionnet.machinery.limits.shaft_limit import VIBRATORY_STRESSES, ShaftLimit
from torsionnet.machinery.orders.calculated_order import swept_comparison
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.measured_range import MeasuredRange, measured_ranges
from torsionnet.machinery.verdicts.speed_spans import whole_rpm
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.round_section import section_fault
from torsionnet.report.condition_tables import SAME_VALUE
from torsionnet.report.document_tree import Block, Cell, Heading, Paragraph, Picture, Section, TableBlock
from torsionnet.report.measured_orders import (
    MeasuredFile,
    PlaceTest,
    measured_order_tables,
    measured_range_block,
    read_measured,
)
from torsionnet.report.measurement_places import (
    MeasuringPlace,
    files_by_case,
    measuring_places,
    within_calculated,
)
from torsionnet.report.report_cylinders import governing_misfire, in_words_of
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, engineering_unit, unit
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INTRODUCTION = (
    "Expected values for a measurement: peak amplitudes of single orders, and half the range of the sum of "
    "all orders. Orders and speeds are those of {reference}. The peak of an order is the speed at which this order "
    "alone is largest at the place of measurement, near its critical speed."
)
"""Paragraph before the tables of a measurement plan."""
CAPTIONS = {
    "torque": "Torque by strain gauges, {of}{where}",
    "angle": "Angle by torsiograph or encoder, {of}{where}",
}
"""Captions of the tables of a measurement plan, by the quantity that is measured."""
HIGHEST = "highest permitted"
"""Reason to measure at the highest speed permitted in a condition."""
OUT_COLUMNS = (
    Heading("Place"),
    Heading("Speed", "rpm", numeric=True),
    Heading("What it is"),
    Heading("Worst case"),
    Heading("Half range", numeric=True),
    Heading("Unit"),
    Heading("Orders, expected", wide=True),
)
MOST_ORDERS_OUT = 2
"""Number of largest orders expected with a cylinder out, as many as fit one line."""
DAMPING_NOTE = (
    "Peaks are compared at their own speeds: a natural frequency that is a little off shifts the peak, and the "
    "amplitude at a fixed speed changes much more than the peak itself."
)
"""Note below tables that compare measured peaks."""
TOLERANCE = (
    "Tolerance of the measurement, assumed: {share:g} % of the half range and {speed:g} % of the speed, as of strain "
    "gauges or a torsiograph with a calibrated chain; that of the instruments used counts."
)
"""Paragraph before the tables on how well a measurement is taken to know its values."""
JUDGED = "Judged: the stress that the limit compares, the larger one of both ends of the shaft."
"""Note below a table of torques on the column of the stress that a limit judges."""
RUN_UP_NOTE = (
    "A fast run-up does not reach the peaks of steady speed. Expected amplitudes, limits and calculated half ranges "
    "are those of steady speed."
)
"""Note below tables that compare the orders of a run-up too fast for steady peaks."""


def measurement_plan_section(subject: ReportData) -> Section | None:
    """Section of a report on measurements on board, with expected and measured amplitudes.

    None for a model without excitations, or without a place to measure at.
    """
    if not subject.has_excitations:
        return None
    places = measuring_places(subject)
    files = files_by_case(subject)
    if not places:
        return None
    blocks: list[Block] = []
    reference = ""
    for case, tests in files or ((subject.normal_case, ()),):
        reference, blocks_of_case = _of_condition(subject, case, places, tests)
        blocks += blocks_of_case
    blocks += [] if files else _with_cylinder_out(subject, places)
    text = phrase(INTRODUCTION, reference=as_words(reference))
    known = phrase(TOLERANCE, share=100 * SAME_VALUE, speed=100 * SAME_SPEED)
    return Section("measurement_plan", ("Measurement plan",), (Paragraph((text,)), Paragraph((known,)), *blocks))


def _of_condition(
    subject: ReportData, case: Case, places: Sequence[MeasuringPlace], files: Sequence[MeasuredFile]
) -> tuple[str, list[Block]]:
    """Reference shaft, and tables of the plan in one condition for every place that it has."""
    blocks: list[Block] = []
    runs = {place: run for place in places if (run := _run(case, place)) is not None}
    channels = [run.outputs[0] for run in runs.values()]
    tests: dict[str, list[PlaceTest]] = {}
    for file in files:
        for name, orders in read_measured(file, channels, case.configuration).items():
            run = next(run for run in runs.values() if run.outputs[0].name == name)
            tests.setdefault(name, []).append(_test(case, run, file, within_calculated(file, run, name, orders)))
    reference = ""
    for place, run in runs.items():
        reference, name = run.reference, run.outputs[0].name
        speeds = merged_speeds([*critical_peaks(run), *_fixed_speeds(subject, case, run)]) or (_largest(run),)
        at = _at(case, place, speeds, run.reference)
        measured = [order for test in tests.get(name, ()) for order in test.orders]
        blocks.append(_place_table(subject, case, place, at, speeds, measured))
        if name in tests:
            blocks += measured_order_tables(run, name, tests[name], subject.conventions, *_placed(place, case))
            blocks.append(Paragraph((DAMPING_NOTE,)))
            if any(test.remarks for test in tests[name]):
                blocks.append(Paragraph((RUN_UP_NOTE,)))
    return reference, [*blocks, *_beside_limits(subject, case, files)]


def _test(case: Case, run: OrderResponse, file: MeasuredFile, orders: tuple[MeasuredOrder, ...]) -> PlaceTest:
    """Measured orders at a place, with those of the model along the speed over time if the run-up was a fast one."""
    if not is_tracked_table(file.path):
        return PlaceTest(orders)
    channel = run.outputs[0]
    comparison = swept_comparison(case.drivetrain, run, [channel.name], tracked_channel(file.path, channel))
    return PlaceTest(orders, comparison.orders.get(channel.name, ()), comparison.remarks)


def _beside_limits(subject: ReportData, case: Case, files: Sequence[MeasuredFile]) -> list[Block]:
    """Table and figures of measured half ranges beside the limits of the condition.

    Empty without half ranges of a limited quantity, or where limits were not judged in this condition.
    """
    checks = subject.limit_conclusion.checks if subject.limit_conclusion else ()
    check = next((judged for judged in checks if judged.configuration == case.configuration), None)
    if check is None:
        return []
    ranges: list[MeasuredRange] = []
    for file in files:
        if is_tracked_table(file.path):
            with suppress(UsageError):  # the file has no half range, or none that a limit judges
                ranges += measured_ranges(case.drivetrain, check, read_tracked_orders(file.path))
    if not ranges:
        return []
    where = phrase(" in configuration {name}", name=case.title) if case.configuration else ""
    blocks: list[Block] = [
        measured_range_block(
            ranges, subject.conventions, phrase("Measured half ranges beside limits{where}", where=_where(case))
        )
    ]
    for number, name in enumerate(dict.fromkeys(judged.limited.limit for judged in ranges), 1):
        drawn = limit_picture(check, name, subject.conventions, ranges)
        caption = (
            phrase("Limit {name} over speed{where}, measured half ranges as dots.", name=as_words(name), where=where),
        )
        told = f"{as_words(name)} over speed with its limits and measured half ranges{where}"
        blocks.append(Picture(f"measured_limit_{number}", drawn, caption, told))
    return blocks


def limit_picture(check: LimitCheck, name: str, conventions: Conventions, measured: Sequence[MeasuredRange]) -> Figure:
    """Figure of one limit over speed with the half ranges of a test."""
    from torsionnet.plot.limit_plot import limit_check

    return limit_check(replace(check, title=""), name, conventions=conventions, title="", measured=measured)


def _with_cylinder_out(subject: ReportData, places: Sequence[MeasuringPlace]) -> list[Block]:
    """Table of the condition with a cylinder out that uses the limits most, at its worst and highest permitted speed.

    Empty where none was judged.
    """
    worst = governing_misfire(subject)
    if worst is None or worst.verdict.worst is None:
        return []
    case, check = subject.judged_case(worst.check), worst.check
    speed, limit = float(check.speeds[worst.verdict.worst]), as_words(worst.verdict.limit)
    template = "Worst of {limit}" if check.permits(speed) else "Worst of {limit}, not permitted"
    wanted = [PlannedSpeed(speed, phrase(template, limit=limit)), *_highest(check)]
    rows: list[tuple[Cell, ...]] = []
    for place in places:
        try:
            run = _at(case, place, merged_speeds(wanted))
        except UsageError:  # switched off in this condition
            continue
        rows += _out_rows(subject, place, run, merged_speeds(wanted))
    words = in_words_of(case.drivetrain.definition.excitations.values(), "Expected with a cylinder out{where}")
    return [table(phrase(words, where=_where(case)), OUT_COLUMNS, rows)] if rows else []


def _out_rows(
    subject: ReportData, place: MeasuringPlace, run: OrderResponse, speeds: Sequence[PlannedSpeed]
) -> Iterator[tuple[Cell, ...]]:
    """Yield a row for each planned speed: half range and largest orders at a place, and the cylinder worst there."""
    channel = run.outputs[0]
    scale, shown = _unit_of(run, subject)
    rows = planned_amplitudes(run, speeds, channel.name)
    for at, planned in enumerate(speeds):
        largest = [row for row in rows if row.speed == planned.speed][:MOST_ORDERS_OUT]
        orders = "; ".join(f"{as_words(row.name)}: {NumberText(row.amplitude * scale, 3)}" for row in largest)
        yield (
            joined(", ", (phrase(capital(place.sensor.quantity)), as_words(place.sensor.of))),
            NumberText(planned.speed * RPM, 4),
            capital(planned.reason),
            _case(run, at, channel.name),
            NumberText(float(run.half_range[at, 0]) * scale, 3),
            unit(shown),
            orders,
        )


def _case(run: OrderResponse, at: int, name: str) -> str:
    """Name of the case of excitation that is worst for an output at a speed, given by its index; or nothing."""
    return as_words(run.case_at(at, name)) if isinstance(run, WorstResponse) else ""


def _at(case: Case, place: MeasuringPlace, speeds: Sequence[PlannedSpeed], of: str | None = None) -> OrderResponse:
    """Response at a place, and of the stress there, at planned speeds one after the other."""
    outputs = dict.fromkeys([place.name, *map(str, _stress(case, place)), *map(str, _judged(case, place)[0])])
    return case.drivetrain.order_response([*outputs], speeds=[planned.speed for planned in speeds], speed_of=of)


def _run(case: Case, place: MeasuringPlace) -> OrderResponse | None:
    """Response at a place over the speeds of the model; None where it is switched off in this condition."""
    try:
        return case.drivetrain.order_response(place.name, refine=True)
    except UsageError:
        return None


def _largest(run: OrderResponse) -> PlannedSpeed:
    """Speed of the largest vibration at a place, for a range of speeds that nothing else marks."""
    return PlannedSpeed(float(run.speeds[run.half_range[:, 0].argmax()]), "largest half range")


def _fixed_speeds(subject: ReportData, case: Case, run: OrderResponse) -> Iterator[PlannedSpeed]:
    """Rated speed, ends of the condition's own barred ranges and its highest speed permitted, if calculated."""
    speeds, judged = subject.model.definition.speeds, subject.limit_conclusion
    wanted = [PlannedSpeed(speeds.rated, "rated", True)] if speeds is not None and speeds.rated else []
    for check in judged.checks if judged else ():
        if check.configuration == case.configuration:
            # As the operating instructions say them: outward to whole rpm.
            ends = [(low / RPM, high / RPM) for low, high in (span.rpm_outward for span in check.passed)]
            for low, high in ends:
                wanted += [PlannedSpeed(low, "barred from", True), PlannedSpeed(high, "barred to", True)]
            wanted += _highest(check)
    low, high = float(run.speeds.min()), float(run.speeds.max())
    yield from (planned for planned in wanted if low * (1 - 1e-9) <= planned.speed <= high * (1 + 1e-9))


def _highest(check: LimitCheck) -> list[PlannedSpeed]:
    """Highest speed permitted in a condition, in whole rpm as the operating instructions say it; empty for any."""
    if check.highest is None or check.highest <= check.speeds[0]:
        return []
    return [PlannedSpeed(whole_rpm(check.highest, math.floor) / RPM, HIGHEST, True)]


def _stress(case: Case, place: MeasuringPlace) -> list[Sensor]:
    """Sensor of the stress that the torque of a place makes, if the place is a round shaft."""
    if place.sensor.quantity != "torque" or section_fault(case.drivetrain.definition.elements[place.sensor.of]):
        return []
    return [Sensor("stress", place.sensor.of)]


def _judged(case: Case, place: MeasuringPlace) -> tuple[list[Sensor], float]:
    """Sensors whose largest half range the limit on the stress of a place's shaft judges, and the factor to Pa.

    Nothing without such a limit.
    """
    if place.sensor.quantity != "torque":
        return [], 0.0
    view = limit_subject(case.drivetrain.definition, case.drivetrain.exact_values)
    limits = [limit for limit in case.drivetrain.definition.limits.values() if isinstance(limit, ShaftLimit)]
    sensors_of_limits = (
        limit.vibratory_sensors(criterion, view)
        for limit in limits
        if limit.element == place.sensor.of
        for criterion in VIBRATORY_STRESSES
    )
    return next((limit for limit in sensors_of_limits if limit is not None), ([], 0.0))


def _unit_of(run: OrderResponse, subject: ReportData) -> tuple[float, str]:
    """Factor and unit of a measured output: torques as in the tables of limits, without limits by their own size."""
    size = {} if subject.model.definition.limits else {"size": float(run.half_range[:, 0].max())}
    return engineering_unit(run.outputs[0].unit, subject.conventions, **size)


def _place_table(
    subject: ReportData,
    case: Case,
    place: MeasuringPlace,
    run: OrderResponse,
    speeds: Sequence[PlannedSpeed],
    measured: Sequence[MeasuredOrder],
) -> TableBlock:
    """Table of one place: speed, order, expected amplitude, half range, and what was measured."""
    rows = planned_amplitudes(run, speeds, run.outputs[0].name)
    scale, shown = _unit_of(run, subject)
    tests = [measured_at(row, measured) for row in rows]
    columns = [
        Heading("Speed", "rpm", numeric=True),
        Heading("What it is", wide=True),
        Heading("Order", numeric=True),
        Heading("Excited by"),
        Heading("Expected", unit(shown), numeric=True),
        Heading("Measured", unit(shown), numeric=True),
        Heading("Deviation", "%", numeric=True),
        Heading("Half range", unit(shown), numeric=True),
        Heading("Half range", unit("N/mm^2"), numeric=True),
        Heading("Judged", unit("N/mm^2"), numeric=True),
    ]
    ends, factor = _judged(case, place)
    first = [number == 0 or rows[number - 1].speed != row.speed for number, row in enumerate(rows)]
    at = [int(np.argmin(abs(run.speeds - row.speed))) for row in rows]
    has_stress = len(_stress(case, place)) > 0
    # Stresses from Pa to N/mm^2.
    stress = [float(run.half_range[row_at, 1]) * 1e-6 if has_stress else None for row_at in at]
    places = [run.output(str(sensor)) for sensor in ends]
    judged = [float(run.half_range[row_at, places].max()) * factor * 1e-6 if places else None for row_at in at]
    cells: list[list[Cell]] = [
        _once(aligned_numbers([row.rpm for row in rows]), first),
        _once([capital(row.reason) for row in rows], first),
        [f"{row.order:.4g}" for row in rows],
        [as_words(row.name) for row in rows],
        list(aligned_numbers([row.amplitude * scale for row in rows], 3)),
        list(aligned_numbers([None if test is None else test * scale for test in tests], 3))
        if measured
        else [""] * len(rows),
        [_deviation(row, test) for row, test in zip(rows, tests, strict=True)] if measured else [""] * len(rows),
        _once(aligned_numbers([row.half_range * scale for row in rows], 3), first),
        _once(aligned_numbers(stress, 3), first) if has_stress else [""] * len(rows),
        _once(aligned_numbers(judged, 4), first) if places else [""] * len(rows),
    ]
    template = CAPTIONS.get(place.sensor.quantity, f"{capital(place.means)}, {{of}}{{where}}")
    caption = phrase(template, of=as_words(place.sensor.of), where=_where(case))
    return table(caption, columns, list(zip(*cells, strict=True)), [JUDGED] if places else [])


def _once(cells: Sequence[Cell], first: Sequence[bool]) -> list[Cell]:
    """Cells of a column that stand in the first row of each speed only."""
    return [cell if shown else "" for cell, shown in zip(cells, first, strict=True)]


def _deviation(planned: PlannedAmplitude, measured: float | None) -> Cell:
    """Measured less expected amplitude over the expected one in per cent; a dash where none was measured."""
    known = None if measured is None else 100 * (measured / planned.amplitude - 1)
    return NumberText(known, 3, None if known is None else 1)


def _placed(place: MeasuringPlace, case: Case) -> tuple[str, str]:
    """Texts of how a place is measured, and of what it is on and in which condition."""
    of = as_words(place.sensor.of)
    if not case.configuration:
        return phrase(place.means), f", {of}"
    return phrase(place.means), phrase(", {of}; condition {name}", of=of, name=case.title)


def _where(case: Case) -> str:
    return phrase("; condition {name}", name=case.title) if case.configuration else ""
