"""Torques that go on acting as a motion starts at an operating point, and notes on those that stay as they are."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping

from torsionnet.base.errors import ModelError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.model.balanced_state import BalancedState
from torsionnet.model.element_base.laws import MotionLaw, Values
from torsionnet.model.operating_point import torque_place
from torsionnet.model.speeds import mean_speeds
from torsionnet.motion.scenarios.time_history import TimeHistory
from torsionnet.motion.smooth_laws import Scale

EQUAL = 1e-9
"""Share by which a scale at the operating point and one at the start may differ and count as the same."""


def acting_means(
    drivetrain: AssembledModel, replaced: Iterable[tuple[str, ...]] = (), *, in_full: bool = True
) -> dict[str, float]:
    """Mean torques in N m of the operating point by node that go on acting, those on ``replaced`` nodes left out.

    Where laws of motion act ``in_full``, those that a law on the node gives are left out too: a propeller whose torque
    follows the speed brakes once, also where the load states its torque.
    """
    tangents, others = drivetrain.definition.tangents, set(replaced)
    means = dict(drivetrain.mean_torques)
    for place, torque in drivetrain.definition.operating_point.torque.items() if not drivetrain.definition.load else ():
        nodes = torque_place(place).nodes
        if nodes in others and len(nodes) > 1:
            for node, sign in zip(nodes, (1, -1), strict=True):
                means[node] = means.get(node, 0.0) - sign * float(torque.evaluate(drivetrain.exact_values))
    means = {
        node: torque for node, torque in means.items() if torque and node in drivetrain.nodes and (node,) not in others
    }
    if not (means and in_full):
        return means
    try:
        state = None if tangents is None else tangents.state
    except ModelError:  # other torques may be in balance
        return means
    stated = {*_taken_over(drivetrain, means, state), *(() if state is None else state.stated)}
    return {node: torque for node, torque in means.items() if node not in stated}


def _taken_over(drivetrain: AssembledModel, means: Mapping[str, float], state: BalancedState | None) -> Iterator[str]:
    """Yield nodes whose mean torque brakes as a law over their absolute speed does, whose working point it is."""
    speeds = given_speeds(drivetrain) if state is None else state.speeds
    value = Values(drivetrain.exact_values)
    for element in drivetrain.definition.switched_on:
        if not (element.has_motion_laws and element.has_own_working_point):
            continue
        for law in element.whole_parts(value):
            if not isinstance(law, MotionLaw) or len(law.row) != 1 or law.curve.over != "rate" or law.sensed:
                continue
            ((node, share),) = law.row.items()
            rate = float(share) * speeds.get(node, 0.0)
            if rate and node in means and float(law.torque(0.0, rate)) * float(share) * means[node] < 0:
                yield node


def held_load(drivetrain: AssembledModel, nodes: Container[str]) -> tuple[str, ...]:
    """Note that torques of the load on ``nodes``, which would follow the speed, stay as they are; or no note."""
    load = drivetrain.definition.load
    if load is None:
        return ()
    # Their slopes follow the speed also where they are linear.
    following = {getattr(one, "node", None) for one in drivetrain.definition.switched_on if one.has_motion_laws}
    held = [
        place
        for place, one in load.by_place.items()
        if (one.over_speed or one.torque_exponent)
        and any(node in nodes for node in torque_place(place).nodes)
        and torque_place(place).of not in following
    ]
    text = "the torques of the load at {places} are held, whatever the speed"
    return (phrase(text, places=", ".join(held)),) if held else ()


def scale_notes(drivetrain: AssembledModel, scales: Mapping[Scale, TimeHistory]) -> Iterator[str]:
    """Yield a note on each scale of a torque that is another at the operating point than from the start on."""
    value = Values(drivetrain.exact_values)
    for (element, what), history in scales.items():
        for law in drivetrain.definition.elements[element].whole_parts(value):
            if isinstance(law, MotionLaw) and law.scaled_by == what:
                own, first = float(law.scale), history.first
                if abs(own - first) > EQUAL * max(abs(own), abs(first)):
                    text = (
                        "the {what} of {element} is {own:g} at the operating point and {first:g} from the start on, "
                        "in SI units"
                    )
                    yield phrase(text, what=what, element=element, own=own, first=first)


def given_speeds(drivetrain: AssembledModel) -> dict[str, float]:
    """Mean speed in rad/s by node that the operating point gives, empty where it gives none."""
    definition = drivetrain.definition
    return mean_speeds(definition, drivetrain.exact_values) if definition.operating_point.speed else {}
