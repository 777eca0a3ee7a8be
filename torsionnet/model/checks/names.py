"""Checks that every name in a model exists, and that everything named is used.

Here as well: checks of entries that alternatives of a configuration change: they must exist, and their values must fit.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import EntryPath, Fault, ModelError, comma_list, nearest, question, unknown_name
from torsionnet.base.expressions import Expression
from torsionnet.base.packages import imported
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.channels import Input, Sensor, channel_words, parse_pair, parse_sensor, port_fault
from torsionnet.model.configurations import Overlay
from torsionnet.model.definition import (
    ELEMENTS,
    EXCITATIONS,
    SCENARIOS,
    SINGLE_SECTIONS,
    SPEEDS,
    Definition,
    all_nodes,
    by_section,
    section_of,
)
from torsionnet.model.element_base.round_section import section_fault
from torsionnet.model.elements import GROUND, Element
from torsionnet.model.operating_point import OperatingPoint, torque_place
from torsionnet.model.response_pair import Pair
from torsionnet.model.sections import OWNERS

if TYPE_CHECKING:
    from torsionnet.motion.scenarios.scenario import Scenario

_TABLES = ((ELEMENTS,), (EXCITATIONS,), (SCENARIOS,))


def unfit_overrides(definition: Definition) -> list[Fault]:
    """Faults of alternatives whose ``box.engaged``, ``engine.misfire`` or ``load.power`` does not exist or fit."""
    return [fault for path, overlay in _alternatives(definition) for fault in _unfit(definition, overlay, path)]


def at_override(fault: Fault, definition: Definition, choice: Mapping[str, str]) -> Fault:
    """Fault of an entry whose path is moved to the alternative that gives the entry its value.

    Where none does, to one that changes the section which the fault is about besides.
    """
    section = (
        fault.path
        if fault.path[:1] and fault.path[0] in SINGLE_SECTIONS
        else fault.path[1:]
        if fault.path[:1] in _TABLES
        else ()
    )
    if len(section) < 2:
        return fault
    key = f"{section[0]}.{section[1]}"
    besides = None
    for axis, label in choice.items():
        for name in definition.configurations[axis][label].entries:
            if name == key:
                return replace(fault, path=("configurations", axis, label, key, *section[2:]))
            if fault.about and name.startswith(f"{fault.about}."):
                besides = replace(fault, path=("configurations", axis, label, name))
    return besides or fault


def _alternatives(definition: Definition) -> Iterator[tuple[EntryPath, Overlay]]:
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            if overlay.entries:
                yield ("configurations", axis, label), overlay


def _changed(one: Element | Scenario, changes: Mapping[str, Any]) -> Element | Scenario | None:
    """Copy of an element or a scenario with the entries that an alternative changes; None where they do not fit it."""
    try:
        return replace(one, **changes) if changes.keys() <= dict(one.specs()).keys() else None
    except ModelError:
        return None


def _unfit(definition: Definition, overlay: Overlay, path: EntryPath) -> Iterator[Fault]:
    unknown = {key: fault for key in overlay.entries if (fault := _meaningless(definition, key, (*path, key)))}
    yield from unknown.values()
    for (table, name), changes in by_section(definition, overlay.entries).items():
        keys = {entry: (*path, f"{name}.{entry}") for entry in changes}
        if not any(f"{name}.{entry}" in unknown for entry in changes):
            for fault in _wrong_values(definition, table, name, changes):
                about = next((one for one in fault.path if one in keys), next(iter(keys)))
                yield replace(fault, path=keys[str(about)])


def _meaningless(definition: Definition, key: str, path: EntryPath) -> Fault | None:
    """Fault that an entry which an alternative changes does not exist, or None."""
    name, _, entry = key.rpartition(".")
    found = section_of(definition, key)
    if found is None:
        return _no_section(definition, name, path)
    known = dict(found[2].specs())
    return None if entry in known else unknown_name(f"entry of {name}", entry, known, path, on_key=True)


def _no_section(definition: Definition, name: str, path: EntryPath) -> Fault:
    """Fault that an alternative cannot change entries of the section it names."""
    if name in {declared.name for declared in definition.declared()} - {*SINGLE_SECTIONS}:
        text = (
            f"a configuration does not change entries of {name}:; it may change parameters, and entries of elements, "
        )
        text += "excitations, scenarios, load: and speeds: (box.engaged, engine.misfire, fault.phases, load.power, "
        return Fault(text + "speeds.range)", path, on_key=True, kind="fixed-entry")
    owner, _, entry = name.partition(".")
    outer = section_of(definition, name) if entry else None
    if outer is not None:
        known_entries = dict(outer[2].specs())
        if entry not in known_entries:
            return unknown_name(f"entry of {owner}", entry, known_entries, path, on_key=True)
        whole = f"write {owner}.{entry}: {{...}} with all its entries"
        return Fault(
            f"a configuration changes {entry} of {owner} as a whole; {whole}", path, on_key=True, kind="fixed-entry"
        )
    if name in definition.limits:
        return Fault(
            f"{name} is a limit; limits are the same in all configurations", path, on_key=True, kind="fixed-entry"
        )
    sections = [key for key in SINGLE_SECTIONS if getattr(definition, key)]
    known = [*definition.excitations, *definition.elements, *definition.scenarios, *sections]
    return unknown_name("element, excitation or scenario", name, known, path, on_key=True)


def _wrong_values(definition: Definition, table: str, name: str, changes: Mapping[str, Any]) -> tuple[Fault, ...]:
    """Faults of a section whose entries an alternative changes to wrong values."""
    try:
        changed = definition.with_overlay(
            Overlay(entries={f"{name}.{entry}": value for entry, value in changes.items()})
        )
    except ModelError as error:
        return error.faults
    if table == ELEMENTS:
        return tuple(_moved(definition.elements[name], changed.elements[name], changes))
    if table == SPEEDS:
        # An engine may have no gas at other speeds; what was wrong before the change is told where it stands.
        before, after = map(imported(OWNERS[EXCITATIONS].faults), (definition, changed))
        return tuple(one for one in after if one.severity == "error" and one not in before)
    if table in SINGLE_SECTIONS:
        return ()
    # What was wrong before the change is told where it stands.
    faults_of_one = imported(OWNERS[table].faults_of_one)
    return () if any(faults_of_one(definition, name)) else tuple(faults_of_one(changed, name))


def _moved(before: Element, after: Element, changes: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of elements that an alternative switches by an entry or moves to other nodes, which it may not."""
    if before.enabled != after.enabled:
        text = phrase("write on: [{0}] or off: [{0}] to switch an element", ModelName(before.name))
        yield Fault(text, ("enabled",), on_key=True, kind="fixed-entry")
    if before.ports != after.ports:
        text = phrase(
            "a configuration does not move {} to other nodes; write two elements, and switch them with on: and off:",
            ModelName(before.name),
        )
        yield Fault(text, (next(iter(changes)),), on_key=True, kind="fixed-entry")


