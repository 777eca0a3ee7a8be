"""Checks that excitations, speeds and limits of a model fit its drivetrain, and have the data that they need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import EntryPath, Fault, ModelError, TorsionnetError, UsageError, message_of, unknown_name
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.machinery.excitations import OrderExcitation
from torsionnet.machinery.excitations.harmonic_torque import PropellerTorque
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine, unlocked_engines
from torsionnet.machinery.limits.evidence import LimitSubject
from torsionnet.machinery.limits.iacs_m68 import IacsM68
from torsionnet.machinery.limits.limit import Limit, unit_slips
from torsionnet.model.channels import Input, named_nodes
from torsionnet.model.checks.operation import unknown_in_load
from torsionnet.model.definition import LOAD, Definition, all_nodes, with_operating_values
from torsionnet.model.elements import Values
from torsionnet.model.elements.loads import Propeller
from torsionnet.model.kinematics import twist_fault
from torsionnet.model.load.external_torques import ExternalTorques
from torsionnet.model.operating_values import OperatingPoints
from torsionnet.model.parameters import resolve
from torsionnet.model.speeds import total_ratio

# Checks that excitations and speeds fit the drivetrain.


def unfit_excitations(definition: Definition) -> list[Fault]:
    """Faults of excitations, speeds and a load on nodes that do not exist or have no ratio to the reference shaft."""
    nodes = all_nodes(definition.elements.values())
    faults: list[Fault] = [*_unfit_elements(definition)]
    places: list[tuple[str, EntryPath]] = []
    if definition.speeds is not None:
        places.append((definition.speeds.of, ("speeds", "of")))
    for name, excitation in definition.excitations.items():
        places += _places(name, excitation)
    faults += [unknown_name("node", node, nodes, path) for node, path in dict.fromkeys(places) if node not in nodes]
    if LOAD in definition.excitations:
        text = f'"{LOAD}" is the entry on who drives and who absorbs; give the excitation another name'
        faults.append(Fault(text, ("excitations", LOAD), on_key=True, kind="invalid-name"))
    if definition.load is not None:
        faults += unknown_in_load(definition, definition.load)
    values, wrong = resolve(definition.parameters)
    if faults:
        return faults
    try:
        ratios, without = ({}, []) if wrong else _shaft_ratios(definition, values)
        mismatches = [*without, *(() if wrong else _rigid(definition, values)), *_on_imposed(definition)]
    except (TorsionnetError, ArithmeticError):  # what cannot be calculated, as without a parameter, is told elsewhere
        return []
    return mismatches or [*_remarks(definition, ratios)]


def _unfit_elements(definition: Definition) -> Iterator[Fault]:
    """Faults of excitations that impose a twist in an element that does not exist or is of the wrong kind."""
    for name in definition.excitations:
        yield from _unfit_element(definition, name)


def _unfit_element(definition: Definition, name: str) -> Iterator[Fault]:
    excitation = definition.excitations[name]
    if excitation.element_entry is None:
        return
    path, element = excitation.element_entry
    if element not in definition.elements:
        yield unknown_name("element", element, definition.elements, ("excitations", name, *path))
    else:
        yield from (fault.under("excitations", name) for fault in excitation.element_faults(definition.elements))


def excitation_faults(definition: Definition, name: str) -> Iterator[Fault]:
    """Faults of an excitation on nodes or in an element that do not exist or are of the wrong kind."""
    nodes = all_nodes(definition.elements.values())
    for node, path in _places(name, definition.excitations[name]):
        if node not in nodes:
            yield unknown_name("node", node, nodes, path)
    yield from _unfit_element(definition, name)


def _places(name: str, excitation: OrderExcitation) -> Iterator[tuple[str, EntryPath]]:
    """Pairs (node, path) of the nodes that an excitation names, and of the entries that name them."""
    reaction = (excitation.reaction_entry,) if excitation.reaction_entry else ()
    for path, node in (*excitation.node_entries, *reaction):
        yield node, ("excitations", name, *path)
    if excitation.shaft:
        yield excitation.shaft, ("excitations", name, "speed_of")


def _rigid(definition: Definition, values: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of excitations that impose a twist in an element that is rigid."""
    for name, excitation in definition.excitations.items():
        if excitation.element_entry is not None:
            path, element = excitation.element_entry
            fault = twist_fault(definition.elements[element], definition.elements[element].parts(Values(values)))
            if fault:
                yield Fault(fault, ("excitations", name, *path), kind="not-applicable")


