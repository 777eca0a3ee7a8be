"""Symbolic drivetrains, and the readings of sensors as rows on their networks.

The torque through a rigid connection is read where that connection is taken away: with a law kappa on its row a, the
torque is kappa a^T theta, and

    kappa a^T adj(D + kappa a a^T) b = kappa a^T adj(D) b

while det(D + kappa a a^T) tends to kappa times the determinant of the rigid drivetrain. So its numerator is the twist
of the connection in the drivetrain without it: no subtraction, and nothing upstream of it appears but as a factor.

Here as well: determinant of a symbolic network and bilinear forms of its adjugate, as nodes of a straight-line program.

Continued fraction of a transfer function on a drivetrain without loops, as an engineer writes it by hand.

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
from functools import cached_property
from typing import Any, ClassVar

from torsionnet.base.program import Program, ProgramNode
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.symbolic import law_parts, symbol_of, symbolic_values
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Values
from torsionnet.model.elimination import substitute
from torsionnet.model.kinematics import Kinematics, kinematics_on
from torsionnet.model.readings import reading
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
from torsionnet.symbolic.algebra.recursion import (
    GraphBlock,
    Quotient,
    Recursion,
    SolvedBlock,
    is_forest,
    orient,
    quotient,
)


def _solve_block(block: GraphBlock[Quotient], hanging: Mapping[str, Quotient], program: Program) -> SolvedBlock:
    """Solved block with closed loops, whose algebra a tree does not need."""
    from torsionnet.symbolic.algebra.deletion_contraction import solve_block

    return solve_block(block, hanging, program)


def recursion_from(root: str, network: Network[Stiffness], program: Program) -> Recursion:
    """Determinants of a network's parts as seen from a root coordinate, recorded once per program."""
    return program.memo.once(
        Recursion,
        (network, root),
        lambda: Recursion(network_in_quotients(network, program), program, root, _solve_block),
    )


def network_in_quotients(network: Network[Stiffness], program: Program) -> Network[Quotient]:
    """Network with parallel laws added up, the dynamic stiffness of each law a quotient of program nodes."""

    def added() -> Network[Quotient]:
        members = add_parallel_laws(network, reflected_sum).members
        return Network(
            network.coordinates, tuple(NetworkMember(member.row, quotient(member.law, program)) for member in members)
        )

    return program.memo.once(Network, network, added)


def determinant(network: Network[Stiffness], program: Program, first: str = "") -> ProgramNode:
    """Determinant det D of the dynamic stiffness matrix of a network, as a node of the program."""
    root = first or next(iter(network.coordinates), "")
    return recursion_from(root, network, program).determinant if root else program.leaf(1)


def bilinear(network: Network[Stiffness], program: Program, reading: SymbolRow, load: SymbolRow) -> ProgramNode:
    """Bilinear form reading^T adj(D) load of a network's dynamic stiffness matrix D, as a node of the program."""
    total = program.leaf(0)
    for root, share in load.items():
        total = total + program.leaf(share) * recursion_from(root, network, program).reading(reading)
    return total


PURE_S = Stiffness(damping=ONE)


@dataclass(frozen=True)
class SymbolicPart:
    """Term of a sensor reading, factor * s^power * law * (row theta), or factor * torque of a constraint or action."""

    row: Mapping[str, Any]
    factor: Any = ONE
    power: int = 0
    law: Stiffness | None = None
    rigid: int | None = None
    action: int | None = None


@dataclass(frozen=True)
class ReducedNetwork:
    """Network with rigid rows kept at zero, rows over its coordinates, and the factor that its determinant lacks."""

    network: Network[Stiffness]
    rows: tuple[SymbolRow, ...]
    factor: Any


