"""Mean torques from outside on the nodes of a drivetrain, from its load over speed or its operating point.

Here as well: places where the drivers and absorbers of a load act, and the nodes that take their reactions.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import EntryPath, Fault, UsageError, unfit_word
from torsionnet.model.channels import Input, parse_pair
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.operating_point import torque_place
from torsionnet.model.speeds import mean_speeds, speeds_by_reference

if TYPE_CHECKING:
    from torsionnet.model.load.load_section import Absorber, Load

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
        engines = [name for name, excitation in definition.excitations.items() if excitation.kind == ENGINE]
        if len(engines) != 1:
            raise UsageError("say who drives: driven_by: {node: 1}, or the name of an excitation", kind="missing-entry")
        shares = {engines[0]: 1.0}
    by_place: dict[Input, float] = {}
    for name, share in shares.items():
        places = [reacting(definition, name)]
        if name in definition.excitations:
            excitation = definition.excitations[name]
            places = [Input("torque", node, excitation.reaction_node) for _, node in excitation.node_entries]
        for place in places:
            by_place[place] = by_place.get(place, 0.0) + share / len(places)
    return by_place


def reacting(definition: Definition, text: str) -> Input:
    """Torque input where a driver or absorber acts, with the node that takes its reaction.

    On a node alone it is the machine whose excitation acts there, and reacts where that does.
    """
    place = torque_place(text)
    if parse_pair(text) is not None:
        return place
    reactions = {
        excitation.reaction_node
        for excitation in definition.excitations.values()
        if excitation.quantity == "torque" and place.of in excitation.nodes and excitation.reaction_node is not None
    }
    return Input("torque", place.of, *reactions) if len(reactions) == 1 else place


def on_nodes(acting: Iterable[tuple[Input, float]]) -> dict[str, float]:
    """Torque in N m by node, from torques that act on a node or between two nodes."""
    torques: dict[str, float] = {}
    for place, torque in acting:
        for node, share in place.row.items():
            torques[node] = torques.get(node, 0.0) + share * torque
    return torques


def unknown_driver(definition: Definition, name: str, path: EntryPath) -> Fault | None:
    """Fault, at a path, that a node or excitation of this name cannot drive, or None."""
    nodes = all_nodes(definition.elements.values())
    if name in definition.excitations or all(node in nodes for node in torque_place(name).nodes):
        return None
    known, rest = [*definition.excitations, *nodes], "driven_by has nodes or excitations"
    return unfit_word(f'no node or excitation is named "{name}"', name, known, path, rest, on_key=True)


UNKNOWN = "the load determines no mean torques here"
"""End of messages on a driver or absorber that is cut off from the load's reference node."""

NEEDS_RATED = "what follows the speed, as the load does, needs the rated speed: speeds: {of: node, rated: 750 rpm, ...}"
"""Message that the rated speed of the reference shaft is missing."""

UNBALANCED_SHARE = 0.05
"""Share of the largest torque that may remain unbalanced, for rounding of data sheets and drag in bearings."""


class CutOffError(UsageError):
    """Error that a driver or absorber does not turn with the reference node, as behind an open clutch."""


def reference_node(definition: Definition) -> str:
    """Name of the node whose speed a load follows: that of ``speeds:``, else the first absorber."""
    if definition.speeds is not None:
        return str(definition.speeds.of)
    return torque_place(next(iter(definition.load.by_place))).of if definition.load else ""