def _shaft_ratios(definition: Definition, values: Mapping[str, Any]) -> tuple[dict[str, float], list[Fault]]:
    """Ratio of each excitation's shaft speed to the reference speed by name, and faults of excitations without one."""
    ratios: dict[str, float] = {}
    faults: list[Fault] = []
    if definition.speeds is None:
        return ratios, faults
    for name, excitation in definition.excitations.items():
        try:
            ratios[name] = abs(float(total_ratio(definition, values, excitation.shaft, definition.speeds.of)))
        except UsageError as error:
            faults.append(Fault(message_of(error), ("excitations", name, "speed_of"), kind="no-ratio"))
    return ratios, faults


def _remarks(definition: Definition, ratios: Mapping[str, float]) -> Iterator[Fault]:
    """Warnings and notes of the excitations, at the speeds of their shafts where these are known."""
    for name, excitation in definition.excitations.items():
        speeds = None
        if definition.speeds is not None and name in ratios:
            speeds = np.array(definition.speeds.values) * ratios[name]
        for fault in excitation.remarks(speeds):
            yield fault.under("excitations", name)
        yield from _in_run_up(definition, name, ratios)
    yield from _between_engines(definition)


def _in_run_up(definition: Definition, name: str, ratios: Mapping[str, float]) -> Iterator[Fault]:
    """Faults and notes of an excitation at the load of a run-up, as of an engine without gas at so small a load."""
    run_up = definition.speeds.run_up if definition.speeds is not None else None
    if run_up is None or name not in ratios:
        return
    speeds = np.array(run_up.range) * ratios[name]
    for fault in definition.excitations[name].at_load(run_up.load).remarks(speeds):
        if fault.path[:1] == ("load",):
            text = phrase("{0} in the run-up: {1}", ModelName(name), fault.message)
            yield replace(fault, message=text, path=("speeds", "run_up", "load"))


def _between_engines(definition: Definition) -> Iterator[Fault]:
    """Notes on engines of a model whose phase angle to each other is not given."""
    acting = {name: excitation for name, excitation in definition.excitations.items() if excitation.enabled}
    engines = unlocked_engines(acting, definition.excitations)
    first = next(iter(engines.values()), "")
    for name in dict.fromkeys(engines.values()):
        if name != first:
            text = phrase(
                "no phase is given between {0} and {1}: the worst angle between their crankshafts counts; if they are "
                "fixed to each other, give the crank angle by which {0} fires later, phase: 30 deg",
                ModelName(name),
                ModelName(first),
            )
            yield Fault(text, ("excitations", name), on_key=True, severity="note")


def _on_imposed(definition: Definition) -> Iterator[Fault]:
    """Faults of torques on nodes whose motion another excitation imposes."""
    acting = {name: excitation for name, excitation in definition.excitations.items() if excitation.enabled}
    motions = [(name, excitation) for name, excitation in acting.items() if excitation.quantity == "angle"]
    imposed = {frozenset(source.channel(node).nodes): name for name, source in motions for node in source.nodes}
    for name, excitation in acting.items():
        for path, node in excitation.node_entries if excitation.quantity == "torque" else ():
            channel = excitation.channel(node)
            by = imposed.get(frozenset(channel.nodes)) or _all_imposed(channel, imposed)
            if by is not None:
                said = "the motion of {} is imposed by {}; a torque there does nothing"
                text = phrase(said, named_nodes(channel), ModelName(by))
                yield Fault(text, ("excitations", name, *path), kind="no-effect")


