"""Continued fraction of a transfer function on a drivetrain without loops, as an engineer writes it by hand.

Seen from the root, a branch with the edge y and Z_c behind it is as flexible as both in series,

    1/Z_branch = 1/y + 1/Z_c,   Z_v = g_v + sum of Z_branch,

and a motion is handed on along the path by y/(y + Z_c). Where nothing but one branch hangs on a coordinate its
receptance is that of the branch: ``theta_1/T_T = 1/(k_1 + c_1 s) + 1/(I_2 s^2 + (c_2 + c_B) s + k_2)``.

A shaft with inertia of its own is written as a spring k + c s - J s^2/6 between two inertias J/2: the same dynamic
stiffness, in which everything appears once.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from torsionnet.symbolic.algebra.block_tree import GraphBlock, is_forest, orient
from torsionnet.symbolic.algebra.network import (
    ONE,
    Network,
    NetworkMember,
    Stiffness,
    SymbolRow,
    add_parallel_laws,
    reflected_sum,
    vanishes,
)
from torsionnet.symbolic.symbolic_sensors import Mechanism, SymbolicPart


class NoContinuedFractionError(Exception):
    """Error raised where no continued fraction exists, with closed loops or a torque on several coordinates."""


@dataclass
class ContinuedFraction:
    """Receptance of every coordinate of a network without loops, as continued fractions seen from ``root``.

    ``element`` turns laws and ratios into what the fraction is made of: sympy expressions, or steps of a program.
    """

    network: Network[Stiffness]
    root: str
    element: Callable[[Any], Any]
    receptance: dict[str, Any] = field(default_factory=dict)
    flexibility: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.tree = orient(self.network, self.root)
        for name in reversed(self.tree.order):
            self._eliminate(name)

    def _eliminate(self, name: str) -> None:
        """Store the receptance of a coordinate from those of its branches, None where nothing holds it."""
        found = []
        for block in self.tree.below[name]:
            (child,), (member,) = block.below, block.members
            if self.receptance[child] is not None:
                series = self._one / self.element(member.law) + self._squared(member, child) * self.receptance[child]
                self.flexibility[child] = series / self._squared(member, name)
                found.append(self.flexibility[child])
        grounds = self.network.grounds.get(name, [])
        if not grounds and len(found) == 1:
            self.receptance[name] = found[0]
            return
        total = self.element(grounds[0]) if grounds else None
        for flexibility in found:
            total = self._one / flexibility if total is None else total + self._one / flexibility
        self.receptance[name] = None if total is None else self._one / total

    @property
    def _one(self) -> Any:
        return self.element(1)

    def _squared(self, member: NetworkMember[Stiffness], name: str) -> Any:
        return self.element(member.row[name] ** 2)

    def motion(self, end: str) -> Any:
        """Ratio of the motion of the coordinate ``end`` to the motion at the root, in the fraction's algebra."""
        result = self._one
        for block, far in self.tree.path(end):
            result = result * self._handed_on(block, far)
        return result

    def _handed_on(self, block: GraphBlock[Stiffness], far: str) -> Any:
        (member,) = block.members
        ratio = self.element(-member.row[block.top] / member.row[far])
        if self.receptance[far] is None:
            return ratio
        y = self.element(member.law) * self._squared(member, far)
        return ratio * (y / (y + self._one / self.receptance[far]))

    def reading(self, row: SymbolRow, law: Any = None) -> Any:
        """Ratio of a reading, row theta times a law, to the motion at the root, in the fraction's algebra."""
        row = {name: value for name, value in row.items() if name in self.tree.below}
        for child in row if len(row) == 2 else ():
            block = self.tree.above.get(child)
            if block and block.top in row and _parallel(row, block.members[0].row):
                return self._torque(block, row[block.top], law)
        total = self.element(0)
        for name, value in row.items():
            total = total + self.element(value) * self.motion(name)
        return total if law is None else self.element(law) * total

    def _torque(self, block: GraphBlock[Stiffness], scale: Any, law: Any) -> Any:
        """Torque of ``law`` on an edge (twist without law) over the root motion, times ``scale``, as expression."""
        (child,), (member,) = block.below, block.members
        if child not in self.flexibility:
            return self.element(0)
        carried = self.motion(block.top) * self.element(scale / member.row[block.top] ** 2)
        torque = carried * (self._one / self.flexibility[child])
        if law is not None and law == member.law:
            return torque
        twist = torque / self.element(member.law)
        return twist if law is None else twist * self.element(law)


