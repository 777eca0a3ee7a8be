"""Places where the drivers and absorbers of a load act, and the nodes that take their reactions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from torsionnet.core.errors import UsageError, suggestion_or
from torsionnet.model.channels import Input, parse_pair
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.torque_places import torque_place

if TYPE_CHECKING:
    from torsionnet.model.load.load_section import Load

ENGINE = "reciprocating_engine"
"""Kind of the excitation that drives where the load names no driver."""


def drivers(definition: Definition, load: Load) -> dict[Input, float]:
    """Share of the power that each driver of a load gives, by the place where it acts.

    That of an engine is spread evenly over its cylinders.

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
    found: dict[Input, float] = {}
    for name, share in shares.items():
        places = [reacting(definition, name)]
        if name in definition.excitations:
            excitation = definition.excitations[name]
            places = [Input("torque", node, excitation.reaction_node) for _, node in excitation.node_entries]
        for place in places:
            found[place] = found.get(place, 0.0) + share / len(places)
    return found


def reacting(definition: Definition, text: str) -> Input:
    """Torque input where a driver or absorber acts, with the node that takes its reaction.

    On a node alone it is the machine whose excitation acts there, and reacts where that does.
    """
    place = torque_place(text)
    if parse_pair(text) is not None:
        return place
    found = {
        one.reaction_node
        for one in definition.excitations.values()
        if one.quantity == "torque" and place.of in one.nodes and one.reaction_node is not None
    }
    return Input("torque", place.of, *found) if len(found) == 1 else place


def on_nodes(acting: Iterable[tuple[Input, float]]) -> dict[str, float]:
    """Torque in N m by node, from torques that act on a node or between two nodes."""
    found: dict[str, float] = {}
    for place, torque in acting:
        for node, share in place.row.items():
            found[node] = found.get(node, 0.0) + share * torque
    return found


def unknown_driver(definition: Definition, name: str) -> str | None:
    """Message that a node or excitation of this name cannot drive, or None."""
    nodes = all_nodes(definition.elements.values())
    if name in definition.excitations or all(node in nodes for node in torque_place(name).nodes):
        return None
    known = [*definition.excitations, *nodes]
    return f'no node or excitation is named "{name}"{suggestion_or(name, known, "driven_by has nodes or excitations")}'
