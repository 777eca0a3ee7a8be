"""Mean torques from outside on the nodes of a drivetrain: of its load over speed, or of its operating point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from torsionnet.core.errors import UsageError, meant_or
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.load.load_section import Load
from torsionnet.model.speeds import mean_speeds, speeds_with

ENGINE = "reciprocating_engine"
"""The type of excitation that drives where nothing else is said."""

NEEDS_RATED = "the load needs the rated speed: speeds: {of: node, rated: 750 rpm, ...}"


def reference_node(definition: Definition) -> str:
    """The node whose speed is meant where a load follows the speed: that of ``speeds:``, else the first absorber."""
    if definition.speeds is not None:
        return str(definition.speeds.of)
    return next(iter(definition.load.by_node)) if definition.load else ""


def operating_speed(definition: Definition, values: Mapping[str, Any]) -> float:
    """Speed of the reference node in rad/s about which the model is linear: the operating point's, else the rated one.

    Raises
    ------
    UsageError
        Nothing says it.
    """
    reference = reference_node(definition)
    speed = mean_speeds(definition, values).get(reference) if definition.operating_point.speed else None
    rated = definition.speeds.rated if definition.speeds else None
    found = speed or rated or _rated_of_absorber(definition, values, reference)
    if not found:
        raise UsageError(NEEDS_RATED)
    return float(found)


def _rated_of_absorber(definition: Definition, values: Mapping[str, Any], reference: str) -> float | None:
    """The reference node's speed at which the first absorber with a rated speed of its own has that."""
    ratios = speed_ratios(definition, values, reference)
    for node, absorber in definition.load.by_node.items() if definition.load else ():
        if absorber.rated and ratios.get(node):
            return float(absorber.rated / abs(ratios[node]))
    return None


def load_torques(definition: Definition, values: Mapping[str, Any], speed: float) -> dict[str, float]:
    """Mean torques of the load in N m by node, at a speed > 0 of the reference node in rad/s.

    A driver's torque has the sign of the rotation of its node, an absorber's the opposite one. Power is shared, so that
    drivers of unlike speeds have unlike torques.

    Raises
    ------
    UsageError
        A node does not turn with the reference, nobody drives, or the speed is outside a table.
    """
    load = definition.load
    assert load is not None
    reference = reference_node(definition)
    ratios = speed_ratios(definition, values, reference)
    rated = definition.speeds.rated if definition.speeds else None
    torques: dict[str, float] = {}
    power = 0.0
    for node, absorber in load.by_node.items():
        ratio = _ratio(definition, ratios, node, reference)
        if absorber.needs_rated and not rated:
            raise UsageError(f"{NEEDS_RATED}, or rated of its own")
        torque = absorber.torque_at(abs(ratio) * speed, abs(ratio) * rated if rated else None)
        torques[node] = torques.get(node, 0.0) - math.copysign(torque, ratio)
        power += torque * abs(ratio) * speed
    for node, share in drivers(definition, load).items():
        torques[node] = torques.get(node, 0.0) + share * power / (_ratio(definition, ratios, node, reference) * speed)
    return torques


def speed_ratios(definition: Definition, values: Mapping[str, Any], reference: str) -> dict[str, float]:
    """Speed of every node over that of the reference, where it follows."""
    speeds = speeds_with(definition, values, reference)
    own = speeds.get(reference)
    return {node: speed / own for node, speed in speeds.items()} if own else {}


def _ratio(definition: Definition, ratios: Mapping[str, float], node: str, reference: str) -> float:
    if node not in all_nodes(definition.active):
        raise UsageError(f'nothing is attached to "{node}" in this configuration')
    if not ratios.get(node):
        why = "does not turn" if node in ratios else "has no fixed ratio to it"
        raise UsageError(f"{node} {why} when {reference} turns; it can neither drive nor absorb")
    return ratios[node]


def drivers(definition: Definition, load: Load) -> dict[str, float]:
    """Share of the power by node; that of an engine is spread evenly over its cylinders.

    Raises
    ------
    UsageError
        Nobody is named, and the model has not exactly one engine.
    """
    shares = dict(load.driven_by)
    if not shares:
        engines = [name for name, one in definition.excitations.items() if one.kind == ENGINE]
        if len(engines) != 1:
            raise UsageError("say who drives: driven_by: {node: 1}, or the name of an excitation")
        shares = {engines[0]: 1.0}
    found: dict[str, float] = {}
    for name, share in shares.items():
        nodes = (
            [node for _, node in definition.excitations[name].node_entries]
            if name in definition.excitations
            else [name]
        )
        for node in nodes:
            found[node] = found.get(node, 0.0) + share / len(nodes)
    return found


def unknown_driver(definition: Definition, name: str) -> str | None:
    """Why ``name`` cannot drive, or None."""
    nodes = all_nodes(definition.elements.values())
    if name in definition.excitations or name in nodes:
        return None
    known = [*definition.excitations, *nodes]
    return f'no node or excitation is named "{name}"{meant_or(name, known, "driven_by has nodes or excitations")}'


def mean_torques(definition: Definition, values: Mapping[str, Any]) -> dict[str, float]:
    """Mean external torque in N m by node at the operating point: of the load, else as the operating point gives it."""
    if definition.load is not None:
        return load_torques(definition, values, operating_speed(definition, values))
    return stated_torques(definition, values)


def stated_torques(definition: Definition, values: Mapping[str, Any]) -> dict[str, float]:
    """Mean external torque in N m on the nodes for which the operating point gives one."""
    return {node: float(value.evaluate(values)) for node, value in definition.operating_point.torque.items()}