@dataclass(eq=False)
class Mechanism:
    """Symbolic drivetrain in which the torques of the rigid connections in ``loose`` can be read.

    Attributes
    ----------
    drivetrain : Drivetrain
    referred_to : tuple of str
        Nodes kept as coordinates.
    loose : tuple of int
        Constraints whose torque is wanted, by number.
    """

    has_actions: ClassVar[bool] = False
    """Whether torques of controllers are unknowns beside the coordinates, so that no continued fraction exists."""
    drivetrain: AssembledModel
    referred_to: tuple[str, ...] = ()
    loose: tuple[int, ...] = ()
    program: Program = field(default_factory=Program)

    @cached_property
    def values(self) -> Values:
        """Values of all parameters of the drivetrain, recorded to be written in symbols."""
        return symbolic_values(self.drivetrain.definition.parameters, self.drivetrain.exact_values)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Kinematics of the drivetrain with all constraints solved except the rigid connections in ``loose``."""
        plain = self.drivetrain.assembly.kinematics
        return kinematics_on(self.values, plain, self.drivetrain.definition, self.referred_to, self.loose)

    def row(self, row: Mapping[str, Any]) -> SymbolRow:
        """Symbolic coefficients of a row over coordinates, from its coefficients over nodes."""
        number, solved = self.values.algebra.number, self.kinematics.reduction.solved
        reduced = substitute({node: number(value) for node, value in row.items()}, solved)
        return {name: symbol_of(value) for name, value in reduced.items()}

    @cached_property
    def network(self) -> Network[Stiffness]:
        """Network of the drivetrain's laws over the coordinates, in which loose connections carry nothing."""
        laws = [(law_parts(owner, law), self.row(law.row)) for owner, law in self.kinematics.laws if law.acts]
        members = tuple(NetworkMember(row, Stiffness(*parts)) for parts, row in laws if row)
        return Network(self.kinematics.coordinates, members)

    def reduced(self, rows: Collection[SymbolRow], loose: int | None = None) -> ReducedNetwork:
        """Network with the mechanism's loose connections made rigid, except number ``loose``, and given rows in it."""
        rigid = {index: self.row(self.kinematics.constraints[index][1]) for index in self.loose}
        network, factor = self.network, ONE
        carried = [*rows, *([rigid[loose]] if loose is not None else [])]
        waiting = [row for index, row in rigid.items() if index != loose]
        # Every rigid row takes a coordinate away, also from the rows that wait.
        while waiting:
            contraction = network.contracted(waiting.pop(0))
            network, factor = contraction.network, factor * contraction.factor
            waiting = [contraction.row(row) for row in waiting]
            carried = [contraction.row(row) for row in carried]
        return ReducedNetwork(network, tuple(carried), factor)

    def determinant(self, load: SymbolRow) -> ProgramNode:
        """Determinant det D of the drivetrain's dynamic stiffness, as a node of the program."""
        reduced = self.reduced([load])
        first = next(iter(reduced.rows[0]), "")
        return self.program.leaf(reduced.factor) * determinant(reduced.network, self.program, first)

    def numerator(self, parts: Collection[SymbolicPart], load: Mapping[str, int]) -> ProgramNode:
        """Numerator of a reading under torques on nodes, det D times the reading, a node of the program."""
        total = self.program.leaf(0)
        for part in parts:
            # The torque of a rigid connection is read as the twist of its row in the drivetrain without it.
            reduced = self.reduced([self.row(part.row), self.row(load)], part.rigid)
            row, loaded = reduced.rows[-1 if part.rigid is not None else 0], reduced.rows[1]
            number = self.program.leaf(part.factor * reduced.factor)
            for law in [PURE_S] * part.power + ([part.law] if part.law else []):
                number = number * self.program.leaf(law)
            total = total + bilinear(reduced.network, self.program, row, loaded) * number
        return total


def parts_of(mechanism: Mechanism, sensor: Sensor) -> list[SymbolicPart]:
    """Terms of the reading of a sensor in symbols, the sum of which is the reading."""
    kinematics = mechanism.kinematics
    rows = ((owner, law.row) for owner, law in kinematics.laws)
    driving = [(owner, action.row) for owner, action in kinematics.actions]
    elements = mechanism.drivetrain.elements
    read = reading(sensor, elements, mechanism.values, rows, kinematics.constraints, driving)
    if read.row is not None:
        return [SymbolicPart(read.row, power=read.power)]
    shares = [(*kinematics.laws[number], symbol_of(factor)) for number, factor in read.laws.items()]
    laws = [SymbolicPart(law.row, by, law=Stiffness(*law_parts(owner, law))) for owner, law, by in shares if law.acts]
    rigid = [SymbolicPart({}, symbol_of(by), rigid=number) for number, by in read.constraints.items()]
    return laws + rigid + [SymbolicPart({}, symbol_of(by), action=number) for number, by in read.actions.items()]


