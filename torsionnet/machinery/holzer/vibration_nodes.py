"""Nodes of vibration of a mode, the places at rest between masses that swing against each other."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.result_rows import Out
from torsionnet.machinery.holzer.holzer_table import HolzerStation, HolzerTable

STANDING_SHARE = 1e-6
"""Ratio of a mass's amplitude to that of its neighbour up to which the mass itself counts as the node: what rounding
leaves of a mode that is symmetric about a mass."""

ROUNDED_SHARE = 1e-10
"""Ratio of a mass's amplitude to the largest one of the mode below which it is rounding and has no sign."""


@dataclass(frozen=True)
class VibrationNode:
    """Place at rest in a mode, as a share of the compliance between two masses, with the names of both masses.

    Attributes
    ----------
    first, second : str
        Masses on both sides; the same for a mass at rest.
    elements : tuple of str
        Elements between these masses; empty for a mass at rest.
    position : float
        Share of the twist between them that lies before the node, seen from ``first``: of a uniform shaft the share of
        its length.
    """

    first: Annotated[str, Out("from")]
    second: Annotated[str, Out("to")]
    elements: tuple[str, ...]
    position: Annotated[float, Out("node at", "%", digits=3, factor=100)]


def vibration_nodes(holzer: HolzerTable) -> tuple[VibrationNode, ...]:
    """Nodes of vibration along the lines of a Holzer table, each with its place between two masses.

    Along a spring between two masses the angle is linear in the compliance, so that the node lies at
    ``theta_1 / (theta_1 - theta_2)`` of the compliance, both angles referred to one shaft.

    Parameters
    ----------
    holzer : HolzerTable
        Of a mode. Connections that a Holzer table does not follow, as planetary sets, have no node here.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> [(one.first, one.second, round(one.position, 6))
    ...     for one in vibration_nodes(tn.Drivetrain("fan", elements).holzer_table(1))]
    [('a', 'b', 0.333333)]
    """
    found = []
    rounding = ROUNDED_SHARE * max(abs(one.amplitude) for branch in holzer.branches for one in branch.stations)
    rests: dict[str, set[int]] = {}
    for here, after in _links(holzer):
        assert here.link is not None
        near, far = (one if abs(one) > rounding else 0.0 for one in (here.amplitude, after.amplitude * here.link.ratio))
        limit = STANDING_SHARE * max(abs(near), abs(far))
        if here.link.rigid or not limit:
            continue
        if near * far < 0 and min(abs(near), abs(far)) > limit:
            found.append(VibrationNode(here.node, after.node, here.link.elements, near / (near - far)))
        # The sense of a neighbour is seen on the shaft of the mass at rest.
        for node, own, other in ((here.node, near, far), (after.node, far, near)):
            if abs(own) <= limit:
                forwards = other > 0 if node == here.node else other * here.link.ratio > 0
                rests.setdefault(node, set()).add(1 if forwards else -1)
    still = (VibrationNode(node, node, (), 0.0) for node, senses in rests.items() if len(senses) > 1)
    return (*found, *still)


def _links(holzer: HolzerTable) -> Iterator[tuple[HolzerStation, HolzerStation]]:
    """Yield pairs of neighbouring stations of a Holzer table, in a branch up to the station that it joins."""
    for branch in holzer.branches:
        stations = list(branch.stations)
        if branch.joins:
            stations.append(holzer.station(branch.joins))
        for here, after in itertools.pairwise(stations):
            if here.link is not None:
                yield here, after
