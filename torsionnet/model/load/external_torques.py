"""Mean torques from outside on the nodes of a drivetrain: of its load over speed, or of its operating point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from torsionnet.core.errors import UsageError, meant_or
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.load.load_section import Load
from torsionnet.model.speeds import mean_speeds, speeds_with

UNKNOWN = "the load determines no mean torques here"

ENGINE = "reciprocating_engine"
"""The type of excitation that drives where nothing else is said."""

NEEDS_RATED = "what follows the speed, as the load does, needs the rated speed: speeds: {of: node, rated: 750 rpm, ...}"


class CutOffError(UsageError):
    """A driver or absorber does not turn with the reference node in this configuration, as behind an open clutch."""


def reference_node(definition: Definition) -> str:
    """The node whose speed is meant where a load follows the speed: that of ``speeds:``, else the first absorber."""
    if definition.speeds is not None:
        return str(definition.speeds.of)
    return next(iter(definition.load.by_node)) if definition.load else ""


@dataclass(frozen=True, eq=False)
class ExternalTorques:
    """The mean torques on a drivetrain over its speed: of its load, else those its operating point states.

    ``values`` are those of the parameters. A driver's torque has the sign of the rotation of its node, an absorber's
    the opposite one; the reference node turns in the positive sense. Power is shared, so that drivers of unlike speeds
    have unlike torques.
    """

    definition: Definition
    values: Mapping[str, Any]

    @property
    def reference(self) -> str:
        return reference_node(self.definition)

    @cached_property
    def mean_speeds(self) -> dict[str, float]:
        """Speed in rad/s of every node that the operating point determines.

        Raises
        ------
        ModelError
            The speeds of the operating point do not fit the ratios.
        """
        return mean_speeds(self.definition, self.values) if self.definition.operating_point.speed else {}

    @cached_property
    def ratios(self) -> dict[str, float]:
        """Speed of every node over that of the reference, where it follows."""
        speeds = speeds_with(self.definition, self.values, self.reference, self.mean_speeds)
        own = speeds.get(self.reference)
        return {node: speed / own for node, speed in speeds.items()} if own else {}

    @cached_property
    def operating_speed(self) -> float:
        """Speed of the reference in rad/s about which the model is linear: the operating point's, else the rated one.

        Raises
        ------
        UsageError
            Nothing says it.
        """
        definition = self.definition
        rated = definition.speeds.rated if definition.speeds else None
        found = self.mean_speeds.get(self.reference) or rated or self._rated_of_absorber()
        if not found:
            raise UsageError(NEEDS_RATED)
        return float(found)

    def _rated_of_absorber(self) -> float | None:
        """The reference's speed at which the first absorber with a rated speed of its own has that."""
        for node, absorber in self.definition.load.by_node.items() if self.definition.load else ():
            if absorber.rated and self.ratios.get(node):
                return float(absorber.rated / abs(self.ratios[node]))
        return None

    @cached_property
    def at_operating_point(self) -> dict[str, float]:
        """Torques in N m by node at the operating point: of the load, else as stated there."""
        if self.definition.load is None:
            return stated_torques(self.definition, self.values)
        return self.at(self.operating_speed)

    def at(self, speed: float) -> dict[str, float]:
        """Torques in N m by node at a speed > 0 of the reference in rad/s.

        Raises
        ------
        UsageError
            A node does not turn with the reference, nobody drives, the speed is outside a table, or there is no load
            and the operating point does not state the torques at this speed.
        """
        if self.definition.load is not None:
            return self._of_load(speed, self.definition.load)
        stated = stated_torques(self.definition, self.values)
        if not stated or not math.isclose(speed, self.operating_speed):
            raise UsageError("mean torques over speed need the entry load: {absorbed_at: node, power: ..., ...}")
        return stated

    def _of_load(self, speed: float, load: Load) -> dict[str, float]:
        rated = self.definition.speeds.rated if self.definition.speeds else None
        torques: dict[str, float] = {}
        power = 0.0
        for node, absorber in load.by_node.items():
            ratio = self._ratio(node)
            if absorber.needs_rated and not rated:
                raise UsageError(f"{NEEDS_RATED}, or rated of its own")
            torque = absorber.torque_at(abs(ratio) * speed, abs(ratio) * rated if rated else None)
            torques[node] = torques.get(node, 0.0) - math.copysign(torque, ratio)
            power += torque * abs(ratio) * speed
        for node, share in self._drivers.items():
            torques[node] = torques.get(node, 0.0) + share * power / (self._ratio(node) * speed)
        return torques

    @cached_property
    def _drivers(self) -> dict[str, float]:
        assert self.definition.load is not None
        return drivers(self.definition, self.definition.load)

    def _ratio(self, node: str) -> float:
        ratio = self.ratios.get(node)
        if ratio:
            return ratio
        if node not in all_nodes(self.definition.active):
            raise CutOffError(f'nothing is attached to "{node}" in this configuration; {UNKNOWN}')
        why = "stands still" if ratio is not None else "turns independently"
        text = f"{node} {why} when {self.reference} turns, so that it can neither drive nor absorb"
        raise CutOffError(f"{text}; {UNKNOWN}")


def drivers(definition: Definition, load: Load) -> dict[str, float]:
    """Share of the power by node; that of an engine is spread evenly over its cylinders.

    Raises
    ------
    UsageError
        Nobody is named, and the model has not exactly one engine.
    """
    shares = dict(load.driven_by)
    if not shares:
        engines = [name for name, one in definition.excitations.items() if one.kind == ENGINE]
        if len(engines) != 1:
            raise UsageError("say who drives: driven_by: {node: 1}, or the name of an excitation")
        shares = {engines[0]: 1.0}
    found: dict[str, float] = {}
    for name, share in shares.items():
        nodes = (
            [node for _, node in definition.excitations[name].node_entries]
            if name in definition.excitations
            else [name]
        )
        for node in nodes:
            found[node] = found.get(node, 0.0) + share / len(nodes)
    return found


def unknown_driver(definition: Definition, name: str) -> str | None:
    """Why ``name`` cannot drive, or None."""
    nodes = all_nodes(definition.elements.values())
    if name in definition.excitations or name in nodes:
        return None
    known = [*definition.excitations, *nodes]
    return f'no node or excitation is named "{name}"{meant_or(name, known, "driven_by has nodes or excitations")}'


def mean_torques(external: ExternalTorques) -> dict[str, float]:
    """Mean external torque in N m by node at the operating point: of the load, else as the operating point gives it.

    None where the load is cut off.
    """
    try:
        return external.at_operating_point
    except CutOffError:
        return {}


def stated_torques(definition: Definition, values: Mapping[str, Any]) -> dict[str, float]:
    """Mean external torque in N m on the nodes for which the operating point gives one."""
    return {node: float(value.evaluate(values)) for node, value in definition.operating_point.torque.items()}
