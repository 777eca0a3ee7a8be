"""Free end of an engine, where a torsiograph is driven."""

from __future__ import annotations

from torsionnet.model.definition import Definition
from torsionnet.model.elements import GROUND
from torsionnet.model.excitations.engine_entries import EngineEntries


def free_end(model: Definition) -> str:
    """Node at the free end of the first engine that runs; empty for a model without an engine.

    It is the end of the line beyond the cylinders that leads to no load: the last node from which nothing goes on but a
    damper. Where both sides lead on, it is the first cylinder of the engine.

    Examples
    --------
    >>> import torsionnet as tn
    >>> free_end(tn.load("two_stroke_ship").definition), free_end(tn.load("marine_medium_speed").definition)
    ('cyl1', 'free_end')
    """
    engine = next((one for one in model.excitations.values() if isinstance(one, EngineEntries) and one.enabled), None)
    if engine is None:
        return ""
    cylinders = list(engine.cylinders.values())
    beside = _neighbours(model)
    for cylinder in (cylinders[0], cylinders[-1]):
        reached = _beyond(cylinder, set(cylinders), beside)
        if len(reached) <= 1:  # nothing but one end piece
            return reached[0] if reached else cylinder
    return cylinders[0]


def _neighbours(model: Definition) -> dict[str, set[str]]:
    """Nodes that an element that is switched on ties to each node, the ground left out."""
    found: dict[str, set[str]] = {}
    for element in model.active:
        nodes = [node for node in element.ports.values() if node != GROUND]
        for node in nodes:
            found.setdefault(node, set()).update(other for other in nodes if other != node)
    return found


def _beyond(cylinder: str, cylinders: set[str], beside: dict[str, set[str]]) -> list[str]:
    """Nodes that are reached from a cylinder without passing another one, the nearest first."""
    reached: list[str] = []
    open_nodes = [node for node in beside.get(cylinder, set()) if node not in cylinders]
    while open_nodes:
        node = open_nodes.pop(0)
        if node not in reached:
            reached.append(node)
            open_nodes += [other for other in beside[node] if other not in cylinders and other != cylinder]
    return reached
