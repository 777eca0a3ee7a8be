"""Kinematics of a drivetrain, its constraints solved for coordinates, theta = T q.

Here as well: motions of the drivetrain that some of its laws do not resist; check whether a twist, as an error of teeth
or of a joint, can be imposed in an element.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from torsionnet.base.errors import Fault, UsageError, did_you_mean, named_list
from torsionnet.base.expressions import exact
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import Action, Constraint, Element, Law, Part, Row, Values
from torsionnet.model.elimination import Reduction, reduce_rows, rows_holding, smallest_failing_rows


@dataclass(frozen=True)
class OwnedPart:
    """Law, constraint or action with the name of its element."""

    element: str
    part: Part


@dataclass(frozen=True, eq=False)
class MadeParts:
    """Laws and constraints of an element, and the parameter values from which they were made, for reuse."""

    of: Element
    names: tuple[str, ...]
    used: tuple[Any, ...]
    kinds: tuple[type, ...]
    parts: tuple[OwnedPart, ...]


@dataclass(frozen=True)
class Kinematics:
    """Parts of all elements and solved constraints of one configuration of a drivetrain.

    Attributes
    ----------
    nodes : tuple of str
        All nodes in the order of their first mention.
    parts : tuple of OwnedPart
        Laws, constraints and actions in the order of the elements.
    imposed : tuple of str
        Names of the inputs that impose an angle; each appears in rows as the pseudo node ``input:NAME``. Inputs on
        locked nodes are left out.
    driven : tuple of dict
        Rows over nodes of the imposed angles: of one node, or of one node relative to another.
    reduction : Reduction
        Every dependent node over coordinates and imposed angles; an empty row is a node held at zero.
    coordinates : tuple of str
        The nodes kept as coordinates q.
    made : mapping
        Parts by element, with the values they were made from: models that differ in some parameters share the others.
    """

    nodes: tuple[str, ...]
    parts: tuple[OwnedPart, ...]
    imposed: tuple[str, ...]
    driven: tuple[Row, ...]
    reduction: Reduction
    coordinates: tuple[str, ...]
    made: Mapping[str, MadeParts] = field(default_factory=dict, compare=False, repr=False)

    def holds(self, node: str) -> bool:
        """Whether rigid connections to ground keep the node at zero."""
        return not self.reduction.is_free(node) and not self.reduction.reduced({node: 1})

    def holds_row(self, row: Mapping[str, Any]) -> bool:
        """Whether rigid connections keep a row over nodes at zero: a locked node, or two that turn as one."""
        return not self.reduction.reduced(row)

    @cached_property
    def laws(self) -> tuple[tuple[str, Law], ...]:
        return tuple((owned.element, owned.part) for owned in self.parts if isinstance(owned.part, Law))

    @cached_property
    def actions(self) -> tuple[tuple[str, Action], ...]:
        return tuple((owned.element, owned.part) for owned in self.parts if isinstance(owned.part, Action))

    @cached_property
    def constraints(self) -> tuple[tuple[str, Row], ...]:
        return constraints_of(self.parts)


def pseudo_node(input_name: str) -> str:
    """Name of the unknown for an imposed angle, which no node can have."""
    return f"input:{input_name}"


UNIT = pseudo_node("")
"""Name of the unknown whose value is 1, for rows with a constant."""


def owned_parts(definition: Definition, value: Values) -> tuple[OwnedPart, ...]:
    """Laws, constraints and actions, each with its element's name, of all elements that are switched on."""
    return tuple(OwnedPart(element.name, part) for element in definition.active for part in element.parts(value))


def constraints_of(parts: Sequence[OwnedPart]) -> tuple[tuple[str, Row], ...]:
    """Pairs of element name and row over nodes of every constraint among the parts."""
    return tuple((owned.element, owned.part.row) for owned in parts if isinstance(owned.part, Constraint))


def exact_row(row: Mapping[str, Any]) -> dict[str, Fraction]:
    """Exact fractions of a row's coefficients by node, on which pivots and rank are decided."""
    return {node: exact(coefficient) for node, coefficient in row.items()}