MOST_HINTS = 20
"""Largest number of dead ends for which a misspelt node is looked for, as a model with more has them on purpose."""


def _nodes(definition: Definition) -> dict[str, None]:
    return dict.fromkeys(all_nodes(definition.elements.values()))


def _unknown_node(name: str, nodes: Collection[str], path: EntryPath, *, on_key: bool = False) -> Fault:
    if name == GROUND:
        return Fault("ground does not move; name a node", path, on_key=on_key, kind="grounded-node")
    return unknown_name("node", name, nodes, path, on_key=on_key)


def _expressions(definition: Definition) -> Iterator[tuple[EntryPath, Expression]]:
    """Path and expression of everything that the model, its alternatives and its scenarios calculate."""
    for name, parameter in definition.parameters.items():
        yield ("parameters", name), parameter.value
    for name, element in definition.elements.items():
        for path, _, expression, _ in element.expressions():
            yield ("elements", name, *path), expression
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            for name, value in overlay.parameters.items():
                yield ("configurations", axis, label, name), value
            yield from _point_expressions(overlay.operating_point, ("configurations", axis, label, "operating_point"))
    yield from _point_expressions(definition.operating_point, ("operating_point",))
    for place, overlay in _alternatives(definition):
        for (table, name), changes in by_section(definition, overlay.entries).items():
            changed = _changed(getattr(definition, table)[name], changes) if table in (ELEMENTS, SCENARIOS) else None
            for inner, _, expression, _ in changed.expressions() if changed else ():
                # Elements whose torques a scenario scales stand among its entries.
                scaled = table == SCENARIOS and inner[0] not in dict(changed.specs()) if changed else False
                entry, *rest = ("elements", *inner) if scaled else inner
                if entry in changes:
                    yield (*place, f"{name}.{entry}", *rest), expression
    for name, scenario in definition.scenarios.items():
        for path, _, expression, _ in scenario.expressions():
            yield ("scenarios", name, *path), expression


