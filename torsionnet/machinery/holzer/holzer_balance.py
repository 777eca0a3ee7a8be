"""Torques of inertias, springs and rigid connections on all nodes, at one frequency without damping.

The motion is the shape of a mode, or that of a Holzer trial: amplitude 1 at the first station, equilibrium everywhere
but at the last station, where a torque remains.

Lines of a Holzer table through a drivetrain, a main line, and branches that join it. Two nodes with a spring, a shaft,
a gear or a rigid coupling between them follow each other. Elements that close a loop or tie three nodes, as planetary
sets do, are not followed: their torques count at their nodes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import Assembly, FloatArray, refuse_actions
from torsionnet.model.elements.shaft import Shaft

Coefficients = Mapping[str, float]
"""Coefficients of the angles in one spring's twist or one rigid connection, by node."""


@dataclass(frozen=True)
class NodeLoad:
    """Torque of a spring or rigid connection on the nodes of its row, ``torque`` in N m times the coefficient there.

    Each node of its row loses that much.

    ``stiffness`` is infinite for a constraint; ``housing`` is the node that takes the reaction torque of a gear stage,
    if that node moves.
    """

    element: str
    row: Coefficients
    torque: float
    stiffness: float
    housing: str | None = None

    @property
    def ends(self) -> tuple[str, ...]:
        """Nodes between which the torque passes, without the housing that takes a reaction."""
        return tuple(node for node in self.row if node != self.housing)

    @property
    def rigid(self) -> bool:
        """Whether the torque is that of a rigid connection, which has no finite stiffness."""
        return math.isinf(self.stiffness)

    def stiffness_at(self, node: str) -> float:
        """Stiffness in N m/rad referred to a node, with all other nodes held."""
        return self.stiffness * self.row[node] ** 2


@dataclass(frozen=True, eq=False)
class HolzerBalance:
    """Angles (rad), inertias (kg m^2), inertia torques (N m) by node, and torques of springs and rigid links.

    Attributes
    ----------
    angles : mapping
        Node -> angle, rad.
    masses : mapping
        Node -> inertia of the masses at the node alone, kg m^2.
    inertias : mapping
        Node -> inertia with half of that of adjacent shafts, kg m^2.
    distributed_torques : mapping
        Node -> torque of the shafts' own inertia, omega^2 sum(M_ij theta_j), N m.
    loads : tuple of NodeLoad
    """

    angles: Mapping[str, float]
    masses: Mapping[str, float]
    inertias: Mapping[str, float]
    distributed_torques: Mapping[str, float]
    loads: tuple[NodeLoad, ...]


def trial_angles(drivetrain: AssembledModel, omega: float, first: str, last: str) -> FloatArray:
    """Angles (n_nodes,) in rad at omega in rad/s under a torque on ``last`` that turns ``first`` by 1 rad.

    Raises
    ------
    SolveError
        There is no such motion: ``first`` stands still whatever acts on ``last``.
    """
    assembly = drivetrain.assembly
    refuse_actions(assembly.system.actions, "a Holzer table is")
    (stiffness, inertia), rows = _coefficients(assembly, omega), assembly.system.rows
    # D = B^T diag(k - omega^2 J) B, undamped.
    dynamic = rows.T @ ((stiffness - omega**2 * inertia)[:, None] * rows)
    nodes = assembly.node_rows.dense
    start, end = nodes[assembly.node_index[first]], nodes[assembly.node_index[last]]
    scale = max(np.abs(dynamic).max(initial=0), 1e-300)
    # D theta = e_last T and theta_first = 1, with the torque T as a further unknown; D is scaled to the size of the
    # row.
    bordered = np.block([[dynamic / scale, -end[:, None]], [start[None, :], np.zeros((1, 1))]])
    try:
        unknowns = np.linalg.solve(bordered, np.append(np.zeros(len(dynamic)), 1.0))
    except np.linalg.LinAlgError:
        text = f"at {omega / (2 * np.pi):.6g} Hz {first} stands still whatever acts on {last}; start elsewhere"
        raise SolveError(text, kind="no-solution") from None
    return np.asarray(nodes @ unknowns[:-1])