def _all_imposed(channel: Input, imposed: Mapping[frozenset[str], str]) -> str | None:
    """Name of the excitation that imposes the first node's motion, if all nodes are imposed one by one, or None."""
    each = [imposed.get(frozenset({node})) for node in channel.nodes]
    return each[0] if None not in each else None


# Check of excitations in conditions in which their shaft is cut off, as that of an engine that is declutched.


def cut_off_excitations(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about excitations that act although no ratio leads from their shaft to the reference shaft."""
    for name, excitation in external.definition.excitations.items():
        if excitation.enabled and excitation.shaft and excitation.shaft not in external.ratios:
            text = phrase(
                "no ratio leads from {} to {} in this condition, so that orders of {} have no speed: switch it off "
                "there, {}.enabled: false",
                ModelName(excitation.shaft), ModelName(external.reference), ModelName(name), ModelName(name),
            )  # fmt: skip
            yield Fault(text, ("excitations", name), "warning", on_key=True, kind="no-ratio")


# Check of propeller damping by Archer's formula, which holds at full ahead, in conditions of small torque.

SMALL_TORQUE_SHARE, SLIP_TORQUE_SHARE = 0.5, 0.01
"""Shares of the full-ahead torque below which Archer's formula does not apply, or a unit was slipped. Other checks warn
about the slip."""


def archer_at_small_torque(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about damping by Archer from a torque far below that of full ahead, at rated speed."""
    rated, definition = external.rated_speed, external.definition
    screws = [element for element in definition.active if isinstance(element, Propeller) and element.archer is not None]
    if not rated or not screws:
        return
    values = _values_at_speed(external, rated)
    before = definition.written
    written = None if before is None else ExternalTorques(before, resolve(before.parameters)[0])
    for screw in screws:
        torque, ratio = not_none(screw.torque), abs(external.ratios.get(str(screw.node), 0.0))
        if not ratio or not torque.names <= values.keys():
            continue
        taken = float(torque.evaluate(values))
        # Full ahead is the largest torque that the propeller takes at this speed here or as written, by its excitation,
        # T (n/n_rated)^exponent, or by the element: a condition may change any of them.
        known = [
            propeller.torque * (ratio * rated / propeller.rated) ** propeller.exponent
            for source in (definition, before or definition)
            for propeller in source.excitations.values()
            if isinstance(propeller, PropellerTorque) and propeller.node == screw.node
        ]
        same = None if written is None else written.definition.elements.get(screw.name)
        if written is not None and isinstance(same, Propeller) and same.torque is not None:
            at_speed = _values_at_speed(written, rated)
            known += [float(same.torque.evaluate(at_speed))] if same.torque.names <= at_speed.keys() else []
        whole = max(known, default=0.0)
        if SLIP_TORQUE_SHARE * whole < taken < SMALL_TORQUE_SHARE * whole:
            text = f"Archer's damping with {taken / 1e3:.4g} kN*m, {taken / whole:.0%} of the torque of full ahead"
            text += " at that speed; the formula is for a propeller that works at its pitch:"
            yield Fault(
                f"{text} give damping for this condition",
                ("elements", screw.name, "archer"),
                "warning",
                about=LOAD,
                kind="missing-entry",
            )


def _values_at_speed(external: ExternalTorques, speed: float) -> Mapping[str, Any]:
    """Value in SI units of every parameter, by name, at a speed of the reference shaft in rad/s.

    Empty where the load determines no torque there.
    """
    if not external.definition.following:
        return external.values
    try:
        operating = OperatingPoints(external).at(speed)
    except UsageError:
        return {}
    return resolve(with_operating_values(external.definition, operating).parameters)[0]


# Checks that limits name existing elements and nodes, and that these have the data the rules need.

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
