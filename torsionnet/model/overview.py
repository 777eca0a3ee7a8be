"""Tables of a model's elements, parameters, inputs, sensors, configurations and mean speeds."""

from __future__ import annotations

import html
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

from torsionnet.base.entries.composite import Listed, Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import NumberTable, Value
from torsionnet.base.entries.spec import Flag, Spec
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.number_text import screen_text
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM, expected_unit
from torsionnet.model.channels import PORT_QUANTITIES, UNITS
from torsionnet.model.checks.values import parameter_units
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.element_base.curves import Characteristic
from torsionnet.model.element_base.element_entries import MultipleValues, NodeName, NodePair, ReferenceNode
from torsionnet.model.element_base.laws import Law
from torsionnet.model.element_base.quantity_table import TableByName
from torsionnet.model.element_base.spring_stages import QuantityRows
from torsionnet.model.elements import Element, Values

if TYPE_CHECKING:
    from torsionnet.model.configurations import Overlay
    from torsionnet.model.model import Model


# Values that an element gives, one by one, with those of nested entries.

REMARKS = ("description", "enabled")
"""Names of the entries that tables show in their column of remarks."""


def given(element: Element) -> Iterator[tuple[str, Spec[object], Any]]:
    """Name, specification and value of the entries that an element gives, but nodes and remarks.

    Nested names as ``silicone.moduli``.
    """
    for name, (spec, value) in element.scalars().items():
        if not has_own_column(name, spec):
            yield from _leaves(name, spec, value)


def has_own_column(name: str, spec: Spec[object]) -> bool:
    """Whether a table of elements shows the entry in a column of its own: nodes, and remarks."""
    of = spec.of if isinstance(spec, Listed) else spec
    nodes = isinstance(of, NodeName | NodePair) and not isinstance(of, ReferenceNode)
    return nodes or name in REMARKS


def _leaves(name: str, spec: Spec[object], value: Any) -> Iterator[tuple[str, Spec[object], Any]]:
    if isinstance(value, tuple) and value and all(isinstance(part, Declared) for part in value):
        for number, part in enumerate(value, 1):
            yield from _leaves(f"{name} {number}", spec, part)
    elif isinstance(value, Declared):
        if isinstance(spec, Typed):
            yield name, spec, value.kind
        for inner, of in value.specs():
            if (part := getattr(value, inner)) is not None:
                yield from _leaves(f"{name}.{inner}", of, part)
    else:
        yield name, spec, value


def in_words(spec: Spec[object], value: Any) -> str:
    """Text of an entry's value that is no number: yes or no, a word, or a list of words."""
    if isinstance(spec, Flag):
        return "yes" if value else "no"
    if isinstance(spec, NumberTable):
        return f"{len(value)} rows, {value[0][0]:g} to {value[-1][0]:g}"
    plain = value if isinstance(value, str) else spec.plain(value)
    if isinstance(plain, list) and plain and all(isinstance(row, list) for row in plain):
        rows = "; ".join(map(_listed_values, plain))
        return rows if len(plain) <= MOST_MATRIX_ROWS else f"{len(plain)} x {len(plain[0])}"
    return _listed_values(plain)


def _listed_values(plain: Any) -> str:
    if isinstance(plain, Mapping):
        return ", ".join(f"{name} {_listed_values(part)}" for name, part in plain.items())
    return ", ".join(map(_listed_values, plain)) if isinstance(plain, list | tuple) else str(plain)


MOST_MATRIX_ROWS = 3
"""Largest number of rows of a matrix that a table of elements writes out."""
MOST_ROWS = 60
"""Largest number of rows of a table in a notebook, beyond which the table is cut: a page that scrolls, and loads at
once."""
Written: TypeAlias = tuple[str | float, ...]
"""Type of a text with numbers in it, which a table writes with the digits of its column."""


def tables(rig: Model) -> tuple[Table, ...]:
    """Tables of elements, parameters, channels, configurations and speeds of a model; unused ones have no rows."""
    return (
        elements_table(rig),
        parameters_table(rig),
        channels_table(rig),
        configurations_table(rig),
        speeds_table(rig),
    )


def page(rig: Model) -> str:
    """HTML of the tables of a model, cut after the first rows for large models."""
    shown = [_beginning(table) for table in tables(rig) if table.rows]
    return "\n".join([f"<p><b>{html.escape(rig.title)}</b></p>", *(table.to_html() for table in shown)])


def _beginning(table: Table) -> Table:
    if len(table.rows) <= MOST_ROWS:
        return table
    return replace(
        table, rows=table.rows[:MOST_ROWS], notes=(*table.notes, f"the first {MOST_ROWS} of {len(table.rows)}")
    )


def elements_table(rig: Model) -> Table:
    """Table of a model's elements with type, nodes, values and remark."""
    columns = (Column("element"), Column("type"), Column("nodes"), Column("values"), Column("description"))
    rows = tuple(
        (element.name, element.kind, nodes_text(element), _listed(values_of(element, rig)), _remark(element))
        for element in rig.definition.elements.values()
    )
    return without_empty_columns(Table("Elements", columns, rows))


def without_empty_columns(table: Table) -> Table:
    return table.chosen(
        [index for index in range(len(table.columns)) if any(row[index] not in ("", (), None) for row in table.rows)]
    )


def _listed(values: Iterable[Written]) -> Written:
    """Texts of several values as one text, joined by semicolons."""
    parts = [part for value in values for part in ("; ", *value)]
    return tuple(parts[1:])


