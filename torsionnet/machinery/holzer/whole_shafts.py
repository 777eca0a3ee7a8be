"""Shafts that a model divides into segments, put together again for tables of masses and shafts."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.holzer.holzer_lines import Neighbours
from torsionnet.machinery.holzer.mass_elastic_table import MassElasticShaft


@dataclass(frozen=True)
class HiddenNodes:
    """Nodes inside of divided shafts, and the inertia in kg m^2 that each end of the shafts takes over from them.

    Attributes
    ----------
    names : frozenset of str
    shares : mapping
        Node -> inertia.
    """

    names: frozenset[str] = frozenset()
    shares: Mapping[str, float] = field(default_factory=dict)


def hidden_nodes(drivetrain: AssembledModel, tree: Neighbours, inertias: Mapping[str, float]) -> HiddenNodes:
    """Inner nodes of the divided shafts of a drivetrain, each split on the two ends of its shaft by its place.

    A node at the share x of the shaft's flexibility gives 1 - x of its inertia to the first end and x to the other, as
    if the shaft twisted evenly; the sum stays. A shaft that closes a loop stays divided.
    """
    names: set[str] = set()
    shares: dict[str, float] = {}
    for element in drivetrain.elements.values():
        inner = element.internal_nodes if hasattr(element, "segments") else ()
        chain = _chain(tree, inner) if inner and set(inner) <= tree.keys() else []
        if not chain:
            continue
        steps = [1 / sum(load.stiffness_at(one) for load in tree[one][other]) for one, other in pairwise(chain)]
        names |= set(inner)
        for place, node in enumerate(chain[1:-1], 1):
            share = sum(steps[:place]) / sum(steps)
            for end, part in ((chain[0], 1 - share), (chain[-1], share)):
                shares[end] = shares.get(end, 0.0) + part * inertias[node]
    return HiddenNodes(frozenset(names), shares)


def _chain(tree: Neighbours, inner: Sequence[str]) -> list[str]:
    """Nodes of a shaft from end to end through its inner nodes; empty where these do not stand in one elastic line."""
    first = next((node for node in inner if len(set(tree[node]) - set(inner)) >= 1), None)
    if first is None:
        return []
    chain = [next(one for one in tree[first] if one not in inner), first]
    while chain[-1] in inner:
        onward = [one for one in tree[chain[-1]] if one != chain[-2]]
        if len(onward) != 1 or any(load.rigid for load in tree[chain[-1]][onward[0]]):
            return []
        chain += onward
    return chain if set(inner) <= set(chain) else []


def whole_shaft(parts: Sequence[MassElasticShaft]) -> MassElasticShaft:
    """Connection equivalent to several in series, of stiffness 1/sum(1/k) in N m/rad and with the sum of their losses.

    Damping is the one with the same loss at an even twist, k^2 sum(c_i/k_i^2), the loss factor k sum(eta_i/k_i).

    Examples
    --------
    >>> half = MassElasticShaft(("line",), "b", 8e6, damping=40.0)
    >>> both = whole_shaft([half, half])
    >>> both.stiffness, both.damping, both.segments
    (4000000.0, 20.0, 2)
    """
    if len(parts) == 1:
        return parts[0]
    stiffness = 1 / sum(1 / one.stiffness for one in parts)
    return replace(
        parts[0],
        to=parts[-1].to,
        stiffness=stiffness,
        damping=stiffness**2 * sum(one.damping / one.stiffness**2 for one in parts),
        loss_factor=stiffness * sum(one.loss_factor / one.stiffness for one in parts),
        segments=len(parts),
    )


def shown_steps(
    steps: Sequence[tuple[str, str]], hidden: Container[str]
) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Yield every shown node of a line with the steps (node, next node) to the next shown one; none after the last.

    Examples
    --------
    >>> list(shown_steps([("a", "s.1"), ("s.1", "b"), ("b", "")], {"s.1"}))
    [('a', [('a', 's.1'), ('s.1', 'b')]), ('b', [])]
    """
    rows: list[tuple[str, list[tuple[str, str]]]] = []
    for node, after in steps:
        if node not in hidden:
            rows.append((node, []))
        if after:
            rows[-1][1].append((node, after))
    yield from rows
