"""Poles of transfer functions against a measured input.

A measured input does not leave the drivetrain as it is: whatever happens upstream of a torque transducer is in its
reading. The poles of theta/T are those of the drivetrain cut at the transducer, with everything on the side of the
excitation taken away, if the cut separates the two sides. Where it does not, or other quantities are measured, the
poles are the rates at which the measured inputs stay zero while the excitations do what that takes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.functionals import port_of
from torsionnet.core.errors import SolveError, UsageError
from torsionnet.model.channels import ELEMENT_QUANTITIES, Input, Sensor
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import GROUND, Element
from torsionnet.response import Modes
from torsionnet.solve.reduction import require_resistance
from torsionnet.solve.transfer_request import as_sensor, ask

Found: TypeAlias = tuple[Modes, tuple[str, ...]]


@dataclass(frozen=True)
class Cut:
    """Elements that stay when the drivetrain is cut at a torque sensor and the side of the excitation is taken away."""

    kept: tuple[str, ...]


def poles_of_measured(
    drivetrain: AssembledModel,
    measured_input: str | Sensor | Sequence[str | Sensor],
    excitation: str | Sequence[str] | None,
    natural_modes: Callable[[AssembledModel], Found],
) -> Found:
    """Modes of the drivetrain cut at a measured input, and what is doubtful about them.

    Raises
    ------
    UsageError
        The measured input is no sensor, or no excitation reaches it.
    SolveError
        Some coordinates have neither inertia nor spring nor damper.
    """
    system = drivetrain.assembly.system
    require_resistance(system, np.ones(len(system.sparse_rows), dtype=bool))
    request = ask(drivetrain, _anything(drivetrain), measured_input, excitation)
    if not request.is_measured:
        raise UsageError(f'"{measured_input}" is no sensor; a measured input is one')
    entries = [measured_input] if isinstance(measured_input, str | Sensor) else list(measured_input)
    sensor = as_sensor(drivetrain, entries[0])
    cut = find_cut(drivetrain, sensor, request.excitations) if sensor is not None and len(entries) == 1 else None
    if cut is None:
        from torsionnet.solve.pencil import measured_poles

        return measured_poles(drivetrain, request)
    return _of_cut_system(drivetrain, cut, str(entries[0]), natural_modes)


def _anything(drivetrain: AssembledModel) -> str:
    if not drivetrain.nodes:
        raise UsageError("the drivetrain has no nodes")
    return f"angle({drivetrain.nodes[0]})"


def find_cut(drivetrain: AssembledModel, sensor: Sensor, excitations: tuple[Input, ...]) -> Cut | None:
    """The cut at a torque sensor, or None if it is no torque or does not separate the drivetrain.

    Elements and nodes are the vertices of a graph, every port an edge; the torque at a port flows over one edge. Ground
    does not connect.
    """
    if sensor.quantity != "torque":
        return None
    element = drivetrain.elements[sensor.of]
    node, _ = port_of(element, sensor.at)
    links = _links(drivetrain, without=(node, element.name))
    driven = _reach(links, [_node(excitation.of) for excitation in excitations])
    sides = {_node(node), _element(element.name)}
    if len(driven & sides) != 1:
        return None
    other = (sides - driven).pop()
    kept = _reach(links, [other])
    return Cut(tuple(name for name in drivetrain.elements if _element(name) in kept))


def _node(name: str) -> str:
    return f"node {name}"


def _element(name: str) -> str:
    return f"element {name}"


def _links(drivetrain: AssembledModel, without: tuple[str, str]) -> dict[str, set[str]]:
    links: dict[str, set[str]] = {_node(node): set() for node in drivetrain.nodes}
    for name, element in drivetrain.elements.items():
        links[_element(name)] = set()
        for node in {*element.ports.values(), *element.internal_nodes} - {GROUND}:
            if (node, name) != without:
                links[_element(name)].add(_node(node))
                links[_node(node)].add(_element(name))
    return links


def _reach(links: dict[str, set[str]], start: list[str]) -> set[str]:
    seen, waiting = set(start), list(start)
    while waiting:
        for neighbour in links[waiting.pop()] - seen:
            seen.add(neighbour)
            waiting.append(neighbour)
    return seen


def cut_definition(definition: Definition, kept: tuple[str, ...]) -> Definition:
    """The definition with only the elements kept, and the inputs and sensors that still make sense."""
    elements: dict[str, Element] = {name: definition.elements[name] for name in kept}
    nodes = all_nodes(elements.values())
    inputs = {
        name: channel
        for name, channel in definition.inputs.items()
        if channel.of in nodes and channel.quantity == "angle"
    }
    sensors = {
        name: sensor
        for name, sensor in definition.sensors.items()
        if sensor.of in (elements if sensor.quantity in ELEMENT_QUANTITIES else nodes)
    }
    return replace(definition, elements=elements, inputs=inputs, sensors=sensors)


def _of_cut_system(
    drivetrain: AssembledModel, cut: Cut, measured: str, natural_modes: Callable[[AssembledModel], Found]
) -> Found:
    rest = drivetrain.with_definition(cut_definition(drivetrain.definition, cut.kept))
    try:
        found, doubts = natural_modes(rest)
    except SolveError as error:  # the whole has been checked, so it is the cut that leaves a loose end
        raise UsageError(
            f"{measured} is zero at every frequency: nothing on the other side of it resists a motion"
        ) from error
    shapes = np.full((len(drivetrain.nodes), len(found)), np.nan + 0j)
    place = {node: number for number, node in enumerate(drivetrain.nodes)}
    shapes[[place[node] for node in found.nodes]] = found.shapes
    kept = set(cut.kept)
    removed = [name for name in drivetrain.elements if name not in kept]
    notes = (f"poles of the drivetrain cut at {measured}, without {', '.join(removed)}",)
    found = replace(
        found, nodes=drivetrain.nodes, shapes=shapes, title=f"{drivetrain.title}, cut at {measured}", notes=notes
    )
    return found, doubts
