"""Section of a report on parameters as written and in SI units, configurations and operating points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.base.expressions import Number
from torsionnet.base.number_text import aligned_numbers, typeset_unit
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.model.checks.parameter_units import parameter_units
from torsionnet.report.document_tree import Block, Cell, Heading, Math, NumberText, Section, TableBlock, Text
from torsionnet.report.expression_latex import expression_latex
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_tables import shown_cells, table
from torsionnet.report.report_text import as_words, symbol_or_words, unit

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.model.parameters import Parameter

MOST_ROWS, MOST_COLUMNS = 60, 12
"""Largest number of rows in a table of parameters or nodes, and of parameters compared between configurations."""


def parameters_section(subject: ReportData) -> Section | None:
    """Section of a report on the parameters, configurations and operating points; None for a model without any."""
    rig = subject.model
    blocks: list[Block] = []
    if rig.parameters:
        blocks.append(_parameters(rig, dict(subject.request.settings)))
    changed = _changed(subject.cases)
    if changed:
        blocks.append(_configurations(subject.cases, changed, rig))
    switched = _switched(subject.cases)
    if switched:
        blocks.append(_switches(subject.cases, switched))
    blocks += _operating_points(subject.cases)
    return Section("parameters", ("Parameters",), tuple(blocks)) if blocks else None


def _units(rig: Drivetrain) -> dict[str, str]:
    return parameter_units(rig.definition)


def _parameters(rig: Drivetrain, settings: dict[str, str]) -> TableBlock:
    units = _units(rig)
    columns = (
        Heading("Symbol"),
        Heading("As given"),
        Heading("SI value", numeric=True),
        Heading("SI unit"),
        Heading("Plausible"),
        Heading("Description", wide=True),
    )
    rows = [
        (
            symbol_or_words(name),
            _written(parameter),
            NumberText(rig.parameters[name], 6),
            unit(units[name]),
            _bounds(parameter),
            parameter.description + ("; changed for this report" if name in settings else ""),
        )
        for name, parameter in rig.parameter_definitions.items()
    ]
    return table("Parameters", columns, rows, most=MOST_ROWS)


def _written(parameter: Parameter) -> Cell:
    value = parameter.value
    if parameter.by is not None:
        return parameter.written
    if isinstance(value, Number):
        return typeset_unit(str(value))
    return Math(expression_latex(value))


def _bounds(parameter: Parameter) -> Text:
    if parameter.bounds is None:
        return ()
    low, high = parameter.bounds
    return (NumberText(low), " to ", NumberText(high))


def _changed(cases: tuple[Case, ...]) -> list[str]:
    """Names of parameters that do not have the same value in all configurations of the report."""
    first = cases[0].drivetrain.parameters
    return [name for name in first if len({case.drivetrain.parameters[name] for case in cases}) > 1]


def _configurations(cases: tuple[Case, ...], names: list[str], rig: Drivetrain) -> TableBlock:
    units = _units(rig)
    shown = names[:MOST_COLUMNS]
    columns = (
        Heading("Configuration"),
        *(Heading(symbol_or_words(name), unit(units[name]), numeric=True) for name in shown),
    )
    values = [[NumberText(case.drivetrain.parameters[name], 6) for case in cases] for name in shown]
    rows = [(case.configuration, *row) for case, row in zip(cases, zip(*values, strict=True), strict=True)]
    rest = len(names) - len(shown)
    notes = [phrase("… and {count} more parameters", count=rest)] if rest > 0 else []
    return table("Parameters that differ between the configurations", columns, rows, notes)


def _switched(cases: tuple[Case, ...]) -> list[str]:
    every = cases[0].drivetrain.definition.elements
    return [name for name in every if len({name in case.drivetrain.elements for case in cases}) > 1]


def _switches(cases: tuple[Case, ...], names: list[str]) -> TableBlock:
    columns = (Heading("Configuration"), *(Heading(as_words(name)) for name in names))
    rows = [
        (case.configuration, *("on" if name in case.drivetrain.elements else "off" for name in names)) for case in cases
    ]
    return table("Elements that are switched", columns, rows)


def _operating_points(cases: tuple[Case, ...]) -> list[Block]:
    """Tables of mean speeds and torques at operating points, one for all configurations that share it."""
    alike: dict[tuple[object, ...], list[Case]] = {}
    for case in cases:
        rig = case.drivetrain
        alike.setdefault((*rig.mean_speeds.items(), None, *rig.mean_torques.items()), []).append(case)
    found: list[Block] = []
    for group in alike.values():
        names = ", ".join(case.configuration for case in group) if len(alike) > 1 else ""
        shown = _operating_point(group[0].drivetrain, phrase(", configuration {name}", name=names) if names else "")
        found += [shown] if shown else []
    return found


def _operating_point(rig: Drivetrain, where: str) -> TableBlock | None:
    speeds = rig.mean_speeds if any(rig.mean_speeds.values()) else {}
    torques = {node: value for node, value in rig.mean_torques.items() if value}
    nodes = [node for node in rig.nodes if node in speeds or node in torques]
    if not nodes:
        return None
    columns = (Heading("Node"), Heading("Mean speed", "rpm", numeric=True), Heading("Mean torque", "N·m", numeric=True))
    shaft_speeds = aligned_numbers([speeds[node] * RPM if node in speeds else None for node in nodes])
    loads = aligned_numbers([torques.get(node) for node in nodes])
    rows = [(as_words(node), speed, load) for node, speed, load in zip(nodes, shaft_speeds, loads, strict=True)]
    together: dict[str, list[tuple[Cell, ...]]] = {}
    for row in rows:
        together.setdefault(str(shown_cells(row[1:])), []).append(row)
    return table(
        phrase("Operating point{where}", where=where),
        columns,
        [row for group in together.values() for row in group],
        most=MOST_ROWS,
    )
