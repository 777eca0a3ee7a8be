"""Section of a report on the excitations, their entries, speeds and torques by order."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.base.entries.composite import Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Spec
from torsionnet.base.number_text import MISSING_TYPESET, aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM, expected_unit
from torsionnet.machinery.excitations.harmonic_torque import PropellerTorque
from torsionnet.machinery.excitations.pressure_trace import PressureTrace
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.excitations.table_by_pressure import TableByPressure
from torsionnet.machinery.orders.order_solution import shaft_speeds
from torsionnet.report.document_tree import Block, Cell, Heading, NumberText, Paragraph, Section, TableBlock
from torsionnet.report.report_cylinders import engine_blocks, state_table
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_orders import acting_otherwise, first_acting, highest_orders, other_table, propeller_block
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, unit

if TYPE_CHECKING:
    from torsionnet.machinery.excitations import OrderExcitation
    from torsionnet.machinery.excitations.speed_range import SpeedRange


EQUAL_AMPLITUDES = 1e-9
"""Relative difference up to which amplitudes of torques count as equal, no more than rounding."""
LONGEST_LIST = 12
"""Largest number of numbers in a list that a report writes out; longer lists are given by their range."""
MOST_ORDERS = 30
"""Largest number of orders in the table of an excitation; of more it gives the number."""
ROUNDING = 1e-12
"""Amplitude over the largest one of an excitation below which it is what rounding leaves."""
OWN_SHAFT = " Orders of an excitation are multiples of the speed of its own shaft."
"""Note on which shaft the orders of an excitation refer to."""
Row = tuple[Cell, ...]


def excitations_section(subject: ReportData) -> Section | None:
    """Section of a report on the excitations; None for a model without."""
    if not subject.has_excitations:
        return None
    definition = subject.model.definition
    blocks: list[Block] = [Paragraph((_speeds(definition.speeds), OWN_SHAFT))] if definition.speeds else []
    for name, excitation in definition.excitations.items():
        blocks.append(_entries(name, excitation))
        blocks.append(_torques(subject.cases[0], name, excitation))
    changed = [*_changes(subject)]
    if changed:
        columns = (Heading("Configuration"), Heading("Excitation"), Heading("Entry"), Heading("Value", wide=True))
        blocks.append(table("What configurations change of the excitations", columns, changed))
    return Section("excitations", ("Excitations",), tuple(blocks))


def _speeds(speeds: SpeedRange) -> str:
    low, high = speeds.values[0] * RPM, speeds.values[-1] * RPM
    rated = phrase("; rated speed {speed:.6g} rpm", speed=speeds.rated * RPM) if speeds.rated else ""
    count = len(speeds.values)
    return phrase(
        "The speed of {node} runs from {low:.6g} to {high:.6g} rpm, {count} values{rated}.",
        node=as_words(speeds.of),
        low=low,
        high=high,
        count=count,
        rated=rated,
    )


def _entries(name: str, excitation: OrderExcitation) -> TableBlock:
    columns = (Heading("Property"), Heading("Value", wide=True), Heading("Unit"))
    rows = [*_properties(excitation)]
    return table(
        phrase("Excitation {name}: {type}", name=as_words(name), type=as_words(excitation.kind)), columns, rows
    )


def _properties(entry: Declared, over: str = "") -> Iterator[Row]:
    """Property, value and unit, as cells, of everything that the model gives of an excitation or another entry."""
    absent = dict(entry.defaults())
    for name, spec in entry.specs():
        value = getattr(entry, name)
        if value is None or value == absent.get(name, ()) or (isinstance(value, tuple) and not value):
            continue
        if isinstance(spec, Nested) and isinstance(value, Declared):
            yield from _properties(value, f"{over}{as_words(name)}: ")
        else:
            yield f"{over}{as_words(name)}", *_value_cells(spec, value)


def _value_cells(spec: Spec[object], value: Any) -> tuple[Cell, Cell]:
    """Value and unit of an entry as two cells."""
    if isinstance(spec, Value) and spec.dimension == "speed":
        return NumberText(value * RPM, 6), "rpm"
    if isinstance(spec, Value):
        return NumberText(float(value), 6), unit(expected_unit(spec.dimension))
    if isinstance(value, PressureTrace):
        return as_words(str(value)), "–"
    if isinstance(spec, TableByPressure) and all(isinstance(entry, PressureTrace) for entry in value.values()):
        return as_words("; ".join(f"at {pressure / 1e5:.6g} bar {entry}" for pressure, entry in value.items())), "–"
    if isinstance(value, tuple) and len(value) > LONGEST_LIST:
        return phrase(
            "{count} values between {low:.6g} and {high:.6g}", count=len(value), low=min(value), high=max(value)
        ), "SI"
    if isinstance(value, Mapping) and value and all(isinstance(entry, Declared) for entry in value.values()):
        return "; ".join(f"{_text(key)}: {_given_values_text(entry)}" for key, entry in value.items()), "–"
    return _text(spec.plain(value)), "–"


def _given_values_text(entry: Declared) -> str:
    """Text with the names and values of what is given of one of several entries, each number with its unit."""
    absent = dict(entry.defaults())
    entries = ((name, spec, getattr(entry, name)) for name, spec in entry.specs())
    return ", ".join(
        f"{as_words(name)} {_with_unit(spec, value)}"
        for name, spec, value in entries
        if value not in (None, absent.get(name))
    )


def _with_unit(spec: Spec[object], value: Any) -> str:
    if not isinstance(spec, Value):
        return _text(spec.plain(value))
    if spec.dimension == "angle":
        return f"{math.degrees(value):.6g} {unit('deg')}"
    return f"{float(value):.6g} {unit(expected_unit(spec.dimension))}".removesuffix(f" {MISSING_TYPESET}")


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return "; ".join(f"{key}: {_text(inner)}" for key, inner in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(_text, value))
    return f"{value:.6g}" if isinstance(value, float) else as_words(str(value))


def _torques(case: Case, name: str, excitation: OrderExcitation) -> TableBlock:
    """Table of the largest amplitude of every order of an excitation in N m, with the node on which it acts."""
    speed, own = shaft_speeds(case.drivetrain, name)
    torques = excitation.torques(np.array([own]))
    sizes = np.abs(torques.amplitudes[0])
    same = sizes >= (1 - EQUAL_AMPLITUDES) * sizes.max(axis=1, keepdims=True)
    where = np.argmax(same, axis=1)  # of equal ones the first
    largest = sizes[np.arange(len(where)), where]
    # What rounding leaves of cylinders that cancel each other is no torque, and has no phase.
    largest[largest < ROUNDING * largest.max(initial=0.0)] = 0.0
    phases = np.degrees(np.angle(torques.amplitudes[0][np.arange(len(where)), where]))
    fixed = np.zeros(len(where)) if torques.fixed is None else torques.fixed
    beside: list[Cell] = [NumberText(hertz, 6) if fixed.any() else "" for hertz in fixed.tolist()]
    columns = (
        Heading("Order", numeric=True),
        Heading("Frequency beside it", "Hz", numeric=True),
        Heading("Amplitude", unit("N*m" if excitation.quantity == "torque" else "rad"), numeric=True),
        Heading("Phase", "deg", numeric=True),
        Heading("Node"),
    )
    rows = zip(
        [NumberText(float(order), 6) for order in torques.orders],
        beside,
        aligned_numbers(largest.tolist()),
        [NumberText(float(phase), 4, 1) if size else "" for phase, size in zip(phases, largest, strict=True)],
        [_node(torques.nodes, place, int(count)) for place, count in zip(where, same.sum(axis=1), strict=True)],
        strict=True,
    )
    other = (
        "" if math.isclose(own, speed) else phrase(", where the reference shaft has {speed:.6g} rpm", speed=speed * RPM)
    )
    what = "Imposed motion of {name} by order of its shaft at {speed:.6g} rpm{reference}"
    if excitation.quantity == "torque":
        what = "Torques of {name} by order of its shaft at {speed:.6g} rpm{reference}"
    caption = phrase(what, name=as_words(name), speed=own * RPM, reference=other)
    notes = ["Of several nodes the one with the largest amplitude, of equal ones the first; cylinders differ in phase."]
    return table(caption, columns, list(rows), notes if len(torques.nodes) > 1 else [], most=MOST_ORDERS)


def _node(nodes: Sequence[str], place: int, alike: int) -> str:
    """Text with the node whose phase is given, and the number of nodes with the same amplitude."""
    return as_words(nodes[place]) + (phrase(" (of {count} alike)", count=alike) if alike > 1 else "")


def _changes(subject: ReportData) -> Iterator[Row]:
    """Table rows on entries of excitations that a configuration has otherwise than the model as written."""
    written = subject.model.definition.excitations
    for case in subject.cases:
        for name, excitation in case.drivetrain.definition.excitations.items():
            for entry, spec in excitation.specs():
                value = getattr(excitation, entry)
                if name in written and value != getattr(written[name], entry, None):
                    yield case.title, as_words(name), as_words(entry), _value_cells(spec, value)[0]


# Section of a report on the excitation: engines, propellers, and everything else that acts by order.


def harmonics_section(subject: ReportData) -> Section | None:
    """Section of a report on the harmonics of all excitations; None for a model without excitations."""
    if not subject.has_excitations or not subject.natural_frequencies:
        return None
    blocks: list[Block] = []
    others: list[tuple[Case, str]] = []
    for name in subject.model.definition.excitations:
        case = first_acting(subject, name)
        if case is None:
            continue
        excitation = case.drivetrain.definition.excitations[name]
        if isinstance(excitation, ReciprocatingEngine):
            blocks += engine_blocks(subject, case, name, excitation)
        elif isinstance(excitation, PropellerTorque):
            first, *others_acting = acting_otherwise(subject, name)
            blocks.append(propeller_block(first, name))
            blocks += [propeller_block(other, name, other.title) for other in others_acting]
        else:
            others.append((case, name))
    if others:
        blocks.append(other_table(others))
    states = state_table(subject)
    if states is not None:
        blocks.append(states)
    if end := highest_orders(subject):
        blocks.append(Paragraph((end,)))
    return Section("harmonics", ("Excitation",), tuple(blocks)) if blocks else None
