"""The continued fraction an engineer writes by hand.

Seen from the root, a branch with the edge y and Z_c behind it is as flexible as both in series,

    1/Z_branch = 1/y + 1/Z_c,   Z_v = g_v + sum of Z_branch,

and a motion is handed on along the path by y/(y + Z_c). Where nothing but one branch hangs on a coordinate its
receptance is that of the branch: ``theta_1/T_T = 1/(k_1 + c_1 s) + 1/(I_2 s^2 + (c_2 + c_B) s + k_2)``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import sympy

from torsionnet.symbolics.blocks import Block, is_forest, orient
from torsionnet.symbolics.network import Network, Stiffness, SymbolRow, added_up, reflected, vanishes
from torsionnet.symbolics.readings import Mechanism, Part


class NoContinuedFractionError(Exception):
    """The drivetrain or the question is not that of a tree."""


@dataclass
class Continued:
    """Receptances of every coordinate of the tree on ``root``, seen from there.

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
        """None stands for a coordinate nothing holds, and for a branch that holds nothing."""
        found = []
        for block in self.tree.below[name]:
            (child,) = block.below
            flexibility = Branch(block, self.element).flexibility(self.receptance[child])
            if flexibility is not None:
                self.flexibility[child] = flexibility
                found.append(flexibility)
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

    def motion(self, end: str) -> Any:
        """Motion at ``end`` over motion at the root."""
        result = self._one
        for block, far in self.tree.path(end):
            result = result * Branch(block, self.element).handed_on(self.receptance[far])
        return result

    def reading(self, row: SymbolRow, law: Any = None) -> Any:
        """Row theta, times a law, over the motion at the root."""
        row = {name: value for name, value in row.items() if name in self.tree.below}
        for child in row if len(row) == 2 else ():  # noqa: PLR2004
            block = self.tree.above.get(child)
            if block and block.top in row and len(block.members) == 1 and _parallel(row, block.members[0].row):
                return self._torque(block, row[block.top], law)
        total = self.element(0)
        for name, value in row.items():
            total = total + self.element(value) * self.motion(name)
        return total if law is None else self.element(law) * total

    def _torque(self, block: Block[Stiffness], scale: Any, law: Any) -> Any:
        """The law times the twist of an edge, times scale over the coefficient of the parent."""
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


@dataclass(frozen=True)
class Branch:
    """What a bundle and the receptance behind it are to its upper coordinate; see :mod:`torsionnet.symbolics.bundle`.

    A single edge is in series with what is behind it. With inertia of its own a shaft answers

        1/Z_branch = (1 + W_cc/Z_c) / (W_vv + W/Z_c)

    with W_xz = sum y_e a_ex a_ez and W = sum y_e y_f (a_ev a_fc - a_fv a_ec)^2.
    """

    block: Block[Stiffness]
    element: Callable[[Any], Any]

    def flexibility(self, behind: Any) -> Any:
        """Motion of the upper coordinate over the torque there, None where nothing is held."""
        top, (child,) = self.block.top, self.block.below
        if len(self.block.members) == 1:
            ((near, far),) = self._rows
            if behind is None:
                return None
            series = self.element(1) / self.element(self.block.members[0].law) + self.element(far**2) * behind
            return series / self.element(near**2)
        own, across = self._sum(child, child), self._across()
        if behind is None:
            return None if across is None else own / across
        held = self._sum(top, top) if across is None else self._sum(top, top) + across * behind
        return (self.element(1) + own * behind) / held

    def handed_on(self, behind: Any) -> Any:
        """Motion of the lower coordinate over that of the upper one."""
        top, (child,) = self.block.top, self.block.below
        if len(self.block.members) == 1:
            ((near, far),) = self._rows
            ratio = self.element(-near / far)
            y = self.element(self.block.members[0].law) * self.element(far**2)
            return ratio if behind is None else ratio * (y / (y + self.element(1) / behind))
        held = self._sum(child, child)
        return self.element(-1) * self._sum(top, child) / (held if behind is None else held + self.element(1) / behind)

    @property
    def _rows(self) -> list[tuple[Any, Any]]:
        (child,) = self.block.below
        return [(member.row[self.block.top], member.row[child]) for member in self.block.members]

    def _sum(self, first: str, second: str) -> Any:
        """Sum of y a_x a_z, one law with the coefficients collected."""
        laws = [(member.law, member.row[first] * member.row[second]) for member in self.block.members]
        parts = (sympy.Add(*(law.parts[i] * factor for law, factor in laws)) for i in range(3))
        return self.element(Stiffness(*parts))

    def _across(self) -> Any:
        total = None
        for (one, (a, b)), (other, (c, d)) in combinations(zip(self.block.members, self._rows, strict=True), 2):
            if not vanishes(a * d - c * b):
                both = self.element((a * d - c * b) ** 2) * self.element(one.law) * self.element(other.law)
                total = both if total is None else total + both
        return total


def response(
    mechanism: Mechanism, parts: Collection[Part], node: str, element: Callable[[Any], Any], *, shift: bool = False
) -> tuple[Any, Any]:
    """(A reading over the motion at the root, the receptance at the root) under a torque on a node.

    With ``shift``, a torque on a coordinate without inertia is moved along the only edge there, to where it arrives.

    Raises
    ------
    NoContinuedFractionError
        There are closed loops, or the torque acts on several coordinates.
    """
    found = mechanism.reduced([mechanism.row({node: 1})])
    network, load = added_up(found.network, reflected), found.rows[0]
    if len(load) != 1 or not is_forest(network):
        raise NoContinuedFractionError
    ((root, share),) = load.items()
    rows = [mechanism.reduced([mechanism.row(part.row)]).rows[0] for part in parts]
    if shift and not any(part.rigid is not None for part in parts):
        root, share = _arrival(network, root, share, {name for row in rows for name in row})
    tree = Continued(network, root, element)
    if tree.receptance[root] is None:
        raise NoContinuedFractionError
    total = element(0)
    for part, row in zip(parts, rows, strict=True):
        if part.rigid is None:
            value = tree.reading(row, part.law)
        else:
            value = _handed_through(mechanism, part.rigid, tree, node, element)
        for _ in range(part.power):
            value = value * element("s")
        total = total + element(part.factor) * value
    return total, element(share) * tree.receptance[root]


def _arrival(network: Network[Stiffness], root: str, share: Any, read: Collection[str]) -> tuple[str, Any]:
    """Where a torque on a coordinate that holds nothing itself arrives, short of what is read."""
    came = ""
    while root not in network.grounds and root not in read:
        rows = [member.row for member in network.members if root in member.row and came not in member.row]
        if len(rows) != 1:
            break
        (end,) = (name for name in rows[0] if name != root)
        share = -rows[0][end] / rows[0][root] * share
        came, root = root, end
    return root, share


def _handed_through(mechanism: Mechanism, rigid: int, tree: Continued, node: str, element: Callable[[Any], Any]) -> Any:
    """The torque a rigid connection hands on: what the side away from the root answers to its motion there."""
    found = mechanism.reduced([mechanism.row({node: 1})], rigid)
    network, (load, row) = added_up(found.network, reflected), found.rows
    near = set(orient(network, next(iter(load))).order) if len(load) == 1 else set()
    away = [name for name in row if name not in near]
    if not is_forest(network) or len(away) != 1:
        raise NoContinuedFractionError
    side = Continued(network, away[0], element)
    receptance = side.receptance[away[0]]
    if receptance is None:
        return element(0)
    moved = mechanism.reduced([{away[0]: row[away[0]] ** 0}]).rows[0]
    return element(-1 / row[away[0]]) * tree.reading(moved) / receptance