def imposed_rows(definition: Definition, nodes: Collection[str]) -> dict[str, Row]:
    """Row over nodes and imposed angle, zero in every motion, of each input that imposes an angle, by input."""
    return {
        name: {**exact_row(channel.row), pseudo_node(name): Fraction(-1)}
        for name, channel in definition.inputs.items()
        if channel.quantity == "angle" and all(node in nodes for node in channel.nodes)
    }


def solve_kinematics(
    definition: Definition, value: Values, referred_to: Collection[str] = (), like: Kinematics | None = None
) -> Kinematics:
    """Kinematics of a drivetrain's definition with all constraints solved exactly.

    ``referred_to`` are nodes to keep as coordinates, in this order.

    Where ``like``, of another configuration, has the same nodes and constraints, its solution is taken over.

    Raises
    ------
    UsageError
        ``referred_to`` names an unknown node, or nodes the constraints tie to each other or to ground.
    """
    nodes = all_nodes(definition.active)
    for node in referred_to:
        if node not in nodes:
            raise UsageError(f'no node is named "{node}"{did_you_mean(node, nodes)}', kind="unknown-node")
    # Laws, constraints and actions of each element; those of ``like`` where none of its parameters has changed.
    made: dict[str, MadeParts] = {}
    for element in definition.active:
        known = like.made.get(element.name) if like else None
        if known is not None and known.of is element:
            names = known.names
        else:
            known = None
            names = tuple(sorted({name for _, _, expression, _ in element.expressions() for name in expression.names}))
        used = tuple(value.parameters.get(name) for name in names)
        kinds = tuple(map(type, used))  # a float that equals a fraction is not exact
        if known is None or (used, kinds) != (known.used, known.kinds):
            own = tuple(OwnedPart(element.name, part) for part in element.parts(value))
            known = MadeParts(element, names, used, kinds, own)
        made[element.name] = known
    parts = tuple(part for known in made.values() for part in known.parts)
    imposed = imposed_rows(definition, set(nodes))
    driven = tuple(definition.inputs[name].row for name in imposed)
    same = like is not None and (nodes, tuple(imposed), driven) == (like.nodes, like.imposed, like.driven)
    if like is not None and same and not referred_to:
        again = replace(like, parts=parts, made=made)
        if again.constraints == like.constraints:
            return again
    # Rows a^T theta = 0 of imposed angles and of rigid connections, in fractions; last declared nodes go first.
    order = {node: index for index, node in enumerate(nodes)}
    rigid = [exact_row(row) for _, row in constraints_of(parts)]
    if imposed:
        # Nodes that rigid connections alone hold follow no imposed angle.
        alone = reduce_rows(rigid, order)
        imposed = {
            name: row
            for name, row in imposed.items()
            if alone.reduced({node: share for node, share in row.items() if node in order})
        }
    driven = tuple(definition.inputs[name].row for name in imposed)
    owners = [*imposed, *(name for name, _ in constraints_of(parts))]
    rows: list[Any] = [*imposed.values(), *rigid]
    keep = {*referred_to, *(pseudo_node(name) for name in imposed)}
    reduction = reduce_rows(rows, order, keep)
    # A row left with names to be kept alone would take one of them out.
    tied = [i for i in reduction.blocked if any(node in referred_to for node in reduction.free_names(rows[i]))]
    if tied and referred_to:
        kept = ", ".join(referred_to)
        raise UsageError(
            f"{kept} cannot all be coordinates: {owners[tied[0]]} ties them to each other or to ground",
            kind="contradicting-values",
        )
    coordinates = tuple(node for node in nodes if reduction.is_free(node))
    if referred_to:
        coordinates = in_order_given(coordinates, referred_to)
    return Kinematics(nodes, parts, tuple(imposed), driven, reduction, coordinates, made)


def kinematics_on(
    value: Values, plain: Kinematics, definition: Definition, referred_to: Sequence[str] = (), loose: Sequence[int] = ()
) -> Kinematics:
    """Kinematics solved again with the numbers of ``value``, without the constraints numbered in ``loose``."""
    parts, number = owned_parts(definition, value), value.algebra.number
    rows = [
        {} if index in loose else {node: number(coefficient) for node, coefficient in row.items()}
        for index, (_, row) in enumerate(constraints_of(parts))
    ]
    order = {node: index for index, node in enumerate(plain.nodes)}
    reduction = reduce_rows(rows, order, {*referred_to, *map(pseudo_node, plain.imposed)})
    coordinates = in_order_given([node for node in plain.nodes if reduction.is_free(node)], referred_to)
    return replace(plain, parts=parts, reduction=reduction, coordinates=coordinates)