def _parallel(row: SymbolRow, other: SymbolRow) -> bool:
    first, second = row
    return vanishes(row[first] * other[second] - row[second] * other[first])


def single_edges(network: Network[Stiffness]) -> Network[Stiffness]:
    """Network with all laws between two coordinates combined into one edge, and laws to ground at both ends.

    With the edge on the row (a_v, a_c) and t = b_v b_c / (a_v a_c), a law y on another row (b_v, b_c) adds t y to the
    edge, and y (b_x^2 - t a_x^2) to ground at each end.
    """
    first: dict[frozenset[str], SymbolRow] = {}
    members = []
    for member in add_parallel_laws(network, reflected_sum).members:
        row = first.setdefault(frozenset(member.row), member.row)
        if len(row) != 2 or row is member.row:
            members.append(member)
            continue
        v, c = row
        share = member.row[v] * member.row[c] / (row[v] * row[c])
        members.append(NetworkMember(row, _times(member.law, share)))
        members += [NetworkMember({x: ONE}, _times(member.law, member.row[x] ** 2 - share * row[x] ** 2)) for x in row]
    found = add_parallel_laws(Network(network.coordinates, tuple(members)), reflected_sum)
    acting = (member for member in found.members if not all(map(vanishes, member.law.parts)))
    return Network(network.coordinates, tuple(acting))


def _times(law: Stiffness, factor: Any) -> Stiffness:
    return Stiffness(*(part * factor for part in law.parts))


def response(
    mechanism: Mechanism,
    parts: Collection[SymbolicPart],
    load: Mapping[str, int],
    element: Callable[[Any], Any],
    *,
    shift: bool = False,
) -> tuple[Any, Any]:
    """Continued fractions of a reading over the motion at the root, and of the root's receptance, under a torque.

    With ``shift``, a torque on a coordinate without inertia is moved along the only edge there, to where it arrives.

    Raises
    ------
    NoContinuedFractionError
        There are closed loops, or the torque acts on several coordinates.
    """
    found = mechanism.reduced([mechanism.row(load)])
    network, loaded = single_edges(found.network), found.rows[0]
    if len(loaded) != 1 or not is_forest(network):
        raise NoContinuedFractionError
    ((root, share),) = loaded.items()
    rows = [mechanism.reduced([mechanism.row(part.row)]).rows[0] for part in parts]
    if shift and not any(part.rigid is not None for part in parts):
        root, share = _arrival(network, root, share, {name for row in rows for name in row})
    tree = ContinuedFraction(network, root, element)
    if tree.receptance[root] is None:
        raise NoContinuedFractionError
    total = element(0)
    for part, row in zip(parts, rows, strict=True):
        if part.rigid is None:
            value = tree.reading(row, part.law)
        else:
            value = _handed_through(mechanism, part.rigid, tree, load, element)
        for _ in range(part.power):
            value = value * element("s")
        total = total + element(part.factor) * value
    return total, element(share) * tree.receptance[root]


def _arrival(network: Network[Stiffness], root: str, share: Any, read: Collection[str]) -> tuple[str, Any]:
    """Coordinate to which a torque is moved by single edges, up to inertia or the first one read, and its torque."""
    came = ""
    while root not in network.grounds and root not in read:
        rows = [member.row for member in network.members if root in member.row and came not in member.row]
        if len(rows) != 1:
            break
        (end,) = (name for name in rows[0] if name != root)
        share = -rows[0][end] / rows[0][root] * share
        came, root = root, end
    return root, share


def _handed_through(
    mechanism: Mechanism, rigid: int, tree: ContinuedFraction, load: Mapping[str, int], element: Callable[[Any], Any]
) -> Any:
    """Torque through a rigid connection over the motion at the root, the reaction of the side beyond it."""
    found = mechanism.reduced([mechanism.row(load)], rigid)
    network, (loaded, row) = single_edges(found.network), found.rows
    near = set(orient(network, next(iter(loaded))).order) if len(loaded) == 1 else set()
    away = [name for name in row if name not in near]
    if not is_forest(network) or len(away) != 1:
        raise NoContinuedFractionError
    side = ContinuedFraction(network, away[0], element)
    receptance = side.receptance[away[0]]
    if receptance is None:
        return element(0)
    moved = mechanism.reduced([{away[0]: row[away[0]] ** 0}]).rows[0]
    return element(-1 / row[away[0]]) * tree.reading(moved) / receptance
