"""Section of a report on the elements with their values, and on inputs and sensors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.scalars import QuantityKind, Value
from torsionnet.base.entries.spec import Spec
from torsionnet.base.expressions import Expression, Name, Number
from torsionnet.base.number_text import aligned_numbers, typeset_unit
from torsionnet.base.phrases import phrase, with_values
from torsionnet.base.units import RPM, expected_unit
from torsionnet.model.channels import PORT_QUANTITIES, UNITS, Input
from torsionnet.model.checks.values import parameter_units
from torsionnet.model.damping import MEASURES, DampingMeasure
from torsionnet.model.element_base.curves import Characteristic, LookupCurve
from torsionnet.model.element_base.element_entries import MultipleValues
from torsionnet.model.element_base.laws import Law
from torsionnet.model.element_base.quantity_table import TableByName
from torsionnet.model.element_base.spring_stages import QuantityRows
from torsionnet.model.element_base.stiffness_table import TableEntry
from torsionnet.model.elements import Values
from torsionnet.model.overview import given, in_words
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Inline,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Section,
    TableBlock,
    Text,
)
from torsionnet.report.report_data import Case, ReportData, titles_of
from torsionnet.report.report_tables import expression_latex, shown_cells, table
from torsionnet.report.report_text import as_words, first_names, symbol_or_words, unit
from torsionnet.report.wording import REPORTED_ENTRIES

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.model.elements import Element
    from torsionnet.model.parameters import Parameter


DRIVEN = {"torque": "Torque on {node}", "angle": "Angle on {node}", "twist": "Twist on {element}"}
"""Words on what an input drives, by quantity."""
SENSED = {
    "torque": "Torque through {element}",
    "twist": "Twist of {element}",
    "stress": "Stress of {element}",
    "angle": "Angle of {node}",
    "velocity": "Velocity of {node}",
    "acceleration": "Acceleration of {node}",
}
"""Words on what a sensor shows, by quantity."""
MOST_ELEMENTS = 40
"""Largest number of rows in the report's table of elements; of more it gives the number."""
Row = tuple[Cell, ...]


def elements_section(subject: ReportData) -> Section:
    """Section of a report with tables of the elements and of inputs and sensors."""
    first = subject.cases[0]
    rig = first.drivetrain
    blocks: list[Block] = [_elements(rig, first.title if len(subject.cases) > 1 else "")]
    if rig.inputs or rig.sensors:
        blocks.append(_channels(rig))
    return Section("elements", ("Elements",), tuple(blocks))


def _elements(rig: Drivetrain, title: str) -> TableBlock:
    columns = (
        Heading("Element"),
        Heading("Type"),
        Heading("Between"),
        Heading("Property"),
        Heading("Symbol"),
        Heading("Value", numeric=True),
        Heading("Unit"),
        Heading("Remark", wide=True),
    )
    shown = _alike(rig)
    rows = [row for group in shown[:MOST_ELEMENTS] for row in _group_rows(group, rig)]
    where = phrase(" in configuration {name}", name=title) if title else ""
    elements = table(phrase("Elements{where}; values in SI units", where=where), columns, rows)
    return replace(elements, more=sum(map(len, shown[MOST_ELEMENTS:])))


def _alike(rig: Drivetrain) -> list[list[Element]]:
    """Elements of a drivetrain grouped by equal type and values."""
    groups: dict[str, list[Element]] = {}
    for element in rig.definition.elements.values():
        values = [shown_cells(row) for row in _property_cells(element, rig)]
        groups.setdefault(str((element.kind, _remark(element), values)), []).append(element)
    return list(groups.values())


def _group_rows(group: list[Element], rig: Drivetrain) -> Iterator[Row]:
    """Table rows on a group of equal elements, one for each property; the elements are named in the first row only."""
    element = group[0]
    ends = [between(each) for each in group]
    names, nodes = [as_words(each.name) for each in group], list(dict.fromkeys(ends))
    rest = f"; … and {len(nodes) - MOST_ELEMENTS} more" if len(nodes) > MOST_ELEMENTS else ""
    head: Row = (first_names(names, MOST_ELEMENTS), as_words(element.kind), "; ".join(nodes[:MOST_ELEMENTS]) + rest)
    values = list(_property_cells(element, rig)) or [("", "", "", "")]
    for number, row in enumerate(values):
        yield (*(head if not number else ("", "", "")), *row, _remark(element) if not number else "")


def _remark(element: Element) -> str:
    return "; ".join([*([] if element.enabled else ["switched off"]), *filter(None, [element.description])])


def between(element: Element) -> str:
    """Text of the nodes that an element connects: ``motor – ground``, or its ports by name where there are others."""
    if set(element.ports) <= {"first", "second", "node"}:
        return " – ".join(map(as_words, element.ports.values()))
    return ", ".join(f"{as_words(port)}: {as_words(node)}" for port, node in element.ports.items())


