"""Poles of transfer functions against a measured input, mostly of the drivetrain cut at a transducer.

The reading of a torque transducer contains all that happens upstream. The poles of theta/T are therefore the poles of
the drivetrain cut at the transducer, without everything on the side of the excitation, if the cut separates the two
sides. Where it does not, or other quantities are measured, the poles are the rates s at which the measured inputs can
stay zero under suitable excitations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import SolveError, UsageError
from torsionnet.core.groups import Groups
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import GROUND, Element
from torsionnet.model.readings import port_of
from torsionnet.response import Modes
from torsionnet.solve.dynamic_stiffness.reduction import require_resistance
from torsionnet.solve.dynamic_stiffness.transfer_request import TransferRequest

ModesAndWarnings: TypeAlias = tuple[Modes, tuple[str, ...]]
"""Modes of a drivetrain, and texts of warnings about uncertain ones."""


def poles_against_measured(
    drivetrain: AssembledModel, request: TransferRequest, natural_modes: Callable[[AssembledModel], ModesAndWarnings]
) -> ModesAndWarnings:
    """Modes of a drivetrain cut at its measured input, and texts of warnings about uncertain modes.

    Raises
    ------
    UsageError
        The measured input is no sensor, or no excitation reaches that sensor.
    SolveError
        Some coordinates have neither inertia nor spring nor damper.
    """
    system = drivetrain.assembly.system
    require_resistance(system, np.ones(len(system.sparse_rows), dtype=bool))
    if not request.is_measured:
        raise UsageError(f'"{request.names}" is no sensor; name a sensor as measured input')
    kept = elements_beyond_cut(drivetrain, request)
    if kept is None:
        from torsionnet.solve.modes.bordered_poles import measured_poles

        return measured_poles(drivetrain, request)
    return _of_cut_system(drivetrain, kept, request.names, natural_modes)


def elements_beyond_cut(drivetrain: AssembledModel, request: TransferRequest) -> tuple[str, ...] | None:
    """Names of the elements left without the excited side when the drivetrain is cut at the measured torque.

    None if more than one torque is measured, the cut does not separate the drivetrain, or excitations act on both
    sides. The torque at a port flows between the element and its node there; elements join their other nodes, as does
    an imposed relative motion; ground does not.
    """
    sensor = request.measured[0].sensor
    if sensor is None or sensor.quantity != "torque" or len(request.measured) > 1:
        return None
    node, _ = port_of(drivetrain.elements[sensor.of], sensor.at)
    ends = {name: {*one.ports.values(), *one.internal_nodes} - {GROUND} for name, one in drivetrain.elements.items()}
    ends[sensor.of].discard(node)
    parts = Groups(drivetrain.nodes)
    tied = [set(one.nodes) for one in drivetrain.inputs.values() if one.quantity == "angle"]
    for joined in (*ends.values(), *(nodes for nodes in tied if nodes.issubset(drivetrain.nodes))):
        if joined:
            parts.join(*joined)
    sides = [set(parts.of(node)), {other for end in ends[sensor.of] for other in parts.of(end)}]
    is_driven = [any(not side.isdisjoint(one.nodes) for one in request.excitations) for side in sides]
    if sum(is_driven) != 1:
        return None
    at_node, with_element = sides
    if is_driven[1]:
        return tuple(name for name, joined in ends.items() if not joined.isdisjoint(at_node))
    return tuple(name for name, joined in ends.items() if name == sensor.of or not joined.isdisjoint(with_element))


def cut_definition(definition: Definition, kept: Sequence[str]) -> Definition:
    """Definition with only the elements ``kept``, and the inputs and sensors whose nodes and elements are left."""
    elements: dict[str, Element] = {name: definition.elements[name] for name in kept}
    nodes = set(all_nodes(elements.values()))
    inputs = {
        name: channel
        for name, channel in definition.inputs.items()
        if channel.quantity == "angle" and nodes.issuperset(channel.nodes)
    }
    sensors = {
        name: sensor
        for name, sensor in definition.sensors.items()
        if (sensor.of in elements if sensor.is_on_element else nodes.issuperset(sensor.nodes))
    }
    return replace(definition, elements=elements, inputs=inputs, sensors=sensors)


def _of_cut_system(
    drivetrain: AssembledModel,
    kept: Sequence[str],
    measured: str,
    natural_modes: Callable[[AssembledModel], ModesAndWarnings],
) -> ModesAndWarnings:
    rest = drivetrain.with_definition(cut_definition(drivetrain.definition, kept))
    try:
        found, warned = natural_modes(rest)
    except SolveError as error:  # the whole drivetrain resists every motion, so the cut leaves a loose end
        raise UsageError(
            f"{measured} is zero at every frequency: nothing on the other side of the transducer resists a motion"
        ) from error
    shapes = np.full((len(drivetrain.nodes), len(found)), np.nan + 0j)
    place = {node: number for number, node in enumerate(drivetrain.nodes)}
    shapes[[place[node] for node in found.nodes]] = found.shapes
    removed = [name for name in drivetrain.elements if name not in rest.elements]
    notes = (f"poles of the drivetrain cut at {measured}, without {', '.join(removed)}",)
    found = replace(
        found, nodes=drivetrain.nodes, shapes=shapes, title=f"{drivetrain.title}, cut at {measured}", notes=notes
    )
    return found, warned