def balance_of(drivetrain: AssembledModel, omega: float, angles: FloatArray, last: str | None = None) -> HolzerBalance:
    """Angles, inertias and torques by node in a motion with these angles (n_nodes,) in rad, at omega in rad/s.

    One torque may remain on ``last``.
    """
    assembly = drivetrain.assembly
    refuse_actions(assembly.system.actions, "a Holzer table is")
    angle = dict(zip(assembly.nodes, angles.tolist(), strict=True))
    masses, inertias = dict.fromkeys(angle, 0.0), dict.fromkeys(angle, 0.0)
    distributed, rest = dict.fromkeys(angle, 0.0), dict.fromkeys(angle, 0.0)
    loads = []
    stiffnesses, own = (part.tolist() for part in _coefficients(assembly, omega))
    numbers = zip(assembly.owners, assembly.laws, stiffnesses, own, strict=True)
    for owner, law, stiffness, inertia in numbers:
        row = {node: float(value) for node, value in law.row.items() if node in angle}
        motion = sum(value * angle[node] for node, value in row.items())
        is_mass = len(row) == 1 and not isinstance(drivetrain.elements[owner], Shaft)
        for node, value in row.items():
            # Row sum of J b b^T where the law is of a shaft: its nodes count as moving alike, which gives half to
            # each end.
            inertias[node] += inertia * value * (sum(row.values()) if _is_shaft(row) else value)
            # A mass has J omega^2 theta; what turns with two nodes, as a shaft does, has omega^2 J gamma b.
            if is_mass:
                masses[node] += inertia * value**2
            else:
                distributed[node] += omega**2 * inertia * motion * value
            # What springs leave of the torques of inertia for rigid connections.
            rest[node] += (omega**2 * inertia - stiffness) * motion * value
        if stiffness:
            housing = _housing(drivetrain.elements[owner])
            loads.append(NodeLoad(owner, row, stiffness * motion, stiffness, housing))
    for owner, held, torque in _of_constraints(assembly, rest, last):
        loads.append(NodeLoad(owner, held, torque, math.inf, _housing(drivetrain.elements[owner])))
    return HolzerBalance(angle, masses, inertias, distributed, tuple(loads))


def _is_shaft(row: Coefficients) -> bool:
    """Whether a row is that of a shaft with inertia, half of which goes to each end."""
    return all(abs(value) == 1 for value in row.values())


def _housing(element: Any) -> str | None:
    return getattr(element, "housing", None)


def _of_constraints(
    assembly: Assembly, rest: Mapping[str, float], last: str | None
) -> list[tuple[str, Coefficients, float]]:
    """Owner, row and torque in N m of each rigid connection, from the balance of all other torques at the nodes."""
    rows = [
        (owner, {node: float(value) for node, value in row.items() if node in rest})
        for owner, row in assembly.kinematics.constraints
    ]
    if not rows:
        return []
    # sum_c T_c row_c = rest at every node but the last one, at which a trial frequency leaves a torque over.
    places = {node: place for place, node in enumerate(node for node in rest if node != last)}
    matrix, right = np.zeros((len(places), len(rows))), np.zeros(len(places))
    for node, place in places.items():
        right[place] = rest[node]
    for column, (_, row) in enumerate(rows):
        for node, value in row.items():
            if node in places:
                matrix[places[node], column] = value
    # The equations of all nodes agree: least squares solves them although they are more than the links.
    multipliers = np.linalg.lstsq(matrix, right, rcond=None)[0].tolist()
    return [(owner, row, torque) for (owner, row), torque in zip(rows, multipliers, strict=True)]


def _coefficients(assembly: Assembly, omega: float) -> tuple[FloatArray, FloatArray]:
    """Stiffness in N m/rad and inertia in kg m^2 of all laws, (n_laws,), real, at omega in rad/s.

    The ends of a continuous shaft count as inertias.
    """
    stiffness, inertia = assembly.system.stiffness.copy(), assembly.system.inertia.copy()
    for law, table in assembly.system.dynamic:
        # A Holzer table has no damping: the real part at this frequency.
        kappa = table.with_loss(0).kappa(np.array([omega])).real.item()
        if table.is_elastic:
            stiffness[law] += kappa
        else:
            # kappa = -omega^2 J at the ends of a continuous shaft.
            inertia[law] += -kappa / omega**2 if omega else table.inertia_at_rest
    return stiffness, inertia


