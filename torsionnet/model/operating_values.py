"""Values of the parameters that follow the operating point, over speed.

Here as well: notes on the operating point about which laws of motion are linear, for every linear result.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from torsionnet.base.errors import Fault, UsageError, comma_list
from torsionnet.base.expressions import interpolate_float
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.model.definition import Definition, all_nodes, with_operating_values, with_tangents
from torsionnet.model.element_base.laws import MotionState
from torsionnet.model.elements import Constraint, Law, MotionLaw, Values
from torsionnet.model.elimination import reduce_rows
from torsionnet.model.kinematics import UNIT, exact_row, owned_parts
from torsionnet.model.load.external_torques import ExternalTorques
from torsionnet.model.parameters import VIBRATORY_TORQUE, Parameter, resolve
from torsionnet.model.readings import port_of


def operating_parameter_faults(external: ExternalTorques) -> list[Fault]:
    """Faults of parameters that follow a missing operating point, or whose table ends within the range of speeds."""
    definition = external.definition
    if not definition.following:
        return []
    points = OperatingPoints(external)
    try:
        speeds = [external.operating_speed]
    except UsageError as error:
        return [error.fault.under("parameters", name, "by") for name in definition.following]
    if definition.speeds is not None and (definition.load or not definition.operating_point.torque):
        speeds += [definition.speeds.values[0], definition.speeds.values[-1]]
    faults: dict[str, Fault] = {}
    for speed in speeds:
        for name, parameter in definition.following.items():
            try:
                points.value(parameter, speed)
            except UsageError as error:
                faults.setdefault(name, replace(error.fault, path=("parameters", name), on_key=True))
    return list(faults.values())


@dataclass(frozen=True, eq=False)
class OperatingPoints:
    """Parameters of a drivetrain that follow the operating point, over the speed of the reference node.

    ``external`` has the values of all parameters at any point: ratios and shares of torque do not depend on it.
    """

    external: ExternalTorques

    def at(self, speed: float) -> dict[str, float]:
        """Value in SI units of every parameter that follows the operating point, by name, at a speed in rad/s.

        Parameters over a vibration are taken at the smallest.

        Raises
        ------
        UsageError
            The torques are unknown, a torque is statically indeterminate, or a table ends before.
        """
        values = {}
        for name, parameter in self.external.definition.following.items():
            try:
                values[name] = self.value(parameter, speed)
            except UsageError as error:
                raise UsageError(f"{name}: {error}", kind=error.kind) from None
        return values

    def value(self, parameter: Parameter, speed: float) -> float:
        """Value in SI units of a parameter at a speed of the reference node in rad/s."""
        if parameter.by == VIBRATORY_TORQUE:
            return float(parameter.table[0][1].value)
        # Tables are over sizes; which way a shaft turns or is loaded makes no difference.
        size = abs(self._followed(parameter, speed))
        if not parameter.table:
            return size
        try:
            return interpolate_float(parameter.table, size)
        except UsageError as error:
            shown = f"{size * RPM:.6g} rpm" if parameter.by == "speed" else f"{size:.6g} N*m"
            where = f"{self.external.reference} at {speed * RPM:.6g} rpm"
            what = str(parameter.by).replace("_", " ")
            text = f"the {what} of {parameter.of} is {shown} with {where}; {error}"
            raise UsageError(text, kind=error.kind) from None

    def rows(self, speed: float) -> tuple[int, ...]:
        """Numbers of the rows at which every table stands at a speed of the reference node in rad/s.

        Tables of parameters and of the load; between two speeds with equal numbers all values are smooth.

        Raises
        ------
        UsageError
            As for :meth:`at`.
        """
        self.at(speed)
        rows = []
        for parameter in self.external.definition.following.values():
            followed = 0.0 if parameter.by == VIBRATORY_TORQUE else self._followed(parameter, speed)
            rows += [int(followed < 0), bisect_right([row[0].value for row in parameter.table], abs(followed))]
        return (*rows, *self.external.rows(speed))

    def _followed(self, parameter: Parameter, speed: float) -> float:
        if parameter.by == "speed":
            ratio = self.external.ratios.get(parameter.of)
            if ratio is None:
                raise UsageError(f"{parameter.of} has no fixed ratio to {self.external.reference}", kind="no-ratio")
            return ratio * speed
        torques = self.external.at(speed)
        if parameter.by == "load":
            if parameter.of not in torques:
                raise UsageError(
                    f"{parameter.of} neither drives nor absorbs; the load acts on {', '.join(torques)}",
                    kind="unknown-node",
                )
            return torques[parameter.of]
        # A torque in equilibrium is linear in those from outside, T = sum z T_node.
        if parameter.of not in self._motions:
            self._motions[parameter.of] = torque_per_node(self.external.definition, self.external.values, parameter.of)
        return sum(torque * self._motions[parameter.of].get(node, 0.0) for node, torque in torques.items())

    @cached_property
    def _motions(self) -> dict[str, dict[str, float]]:
        return {}


def at_operating_point(definition: Definition) -> Definition:
    """Definition of a model whose parameters follow the operating point, at its own one, with tangents there."""
    definition = replace(definition, tangents=None)
    points = OperatingPoints(ExternalTorques(definition, resolve(definition.parameters)[0]))
    try:
        return with_tangents(with_operating_values(definition, points.at(points.external.operating_speed)))
    except UsageError:
        return with_tangents(definition)


def operating_speed_notes(external: ExternalTorques) -> tuple[str, ...]:
    """Notes on the speed and the operating point of laws of motion at which the natural frequencies of the model hold.

    Empty if no parameter follows the operating point, and there are no laws of motion.
    """
    following, notes = external.definition.following, law_notes(external.definition)
    if not following:
        return notes
    where = f"{external.reference} at {external.operating_speed * RPM:.6g} rpm"
    names = ", ".join(following)
    return (f"natural frequencies and damping ratios hold with {where}: {names} follow the operating point", *notes)


def torque_per_node(definition: Definition, values: Mapping[str, Any], name: str) -> dict[str, float]:
    """Torque through an element at its first port per external torque on each node, by node, from equilibrium alone.

    This is the virtual motion of the nodes that opens the element by one and leaves all other springs and constraints
    at rest. External torques are in balance, so it does not matter what else moves; nor does the sign.

    Raises
    ------
    UsageError
        The element is switched off, or shares its torque with others by stiffness.
    """
    element = next((element for element in definition.active if element.name == name), None)
    if element is None:
        raise UsageError(f"{name} is switched off in this configuration, and has no torque there", kind="switched-off")
    node, _ = port_of(element, None)
    rows = [
        (owned.element, owned.part.row) for owned in owned_parts(definition, Values(values)) if _hands_on(owned.part)
    ]
    own = [number for number, (owner, row) in enumerate(rows) if owner == name and node in row]
    if len(own) != 1:
        raise UsageError(f"{name} transmits no mean torque, so nothing can follow it", kind="indeterminate-torque")
    # Virtual work: the element opens by one while all else that hands on a torque stays closed.
    opened = {**exact_row(rows[own[0]][1]), UNIT: Fraction(-1)}
    order = {node: index for index, node in enumerate(all_nodes(definition.active))}
    others = [exact_row(row) for number, (_, row) in enumerate(rows) if number != own[0]]
    reduction = reduce_rows([*others, opened], order, {UNIT})
    if reduction.blocked:
        raise UsageError(
            f"{name} shares its mean torque with others by stiffness; nothing can follow it",
            kind="indeterminate-torque",
        )
    # The torque of a law acts by its row: at the port times the coefficient there.
    factor = float(opened[node])
    return {node: factor * float(row[UNIT]) for node, row in reduction.solved.items() if UNIT in row}


def _hands_on(part: object) -> bool:
    return isinstance(part, Constraint) or (isinstance(part, Law) and part.holds_at_rest)


MOST_NAMED = 6
"""Largest number of laws that a note names one by one."""


def law_notes(definition: Definition) -> tuple[str, ...]:
    """Notes on the operating point of laws of motion; none for a model without such laws."""
    tangents = definition.tangents
    if tangents is None:
        return ()
    from torsionnet.model.law_network import following_elements  # few models have laws of motion

    following = following_elements(definition)
    if not following:
        return ()
    names = [element.name for element in following]
    if not tangents.is_loaded:
        text = "without load: {laws} linear at rest; at(torque={...}) gives another point"
        return (phrase(text, laws=comma_list(names, MOST_NAMED)),)
    state = tangents.state
    value = Values(resolve(definition.parameters)[0])
    texts: list[str] = []
    for element in following:
        laws = [part for part in element.whole_parts(value) if isinstance(part, MotionLaw)]
        own = zip(laws, state.states.get(element.name, ()), state.torques.get(element.name, ()), strict=False)
        texts += [f"{element.name} {_state_text(*law)}" for law in own]
    acting = [f"{node} {torque:.6g} N*m" for node, torque in state.external.items() if torque]
    at = f" under {comma_list(acting, MOST_NAMED)}" if acting else ""
    return (f"operating point{at}: {comma_list(texts, MOST_NAMED)}", *state.notes, *_choice(definition))


def running_notes(definition: Definition) -> tuple[str, ...]:
    """Notes on the operating points of laws of motion in results over speed; none for a model without such laws."""
    notes = law_notes(definition)
    if not notes:
        return ()
    where = "at every speed under the load there" if definition.load is not None else "about this point"
    return (*notes, f"laws of motion are linear {where}")


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
        stable = sum(state.is_stable for state in states)
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