def loose_constraints(drivetrain: AssembledModel, sensors: Collection[Sensor]) -> tuple[int, ...]:
    """Numbers of the constraints (rigid connections) whose torque one of the sensors reads."""
    owners = {sensor.of for sensor in sensors if sensor.quantity == "torque"}
    return tuple(
        index for index, (owner, _) in enumerate(drivetrain.assembly.kinematics.constraints) if owner in owners
    )


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
        flexibilities = []
        for block in self.tree.below[name]:
            (child,), (member,) = block.below, block.members
            if self.receptance[child] is not None:
                # 1/Z_branch = 1/y + 1/Z_c, over the ratio of the edge
                series = self._one / self.element(member.law) + self._squared(member, child) * self.receptance[child]
                self.flexibility[child] = series / self._squared(member, name)
                flexibilities.append(self.flexibility[child])
        grounds = self.network.grounds.get(name, [])
        # A single branch keeps its receptance as it is, instead of 1 / (1 / receptance).
        if not grounds and len(flexibilities) == 1:
            self.receptance[name] = flexibilities[0]
            return
        # Z_v = g_v + sum of Z_branch
        total = self.element(grounds[0]) if grounds else None
        for flexibility in flexibilities:
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
        # y / (y + Z_c) times the ratio of the edge; c follows rigidly where nothing holds it.
        ratio = self.element(-member.row[block.top] / member.row[far])
        if self.receptance[far] is None:
            return ratio
        y = self.element(member.law) * self._squared(member, far)
        return ratio * (y / (y + self._one / self.receptance[far]))

    def reading(self, row: SymbolRow, law: Any = None) -> Any:
        """Ratio of a reading, row theta times a law, to the motion at the root, in the fraction's algebra."""
        row = {name: value for name, value in row.items() if name in self.tree.below}
        # A twist is read as the torque of its edge, without a difference of two motions.
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
        # T = Z_branch theta at the upper end of the edge.
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
    simple = add_parallel_laws(Network(network.coordinates, tuple(members)), reflected_sum)
    acting = (member for member in simple.members if not all(map(vanishes, member.law.parts)))
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
    reduced = mechanism.reduced([mechanism.row(load)])
    # Continued fractions, equation (3.4), need a tree of single edges and a torque on one coordinate of it.
    network, loaded = single_edges(reduced.network), reduced.rows[0]
    if len(loaded) != 1 or not is_forest(network):
        raise NoContinuedFractionError
    ((root, share),) = loaded.items()
    rows = [mechanism.reduced([mechanism.row(part.row)]).rows[0] for part in parts]
    if shift and not any(part.rigid is not None for part in parts):
        root, share = _arrival(network, root, share, {name for row in rows for name in row})
    tree = ContinuedFraction(network, root, element)
    if tree.receptance[root] is None:
        raise NoContinuedFractionError
    # y = sum of factor s^power (a theta), or of the torque that a law or a rigid connection makes of it.
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
        # Without inertia the edge carries the whole torque on, over its ratio.
        share = -rows[0][end] / rows[0][root] * share
        came, root = root, end
    return root, share


def _handed_through(
    mechanism: Mechanism, rigid: int, tree: ContinuedFraction, load: Mapping[str, int], element: Callable[[Any], Any]
) -> Any:
    """Torque through a rigid connection over the motion at the root, the reaction of the side beyond it."""
    reduced = mechanism.reduced([mechanism.row(load)], rigid)
    network, (loaded, row) = single_edges(reduced.network), reduced.rows
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