def in_order_given(coordinates: Sequence[str], referred_to: Collection[str]) -> tuple[str, ...]:
    """Names of coordinates in the order of the nodes, with those of ``referred_to`` in the order given.

    >>> in_order_given(["a", "b", "c"], ["c", "a"])
    ('c', 'b', 'a')
    """
    named = iter(node for node in dict.fromkeys(referred_to) if node in coordinates)
    return tuple(next(named) if node in referred_to else node for node in coordinates)


SMALL_LOOP = 100
"""Largest number of elements in a contradicting loop for which a smaller loop is searched, as each costs a solution."""


def contradicting_loop(parts: Sequence[OwnedPart], nodes: Sequence[str]) -> list[str]:
    """Names of elements in a rigid loop of contradicting ratios, which holds a node at zero without a clamp; or empty.

    Constraints on a single node are clamps and left out. Where the ratios of a rigid loop do not agree, the only motion
    left to its nodes is none.
    """
    loose = [(name, row) for name, row in constraints_of(parts) if len(row) > 1]
    rows = [exact_row(row) for _, row in loose]
    order = {node: index for index, node in enumerate(nodes)}
    reduction = reduce_rows(rows, order)
    if not (held := reduction.held()):
        return []

    def contradicts(some: Sequence[Any]) -> bool:
        return bool(reduce_rows(some, order).held())

    # The node that the fewest rows hold shows the shortest loop.
    origin, node = min(((sorted(reduction.origin(node)), node) for node in held), key=lambda pair: len(pair[0]))
    loop = [origin[place] for place in rows_holding([rows[index] for index in origin], node)]
    if len(loop) <= SMALL_LOOP:
        loop = smallest_failing_rows(rows, loop, contradicts)
    return list(dict.fromkeys(loose[index][0] for index in loop))


@dataclass(frozen=True)
class LoopMismatch:
    """Two ratios of the speeds of two nodes of a rigid loop, by one element and by the others of the loop."""

    element: str
    nodes: tuple[str, str]
    own: Fraction
    others: Fraction

    @property
    def deviation(self) -> float:
        """Ratio by the one element over that by the others, less 1."""
        return float(self.own / self.others) - 1


def loop_mismatch(parts: Sequence[OwnedPart], nodes: Sequence[str], loop: Sequence[str]) -> LoopMismatch | None:
    """Ratios by the last element of a contradicting loop with two nodes, and by the others between the same nodes.

    None where no element of the loop has a ratio of just two nodes, or the others leave one open.
    """
    rows = [(name, exact_row(row)) for name, row in constraints_of(parts) if name in loop and len(row) > 1]
    order = {node: index for index, node in enumerate(nodes)}
    for element in reversed(loop):
        own = [row for name, row in rows if name == element]
        if len(own) != 1 or len(own[0]) != 2:
            continue
        # theta_1/theta_2 by this element: share theta_1 + other theta_2 = 0.
        (first, share), (second, other) = own[0].items()
        reduction = reduce_rows([row for name, row in rows if name != element], order)
        # By the others there is a ratio where both follow one free angle.
        ends = [reduction.reduced({node: Fraction(1)}) for node in (first, second)]
        if all(len(end) == 1 for end in ends) and ends[0].keys() == ends[1].keys():
            ((above,), (below,)) = (end.values() for end in ends)
            return LoopMismatch(element, (first, second), Fraction(-other, share), Fraction(above) / Fraction(below))
    return None


