"""Laws of motion of a drivetrain among its linear parts, and the motions that springs leave free."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from torsionnet.base.expressions import FLOAT
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.element_base.laws import WholePart
from torsionnet.model.elements import Constraint, Element, Law, MotionLaw, Row, Values
from torsionnet.model.elimination import Reduction, reduce_rows
from torsionnet.model.kinematics import exact_row
from torsionnet.model.load.external_torques import UNBALANCED_SHARE, stated_torques
from torsionnet.model.motion_laws.piece_curve import PieceCurve, Slope
from torsionnet.model.operating_point import torque_place
from torsionnet.model.parameters import resolve


@dataclass(frozen=True, eq=False)
class PlacedMotionLaw:
    """Law of motion of an element, with its number among the parts of the element.

    ``law`` has exact coefficients, ``rounded`` is the same law in floats, for searches.
    """

    owner: str
    number: int
    law: MotionLaw
    rounded: MotionLaw

    @property
    def is_over_twist(self) -> bool:
        """Whether the torque follows the twist of the row, else its rate."""
        return self.law.curve.over == "twist"


@dataclass(frozen=True, eq=False)
class LawNetwork:
    """Constraints, linear laws and laws of motion of all elements of a drivetrain that are switched on.

    Attributes
    ----------
    nodes : tuple of str
    held : tuple of Row
        Rows over nodes that stand still: constraints, and angles that inputs impose.
    linear : tuple of (str, Law)
        Linear laws with their elements.
    motion : tuple of PlacedMotionLaw
    """

    nodes: tuple[str, ...]
    held: tuple[Row, ...]
    linear: tuple[tuple[str, Law], ...]
    motion: tuple[PlacedMotionLaw, ...]

    @cached_property
    def order(self) -> dict[str, int]:
        return {node: index for index, node in enumerate(self.nodes)}

    @cached_property
    def elastic(self) -> tuple[tuple[str, Law], ...]:
        """Linear laws that resist a constant twist, with their elements."""
        return tuple((owner, law) for owner, law in self.linear if law.holds_at_rest)

    @cached_property
    def over_twist(self) -> tuple[PlacedMotionLaw, ...]:
        return tuple(law for law in self.motion if law.is_over_twist)

    @cached_property
    def over_rate(self) -> tuple[PlacedMotionLaw, ...]:
        return tuple(law for law in self.motion if not law.is_over_twist)

    @cached_property
    def dampers(self) -> tuple[PlacedMotionLaw, ...]:
        """Linear laws whose damping resists a motion that springs leave free, as bearings do, as laws over the rate."""
        dampers = []
        for owner, law in self.linear:
            if law.damping and any(self.free.in_floats(exact_row(law.row)).values()):
                damper = MotionLaw(law.row, PieceCurve("rate", (Slope(damping=float(law.damping)),)))
                dampers.append(PlacedMotionLaw(owner, -1, damper, damper))
        return tuple(dampers)

    @cached_property
    def reduction(self) -> Reduction:
        """Angles of all nodes over the coordinates that constraints leave."""
        return reduce_rows([exact_row(row) for row in self.held], self.order)

    @cached_property
    def free(self) -> Reduction:
        """Motions of all nodes that leave every spring, and every law of motion over the twist, without twist."""
        rows = [exact_row(law.row) for _, law in self.elastic]
        rows += [exact_row(placed.law.row) for placed in self.over_twist]
        return self.reduction.followed_by(rows, self.order)

    @cached_property
    def free_motions(self) -> tuple[str, ...]:
        """Names of coordinates, one for each motion that no spring and no law over the twist resists."""
        return tuple(node for node in self.nodes if self.reduction.is_free(node) and self.free.is_free(node))

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates that springs and laws over the twist resist, with free motions held."""
        left = set(self.free_motions)
        return tuple(node for node in self.nodes if self.reduction.is_free(node) and node not in left)


def law_network(definition: Definition, values: Mapping[str, Any]) -> LawNetwork:
    """Network of the laws of a drivetrain, from the exact values of its parameters."""
    value = Values(values)
    floats = Values({name: float(number) for name, number in values.items()}, FLOAT)
    # Imposed angles stand still, as what is clamped does.
    held: list[Row] = [
        channel.row
        for channel in definition.inputs.values()
        if channel.quantity == "angle" and set(channel.nodes) <= set(all_nodes(definition.switched_on))
    ]
    linear: list[tuple[str, Law]] = []
    motion: list[PlacedMotionLaw] = []
    for element in definition.switched_on:
        parts: Sequence[WholePart] = element.parts(value)
        rounded: Iterator[MotionLaw] = iter(())
        # Laws of motion twice: exact for balances, and in floats for the search of points.
        if element.has_motion_laws and not keeps_own_point(element, definition):
            parts = element.whole_parts(value)
            rounded = (part for part in element.whole_parts(floats) if isinstance(part, MotionLaw))
        for number, part in enumerate(parts):
            if isinstance(part, MotionLaw):
                motion.append(PlacedMotionLaw(element.name, number, part, next(rounded)))
            elif isinstance(part, Constraint):
                held.append(part.row)
            elif isinstance(part, Law):
                linear.append((element.name, part))
    return LawNetwork(all_nodes(definition.switched_on), tuple(held), tuple(linear), tuple(motion))


def keeps_own_point(element: Element, definition: Definition) -> bool:
    """Whether an element stays linear about the working point that its entries name, whatever the operating point.

    An operating point that a call asks for replaces it. It stays where the call names no speed and either its torques,
    with that of the element among them, are in balance, or the law follows more speeds than that of its row.
    """
    if not element.has_own_working_point:
        return False
    if not definition.is_asked:
        return True
    point = definition.operating_point
    if "torque" in element.working_point or point.speed:
        return False
    stated = any(torque_place(place).nodes == (getattr(element, "node", ""),) for place in point.torque)
    return "speed_ratio" in element.working_point or (stated and _torques_balance(definition))


def _torques_balance(definition: Definition) -> bool:
    """Whether the torques of the operating point alone leave nothing over on the motions that are free of springs."""
    values = resolve(definition.parameters)[0]
    free = law_network(replace(definition, is_asked=False), values).free
    # Torque on each motion without springs, and the sum of sizes against which what is left over may be rounding.
    left: dict[str, float] = {}
    size: dict[str, float] = {}
    for node, torque in stated_torques(definition, values).items():
        for name, share in free.in_floats(exact_row({node: 1})).items():
            left[name] = left.get(name, 0.0) + share * torque
            size[name] = size.get(name, 0.0) + abs(share * torque)
    return all(abs(left[name]) <= UNBALANCED_SHARE * size[name] for name in left)


def following_elements(definition: Definition) -> tuple[Element, ...]:
    """Elements whose laws of motion are linear about the operating point of the model, none of which keeps its own."""
    return tuple(
        element
        for element in definition.switched_on
        if element.has_motion_laws and not keeps_own_point(element, definition)
    )