def _property_cells(element: Element, rig: Drivetrain) -> Iterator[tuple[Cell, Cell, Cell, Cell]]:
    """Property, symbol, value and unit, as cells, of everything that the model gives of an element."""
    defaults = element.defaults()
    for name, spec, value in given(element):
        if isinstance(value, DampingMeasure):
            yield from _measure(element, value, rig)
        elif isinstance(spec, QuantityKind) and isinstance(value, Expression):
            number = float(value.evaluate(rig.exact_values))
            if number or isinstance(value, Name):
                yield _property(name), _symbol(value), NumberText(number, 5), unit(expected_unit(spec.dimension))
        elif isinstance(spec, MultipleValues):
            for key, entry in value if isinstance(spec, TableByName) else enumerate(value, 1):
                yield _property(name, key), *_of_table(spec.of, entry, rig)
        elif isinstance(spec, Value):
            yield _property(name), "", NumberText(float(value), 5), unit(expected_unit(spec.dimension))
        elif isinstance(spec, REPORTED_ENTRIES) and value != ():
            yield _property(name), "", _plain(spec, value), "–"
        elif not isinstance(spec, REPORTED_ENTRIES) and value != defaults.get(name, ()):
            yield from _in_words(element, name, spec, value, rig)


def _in_words(
    element: Element, name: str, spec: Spec[object], value: Any, rig: Drivetrain
) -> Iterator[tuple[Cell, Cell, Cell, Cell]]:
    """Cells of property, symbol, value and unit for an entry of several values or of words."""
    expressions = [(path, expression, of) for path, _, expression, of in element.expressions() if path[0] == name]
    for path, expression, of in expressions:
        number = NumberText(float(expression.evaluate(rig.exact_values)), 5)
        yield _property(*path), _symbol(expression), number, unit(expected_unit(of)) if of else "SI"
    if not expressions:
        yield _property(name), "", in_words(spec, value), "–"


def _property(*path: object) -> str:
    """Words on an entry of an element; behind the first blank of its path is the key of one of several values."""
    name, _, key = " ".join(map(str, path)).partition(" ")
    return phrase(f"{as_words(name)} {{key}}", key=as_words(key)) if key else as_words(name)


def _of_table(spec: Spec[object], value: Any, rig: Drivetrain) -> tuple[Cell, Cell, Cell]:
    """Symbol, value and unit, as cells, of one of several quantities of an entry."""
    if isinstance(spec, QuantityKind) and isinstance(value, Expression):
        number = NumberText(float(value.evaluate(rig.exact_values)), 5)
        return _symbol(value), number, unit(expected_unit(spec.dimension))
    return "", _plain(spec, value), "–"


def _symbol(value: Expression) -> Inline:
    return "" if isinstance(value, Number) else Math(expression_latex(value))


def _plain(spec: Spec[object], value: Any) -> str:
    if isinstance(spec, TableEntry):
        return (
            f"table of {len(value.frequencies)} frequencies, {value.frequencies[0]:g} to {value.frequencies[-1]:g} Hz"
        )
    if isinstance(spec, LookupCurve):
        return f"{len(value)} rows, {value[0][0]} to {value[-1][0]}"
    if isinstance(spec, Characteristic | QuantityRows):
        names = ", ".join(column.name for column in spec.columns)
        return f"table of {len(value)} rows of {names}"
    return " : ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _measure(element: Element, value: DampingMeasure, rig: Drivetrain) -> Iterator[tuple[Cell, Cell, Cell, Cell]]:
    """Cells on a measure of damping and on the damping coefficient that follows from the measure."""
    dimension = MEASURES[value.measure].dimension
    at = (
        phrase(" at {frequency:g} Hz", frequency=float(value.at.evaluate(rig.exact_values)))
        if value.at is not None
        else ""
    )
    number = float(value.value.evaluate(rig.exact_values))
    what = MEASURES[value.measure].description
    symbol = Math(expression_latex(value.value)) if not isinstance(value.value, Number) else ""
    yield (
        phrase("damping as {measure}{at}", measure=phrase(what), at=at),
        symbol,
        NumberText(number, 5),
        unit(expected_unit(dimension)),
    )
    laws = [part for part in element.parts(Values(rig.exact_values)) if isinstance(part, Law)]
    if len(laws) == 1 and laws[0].damping:
        yield "damping, from that", "", NumberText(float(laws[0].damping), 5), unit(expected_unit("damping"))


