"""Checks that every name in a model exists, and that everything named is used."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.base.errors import EntryPath, Fault, comma_list, nearest, question, unfit_word, unknown_name
from torsionnet.base.expressions import Expression
from torsionnet.base.packages import imported
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.channels import Input, Pair, Sensor, channel_words, parse_pair, parse_sensor, port_fault
from torsionnet.model.definition import (
    EXCITATIONS,
    SCENARIOS,
    Definition,
    all_nodes,
)
from torsionnet.model.element_base.element_entries import SIZE
from torsionnet.model.elements import GROUND
from torsionnet.model.operating_point import OperatingPoint, torque_place
from torsionnet.model.sections import OWNERS, section_class

if TYPE_CHECKING:
    pass

MOST_HINTS = 20
"""Largest number of dead ends for which a misspelt node is looked for, as a model with more has them on purpose."""


def _unknown_node(name: str, nodes: Collection[str], path: EntryPath, *, on_key: bool = False) -> Fault:
    if name == GROUND:
        return Fault("ground does not move; name a node", path, on_key=on_key, kind="grounded-node")
    return unknown_name("node", name, nodes, path, on_key=on_key)


def _operating_points(definition: Definition) -> Iterator[tuple[EntryPath, OperatingPoint]]:
    """Path and operating point of the model and of each alternative that has one."""
    yield ("operating_point",), definition.operating_point
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            if overlay.operating_point is not None:
                yield ("configurations", axis, label, "operating_point"), overlay.operating_point


def undefined_or_unused_parameters(definition: Definition) -> list[Fault]:
    """Faults of expressions with a parameter nobody defines, and warnings about parameters that nothing uses."""
    # Everything that the model, its alternatives and its scenarios calculate.
    expressions: list[tuple[EntryPath, Expression]] = [
        (("parameters", name), parameter.value) for name, parameter in definition.parameters.items()
    ]
    for table in ("elements", "scenarios"):
        for name, owner in getattr(definition, table).items():
            expressions += [((table, name, *path), expression) for path, _, expression, _ in owner.expressions()]
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            path: EntryPath = ("configurations", axis, label)
            expressions += [((*path, name), value) for name, value in overlay.parameters.items()]
    for path, point in _operating_points(definition):
        for entry in ("speed", "torque"):
            expressions += [((*path, entry, node), value) for node, value in getattr(point, entry).items()]
    if definition.has_overrides:
        from torsionnet.model.checks.overrides import changed_expressions

        expressions += changed_expressions(definition)
    known, used, faults = definition.parameters, set[str](), []
    for path, expression in expressions:
        used |= expression.names
        faults += [unknown_name("parameter", name, known, path) for name in sorted(expression.names - known.keys())]
    for name in known:
        if name not in used:
            text = phrase('parameter "{}" is not used', ModelName(name))
            faults.append(Fault(text, ("parameters", name), "warning", on_key=True, kind="unused-name", about=name))
    return faults


def unknown_nodes(definition: Definition) -> list[Fault]:
    """Faults of sensors, inputs, operating points and shafts referred to on nodes that no element has."""
    nodes = dict.fromkeys(all_nodes(definition.elements.values()))
    faults = []
    for table in ("inputs", "sensors"):
        for name, channel in getattr(definition, table).items():
            places = ((), ()) if len(channel.nodes) < 2 else ((0,), (1,))
            for node, place in zip(channel.nodes, places, strict=False):
                if node not in nodes:
                    faults.append(_unknown_node(node, nodes, (table, name, channel.quantity, *place)))
    for index, port in enumerate(definition.ports):
        if port not in nodes:
            faults.append(_unknown_node(port, nodes, ("ports", index)))
    for path, point in _operating_points(definition):
        named = [("speed", node, node) for node in point.speed]
        named += [("torque", text, node) for text in point.torque for node in torque_place(text).nodes]
        faults += [
            _unknown_node(node, nodes, (*path, table, key), on_key=True)
            for table, key, node in named
            if node not in nodes
        ]
    for table in ("sensors", "elements"):
        for name, quoted in getattr(definition, table).items():
            if quoted.referred_to is not None and quoted.referred_to not in nodes:
                faults.append(_unknown_node(quoted.referred_to, nodes, (table, name, "referred_to")))
    return faults


def unknown_elements(definition: Definition) -> list[Fault]:
    """Faults of sensors on elements, or on ports of elements, that do not exist."""
    faults = []
    for name, sensor in definition.sensors.items():
        if not sensor.is_on_element:
            continue
        path = ("sensors", name, sensor.quantity)
        element = definition.elements.get(sensor.of)
        if element is None:
            faults.append(_no_element(sensor.of, definition, path))
            continue
        if sensor.at is not None:
            unfit = port_fault(element, sensor.at)
            if unfit:
                faults.append(replace(unfit, path=("sensors", name, "at")))
        if sensor.quantity == "stress":
            from torsionnet.model.element_base.round_section import section_fault

            if reason := section_fault(element):
                faults.append(Fault(reason, path, kind="unfit-channel"))
    return faults


def unknown_followed(definition: Definition) -> list[Fault]:
    """Faults of parameters that follow a node or element that does not exist."""
    nodes = all_nodes(definition.elements.values())
    faults = []
    for name, parameter in definition.following.items():
        what, known = ("node", nodes) if parameter.by in ("speed", "load") else ("element", definition.elements)
        if parameter.of not in known:
            faults.append(unknown_name(what, parameter.of, known, ("parameters", name, "of")))
    return faults


def _no_element(name: str, definition: Definition, path: EntryPath) -> Fault:
    if name in all_nodes(definition.elements.values()):
        return Fault(
            phrase('"{}" is a node, no element; a torque is taken through an element', ModelName(name)),
            path,
            kind="unknown-element",
        )
    return unknown_name("element", name, definition.elements, path)


def unknown_in_configurations(definition: Definition) -> list[Fault]:
    """Faults of alternatives that change parameters or elements the model does not have."""
    faults = []
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            path = ("configurations", axis, label)
            for name in overlay.parameters:
                if name not in definition.parameters:
                    known = [*definition.parameters, "title", "on", "off", "operating_point"]
                    faults.append(unknown_name("parameter", name, known, (*path, name), on_key=True))
            for switch in ("on", "off"):
                for index, name in enumerate(getattr(overlay, switch)):
                    if name not in definition.elements:
                        faults.append(unknown_name("element", name, definition.elements, (*path, switch, index)))
            both = set(overlay.on) & set(overlay.off)
            text = "{} is switched on and off at once"
            faults += [
                Fault(phrase(text, ModelName(name)), (*path, "off"), kind="contradicting-entries")
                for name in sorted(both)
            ]
    return faults


def competing_axes(definition: Definition) -> list[Fault]:
    """Faults of a parameter or element that alternatives on two axes set: the order would decide which wins."""
    faults: list[Fault] = []
    homes: dict[str, str] = {}
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            for name in (*overlay.parameters, *overlay.on, *overlay.off, *overlay.entries):
                if homes.setdefault(name, axis) != axis:
                    text = phrase(
                        "{} is set on axis {} too; different axes must change different things",
                        ModelName(name),
                        ModelName(homes[name]),
                    )
                    key = "on" if name in overlay.on else "off" if name in overlay.off else name
                    faults.append(
                        Fault(text, ("configurations", axis, label, key), on_key=True, about=name, kind="repeated-name")
                    )
    return faults


def hidden_names(definition: Definition) -> list[Fault]:
    """Warnings about names where ``output=`` or ``input=`` could mean two things: sensors and inputs win over nodes."""
    nodes = set(all_nodes(definition.elements.values()))
    faults = []
    for table in ("inputs", "sensors"):
        for name, channel in getattr(definition, table).items():
            same = table == "inputs" and (channel.quantity, *channel.nodes) == ("torque", name)
            if name in nodes and not same:
                what = "a measured input" if table == "sensors" else channel_words(channel)
                said = '"{}" is also a node; as input= it means {}, as output= {}, not the node'
                text = phrase(said, ModelName(name), what, channel_words(channel))
                faults.append(Fault(text, (table, name), "warning", on_key=True, kind="ambiguous-name"))
    for name in definition.sensors:
        if name in definition.inputs:
            said = '"{}" is a sensor and an input; as input= it means the excitation, as output= the sensor'
            text = phrase(said, ModelName(name))
            faults.append(Fault(text, ("sensors", name), "warning", on_key=True, kind="ambiguous-name"))
    return faults


def dead_ends(definition: Definition) -> list[Fault]:
    """Warnings about nodes at which a single connection ends: nothing acts there, which often is a misspelt name."""
    touching: dict[str, list[str]] = {}
    for element in definition.elements.values():
        for node in element.ports.values():
            touching.setdefault(node, []).append(element.name)
    channels: tuple[Input | Sensor, ...] = (*definition.inputs.values(), *definition.sensors.values())
    used = {name for channel in channels for name in (channel.of, *channel.nodes)}
    used |= {
        node for source in definition.excitations.values() for node in (*source.nodes, source.reaction_node or GROUND)
    }
    loading = (*definition.load.by_place, *definition.load.driven_by) if definition.load else ()
    used |= {node for place in loading for node in torque_place(place).nodes}
    used |= {node for scenario in definition.scenarios.values() for node in scenario.places}
    used |= {
        node for element in definition.elements.values() if element.may_end_anywhere for node in element.ports.values()
    }
    used |= {GROUND, *definition.ports}
    point = definition.operating_point
    used |= {*point.speed, *(node for place in point.torque for node in torque_place(place).nodes)}
    faults: list[Fault] = []
    for node, names in touching.items():
        if len(names) == 1 and node not in used and len(definition.elements[names[0]].ports) > 1:
            others = (other for other in touching if other != node)
            meant = nearest(node, others) if len(faults) < MOST_HINTS else ""
            said = 'only {} is attached to node "{}"{}; it carries no torque there'
            text = phrase(said, ModelName(names[0]), ModelName(node), question(meant))
            place = ("elements", names[0])
            faults.append(Fault(text, place, "warning", on_key=True, about=node, meant=meant, kind="dead-end"))
    return faults


def pair_faults(pair: Pair, definition: Definition) -> Iterator[Fault]:
    """Yield the faults of a pair of output and input that a model does not have; ``about`` is the name."""
    nodes = {node for element in definition.elements.values() for node in element.ports.values()}
    known = {
        "sensor or node": (pair.output, [*definition.sensors, *nodes]),
        "input, sensor or node": (pair.input, [*definition.inputs, *definition.sensors, *nodes]),
        "input or node": (pair.excitation, [*definition.inputs, *nodes]),
    }
    for what, (name, names) in known.items():
        if not name or name in names:
            continue
        is_written_out = what != "input or node" and parse_sensor(name) is not None
        is_written_out |= what != "sensor or node" and set(parse_pair(name) or "?") <= nodes
        if not is_written_out:
            yield unknown_name(what, name, names, rest=declared(definition, what))


def declared(definition: Definition, what: str) -> str:
    """End of a message on an unknown name: which channels the model declares, ``what`` says of which kind."""
    tables = {table: getattr(definition, f"{table}s") for table in ("input", "sensor") if table in what}
    return "; ".join(f"{table}s: {comma_list(names, none='none')}" for table, names in tables.items())


def unfit_sections(definition: Definition) -> list[Fault]:
    """Faults of sections that name what the model does not have, or that lack data of it."""
    machinery = bool(definition.speeds or definition.load or definition.excitations)
    there = {key: machinery if key == EXCITATIONS else bool(getattr(definition, key)) for key in CHECKED_SECTIONS}
    return [fault for key in CHECKED_SECTIONS if there[key] for fault in imported(OWNERS[key].faults)(definition)]


CHECKED_SECTIONS = (EXCITATIONS, "limits", SCENARIOS, "bench", "report")
"""Keys of the sections that their owners check, in this order."""


def unfit_catalogues(definition: Definition) -> list[Fault]:
    """Notes on the catalogue columns of each element that neither it nor a limit takes."""
    faults: list[Fault] = []
    for name, element in definition.elements.items():
        if element.catalogue is None:
            continue
        known = {entry for entry, _ in element.specs()}
        columns = dict.fromkeys(cell.column.partition(".")[0] for cell in element.catalogue.cells)
        others = [column for column in columns if column not in known and column.casefold() not in REMARKS]
        limited = {entry for rule in section_class("limits").values() for entry, _ in rule.specs()} if others else set()
        for column in others:
            if column not in limited:
                said = 'the column "{}" of {} fits no entry of a {} and no limit'
                text = phrase(said, column, element.catalogue.file, element.kind)
                place = ("elements", name, "catalogue")
                faults.append(replace(unfit_word(text, column, [*known, *limited], place), severity="note"))
    return faults


REMARKS = frozenset({SIZE, "description", "remark", "remarks", "note", "maker", "source"})
"""Names of catalogue columns that are comments and fit no entry."""


def unfit_overrides(definition: Definition) -> list[Fault]:
    """Faults of alternatives that change entries which do not exist, or to values that do not fit."""
    import torsionnet.model.checks.overrides as overrides  # few models have such alternatives

    return overrides.unfit_overrides(definition)


CHECKS: dict[Callable[[Definition], list[Fault]], str] = {
    undefined_or_unused_parameters: "",
    unknown_nodes: "",
    unknown_elements: "sensors",
    unknown_followed: "following",
    unknown_in_configurations: "configurations",
    competing_axes: "configurations",
    hidden_names: "",
    dead_ends: "",
    unfit_overrides: "has_overrides",
    unfit_sections: "",
    unfit_catalogues: "elements",
}
"""Functions that check the names in a model, in the order in which they run, with the section without which there is
nothing to check; empty: always."""