@dataclass(frozen=True, eq=False)
class ExternalTorques:
    """Mean torques on a drivetrain over its speed, from its load or else from its operating point.

    ``values`` are those of the parameters. A driver's torque has the sign of the rotation of its node, an absorber's
    the opposite one; the reference node turns in the positive sense. Power is shared, so that drivers of unlike speeds
    have unlike torques. Between two nodes the speed of the first relative to the second counts, and the second takes
    the reaction.
    """

    definition: Definition
    values: Mapping[str, Any]

    @property
    def reference(self) -> str:
        """Name of the reference node, whose speed the load follows."""
        return reference_node(self.definition)

    @cached_property
    def mean_speeds(self) -> dict[str, float]:
        """Speed in rad/s of every node that the operating point determines, by node.

        Raises
        ------
        ModelError
            The speeds of the operating point do not fit the ratios.
        """
        return mean_speeds(self.definition, self.values) if self.definition.operating_point.speed else {}

    @cached_property
    def ratios(self) -> dict[str, float]:
        """Speed of every node over that of the reference, by node, for nodes that turn with it."""
        speeds = speeds_by_reference(self.definition, self.values, self.reference, self.mean_speeds)
        own = speeds.get(self.reference)
        return {node: speed / own for node, speed in speeds.items()} if own else {}

    @cached_property
    def rated_speed(self) -> float | None:
        """Rated speed of the reference node in rad/s, None where it is not given."""
        rated = self.definition.speeds.rated if self.definition.speeds else None
        return rated or self._rated_of_absorber()

    @cached_property
    def operating_speed(self) -> float:
        """Speed of the reference node in rad/s about which the model is linear.

        The operating point's, else the rated one.

        Raises
        ------
        UsageError
            Nothing says it.
        """
        speed = self.mean_speeds.get(self.reference) or self.rated_speed
        if not speed:
            raise UsageError(NEEDS_RATED, kind="missing-entry")
        return float(speed)

    def _rated_of_absorber(self) -> float | None:
        """Speed in rad/s of the reference node at which the first absorber with a rated speed runs at that speed."""
        for place, absorber in self.absorbers.items():
            ratio = self._relative(place)
            if absorber.rated and ratio:
                return float(absorber.rated / abs(ratio))
        return None

    @cached_property
    def absorbers(self) -> dict[Input, Absorber]:
        """Absorbers of the load by the place where their torque acts."""
        load = self.definition.load
        return {reacting(self.definition, place): absorber for place, absorber in load.by_place.items()} if load else {}

    @cached_property
    def at_operating_point(self) -> dict[str, float]:
        """Mean external torque in N m, by node, at the operating point: of the load, else as stated there."""
        if self.definition.load is None:
            return stated_torques(self.definition, self.values)
        return self.at(self.operating_speed)

    def at(self, speed: float) -> dict[str, float]:
        """Mean external torque in N m, by node, at a speed > 0 of the reference node in rad/s, all cylinders working.

        Raises
        ------
        UsageError
            A node does not turn with the reference, nobody drives, the speed is outside a table, or there is no load
            and the operating point does not state the torques at this speed.
        """
        if self.definition.load is not None:
            return self._of_load(speed, {})
        stated = stated_torques(self.definition, self.values)
        if not stated or not math.isclose(speed, self.operating_speed):
            raise UsageError(
                "mean torques over speed need the entry load: {absorbed_at: node, power: ..., ...}",
                kind="missing-entry",
            )
        return stated

    def rows(self, speed: float) -> tuple[int, ...]:
        """Numbers of the rows at which the tables of the load's absorbers stand at a speed in rad/s."""
        return tuple(
            bisect_right([pair[0] for pair in absorber.over_speed], abs(self._relative(place) or 0.0) * speed)
            for place, absorber in self.absorbers.items()
            if absorber.over_speed
        )

    def in_condition(self, speeds: Sequence[float]) -> list[dict[str, float]]:
        """Mean external torques in N m, by node, at each speed > 0 in rad/s, with the cylinders lost that are lost.

        What they are is said in :mod:`torsionnet.model.load.lost_torques`; see :meth:`at` for errors.
        """
        remaining = self._remaining(speeds)
        if not remaining:
            return [self.at(speed) for speed in speeds]
        each = zip(*(shares.tolist() for shares in remaining.values()), strict=True)
        return [
            self._of_load(speed, dict(zip(remaining, shares, strict=True)))
            for speed, shares in zip(speeds, each, strict=True)
        ]

    def _remaining(self, speeds: Sequence[float]) -> dict[str, Any]:
        if self.definition.load is None or not self.definition.excitations:
            return {}
        # numpy, which few checks of a model need
        import numpy as np

        from torsionnet.model.load.lost_torques import has_lost_torque, remaining_by_node

        if not has_lost_torque(self.definition):
            return {}
        return remaining_by_node(self.definition, self.ratios, np.array(speeds), self._drivers, self.absorbers)

    def kept_power(self, speed: float) -> float:
        """Power of the load in this condition over that with all cylinders working, at a speed > 0 in rad/s.

        1 where no cylinder is lost, or the load does not say what is.
        """
        if not self._remaining([speed]):
            return 1.0
        (now,), before = self.in_condition([speed]), self.at(speed)
        # Power that drives: torques in the sense of their rotation.
        given = [
            sum(max(torque * self.ratios.get(node, 0.0), 0.0) for node, torque in torques.items())
            for torques in (now, before)
        ]
        return given[0] / given[1] if given[1] else 1.0

    def _of_load(self, speed: float, remaining: Mapping[str, float]) -> dict[str, float]:
        rated = self.definition.speeds.rated if self.definition.speeds else None
        acting: list[tuple[Input, float]] = []
        power = 0.0
        given = {place: share * remaining.get(place.of, 1.0) for place, share in self._drivers.items()}
        # What the drivers lose all absorbers take less, in proportion.
        kept = sum(given.values()) if remaining else 1.0
        for place, absorber in self.absorbers.items():
            ratio = self._ratio(place)
            if absorber.needs_rated and not rated:
                raise UsageError(f"{NEEDS_RATED}, or rated of its own", kind="missing-entry")
            torque = absorber.torque_at(abs(ratio) * speed, abs(ratio) * rated if rated else None)
            torque *= remaining.get(place.of, 1.0)
            # An absorber acts against its rotation.
            acting.append((place, -math.copysign(kept * torque, ratio)))
            power += torque * abs(ratio) * speed
        # T = P/omega at the driver's own speed.
        acting += [(place, share * power / (self._ratio(place) * speed)) for place, share in given.items()]
        return on_nodes(acting)

    @cached_property
    def _drivers(self) -> dict[Input, float]:
        assert self.definition.load is not None
        return drivers(self.definition, self.definition.load)

    def _relative(self, place: Input) -> float | None:
        """Speed of a place against its reaction node over that of the reference node.

        A reaction node without a ratio stands still.
        """
        own = self.ratios.get(place.of)
        if own is None or place.against is None:
            return own
        return own - self.ratios.get(place.against, 0.0)

    def _ratio(self, place: Input) -> float:
        node, ratio = place.of, self._relative(place)
        if ratio:
            return ratio
        if node not in all_nodes(self.definition.active):
            raise CutOffError(f'nothing is attached to "{node}" in this configuration; {UNKNOWN}', kind="no-ratio")
        why = "stands still" if ratio is not None else "turns independently"
        text = f"{node} {why} when {self.reference} turns, so that it can neither drive nor absorb"
        raise CutOffError(f"{text}; {UNKNOWN}", kind="no-ratio")


def mean_torques(external: ExternalTorques) -> dict[str, float]:
    """Mean external torque in N m, by node, at the operating point; empty where the load is cut off."""
    try:
        return external.at_operating_point
    except CutOffError:
        return {}


def stated_torques(definition: Definition, values: Mapping[str, Any]) -> dict[str, float]:
    """Mean external torque in N m, by node, that the operating point gives."""
    stated = definition.operating_point.torque
    return on_nodes((torque_place(text), float(value.evaluate(values))) for text, value in stated.items())