# Lines of a Holzer table through a drivetrain, a main line, and branches that join it.

Neighbours = Mapping[str, Mapping[str, tuple[NodeLoad, ...]]]
"""Torques of the elements between two neighbouring nodes, by node and neighbour."""


@dataclass(frozen=True)
class HolzerLine:
    """Names of the nodes on a line of a Holzer table from its free end, and of the node that a branch joins.

    ``joins`` is empty for a main line.
    """

    nodes: tuple[str, ...]
    joins: str = ""

    def steps(self) -> Iterator[tuple[str, str]]:
        """Yield every node with its successor, which is empty after the last node of a main line."""
        yield from zip(self.nodes, (*self.nodes[1:], self.joins), strict=True)


def holzer_lines(
    nodes: Sequence[str], loads: Iterable[NodeLoad], first: str | None
) -> tuple[list[HolzerLine], Neighbours]:
    """Main lines and branches of a Holzer table, by names of nodes, and the torque laws between neighbouring nodes."""
    tree = _tree(nodes, loads)
    lines: list[HolzerLine] = []
    seen: set[str] = set()
    for node in ([first] if first else []) + list(nodes):
        if node not in seen:
            start = node if node == first else _first_end(tree, node, nodes)
            # The main line is the longest way from the start; what leaves it are branches.
            main = _farthest(tree, start, set())
            lines += _with_branches(tree, HolzerLine(tuple(main)), set(main))
            seen |= {node for line in lines for node in line.nodes}
    return lines, tree


def _tree(nodes: Sequence[str], loads: Iterable[NodeLoad]) -> dict[str, dict[str, tuple[NodeLoad, ...]]]:
    """Torques between neighbouring nodes, by node and neighbour, without elements that would close a loop."""
    tree: dict[str, dict[str, tuple[NodeLoad, ...]]] = {node: {} for node in nodes}
    home = {node: node for node in nodes}
    for load in loads:
        if len(load.ends) != 2:
            continue
        near, other = load.ends
        if other in tree[near]:
            tree[near][other] = tree[other][near] = (*tree[near][other], load)
        # Kruskal: an element between nodes that are connected already would close a loop.
        elif _root(home, near) != _root(home, other):
            home[_root(home, near)] = _root(home, other)
            tree[near][other] = tree[other][near] = (load,)
    return tree


def _root(home: dict[str, str], node: str) -> str:
    while home[node] != node:
        home[node] = home[home[node]]
        node = home[node]
    return node


def _first_end(tree: Neighbours, node: str, nodes: Sequence[str]) -> str:
    """Name of the first free end, in the order of the model, among the nodes connected to a node."""
    there = set(_connected(tree, node))
    return next((end for end in nodes if end in there and len(tree[end]) == 1), node)


def _connected(tree: Neighbours, node: str) -> Iterator[str]:
    stack: list[tuple[str, str]] = [(node, "")]
    while stack:
        here, before = stack.pop()
        yield here
        stack += [(other, here) for other in tree[here] if other != before]


def _farthest(tree: Neighbours, start: str, barred: set[str]) -> list[str]:
    """Names of the nodes on the longest path from a node that passes no barred node."""
    before = {start: ""}
    order = [start]
    # Breadth first: the last node reached is the farthest.
    for node in order:
        for other in tree[node]:
            if other not in before and other not in barred:
                before[other] = node
                order.append(other)
    node, way = order[-1], []
    while node:
        way.append(node)
        node = before[node]
    return way[::-1]


def _with_branches(tree: Neighbours, line: HolzerLine, taken: set[str]) -> Iterator[HolzerLine]:
    yield line
    for node in line.nodes:
        for other in tree[node]:
            if other not in taken:
                way = _farthest(tree, other, taken)[::-1]
                taken |= set(way)
                yield from _with_branches(tree, HolzerLine(tuple(way), joins=node), taken)