def _channels(rig: Drivetrain) -> TableBlock:
    columns = (Heading("Symbol"), Heading("Kind"), Heading("Quantity"), Heading("Unit"), Heading("Sign", wide=True))
    rows: list[Row] = [
        (symbol_or_words(name), "input", _place_driven(entry), unit(UNITS[entry.quantity]), "")
        for name, entry in rig.inputs.items()
    ]
    for name, sensor in rig.sensors.items():
        element = rig.elements.get(sensor.of) if sensor.quantity in PORT_QUANTITIES else None
        sign = element.sign_at(sensor.at) if element else ""
        template = SENSED[sensor.quantity]
        template += " at {port}" if sensor.at else ""
        template += " against {other}" if sensor.against else ""
        template += " referred to {shaft}" if sensor.referred_to else ""
        place = as_words(sensor.of)
        names = {"port": sensor.at, "other": sensor.against, "shaft": sensor.referred_to}
        named = {key: as_words(name) for key, name in names.items() if name}
        what = phrase(template, element=place, node=place, **named)
        rows.append((symbol_or_words(name), "sensor", what, unit(UNITS[sensor.quantity]), with_values(sign, as_words)))
    return table("Inputs and sensors", columns, rows, most=MOST_ELEMENTS)


def _place_driven(entry: Input) -> str:
    """Text of what an input drives, and against what."""
    template = DRIVEN[entry.quantity] + (" against {other}" if entry.against else "")
    return phrase(template, node=as_words(entry.of), element=as_words(entry.of), other=as_words(entry.against or ""))


# Section of a report on parameters as written and in SI units, configurations and operating points.

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
        Heading("Tolerance", "%", numeric=True),
        Heading("Description", wide=True),
    )
    rows = [
        (
            symbol_or_words(name),
            _written(parameter),
            NumberText(rig.parameters[name], 6),
            unit(units[name]),
            _bounds(parameter),
            "" if parameter.tolerance is None else NumberText(100 * parameter.tolerance, 3),
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
    rows = [(case.title, *row) for case, row in zip(cases, zip(*values, strict=True), strict=True)]
    rest = len(names) - len(shown)
    notes = [phrase("… and {count} more parameters", count=rest)] if rest > 0 else []
    return table("Parameters that differ between the configurations", columns, rows, notes)


def _switched(cases: tuple[Case, ...]) -> list[str]:
    every = cases[0].drivetrain.definition.elements
    return [name for name in every if len({name in case.drivetrain.elements for case in cases}) > 1]


def _switches(cases: tuple[Case, ...], names: list[str]) -> TableBlock:
    columns = (Heading("Configuration"), *(Heading(as_words(name)) for name in names))
    rows = [(case.title, *("on" if name in case.drivetrain.elements else "off" for name in names)) for case in cases]
    return table("Elements that are switched", columns, rows)


def _operating_points(cases: tuple[Case, ...]) -> list[Block]:
    """Tables of mean speeds and torques at operating points, one for all configurations that share it."""
    alike: dict[tuple[object, ...], list[Case]] = {}
    for case in cases:
        rig = case.drivetrain
        alike.setdefault((*rig.mean_speeds.items(), None, *rig.mean_torques.items()), []).append(case)
    tables: list[Block] = []
    for group in alike.values():
        names = titles_of(group) if len(alike) > 1 else ""
        shown = _operating_point(group[0].drivetrain, phrase(", configuration {name}", name=names) if names else "")
        tables += [shown] if shown else []
    return tables


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


# Section of a report with the schematic of the drivetrain.

PART_HEIGHT = 105.0
"""Largest height in mm of a part of the schematic: with its caption less than half a page, so that pages are filled."""
LEGEND = "Discs are inertias; curved arrows mark inputs, dots sensors of motion and diamonds sensors of torque."
"""Meaning of the signs of a schematic."""


def schematic_section(subject: ReportData) -> Section:
    """Section of a report with the schematic of the drivetrain in the first configuration.

    A tall one is cut into parts. Others differ in values or switched elements.
    """
    from torsionnet.plot.schematics.schematic import schematic_parts

    case = subject.cases[0]
    rig = case.drivetrain
    where = phrase(", configuration {name}", name=case.title) if len(subject.cases) > 1 else ""
    nodes = first_names([as_words(node) for node in rig.nodes])
    alt = f"Schematic of {rig.name}: {len(rig.elements)} elements between the nodes {nodes}"
    parts = schematic_parts(rig, PART_HEIGHT)
    pictures = []
    for number, figure in enumerate(parts, 1):
        part = f", part {number} of {len(parts)}" if len(parts) > 1 else ""
        caption = (
            phrase("The drivetrain{where}, part {number} of {count}.", where=where, number=number, count=len(parts))
            if part
            else phrase("The drivetrain{where}.", where=where)
        )
        name = f"schematic_{number}" if part else "schematic"
        pictures.append(Picture(name, figure, (caption,), f"{alt}{part}"))
    return Section("schematic", ("Drivetrain",), (Paragraph((LEGEND,)), *pictures))
