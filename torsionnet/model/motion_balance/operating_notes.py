"""Notes on the operating point about which laws of motion are linear, for every linear result."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.core.listing import comma_list
from torsionnet.core.units import RPM
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.torque_curve import MotionState
from torsionnet.model.elements import MotionLaw, Values
from torsionnet.model.parameters import resolve

MOST_NAMED = 6
"""Largest number of laws that a note names one by one."""


def law_notes(definition: Definition) -> tuple[str, ...]:
    """Notes on the operating point of laws of motion; none for a model without such laws."""
    tangents = definition.tangents
    if tangents is None:
        return ()
    from torsionnet.model.motion_balance.law_network import following_elements

    following = following_elements(definition)
    if not following:
        return ()
    names = [one.name for one in following]
    if not tangents.is_loaded:
        return (
            f"without load: {comma_list(names, MOST_NAMED)} linear at rest; at(torque={{...}}) gives another point",
        )
    state = tangents.state
    value = Values(resolve(definition.parameters)[0])
    found: list[str] = []
    for element in following:
        laws = [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]
        own = zip(laws, state.states.get(element.name, ()), state.torques.get(element.name, ()), strict=False)
        found += [f"{element.name} {_state_text(*one)}" for one in own]
    acting = [f"{node} {torque:.6g} N*m" for node, torque in state.external.items() if torque]
    at = f" under {comma_list(acting, MOST_NAMED)}" if acting else ""
    return (f"operating point{at}: {comma_list(found, MOST_NAMED)}", *state.notes, *_choice(definition))


def running_notes(definition: Definition) -> tuple[str, ...]:
    """Notes on the operating points of laws of motion in results over speed; none for a model without such laws."""
    notes = law_notes(definition)
    if notes and definition.load is not None:
        notes = (*notes, "at every speed laws of motion are linear under the load there")
    return notes


def symbol_notes(definition: Definition) -> tuple[str, ...]:
    """Notes on the operating point about which formulas hold; none for a model without laws of motion."""
    notes = law_notes(definition)
    if notes and definition.tangents is not None and definition.tangents.is_loaded:
        notes = (*notes, "the formula has the mean twists and slips of this point as numbers; values that move the "
                         "point need a formula of their own")  # fmt: skip
    return notes


def _state_text(law: MotionLaw, state: MotionState, torque: float) -> str:
    holds, torque = law.curve.holds(state), torque + 0.0  # no -0
    if law.curve.over == "rate":
        return f"sticks at {torque:.6g} N*m" if holds else f"slips at {state.rate:.6g} rad/s, {torque:.6g} N*m"
    if not holds and not torque and law.curve.slopes(state)[0] == 0:
        return "moves freely in its gap"
    return f"{'stands' if holds else 'works'} at {state.twist:.6g} rad, {torque:.6g} N*m"


def _choice(definition: Definition) -> Iterator[str]:
    """Note that there are other points in balance, or that the one taken is unstable."""
    assert definition.tangents is not None
    state, states = definition.tangents.state, definition.tangents.states
    if len(states) > 1:
        stable = sum(one.is_stable for one in states)
        by_speed = any(definition.tangents.given_speeds.values())
        which = "nearest to the speeds given" if by_speed else "in which most friction sticks"
        several = "this is the one" if stable == 1 else f"this is the one of them {which}"
        chosen = several if state.is_stable else "this one is not"
        yield f"{len(states)} operating points are in balance, {stable} of them stable; {chosen}{_at(definition)}"
    elif not state.is_stable:
        yield f"the operating point is unstable: speeds move away from it{_at(definition)}"


def _at(definition: Definition) -> str:
    assert definition.tangents is not None
    speeds = definition.tangents.state.speeds
    return "".join(f", {node} at {speed * RPM:.6g} rpm" for node, speed in list(speeds.items())[:1])