def _remark(element: Element) -> str:
    return (
        element.description
        if element.enabled
        else f"switched off{'; ' * bool(element.description)}{element.description}"
    )


def nodes_text(element: Element) -> str:
    """Text of the nodes that an element connects: ``motor - ground``, or its ports by name."""
    if set(element.ports) <= {"first", "second", "node"}:
        return " - ".join(element.ports.values())
    return ", ".join(f"{port} {node}" for port, node in element.ports.items())


def values_of(element: Element, rig: Model) -> Iterator[Written]:
    """Texts as ``stiffness k_2 = 460 N*m/rad``, one for each value that an element gives."""
    defaults = element.defaults()
    for name, spec, value in given(element):
        if value != defaults.get(name, ()):
            yield (f"{name} ", *value_text(element, spec, value, rig))


def value_text(element: Element, spec: Spec[object], value: Any, rig: Model) -> Written:
    if isinstance(value, DampingMeasure):
        at = (" at ", *resolved(value.at, "Hz", rig)) if value.at is not None else ()
        shown = resolved(value.value, _unit_of_measure(value), rig)
        return (f"{value.measure} ", *shown, *at, *_viscous(element, rig))
    if isinstance(spec, MultipleValues):
        named = (
            [(f"{name} ", part) for name, part in value]
            if isinstance(spec, TableByName)
            else [("", part) for part in value]
        )
        return tuple(
            piece
            for number, (name, part) in enumerate(named)
            for piece in (", " if number else "", name, *value_text(element, spec.of, part, rig))
        )
    if isinstance(spec, Characteristic | QuantityRows):
        return (f"of {len(value)} rows",)
    entries = spec.expressions(value)
    if entries:
        return resolved(value, expected_unit(entries[0][2]), rig)
    if hasattr(value, "frequencies"):
        return (f"of {len(value.frequencies)} frequencies",)
    if isinstance(spec, Value):
        unit = expected_unit(spec.dimension)
        return (float(value), "" if unit == "1" else f" {unit}")
    return (in_words(spec, value),)


def _unit_of_measure(value: DampingMeasure) -> str:
    return expected_unit("damping" if value.measure == "c" else "1")


def _viscous(element: Element, rig: Model) -> Written:
    """Text of the viscous coefficient in N*m*s/rad that follows from a measure of damping.

    Empty for elements with several laws.
    """
    laws = [part for part in element.parts(Values(rig.exact_values)) if isinstance(part, Law)]
    return (" = ", float(laws[0].damping), " N*m*s/rad") if len(laws) == 1 and laws[0].damping else ()


def resolved(value: Expression, unit: str, rig: Model) -> Written:
    """Text of a value as written and, if different, in SI: ``0.46 kN*m/rad = 460 N*m/rad``."""
    number = (float(value.evaluate(rig.exact_values)), "" if unit == "1" else f" {unit}")
    if isinstance(value, Number) and value.unit_dimension is None:
        return number
    written = str(value)
    return number if written == screen_text(number) else (f"{written} = ", *number)


def parameters_table(rig: Model) -> Table:
    units = parameter_units(rig.definition)
    columns = (Column("parameter"), Column("value"), Column("unit"), Column("as written"), Column("description"))
    rows = tuple(
        (name, rig.parameters[name], units[name], parameter.written, parameter.description)
        for name, parameter in rig.parameter_definitions.items()
    )
    return Table("Parameters", columns, rows)


def channels_table(rig: Model) -> Table:
    rows = [(name, "input", str(entry), UNITS[entry.quantity], "") for name, entry in rig.inputs.items()]
    for name, sensor in rig.sensors.items():
        element = rig.elements.get(sensor.of) if sensor.quantity in PORT_QUANTITIES else None
        rows.append(
            (name, "sensor", str(sensor), UNITS[sensor.quantity], element.sign_at(sensor.at) if element else "")
        )
    columns = (Column("name"), Column("kind"), Column("what"), Column("unit"), Column("sign"))
    return without_empty_columns(Table("Inputs and sensors", columns, tuple(rows)))


def configurations_table(rig: Model) -> Table:
    rows = tuple(
        (axis, name, changes_text(overlay))
        for axis, alternatives in rig.definition.configurations.items()
        for name, overlay in alternatives.items()
    )
    return Table("Configurations", (Column("axis"), Column("name"), Column("changes")), rows)


def changes_text(overlay: Overlay) -> str:
    changes = [f"{name} = {value}" for name, value in overlay.parameters.items()]
    changes += [
        f"{switch}: {', '.join(names)}" for switch, names in (("on", overlay.on), ("off", overlay.off)) if names
    ]
    changes += [f"{name} = {value}" for name, value in overlay.entries.items()]
    return "; ".join([*changes, *(["operating point"] if overlay.operating_point else [])]) or "as written"


def speeds_table(rig: Model) -> Table:
    columns = (Column("node"), Column("mean speed", "rad/s"), Column("mean speed", "rpm"), Column("mean torque", "N*m"))
    speeds = rig.mean_speeds if rig.definition.operating_point.speed else {}
    torques = rig.mean_torques
    rows = tuple(
        (node, speeds.get(node), speeds[node] * RPM if node in speeds else None, torques.get(node))
        for node in rig.nodes
        if node in speeds or node in torques
    )
    return without_empty_columns(Table("Operating point", columns, rows))