def _point_expressions(point: OperatingPoint | None, path: EntryPath) -> Iterator[tuple[EntryPath, Expression]]:
    if point is not None:
        for table in ("speed", "torque"):
            for node, value in getattr(point, table).items():
                yield (*path, table, node), value


def undefined_parameters(definition: Definition) -> list[Fault]:
    """Faults of expressions that use a parameter nobody defines."""
    known = definition.parameters
    return [
        unknown_name("parameter", name, known, path)
        for path, expression in _expressions(definition)
        for name in sorted(expression.names - known.keys())
    ]


def unused_parameters(definition: Definition) -> list[Fault]:
    """Warnings about parameters that nothing uses; the model is complete without them."""
    used = {name for _, expression in _expressions(definition) for name in expression.names}
    faults = []
    for name in definition.parameters:
        if name not in used:
            text = phrase('parameter "{}" is not used', ModelName(name))
            faults.append(Fault(text, ("parameters", name), "warning", on_key=True, kind="unused-name", about=name))
    return faults


def unknown_nodes(definition: Definition) -> list[Fault]:
    """Faults of sensors, inputs and operating points on nodes that no element has."""
    nodes = _nodes(definition)
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
    points: list[tuple[EntryPath, OperatingPoint | None]] = [(("operating_point",), definition.operating_point)]
    for axis, alternatives in definition.configurations.items():
        points += [
            (("configurations", axis, label, "operating_point"), overlay.operating_point)
            for label, overlay in alternatives.items()
        ]
    for path, point in points:
        named = [("speed", node, node) for node in (point.speed if point else ())]
        named += [
            ("torque", text, node) for text in (point.torque if point else ()) for node in torque_place(text).nodes
        ]
        faults += [
            _unknown_node(node, nodes, (*path, table, key), on_key=True)
            for table, key, node in named
            if node not in nodes
        ]
    return faults


def unknown_references(definition: Definition) -> list[Fault]:
    """Faults of elements and sensors whose values are referred to a shaft that does not exist."""
    nodes = _nodes(definition)
    faults = [
        _unknown_node(sensor.referred_to, nodes, ("sensors", name, "referred_to"))
        for name, sensor in definition.sensors.items()
        if sensor.referred_to is not None and sensor.referred_to not in nodes
    ]
    return faults + [
        _unknown_node(element.referred_to, nodes, ("elements", name, "referred_to"))
        for name, element in definition.elements.items()
        if element.referred_to is not None and element.referred_to not in nodes
    ]


def unknown_followed(definition: Definition) -> list[Fault]:
    """Faults of parameters that follow a node or element that does not exist."""
    nodes = _nodes(definition)
    faults = []
    for name, parameter in definition.following.items():
        what, known = ("node", nodes) if parameter.by in ("speed", "load") else ("element", definition.elements)
        if parameter.of not in known:
            faults.append(unknown_name(what, parameter.of, known, ("parameters", name, "of")))
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
        reason = section_fault(element) if sensor.quantity == "stress" else None
        if reason:
            faults.append(Fault(reason, path, kind="unfit-channel"))
    return faults


def _no_element(name: str, definition: Definition, path: EntryPath) -> Fault:
    if name in _nodes(definition):
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
    nodes = set(_nodes(definition))
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
    used |= {node for one in definition.excitations.values() for node in (*one.nodes, one.reaction_node or GROUND)}
    loading = (*definition.load.by_place, *definition.load.driven_by) if definition.load else ()
    used |= {node for place in loading for node in torque_place(place).nodes}
    used |= {node for one in definition.scenarios.values() for node in one.places}
    used |= {node for one in definition.elements.values() if one.may_end_anywhere for node in one.ports.values()}
    used |= {GROUND, *definition.ports, *definition.operating_point.speed, *definition.operating_point.loaded_nodes}
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
        is_written_out = what != "input or node" and parse_sensor(name) is not None
        is_written_out |= what != "sensor or node" and set(parse_pair(name) or "?") <= nodes
        if name and name not in names and not is_written_out:
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
    """Notes on columns of catalogues that neither elements nor limits take."""
    if all(element.catalogue is None for element in definition.elements.values()):
        return []
    import torsionnet.model.checks.catalogues as catalogues

    return catalogues.unfit_columns(definition)


CHECKS = (
    undefined_parameters,
    unknown_nodes,
    unknown_references,
    unknown_elements,
    unknown_followed,
    unknown_in_configurations,
    competing_axes,
    unused_parameters,
    hidden_names,
    dead_ends,
    unfit_overrides,
    unfit_sections,
    unfit_catalogues,
)
"""Functions that check the names in a model, in the order in which they run."""
