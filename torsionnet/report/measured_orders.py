"""Measured orders that a report lays beside expected amplitudes, and the free end at which they are measured."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.base.number_text import NumberText, aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.orders.order_comparison import (
    ComparedOrder,
    OrderAgreement,
    compared_orders,
    meaning_notes,
    not_compared,
)
from torsionnet.machinery.orders.order_pair import common_turn
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.verdicts.measured_range import MeasuredRange
from torsionnet.model.channels import parse_sensor
from torsionnet.model.definition import Definition
from torsionnet.model.elements import GROUND
from torsionnet.report.document_tree import Cell, Heading, TableBlock
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, engineering_unit, limit_scale, unit

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.frequency_response import Channel
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder


# Measured orders that a report lays beside the amplitudes expected at the places of its measurement plan.

FORM = "CONFIGURATION=FILE, or CONFIGURATION:SENSOR=FILE"
"""Pattern, for error messages, of the text that names a file of measured orders, its condition and its sensor."""


@dataclass(frozen=True)
class MeasuredFile:
    """Path of a file with measured orders, the configuration they were measured in, and the sensor, empty if not said.

    Both names are empty where they are not said.
    """

    path: Path
    configuration: str = ""
    place: str = ""


@dataclass(frozen=True, eq=False)
class PlaceTest:
    """Measured orders of one file at a place of the plan, with those of the model along the speed of a fast run-up.

    Attributes
    ----------
    orders : tuple of MeasuredOrder
        SI.
    swept : tuple of MeasuredOrder
        Empty where the steady response is compared.
    remarks : tuple of str
        Peaks that the run-up did not reach.
    """

    orders: tuple[MeasuredOrder, ...]
    swept: tuple[MeasuredOrder, ...] = ()
    remarks: tuple[str, ...] = ()


def measured_files(raw: Any, model: Drivetrain) -> tuple[MeasuredFile, ...]:
    """Files with measured orders from paths, texts ``CONFIGURATION=FILE`` or a mapping of paths by configuration.

    Raises
    ------
    UsageError
        No such configuration, or none is said although the model has several.
    """
    files = []
    pairs: Iterable[tuple[str, Any]]
    pairs = raw.items() if isinstance(raw, Mapping) else (("", path) for path in raw)
    for name, paths in pairs:
        listed = [paths] if isinstance(paths, (str, os.PathLike, MeasuredFile)) else list(paths)
        files += [path if isinstance(path, MeasuredFile) else _parsed(name, os.fspath(path), model) for path in listed]
    return tuple(files)


def _parsed(name: str, text: str, model: Drivetrain) -> MeasuredFile:
    before, _, file = ("", "", text) if name or Path(text).exists() else text.rpartition("=")
    configuration, _, place = (name or before).rpartition(":")
    if not configuration and not (place in model.sensors or parse_sensor(place)):
        configuration, place = place, ""
    try:
        chosen = model.configured(configuration).configuration if configuration else model.configuration
    except (UsageError, ModelError) as error:
        raise UsageError(f'measured orders "{text}": {error}; write {FORM}', kind="wrong-form") from None
    return MeasuredFile(Path(file), chosen, place)


def read_measured(
    file: MeasuredFile, places: Sequence[Channel], configuration: str
) -> dict[str, tuple[MeasuredOrder, ...]]:
    """Measured orders in a file, by the name of the place of the plan that they were measured at.

    A file of ``torsionnet orders`` names its places; others are told by their unit.

    Raises
    ------
    UsageError
        No place has the unit of the file, or several have it; the message names the file and says what to do.
    """
    from torsionnet.io.tracked_order_tables import is_written_table, read_orders

    names = [place.name for place in places]
    if file.place and file.place not in names:
        raise UsageError(
            f"{file.path.name}: {file.place} is no place of the measurement plan, which has {', '.join(names)}; add it "
            f"to report: {{measure: [{', '.join([*names, file.place])}]}}",
            kind="unknown-name",
        )
    orders_by_place, refusals = {}, []
    for place in places:
        if file.place in ("", place.name):
            try:
                orders_by_place[place.name] = read_orders(file.path, place, configuration)
            except UsageError as error:
                refusals.append(str(error))
    if not orders_by_place:
        reasons = "; ".join(dict.fromkeys(refusals))
        raise UsageError(
            f"{reasons}. The plan measures {', '.join(f'{place.name} in {place.unit}' for place in places)}; give the "
            "file another unit, or name other sensors in report: {measure: [...]}",
            kind="wrong-unit",
        )
    if len(orders_by_place) > 1 and not is_written_table(file.path):
        raise UsageError(
            f"{file.path.name} may be of {' or '.join(orders_by_place)}, which have the same unit; say which: "
            f"{configuration or 'CONFIGURATION'}:{next(iter(orders_by_place))}={file.path.name}",
            kind="ambiguous-name",
        )
    return orders_by_place


# Tables of a report that lay measured orders and half ranges beside calculated ones and limits.

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
    pairs = [pair for test in tests for pair in compared_orders(run, output, test.orders, test.swept)]
    notes = [*meaning_notes(run, pairs), *dict.fromkeys(remark for test in tests for remark in test.remarks)]
    notes += filter(None, [common_turn([compared.pair for compared in pairs])])
    notes += not_compared([order for test in tests for order in test.orders], pairs)
    peaks = phrase("Measured and calculated peaks: {place}{where}", place=place, where=where)
    differences = phrase("Measured beside calculated orders over speed: {place}{where}", place=place, where=where)
    return [
        _peaks(pairs, run.outputs[run.output(output)].unit, conventions, peaks),
        _differences(pairs, differences, list(map(as_words, notes))),
    ]


def _peaks(pairs: Sequence[ComparedOrder], si: str, conventions: Conventions, caption: str) -> TableBlock:
    tests = [(pair.measured.amplitude, pair.measured.speeds) for pair in pairs]
    models = [(pair.calculated, pair.measured.speeds) for pair in pairs]
    peaks = [[(float(size.max()), float(speed[size.argmax()])) for size, speed in side] for side in (tests, models)]
    scale, shown = engineering_unit(si, conventions, max(size for side in peaks for size, _ in side))
    columns = [Heading("Order", numeric=True)]
    cells: list[list[Cell]] = [[f"{pair.measured.order:.4g}" for pair in pairs]]
    for name, side in zip(("Measured", "Calculated"), peaks, strict=True):
        columns += [Heading(name, unit(shown), numeric=True), Heading("Speed", "rpm", numeric=True)]
        cells += [list(aligned_numbers([size * scale for size, _ in side], 3))]
        cells += [list(aligned_numbers([speed * RPM for _, speed in side], 3))]
    columns += [Heading("Deviation", "%", numeric=True), Heading("Verdict")]
    cells += [_percent([pair.agreement.peak for pair in pairs]), [pair.agreement.verdict for pair in pairs]]
    return table(caption, columns, list(zip(*cells, strict=True)))


def _differences(pairs: Sequence[ComparedOrder], caption: str, notes: Sequence[Cell]) -> TableBlock:
    def column(value: Callable[[OrderAgreement], float | None]) -> list[Cell]:
        figures = [value(pair.agreement) for pair in pairs]
        return [""] * len(pairs) if all(figure is None for figure in figures) else _percent(figures)

    columns = (
        Heading("Order", numeric=True),
        Heading("RMS difference", "%", numeric=True),
        Heading("Phase at peak", "deg", numeric=True),
        Heading("RMS phase", "deg", numeric=True),
        Heading("In half widths", numeric=True),
        Heading("Explanation", wide=True),
    )
    cells: list[list[Cell]] = [
        [f"{pair.measured.order:.4g}" for pair in pairs],
        column(lambda agreement: agreement.rms),
        column(lambda agreement: agreement.phase_at_peak),
        column(lambda agreement: agreement.phase_rms),
        column(lambda agreement: agreement.intervals),
        [pair.agreement.sentence for pair in pairs],
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
    for judged_range in ranges:
        largest = float(max(judged_range.measured.max(), judged_range.calculated.max()))
        scale, shown = limit_scale(judged_range.limited.unit, conventions, largest)
        used = judged_range.utilisation[np.isfinite(judged_range.utilisation)]
        sizes = (NumberText(float(size.max()) * scale, 4) for size in (judged_range.measured, judged_range.calculated))
        rows.append((
            f"{as_words(judged_range.limited.limit)}, {as_words(judged_range.limited.criterion)}", *sizes, unit(shown),
            NumberText(judged_range.peak_difference, DIFFERENCE_DIGITS, 1),
            NumberText(100 * float(used.max()), DIFFERENCE_DIGITS, 1) if used.size else "",
            judged_range.verdict, as_words(judged_range.sentence),
        ))  # fmt: skip
    return table(caption, columns, rows, [RANGE_NOTE])


def _percent(values: Sequence[float | None]) -> list[Cell]:
    """Differences with one decimal."""
    return [NumberText(value, DIFFERENCE_DIGITS, None if value is None else 1) for value in values]


# Free end of a drivetrain at which its torsional vibration is measured on board.


def free_end(definition: Definition) -> str:
    """Name of the node at the free end of the engine: the end of the drivetrain nearest to a cylinder.

    Without an engine with cylinders the first end in the order of the model; without ends the first node.

    Examples
    --------
    >>> import torsionnet as tn
    >>> [free_end(tn.load(name).definition) for name in ("marine_medium_speed", "bulk_carrier")]
    ['free_end', 'c1']
    """
    neighbours = _neighbours(definition)
    ends = [node for node, others in neighbours.items() if len(others) == 1] or list(neighbours)
    far = _distances(neighbours, _cylinder_nodes(definition))
    return min(ends, key=lambda node: far.get(node, len(neighbours)), default="")


def _neighbours(definition: Definition) -> dict[str, set[str]]:
    """Nodes that an element connects with each node, in the order in which the elements name them."""
    neighbours: dict[str, set[str]] = {}
    for element in definition.active:
        nodes = [node for node in element.ports.values() if node != GROUND]
        for node in nodes:
            neighbours.setdefault(node, set())
        for node, other in combinations(nodes, 2):
            neighbours[node].add(other)
            neighbours[other].add(node)
    return neighbours


def _cylinder_nodes(definition: Definition) -> list[str]:
    """Nodes of the cylinders of all engines, or nothing where none runs."""
    each = (getattr(excitation, "cylinders", {}) for excitation in definition.excitations.values())
    return [str(node) for cylinders in each for node in cylinders.values()]


def _distances(neighbours: Mapping[str, set[str]], start: list[str]) -> dict[str, int]:
    """Number of elements between each node and the nearest node to start from, of the nodes connected to one."""
    distances = {node: 0 for node in start if node in neighbours}
    order = list(distances)
    for node in order:
        for other in sorted(neighbours[node]):
            if other not in distances:
                distances[other] = distances[node] + 1
                order.append(other)
    return distances
