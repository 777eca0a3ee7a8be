"""Drivetrain with the rings of its viscous dampers free, locked to the hub, or counted by half.

Where natural frequencies are quoted without damping, the ring of an
untuned damper is left out (free), joined to the hub (locked), or half of its inertia is put on the hub, which is where
the film of best damping brings the resonance near.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from torsionnet.base.errors import UsageError, suggestion_or
from torsionnet.model.configurations import known_elements
from torsionnet.model.definition import Definition
from torsionnet.model.elements import Element, Values
from torsionnet.model.elements.rigid import Inertia, RigidCoupling
from torsionnet.model.elements.viscous_damper import ViscousDamper

AS_MODELLED = "as_modelled"
RING_SHARES = {"free": 0.0, "locked": 1.0, "half": 0.5}
"""Share of the ring's inertia that turns with the hub of a viscous damper, by state of the ring."""
STATES = (AS_MODELLED, *RING_SHARES)


def with_dampers(
    definition: Definition, values: Mapping[str, Any], state: str, names: Iterable[str] | None = None
) -> Definition:
    """Definition of a model with the rings of its viscous dampers in a given state.

    Parameters
    ----------
    state : str
        ``"as_modelled"``, ``"free"``, ``"locked"`` or ``"half"``.
    names : iterable of str, optional
        Elements of type viscous_damper, or the spring or damper that is the film between a hub and a ring; by default
        all elements of type viscous_damper.

    Raises
    ------
    UsageError
        No such state or element, no damper at all, or an element that is no film of a ring.
    """
    if state not in STATES:
        known = f"choose {', '.join(STATES)}"
        raise UsageError(f'"{state}" is no state of a damper{suggestion_or(state, STATES, known)}')
    if state == AS_MODELLED:
        return definition
    active = {element.name: element for element in definition.active}
    chosen = [name for name, one in active.items() if isinstance(one, ViscousDamper)]
    if names is not None:
        chosen = known_elements(names, active)
    if not chosen:
        raise UsageError("the model has no element of type viscous_damper; name the spring or damper that is the film")
    elements = dict(definition.elements)
    for name in chosen:
        found = active[name]
        if isinstance(found, ViscousDamper):
            elements[name] = _of_damper(found, Values(values), RING_SHARES[state])
        else:
            elements |= _of_film(found, active, Values(values), RING_SHARES[state])
    return replace(definition, elements=elements)


def _of_damper(damper: ViscousDamper, value: Values, share: float) -> Element:
    """Element with the inertia of a damper's hub and of a share of its ring."""
    inertia = float(value(damper.hub_inertia)) + share * float(value(damper.ring_inertia))
    return Inertia.from_entries(damper.name, node=damper.node, inertia=inertia, enabled=inertia > 0)


def _of_film(film: Element, active: Mapping[str, Element], value: Values, share: float) -> dict[str, Element]:
    """Elements in place of a damper's film and ring, by name.

    A rigid coupling or nothing, and the share of the ring.
    """
    hub, ring = _hub_and_ring(film, active)
    found: dict[str, Element] = {}
    for element in active.values():
        if isinstance(element, Inertia) and element.node == ring:
            inertia = share * float(value(element.inertia))
            found[element.name] = Inertia.from_entries(element.name, node=ring, inertia=inertia, enabled=share > 0)
        elif set(element.ports.values()) == {hub, ring}:
            found[element.name] = replace(element, enabled=False)
    if share:
        found[film.name] = RigidCoupling(film.name, nodes=(hub, ring))
    return found


def _hub_and_ring(film: Element, active: Mapping[str, Element]) -> tuple[str, str]:
    ends = tuple(film.ports.values())
    rings = [node for node in ends if len(ends) == 2 and _is_ring(node, set(ends), active)]
    if len(rings) != 1:
        raise UsageError(
            f'"{film.name}" is no film of a damper: a film lies between a hub and a ring on which nothing else acts'
        )
    (ring,) = rings
    return next(node for node in ends if node != ring), ring


def _is_ring(node: str, ends: set[str], active: Mapping[str, Element]) -> bool:
    """Whether a node carries only inertias and the film of a viscous damper."""
    there = [element for element in active.values() if node in element.ports.values()]
    only = all(isinstance(one, Inertia) or set(one.ports.values()) == ends for one in there)
    return only and any(isinstance(one, Inertia) for one in there)
