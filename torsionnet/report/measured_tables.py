"""Tables of a report that lay measured orders and half ranges beside calculated ones and limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from torsionnet.base.conventions import Conventions
from torsionnet.base.number_text import NumberText, aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.orders.common_turn import common_turn
from torsionnet.machinery.orders.order_agreement import OrderAgreement
from torsionnet.machinery.orders.order_comparison import (
    ComparedOrder,
    compared_orders,
    meaning_notes,
    not_compared,
)
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.verdicts.measured_range import MeasuredRange
from torsionnet.report.document_tree import Cell, Heading, TableBlock
from torsionnet.report.engineering_units import engineering_unit
from torsionnet.report.measured_orders import PlaceTest
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, unit

DIFFERENCE_DIGITS = 3
"""Significant digits of differences in a report: intervals of tests have no more."""
RANGE_NOTE = (
    "Half ranges are (max − min)/2 of all orders together; the deviation is that of the largest ones at the measured "
    "speeds. Of a shaft the measured torque is turned into the stress that its limit judges."
)
"""Note below a table of measured half ranges beside limits."""


def measured_order_tables(
    run: OrderResponse, output: str, tests: Sequence[PlaceTest], conventions: Conventions, place: str, where: str
) -> list[TableBlock]:
    """Tables of the peaks of measured and calculated orders, with a verdict, and of their differences over speed.

    Orders of a run-up too fast for steady peaks are compared with those along its speed over time. ``place`` says how
    and ``where`` on what and in which condition was measured.
    """
    pairs = [pair for one in tests for pair in compared_orders(run, output, one.orders, one.swept)]
    notes = [*meaning_notes(run, pairs), *dict.fromkeys(remark for one in tests for remark in one.remarks)]
    notes += filter(None, [common_turn([one.pair for one in pairs])])
    notes += not_compared([order for one in tests for order in one.orders], pairs)
    peaks = phrase("Measured and calculated peaks: {place}{where}", place=place, where=where)
    differences = phrase("Measured beside calculated orders over speed: {place}{where}", place=place, where=where)
    return [
        _peaks(pairs, run.outputs[run.output(output)].unit, conventions, peaks),
        _differences(pairs, differences, list(map(as_words, notes))),
    ]


def _peaks(pairs: Sequence[ComparedOrder], si: str, conventions: Conventions, caption: str) -> TableBlock:
    tests = [(one.measured.amplitude, one.measured.speeds) for one in pairs]
    models = [(one.calculated, one.measured.speeds) for one in pairs]
    peaks = [[(float(size.max()), float(speed[size.argmax()])) for size, speed in side] for side in (tests, models)]
    scale, shown = engineering_unit(si, conventions, max(size for side in peaks for size, _ in side))
    columns = [Heading("Order", numeric=True)]
    cells: list[list[Cell]] = [[f"{one.measured.order:.4g}" for one in pairs]]
    for name, side in zip(("Measured", "Calculated"), peaks, strict=True):
        columns += [Heading(name, unit(shown), numeric=True), Heading("Speed", "rpm", numeric=True)]
        cells += [list(aligned_numbers([size * scale for size, _ in side], 3))]
        cells += [list(aligned_numbers([speed * RPM for _, speed in side], 3))]
    columns += [Heading("Deviation", "%", numeric=True), Heading("Verdict")]
    cells += [_percent([one.agreement.peak for one in pairs]), [one.agreement.verdict for one in pairs]]
    return table(caption, columns, list(zip(*cells, strict=True)))


def _differences(pairs: Sequence[ComparedOrder], caption: str, notes: Sequence[Cell]) -> TableBlock:
    def column(value: Callable[[OrderAgreement], float | None]) -> list[Cell]:
        found = [value(one.agreement) for one in pairs]
        return [""] * len(pairs) if all(one is None for one in found) else _percent(found)

    columns = (
        Heading("Order", numeric=True),
        Heading("RMS difference", "%", numeric=True),
        Heading("Phase at peak", "deg", numeric=True),
        Heading("RMS phase", "deg", numeric=True),
        Heading("In half widths", numeric=True),
        Heading("Explanation", wide=True),
    )
    cells: list[list[Cell]] = [
        [f"{one.measured.order:.4g}" for one in pairs],
        column(lambda one: one.rms),
        column(lambda one: one.phase_at_peak),
        column(lambda one: one.phase_rms),
        column(lambda one: one.intervals),
        [one.agreement.sentence for one in pairs],
    ]
    return table(caption, columns, list(zip(*cells, strict=True)), notes)


def measured_range_block(ranges: Sequence[MeasuredRange], conventions: Conventions, caption: str) -> TableBlock:
    """Table of the largest measured and calculated half ranges beside their limits, with a verdict and its place."""
    columns = (
        Heading("Limit"),
        Heading("Measured", numeric=True),
        Heading("Calculated", numeric=True),
        Heading("Unit"),
        Heading("Deviation", "%", numeric=True),
        Heading("Utilisation", "%", numeric=True),
        Heading("Verdict"),
        Heading("Explanation", wide=True),
    )
    rows: list[tuple[Cell, ...]] = []
    for one in ranges:
        largest = float(max(one.measured.max(), one.calculated.max()))
        scale, shown = engineering_unit(one.limited.unit, conventions, largest)
        used = one.utilisation[np.isfinite(one.utilisation)]
        sizes = (NumberText(float(size.max()) * scale, 4) for size in (one.measured, one.calculated))
        rows.append((
            f"{as_words(one.limited.limit)}, {as_words(one.limited.criterion)}", *sizes, unit(shown),
            NumberText(one.peak_difference, DIFFERENCE_DIGITS, 1),
            NumberText(100 * float(used.max()), DIFFERENCE_DIGITS, 1) if used.size else "",
            one.verdict, as_words(one.sentence),
        ))  # fmt: skip
    return table(caption, columns, rows, [RANGE_NOTE])


def _percent(values: Sequence[float | None]) -> list[Cell]:
    """Differences with one decimal."""
    return [NumberText(value, DIFFERENCE_DIGITS, None if value is None else 1) for value in values]
