"""Checks that the connected parts can move, hold together and carry their torques; names and values must be sound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from torsionnet.base.errors import (
    Fault,
    UsageError,
    comma_list,
    message_of,
    named_list,
    nearest,
    question,
)
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.base.registers import Groups
from torsionnet.model.channels import Input, Sensor, immobility_text, named_nodes
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import GROUND, Values
from torsionnet.model.kinematics import (
    Kinematics,
    contradicting_loop,
    count_held_motions,
    free_motions,
    loop_mismatch,
    solve_kinematics,
    virtual_motion,
)

MOST_GROUPS, MOST_NAMES = 10, 6
"""Largest number of unconnected groups of nodes reported one by one, and of node names shown of each group: a model
with many gives a readable report."""


def unconnected_parts(definition: Definition) -> list[Fault]:
    """Faults of groups of nodes with no element between them, counting also elements that are switched off.

    Ground does not connect: what is only tied to ground does not feel its neighbour.
    """
    joined = Groups[str]()
    for element in definition.elements.values():
        nodes = [node for node in element.ports.values() if node != GROUND]
        if nodes:
            joined.join(*nodes)
    groups = joined.groups()
    main = max(groups, key=len, default=[])
    others = [group for group in groups if group is not main]
    faults = [_unconnected(definition, group, main) for group in others[:MOST_GROUPS]]
    if len(others) > MOST_GROUPS:
        faults.append(
            Fault(
                f"{len(others) - MOST_GROUPS} more groups of nodes are not connected",
                ("elements",),
                kind="unconnected-nodes",
            )
        )
    return faults


def _unconnected(definition: Definition, names: Sequence[str], main: Sequence[str]) -> Fault:
    group = set(names)
    owner = next(name for name, element in definition.elements.items() if group & set(element.ports.values()))
    order = [node for node in all_nodes(definition.elements.values()) if node in group]
    likely = ((node, nearest(node, main)) for node in order[:MOST_GROUPS])
    about, meant = next((pair for pair in likely if pair[1]), (order[0], ""))
    verb = "is" if len(order) == 1 else "are"
    said = "{} {} not connected to the rest of the drivetrain{}"
    text = phrase(said, named_list(order, MOST_NAMES), verb, question(meant))
    return Fault(text, ("elements", owner), on_key=True, kind="unconnected-nodes", about=about, meant=meant)


def contradicting_gears(definition: Definition, kinematics: Kinematics) -> list[Fault]:
    """Fault of a rigid loop whose ratios do not agree, so that nothing on it could turn."""
    reduction = kinematics.reduction
    loop = contradicting_loop(kinematics.parts, kinematics.nodes) if reduction.held() or reduction.blocked else []
    if not loop:
        return []
    mismatch = loop_mismatch(kinematics.parts, kinematics.nodes, loop)
    both = ""
    if mismatch:
        first, second = map(ModelName, mismatch.nodes)
        by_others = f"by the others {float(mismatch.others):.9g} times, {100 * abs(mismatch.deviation):.3g} % apart"
        turns = "by {} {} turns {:.9g} times as fast as {}, {}; "
        both = phrase(turns, ModelName(mismatch.element), first, float(mismatch.own), second, by_others)
    text = phrase(
        "the rigid ratios of {} contradict each other: the loop could not turn; {}"
        "correct a ratio or give one of them a stiffness",
        named_list(loop),
        both,
    )
    return (
        [Fault(text, ("elements", loop[-1]), on_key=True, kind="contradicting-gears")]
        if loop[-1] in definition.elements
        else [Fault(text, kind="contradicting-gears")]
    )


def massless_without_hold(definition: Definition, kinematics: Kinematics) -> list[Fault]:
    """Faults of motions that no inertia, spring or damper resists: the receptance there is infinite."""
    left = free_motions(kinematics, lambda law: law.acts)
    moving: dict[str, list[str]] = {name: [] for name in kinematics.coordinates if left.is_free(name)}
    for node in kinematics.nodes if moving else ():
        coordinates = kinematics.reduction.free_names({node: 1})
        for name in dict.fromkeys(name for coordinate in coordinates for name in left.free_names({coordinate: 1})):
            moving[name].append(node)
    owners: dict[str, str] = {}
    for element in definition.elements.values() if moving else ():
        for node in element.ports.values():
            owners.setdefault(node, element.name)
    faults = []
    for nodes in moving.values():
        owner = owners.get(nodes[0])
        verb = "moves" if len(nodes) == 1 else "move together"
        them = "it" if len(nodes) == 1 else "them"
        said = "{} {} freely, with no inertia, spring or damper to hold {}"
        text = phrase(said, named_list(nodes, MOST_NAMES), verb, them)
        faults.append(Fault(text, ("elements", owner) if owner else (), on_key=True, kind="indeterminate-motion"))
    return faults


def locked_channels(definition: Definition, kinematics: Kinematics) -> list[Fault]:
    """Warnings about inputs, excitations and sensors on a node that cannot move in this configuration."""
    faults, nodes = [], set(kinematics.nodes)
    for name, channel in definition.inputs.items():
        if nodes.issuperset(channel.nodes) and kinematics.holds_row(channel.row):
            text = phrase("input {} does nothing: {}", ModelName(name), _still(channel))
            faults.append(Fault(text, ("inputs", name, channel.quantity), "warning", kind="no-effect"))
    for name, excitation in definition.excitations.items():
        for path, node in excitation.node_entries if excitation.enabled else ():
            acting = excitation.channel(node)
            if nodes.issuperset(acting.nodes) and kinematics.holds_row(acting.row):
                held = (
                    phrase('"{}", which is locked', ModelName(node))
                    if acting.against is None
                    else phrase("{}, held rigidly", named_nodes(acting))
                )
                text = phrase("{} acts on {}, and has no effect; move it to a node that turns", ModelName(name), held)
                faults.append(Fault(text, ("excitations", name, *path), "warning", kind="no-effect"))
    for name, sensor in definition.sensors.items():
        moves = not sensor.is_on_element and nodes.issuperset(sensor.nodes)
        if moves and kinematics.holds_row(sensor.row):
            text = phrase("sensor {} reads zero: {}", ModelName(name), _still(sensor))
            faults.append(Fault(text, ("sensors", name, sensor.quantity), "warning", kind="zero-reading"))
    return faults


def _still(channel: Input | Sensor) -> str:
    return phrase('"{}" is locked', ModelName(channel.of)) if channel.against is None else immobility_text(channel)


def contradicting_inputs(definition: Definition, kinematics: Kinematics) -> list[Fault]:
    """Faults of inputs that act on a node whose angle another input imposes."""
    imposed = {frozenset(definition.inputs[name].nodes): name for name in kinematics.imposed}
    faults = []
    for name, channel in definition.inputs.items():
        driven = imposed.get(frozenset(channel.nodes))
        if channel.quantity == "torque" and driven is not None:
            said = "the angle of {} is imposed by {}; a torque there does nothing"
            text = phrase(said, named_nodes(channel), ModelName(driven))
            faults.append(Fault(text, ("inputs", name, channel.quantity), kind="contradicting-angles"))
    fixed = [index for index in kinematics.reduction.blocked if index < len(kinematics.imposed)]
    for index in fixed:
        name = kinematics.imposed[index]
        text = phrase(
            "the angle imposed by {} contradicts a rigid connection to another imposed angle", ModelName(name)
        )
        faults.append(Fault(text, ("inputs", name), kind="contradicting-angles"))
    if not fixed and kinematics.reduction.blocked:
        both = "two imposed angles act on nodes that are rigidly connected"
        faults.append(Fault(both, ("inputs", kinematics.imposed[-1]), kind="contradicting-angles"))
    return faults


def indeterminate_torques(definition: Definition, kinematics: Kinematics) -> list[Fault]:
    """Warnings about torque sensors on a rigid connection whose torque equilibrium does not determine."""
    faults = []
    for name, sensor in definition.sensors.items():
        if sensor.quantity != "torque":
            continue
        for index, (owner, _) in enumerate(kinematics.constraints):
            if owner == sensor.of:
                try:
                    virtual_motion(kinematics, index)
                except UsageError as error:
                    path = ("sensors", name, "torque")
                    faults.append(replace(error.fault, path=path, severity="warning"))
    return faults


def idle_channels(definition: Definition, kinematics: Kinematics) -> list[Fault]:
    """Notes on sensors and inputs on parts that are switched off, but not in every configuration."""
    active = {element.name for element in definition.active}
    nodes = set(kinematics.nodes)
    faults = []
    for table in ("inputs", "sensors"):
        for name, channel in getattr(definition, table).items():
            named = (channel.of,) if channel.is_on_element else channel.nodes
            missing = [place for place in named if place not in (active if channel.is_on_element else nodes)]
            if missing:
                text = phrase("{} has nothing to act on: {} is switched off", ModelName(name), ModelName(missing[0]))
                faults.append(Fault(text, (table, name), "note", on_key=True, causes=("off",)))
    return faults


def rigid_body_modes(definition: Definition, kinematics: Kinematics) -> list[Fault]:
    """Note on the number of motions that no spring or controller resists.

    Under torques or a load gaps count as closed.
    """
    closed: tuple[str, ...] = ()
    loaded = definition.load or definition.operating_point.torque
    if loaded and any(element.has_motion_laws for element in definition.active):
        from torsionnet.model.checks.free_laws import with_gaps_closed

        kinematics, closed = with_gaps_closed(definition, kinematics)
    count = len(rigid_motions(kinematics))
    count -= count_held_motions(kinematics) if count and kinematics.actions else 0
    if not count:
        return []
    text = phrase("the drivetrain can turn freely: {count} rigid-body modes", count=count)
    if count == 1:
        text = phrase("the drivetrain can turn freely: one rigid-body mode")
    if closed:
        text = phrase("{motions} while torque presses {laws} together", motions=text, laws=comma_list(closed))
    return [Fault(text, (), "note")]


def rigid_motions(kinematics: Kinematics) -> list[str]:
    """Names of coordinates, one for each independent motion that no spring resists."""
    left = free_motions(kinematics, lambda law: law.holds_at_rest)
    return [name for name in kinematics.coordinates if left.is_free(name)]


def check_structure(definition: Definition, values: Mapping[str, Any]) -> list[Fault]:
    """Faults of all structural checks of one configuration; contradicting gears make the rest meaningless."""
    on = definition.active
    # Values quoted at another shaft first: without the speed ratio to it no element has laws.
    if any(element.enabled and element.referred_to is not None for element in definition.elements.values()):
        from torsionnet.model.referral import referral_faults

        if unfit := list(
            referral_faults([element for element in definition.elements.values() if element.enabled], values)
        ):
            return unfit
    kinematics = solve_kinematics(definition, Values(values))
    # Friction that sticks holds its row in linear results; what turns is judged as it is while it slips.
    slipping = None
    if has_motion_laws := any(element.has_motion_laws for element in on):
        from torsionnet.model.checks.free_laws import loose_kinematics, open_gaps, sticking_loops, stuck_friction

        slipping = loose_kinematics(definition, values)
    faults = contradicting_gears(definition, slipping or kinematics)
    if faults:
        return faults
    faults = locked_channels(definition, kinematics)
    faults = faults if slipping is None else _stuck_channels(faults, locked_channels(definition, slipping))
    faults += contradicting_inputs(definition, kinematics) if kinematics.imposed else []
    faults += massless_without_hold(definition, kinematics)
    # Where no rigid constraint follows from others, equilibrium gives the torque of each.
    if kinematics.reduction.redundant or kinematics.reduction.blocked:
        faults += indeterminate_torques(definition, kinematics)
    faults += idle_channels(definition, kinematics) if len(on) < len(definition.elements) else []
    faults += rigid_body_modes(definition, kinematics)
    if any(sensor.referred_to is not None for sensor in definition.sensors.values()):
        faults += unreachable_shafts(definition, values)
    operated = bool(definition.load or definition.operating_point.speed or definition.operating_point.torque)
    if has_motion_laws:
        faults += [] if operated else open_gaps(definition, values, slipping or kinematics)
        faults += stuck_friction(definition, values, slipping or kinematics, operated=operated)
        faults += sticking_loops(definition, values, slipping or kinematics)
    # An operating point is checked where there is one, a parameter follows it, or an element reads a curve there.
    rated = definition.speeds is not None and definition.speeds.rated and definition.excitations
    if operated or definition.following or rated or any(element.reads_off for element in on):
        from torsionnet.model.checks.operation import unfit_operation

        sound = all(fault.severity != "error" for fault in faults)
        faults += unfit_operation(definition, values, kinematics, sound=sound)
    return faults


def _stuck_channels(stuck: Sequence[Fault], always: Sequence[Fault]) -> list[Fault]:
    """Findings on channels that do nothing, as notes where friction holds them only while it sticks."""
    paths = {fault.path for fault in always}
    text = "{}, in linear results at an operating point where friction sticks or a preload holds"
    return [
        fault if fault.path in paths else replace(fault, message=phrase(text, fault.message), severity="note", kind="")
        for fault in stuck
    ]


def unreachable_shafts(definition: Definition, values: Mapping[str, Any]) -> list[Fault]:
    """Faults of sensors whose readings cannot be referred to the shaft they name, as no gear ratio leads to it.

    Those that are switched off are left out.
    """
    from torsionnet.model.readings import referring_factor  # few sensors are referred

    elements, nodes = {element.name: element for element in definition.active}, all_nodes(definition.active)
    faults = []
    for name, sensor in definition.sensors.items():
        is_on = sensor.of in elements if sensor.is_on_element else all(node in nodes for node in sensor.nodes)
        if sensor.referred_to is not None and is_on:
            try:
                referring_factor(sensor, elements, Values(values))
            except UsageError as error:
                text = phrase("{}: {}", ModelName(name), message_of(error))
                faults.append(Fault(text, ("sensors", name, "referred_to"), kind="no-ratio"))
    return faults
