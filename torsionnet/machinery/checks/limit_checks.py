"""Checks that limits name existing elements and nodes, and that these have the data the rules need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.base.errors import Fault, ModelError, unknown_name
from torsionnet.machinery.excitations.propeller_torque import PropellerTorque
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.limits.evidence import LimitSubject
from torsionnet.machinery.limits.iacs_m68 import IacsM68
from torsionnet.machinery.limits.limit import Limit, unit_slips
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.parameters import resolve

GENERATORS = frozenset({"synchronous_machine", "grid_generator"})
"""Types of elements that are generators."""
GENERATOR_LIMITS = frozenset({"machine_angle", "generating_set_shaft"})
"""Rules of limits that only generators have."""


def unfit_limits(definition: Definition) -> list[Fault]:
    """Faults of limits on elements or nodes that do not exist, or that lack data for the rule."""
    values, wrong = resolve(definition.parameters)
    subject = limit_subject(definition, values)
    known = {"element": subject.elements, "node": subject.nodes}
    faults: list[Fault] = []
    for name, limit in definition.limits.items():
        own_faults = [
            unknown_name(kind, what, known[kind], path) for path, kind, what in limit.named if what not in known[kind]
        ]
        if not own_faults and not wrong:
            own_faults = [*_unfit(limit, subject), *unit_slips(limit)]
        faults += [fault.under("limits", name) for fault in own_faults]
    return faults


def _unfit(limit: Limit, subject: LimitSubject) -> Iterator[Fault]:
    """Faults of one limit after its missing entries were taken from the catalogue of its element."""
    try:
        yield from limit.fitted(subject.elements).unfit(subject)
    except ModelError as error:
        yield Fault(
            f"what the catalogue says of {limit.of} does not fit this limit", on_key=True, kind="unreadable-file"
        )
        yield from error.faults


def limit_subject(definition: Definition, values: Mapping[str, Any]) -> LimitSubject:
    """View of a model in its base configuration, as the checks of limits need it."""
    engines = [source for source in definition.excitations.values() if isinstance(source, ReciprocatingEngine)]
    speeds = definition.speeds
    return LimitSubject(
        elements=definition.elements,
        active={element.name: element for element in definition.active},
        nodes=all_nodes(definition.elements.values()),
        active_nodes=all_nodes(definition.active),
        sensors=definition.sensors,
        speeds=() if speeds is None else speeds.values,
        rated=None if speeds is None else speeds.rated,
        misfiring=any(engine.has_lost_cylinder and not engine.is_unloaded_evenly for engine in engines),
        values=values,
        is_generating_set=is_generating_set(definition),
        cranks=frozenset(node for engine in engines for node in engine.numbers.values()),
        propels=propels(definition),
        fixed_pitch=_has_fixed_pitch(definition),
    )


def _has_fixed_pitch(definition: Definition) -> bool:
    """Whether a model has propellers as excitations, and all of them are of fixed pitch."""
    pitches = {source.pitch for source in definition.excitations.values() if isinstance(source, PropellerTorque)}
    return pitches == {"fixed"}


def propels(definition: Definition) -> bool:
    """Whether a model is one of machinery that propels a ship: it has a propeller, or propulsion shafts by UR M68."""
    kinds = {part.kind for part in (*definition.excitations.values(), *definition.elements.values())}
    return "propeller" in kinds or any(isinstance(limit, IacsM68) for limit in definition.limits.values())


def is_generating_set(definition: Definition) -> bool:
    """Whether a model is one of a piston engine that drives a generator and no propeller."""
    excited = {excitation.kind for excitation in definition.excitations.values()}
    elements = {element.kind for element in definition.elements.values()}
    generates = elements & GENERATORS or {limit.kind for limit in definition.limits.values()} & GENERATOR_LIMITS
    return "reciprocating_engine" in excited and bool(generates) and "propeller" not in excited | elements
