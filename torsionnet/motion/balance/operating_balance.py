"""Operating point of the laws of motion of a drivetrain, worked out when a linear result first needs it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.expressions import Number, exact
from torsionnet.base.units import RPM
from torsionnet.model.balanced_state import BalancedState
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.laws import AT_REST, MotionState
from torsionnet.model.elements import Element, MotionLaw, Row
from torsionnet.model.elimination import reduce_rows
from torsionnet.model.kinematics import UNIT, exact_row
from torsionnet.model.law_network import LawNetwork, PlacedMotionLaw, keeps_own_point, law_network
from torsionnet.model.load.external_torques import CutOffError, ExternalTorques, reference_node, stated_torques
from torsionnet.model.operating_point import OperatingPoint
from torsionnet.model.parameters import resolve

if TYPE_CHECKING:
    from torsionnet.motion.balance.steady_speeds import SteadySpeeds


SAME_SPEED = 1e-9
"""Share of the largest speed by which slips may differ from those that given speeds ask for: more than rounding."""
MOST_COMBINATIONS = 100
"""Largest number of combinations of twists that are listed, beyond which each law has the one nearest to rest."""
MOST_LISTED = 4
"""Largest number of operating points that a message lists."""


@dataclass(frozen=True, eq=False)
class OperatingBalance:
    """Operating point of a model with laws of motion, about which these are linear.

    Attributes
    ----------
    definition : Definition
        The model with its laws of motion at rest.
    speed : float, optional
        Speed in rad/s of the reference node of the load, by default that of the operating point.
    """

    definition: Definition
    speed: float | None = None

    def linear(self, elements: Sequence[Element]) -> tuple[Element, ...]:
        """Elements with the tangents of their laws of motion about the operating point.

        Those whose laws somebody has replaced, and those that keep a working point of their own, are unchanged.
        """
        if not any(map(self._follows, elements)) or self._rests:
            return tuple(elements)
        states = self.state.states
        return tuple(
            element.at_states(states[element.name]) if self._follows(element) and element.name in states else element
            for element in elements
        )

    def _follows(self, element: Element) -> bool:
        replaced = element.other_laws is not None and not element.is_at_own_speed
        return element.has_motion_laws and not replaced and not keeps_own_point(element, self.definition)

    @cached_property
    def state(self) -> BalancedState:
        """State of all laws of motion: of several the stable one nearest to given speeds, else that which sticks.

        Raises
        ------
        ModelError
            The torques are not in balance, a table is left, or there are several points and nothing tells which.
        """
        return self.states[0] if len(self.states) == 1 else self._chosen_point(self.states)

    @cached_property
    def states(self) -> tuple[BalancedState, ...]:
        """States of all laws of motion that are in balance with the mean torques, by rising speed, or nearest first."""
        return tuple(self._states())

    @cached_property
    def external(self) -> dict[str, float]:
        """Mean external torque in N m by node in this condition; empty where there is none, or its load is cut off."""
        external = self._external
        if self.definition.load is None:
            return stated_torques(self.definition, external.values)
        try:
            # With a cylinder lost drivers and absorbers have less than with all working.
            (in_condition,) = external.in_condition([self.speed or external.operating_speed])
            return in_condition
        except (CutOffError, UsageError):
            return {}

    @cached_property
    def given_speeds(self) -> dict[str, float]:
        """Mean speed in rad/s by node that the operating point or the load gives."""
        values = self._external.values
        point = {node: float(given.evaluate(values)) for node, given in self.definition.operating_point.speed.items()}
        if self.definition.load is None:
            return point
        reference = self._external.reference
        try:
            own = self.speed or self._external.operating_speed
        except UsageError:
            return point
        # Given speeds keep their ratio to that of the reference node.
        ratio = own / point[reference] if point.get(reference) else 1.0
        return {**{node: ratio * speed for node, speed in point.items()}, reference: own}

    @property
    def is_loaded(self) -> bool:
        """Whether a torque or a speed is given."""
        return any(self.external.values()) or any(self.given_speeds.values())

    def depends_on(self, names: frozenset[str]) -> bool:
        """Whether the state may change with some parameters, apart from those of torques and speeds from outside.

        It does not where equilibrium alone gives the torques of laws that do not depend on these parameters.
        """
        if self._rests:
            return False

        network = self.network
        following = [element for element in self.definition.switched_on if self._follows(element)]
        if any(expression.names & names for element in following for _, _, expression, _ in element.expressions()):
            return True
        return bool(network.over_rate) or any(virtual_opening(network, law) is None for law in network.over_twist)

    def of(self, definition: Definition) -> OperatingBalance:
        """Operating point of the model with other entries, at the same speed."""
        return OperatingBalance(replace(definition, tangents=None), self.speed)

    def with_values(self, values: Mapping[str, float]) -> OperatingBalance:
        """Operating point of the model with some parameters at other values in SI units."""
        known = self.definition.parameters
        changed = {name: known[name].given(Number(value)) for name, value in values.items()}
        return OperatingBalance(replace(self.definition, parameters={**known, **changed}), self.speed)

    @cached_property
    def _external(self) -> ExternalTorques:
        return ExternalTorques(self.definition, resolve(self.definition.parameters)[0])

    @cached_property
    def network(self) -> LawNetwork:
        return law_network(self.definition, self._external.values)

    @cached_property
    def _rests(self) -> bool:
        """Whether all laws of motion are without load, and rest without twist then."""
        if self.is_loaded:
            return False
        return not any(map(_pushes_at_rest, self.network.motion))

    def _states(self) -> Iterator[BalancedState]:
        network = self.network
        external = {node: torque for node, torque in self.external.items() if node in network.order}
        if self._rests:
            states: dict[str, tuple[MotionState, ...]] = {}
            for placed in network.motion:
                states[placed.owner] = (*states.get(placed.owner, ()), _at_rest(placed.law))
            yield BalancedState({}, states, {name: (0.0,) * len(some) for name, some in states.items()})
            return
        from torsionnet.motion.balance.steady_speeds import steady_speeds

        given = {node: speed for node, speed in self.given_speeds.items() if node in network.order}
        motions = steady_speeds(network, external, given, self.definition.name)
        refused: list[ModelError] = []
        # The nearest to given speeds first, of equally near ones that in which most sticks.
        for motion in sorted(motions, key=lambda speeds: (speeds.distance, -speeds.sticking)) if given else motions:
            try:
                balanced = self._balanced(motion, external)
            except ModelError as error:  # as where the slip of one balance lies beyond a table
                refused.append(error)
            else:
                yield from balanced
        if len(refused) == len(motions):
            raise refused[0]

    def _balanced(self, motion: SteadySpeeds, external: Mapping[str, float]) -> list[BalancedState]:
        """States of all laws with steady speeds, whose torques twist the springs; several where a torque falls."""
        from torsionnet.motion.balance.twist_search import twist_balance

        network = self.network
        acting, slipping = ({node: exact(torque) for node, torque in external.items()} for _ in range(2))
        for law, speed in motion.laws.items():
            for node, share in law.law.row.items() if speed.counts and speed.torque else ():
                for table in (acting,) if law.law.curve.holds(speed.state) else (acting, slipping):
                    table[node] = table.get(node, Fraction(0)) - exact(share) * exact(speed.torque)
        law_states: dict[PlacedMotionLaw, tuple[MotionState, float]] = {
            law: (speed.state, speed.torque) for law, speed in motion.laws.items()
        }
        # Torques that equilibrium alone gives are exact, and their laws are inverted; the others are searched for.
        known = determinate_torques(network, acting)
        choices = [self._states_at(placed, torque) for placed, torque in known.items()]
        if len(known) < len(network.over_twist):
            balance = twist_balance(network, {node: float(torque) for node, torque in acting.items()})
            own = zip(network.over_twist, balance.states, balance.torques.tolist(), strict=True)
            law_states |= {law: (state, torque) for law, state, torque in own if law not in known}
        if math.prod(map(len, choices)) > MOST_COMBINATIONS:
            choices = [some[:1] for some in choices]
        return [
            self._in_states(motion, external, slipping, law_states | dict(zip(known, some, strict=True)))
            for some in itertools.product(*choices)
        ]

    def _in_states(
        self,
        motion: SteadySpeeds,
        external: Mapping[str, float],
        slipping: Mapping[str, Fraction],
        law_states: Mapping[PlacedMotionLaw, tuple[MotionState, float]],
    ) -> BalancedState:
        from torsionnet.motion.balance.rate_states import returns_to_twists

        self._require_range(law_states)
        twisted = {law: law_states[law][0] for law in self.network.over_twist}
        states: dict[str, tuple[MotionState, ...]] = {}
        torques: dict[str, tuple[float, ...]] = {}
        for law in self.network.motion:
            state, own_torque = law_states[law]
            states[law.owner] = (*states.get(law.owner, ()), state)
            torques[law.owner] = (*torques.get(law.owner, ()), own_torque)
        size = max(map(abs, external.values()), default=0.0)
        notes = tuple(
            f"the mean torques leave {torque:.4g} N*m over, taken at {node}"
            for node, torque in motion.left_over.items()
            if abs(torque) > 1e-9 * size and abs(torque) > 0
        )
        if motion.distance > SAME_SPEED * max(map(abs, motion.speeds.values()), default=0.0):
            notes += tuple(
                f"the speeds given are not in balance with the torques: {owner} slips at {rate:.6g} rad/s"
                for owner, rate in motion.slipping.items()
            )
        outer = {node: float(torque) for node, torque in slipping.items()}
        stated = (next(iter(law.law.row)) for law, speed in motion.laws.items() if not speed.counts)
        return BalancedState(
            motion.speeds,
            states,
            torques,
            dict(external),
            outer,
            motion.is_stable and returns_to_twists(self.network, twisted),
            notes,
            motion.sticking,
            tuple(dict.fromkeys(stated)),
        )

    def _states_at(self, placed: PlacedMotionLaw, torque: Any) -> list[tuple[MotionState, float]]:
        """States of a law over the twist at a torque in N m, of a rising curve only the one nearest to rest.

        Of one that falls somewhere, as that of a magnetic coupling beyond its largest torque, all; those that hold come
        first.
        """
        law = placed.law
        places = law.curve.states_at(torque / law.scale) if law.scale else (AT_REST,)
        if places is None:
            places = _bracketed_twists(law, float(torque))
        falling = [state for state in places if not law.curve.holds(state) and law.curve.slopes(state)[0] < 0]
        rising = sorted((state for state in places if state not in falling), key=lambda state: abs(state.twist))
        states = [*rising, *falling] if falling else rising[:1]
        if rising:  # else nothing holds it: where the torque falls alone, it runs away
            return [(state, float(torque)) for state in states]
        raise ModelError(
            [Fault(_not_reached(law, float(torque)), ("elements", placed.owner), kind="no-solution")],
            self.definition.name,
        )

    def _require_range(self, law_states: Mapping[PlacedMotionLaw, tuple[MotionState, float]]) -> None:
        faults = [
            Fault(message, ("elements", law.owner), kind="no-solution")
            for law, (state, _) in law_states.items()
            if (message := law.law.curve.left(state.twist, state.rate, *state.sensed))
        ]
        if faults:
            raise ModelError(faults, self.definition.name)

    def _chosen_point(self, points: Sequence[BalancedState]) -> BalancedState:
        """Stable one of several points, of these the nearest to given speeds, else that in which most laws stick.

        Friction that sticks keeps doing so until something makes it slip.
        """
        stable = [point for point in points if point.is_stable]
        if not stable:
            return points[0]
        if any(self.given_speeds.values()):
            return stable[0]
        most = max(point.sticking for point in stable)
        sticking = [point for point in stable if point.sticking == most]
        if len({tuple(point.speeds.items()) for point in sticking}) == 1:
            return sticking[0]  # of several twists the one nearest to rest comes first
        listed = "; ".join(map(self._speeds_text, sticking[:MOST_LISTED]))
        text = (
            f"{len(sticking)} stable operating points are in balance: {listed}; choose one with speed={{node: value}}"
        )
        raise ModelError([Fault(text, ("operating_point", "speed"), kind="missing-entry")], self.definition.name)

    def _speeds_text(self, point: BalancedState) -> str:
        nodes = dict.fromkeys(node for law in self.network.over_rate for node in law.law.row)
        speeds = {node: point.speeds[node] for node in nodes if node in point.speeds}
        return ", ".join(f"{node} {speed * RPM:.6g} rpm" for node, speed in list(speeds.items())[:MOST_LISTED])


def _pushes_at_rest(placed: PlacedMotionLaw) -> bool:
    """Whether a law has a torque at rest without twist, as a motor has, or a table that is not symmetric."""
    if placed.law.curve.holds(AT_REST):
        return False
    try:
        return bool(placed.law.torque(0, 0, *([0] * len(placed.law.sensed))) != 0)
    except ArithmeticError:  # as that of a constant power
        return True


def _at_rest(law: MotionLaw) -> MotionState:
    rest = getattr(law.curve, "rest", None)
    return MotionState(piece=rest)


def _bracketed_twists(law: MotionLaw, torque: float) -> tuple[MotionState, ...]:
    """Twists at which a smooth law gives a torque in N m, between the corners of its curve and beyond."""
    from scipy.optimize import brentq

    def over(twist: float) -> float:
        return float(law.torque(twist, 0.0)) - torque

    places = sorted({0.0, *map(float, law.curve.corners())})
    reach = max(1.0, *map(abs, places))
    while over(reach) * over(-reach) > 0 and reach < 1e9:
        reach *= 2
    ends = [-reach, *places, reach]
    return tuple(
        MotionState(float(brentq(over, low, high, xtol=1e-300, rtol=1e-14)))
        for low, high in pairwise(ends)
        if over(low) * over(high) <= 0 and low < high
    )


def _not_reached(law: MotionLaw, torque: float) -> str:
    """Message that no twist gives a torque in N m."""
    ends = [float(law.torque(end, 0)) for end in law.curve.range() if end is not None]
    if not ends and law.curve.corners():
        most = max((float(law.torque(place, 0)) for place in law.curve.corners()), key=lambda extreme: extreme * torque)
        return f"the mean torque is {torque:.6g} N*m, and it holds at most {most:.6g} N*m; reduce the torque"
    reach = f", and it ends at {max(ends, key=lambda end: end * torque):.6g} N*m" if ends else ""
    return f"the mean torque is {torque:.6g} N*m{reach}; extend the table or the last stage, or reduce the torque"


# Operating point of a call, from torques by place and a speed or speeds by node.


def asked_point(
    definition: Definition, torque: Mapping[str, Any] | None, speed: Mapping[str, Any] | float | str | None
) -> OperatingPoint:
    """Operating point with torques by place and a speed of the reference node, or speeds by node.

    Raises
    ------
    UsageError
        Neither torques nor speeds, or a speed without a reference node.
    ModelError
        A value that is no torque or speed.
    """
    if not torque and speed is None:
        raise UsageError(
            'give torques or speeds of the operating point, as at(torque={"crank": "200 N*m"})', kind="missing-entry"
        )
    if speed is not None and not isinstance(speed, Mapping):
        reference = reference_node(definition) or next(iter(definition.operating_point.speed), "")
        if not reference:
            raise UsageError(
                f"{speed} is the speed of no node in particular, as the model has neither speeds: nor load:; "
                "give it by node, as speed={node: value}",
                kind="missing-entry",
            )
        speed = {reference: speed}
    point, faults = OperatingPoint.read({"torque": dict(torque or {}), "speed": dict(speed or {})})
    if faults or point is None:
        raise ModelError(faults or [Fault("no operating point", kind="no-solution")], "the operating point")
    return point


# Mean torques of laws that equilibrium alone gives, exact as the torques from outside are.

MOST_LAWS = 40
"""Largest number of laws whose torque is sought by opening each of them, an elimination for every law."""


def determinate_torques(network: LawNetwork, external: Mapping[str, Fraction]) -> dict[PlacedMotionLaw, Fraction]:
    """Mean torque in N m of each law over the twist, of those that share it with nothing else, from torques by node.

    It is the work of the external torques on the virtual motion that opens the law by one and leaves everything else
    without twist. Torques that leave something over are taken where the free motions are held.
    """
    if len(network.over_twist) > MOST_LAWS:
        return {}
    torques = {}
    for law in network.over_twist:
        motion = virtual_opening(network, law)
        if motion is not None:
            torques[law] = sum((torque * motion.get(node, 0) for node, torque in external.items()), start=Fraction(0))
    return torques


def virtual_opening(network: LawNetwork, opened: PlacedMotionLaw) -> dict[str, Fraction] | None:
    """Virtual motion of the nodes that opens a law by one and nothing else; None where others have to open with it."""
    # b z = 1 for the law that is opened, b z = 0 for all others, and free motions held.
    rows: list[Row] = [exact_row(row) for row in network.held]
    rows += [exact_row(law.row) for _, law in network.elastic]
    rows += [exact_row(law.law.row) for law in network.over_twist if law is not opened]
    rows += [{node: Fraction(1)} for node in network.free_motions]
    return _motion_of([*rows, {**exact_row(opened.law.row), UNIT: Fraction(-1)}], network)


def _motion_of(rows: Iterable[Row], network: LawNetwork) -> dict[str, Fraction] | None:
    reduction = reduce_rows(rows, network.order, {UNIT})
    if reduction.blocked:
        return None
    return {node: row[UNIT] for node, row in reduction.solved.items() if UNIT in row}
