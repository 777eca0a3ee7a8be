"""Mean torques of laws that equilibrium alone gives, exact as the torques from outside are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from torsionnet.model.elements import Row
from torsionnet.model.elimination import reduce_rows
from torsionnet.model.kinematics import UNIT, exact_row
from torsionnet.model.law_network import LawNetwork, PlacedMotionLaw

MOST_LAWS = 40
"""Largest number of laws whose torque is sought by opening each of them, an elimination for every law."""


def determinate_torques(network: LawNetwork, external: Mapping[str, Fraction]) -> dict[PlacedMotionLaw, Fraction]:
    """Mean torque in N m of each law over the twist, of those that share it with nothing else, from torques by node.

    It is the work of the external torques on the virtual motion that opens the law by one and leaves everything else
    without twist. Torques that leave something over are taken where the free motions are held.
    """
    if len(network.over_twist) > MOST_LAWS:
        return {}
    found = {}
    for law in network.over_twist:
        motion = virtual_opening(network, law)
        if motion is not None:
            found[law] = sum((torque * motion.get(node, 0) for node, torque in external.items()), start=Fraction(0))
    return found


def virtual_opening(network: LawNetwork, opened: PlacedMotionLaw) -> dict[str, Fraction] | None:
    """Virtual motion of the nodes that opens a law by one and nothing else; None where others have to open with it."""
    rows: list[Row] = [exact_row(row) for row in network.held]
    rows += [exact_row(law.row) for _, law in network.elastic]
    rows += [exact_row(one.law.row) for one in network.over_twist if one is not opened]
    rows += [{node: Fraction(1)} for node in network.free_motions]
    return _motion_of([*rows, {**exact_row(opened.law.row), UNIT: Fraction(-1)}], network)


def _motion_of(rows: Iterable[Row], network: LawNetwork) -> dict[str, Fraction] | None:
    reduction = reduce_rows(rows, network.order, {UNIT})
    if reduction.blocked:
        return None
    return {node: row[UNIT] for node, row in reduction.solved.items() if UNIT in row}