def virtual_motion(kinematics: Kinematics, index: int, number: Callable[[Any], Any] = exact) -> dict[str, Any]:
    """Virtual motion of every node, by node, that violates constraint ``index`` by one and no other constraint.

    The torque of the constraint is the work of all other torques on z. Imposed angles stand still in z.
    ``number`` converts coefficients to the arithmetic to work in.

    Raises
    ------
    UsageError
        The torque is statically indeterminate; the message names the rigid loop.
    """
    constraints = kinematics.constraints
    rows: list[Any] = [{node: number(value) for node, value in row.items()} for _, row in constraints]
    # a^T z = 1 for this constraint, a^T z = 0 for all others; the name UNIT stands for 1.
    rows[index] = {**rows[index], UNIT: Fraction(-1)}
    # It comes last, so that it is the row left over where the others hold its motion already.
    rows = [row for number, row in enumerate(rows) if number != index] + [rows[index]]
    names = [name for number, (name, _) in enumerate(constraints) if number != index] + [constraints[index][0]]
    imposed: list[Any] = [exact_row(row) for row in kinematics.driven]
    order = {node: number for number, node in enumerate(kinematics.nodes)}
    reduction = reduce_rows([*imposed, *rows], order, {UNIT})
    for blocked in reduction.blocked:
        origin = {*reduction.origin_of_row(blocked), blocked}
        loop = sorted(number - len(imposed) for number in origin if number >= len(imposed))
        owners = {names[number] for number in loop}
        loop_names = list(dict.fromkeys(name for name, _ in constraints if name in owners))
        raise UsageError(Fault(_indeterminate(constraints[index][0], loop_names), kind="indeterminate-torque"))
    return {node: row[UNIT] for node, row in reduction.solved.items() if UNIT in row}


def _indeterminate(element: str, loop: list[str]) -> str:
    if len(loop) < 2:
        return phrase("torque through {} is statically indeterminate; give it a stiffness", ModelName(element))
    said = "torque through {} is statically indeterminate: {} form a rigid loop; give one of them a stiffness"
    return phrase(said, ModelName(element), named_list(loop))


def free_motions(kinematics: Kinematics, answers: Callable[[Law], bool]) -> Reduction:
    """Reduction of the drivetrain to the motions that leave every law chosen by the function ``answers`` without twist.

    Imposed angles stand still.
    """
    imposed = [{pseudo_node(name): 1} for name in kinematics.imposed]
    rows = [exact_row(law.row) for _, law in kinematics.laws if answers(law)]
    order = {name: index for index, name in enumerate((*kinematics.nodes, *map(pseudo_node, kinematics.imposed)))}
    return kinematics.reduction.followed_by([*imposed, *rows], order)


def count_held_motions(kinematics: Kinematics) -> int:
    """Number of motions without a spring that a torque holds which follows a constant angle, as of a governor.

    As that of a governor does which integrates the speed. A torque that acts between parts turning as one holds none.
    """
    acting = [action for _, action in kinematics.actions if action.acts_at_rest]
    if not acting:
        return 0
    left = free_motions(kinematics, lambda law: law.holds_at_rest)
    # Torques by angles of the free motions, gain lever share: the rank of this matrix is what they hold.
    torques: dict[str, dict[str, Fraction]] = {}
    for action in acting:
        gain = next(exact(value) for value in action.numerator if value != 0)
        driven, sensed = (left.reduced(exact_row(row)) for row in (action.row, action.sensed))
        for name, lever in driven.items():
            row = torques.setdefault(name, {})
            for other, share in sensed.items():
                row[other] = row.get(other, Fraction(0)) + gain * lever * share
    rows = [{name: value for name, value in row.items() if value} for row in torques.values()]
    return reduce_rows(rows, {name: place for place, name in enumerate(kinematics.coordinates)}).rank


def twist_fault(element: Element, parts: Sequence[Part]) -> str | None:
    """Message if no twist can be imposed in an element with these ``parts``, else None.

    >>> from torsionnet.model.elements.gears import Gear
    >>> from torsionnet.model.element_base.laws import Values
    >>> stage = Gear("stage", nodes=("a", "b"), ratio=2)
    >>> twist_fault(stage, stage.parts(Values({})))
    'stage is rigid: an imposed twist needs something that gives way; give it a stiffness'
    """
    laws = [part for part in parts if isinstance(part, Law) and part.acts]
    if len(laws) < len(parts):
        said = "{} is rigid: an imposed twist needs something that gives way; give it a stiffness"
        return phrase(said, ModelName(element.name))
    if len(laws) == 1 and laws[0].inertia == 0:
        return None
    said = "{} has inertia or several springs; impose the twist in a spring or a compliant gear beside it"
    return phrase(said, ModelName(element.name))
