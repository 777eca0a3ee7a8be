"""Mean speed ratios between shafts along the elements between them, in any algebra.

On average no spring winds up: springs pass a mean speed on, and gears divide it. A row of three nodes, of a planetary
set or of a gear in a housing, passes it on between two of them where the third stands still; an open differential also
where all three turn, its outputs alike, as of a vehicle that goes straight on. Values
referred from one shaft to another keep their energy: angles are multiplied by the speed ratio, torques divided by it,
and stiffness, damping and inertia change with its square.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar

from torsionnet.base.registers import Groups
from torsionnet.model.element_base.element import Element, OtherLaws
from torsionnet.model.element_base.laws import GROUND, Law, MotionLaw, MotionState, Part, Row, Values, WholePart


@dataclass(frozen=True)
class SpeedStep:
    """Step of a speed path from one node to the next, by a row of node speeds that an element gives.

    ``alike`` says that all nodes of the row turn at one speed, as those of an open differential.
    """

    element: Element
    row: int
    start: str
    end: str
    alike: bool = False

    def ratio(self, value: Values) -> Any:
        """Speed of the step's end node over that of its start node, in the algebra of ``value``."""
        if self.alike:
            return Fraction(1)
        row = self.element.mean_speed_rows(value)[self.row]
        return -_quotient(row[self.start], row[self.end])


@dataclass(frozen=True)
class SpeedPath:
    """Steps, each with a mean speed ratio, from a shaft to the shaft that values are referred to.

    Steps whose ratio is always 1 are left out.
    """

    steps: tuple[SpeedStep, ...]

    def ratio(self, value: Values) -> Any:
        """Speed of the path's last shaft over that of its first, in the algebra of ``value``."""
        total: Any = Fraction(1)
        for step in self.steps:
            total = step.ratio(value) * total
        return total

    def actual(self, parts: Iterable[Part], value: Values) -> tuple[Part, ...]:
        """Laws converted from the speed of the path's last shaft, where they are quoted, to that of the first."""
        if not self.steps:
            return tuple(parts)
        factor = self.ratio(value) ** 2
        return tuple(_scaled(part, factor) if isinstance(part, Law) else part for part in parts)

    def whole(self, parts: Iterable[WholePart], value: Values) -> tuple[WholePart, ...]:
        """Laws, those of motion in full, converted from the speed of the path's last shaft to that of the first."""
        if not self.steps:
            return tuple(parts)
        # Angles are multiplied by the ratio r and torques divided by it: k, c and J take r^2.
        ratio = self.ratio(value)
        return tuple(
            replace(part, curve=part.curve.scaled(ratio))
            if isinstance(part, MotionLaw)
            else _scaled(part, ratio**2)
            if isinstance(part, Law)
            else part
            for part in parts
        )


@dataclass(frozen=True)
class LawsAtOwnShaft(OtherLaws):
    """Laws of an element converted from the shaft where they are quoted to its own shaft; constraints are unchanged."""

    are_converted: ClassVar[bool] = True

    path: SpeedPath

    def parts(self, value: Values) -> tuple[Part, ...]:
        return self.path.actual(self.element.parts(value), value)

    def whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        return self.path.whole(self.element.whole_parts(value), value)

    def tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Tangents about states at the element's own shaft."""
        ratio = self.path.ratio(value)
        quoted = [state.scaled(ratio) for state in states]
        return self.path.actual(self.element.tangent_parts(value, quoted), value)


def _quotient(above: Any, below: Any) -> Any:
    return Fraction(above, below) if isinstance(above, int) and isinstance(below, int) else above / below


def _scaled(law: Law, factor: Any) -> Law:
    given = {"inertia": law.inertia, "damping": law.damping, "stiffness": law.stiffness}
    return replace(law, **{name: size * factor for name, size in given.items() if size != 0})


@dataclass(frozen=True)
class _Held:
    """Row of node speeds that an element makes zero on average."""

    element: Element
    number: int
    row: Row

    def leads(self, start: str, still: set[str]) -> Iterator[str]:
        """Nodes of the row whose mean speed follows from that of ``start``."""
        if start in self.row:
            moving = [node for node in self.row if node not in still]
            if start in moving and (len(moving) == 2 or self.is_alike(still)):
                yield from (node for node in moving if node != start)

    def is_alike(self, still: set[str]) -> bool:
        """Whether the row is that of an open differential none of whose members stands still."""
        outputs = {node for port, node in self.element.ports.items() if port in ("left", "right")}
        return self.element.glyph == "differential" and outputs < self.row.keys() and still.isdisjoint(self.row)

    @property
    def is_unity(self) -> bool:
        """Whether both nodes of the row always turn at one speed: the coefficients are 1 and -1 whatever the values."""
        return len(self.row) == 2 and all(type(a) is int for a in self.row.values()) and sum(self.row.values()) == 0


@dataclass(frozen=True)
class SpeedTree:
    """Next step towards an end node from every node, over rows in which all other nodes stand still.

    ``closing`` are the steps of the rows that close loops, each in both directions.
    """

    steps: Mapping[str, SpeedStep | None]
    closing: tuple[SpeedStep, ...]


class SpeedPaths:
    """Finder of speed paths between shafts through a sequence of elements, in one algebra."""

    def __init__(self, elements: Sequence[Element], value: Values) -> None:
        self.elements: Sequence[Element] = elements
        self.value: Values = value
        self._trees: dict[str, SpeedTree] = {}

    def between(self, start: str, end: str) -> SpeedPath | None:
        """Speed path from one node to another, or None where no connection exists."""
        tree = self.tree(start, end).steps
        if start not in tree:
            return None
        steps = []
        node = start
        while node != end:
            step = tree[node]
            if step is None:
                break
            if not self._is_unity(step):
                steps.append(step)
            node = step.end
        return SpeedPath(tuple(steps))

    def tree(self, start: str, end: str) -> SpeedTree:
        """Next steps from all connected nodes towards the node ``end``.

        ``start`` is included if any way leads there.
        """
        if end not in self._trees:
            self._trees[end] = self._tree(end, ())
        tree = self._trees[end]
        return tree if start in tree.steps else self._tree(end, (start,))  # which moves after all

    @cached_property
    def _rows(self) -> list[_Held]:
        return [
            _Held(element, number, row)
            for element in self.elements
            for number, row in enumerate(element.mean_speed_rows(self.value))
        ]

    @cached_property
    def _at(self) -> dict[str, list[_Held]]:
        by_node: dict[str, list[_Held]] = {}
        for held in self._rows:
            for node in held.row:
                by_node.setdefault(node, []).append(held)
        return by_node

    def _is_unity(self, step: SpeedStep) -> bool:
        return step.alike or any(
            held.is_unity for held in self._at[step.start] if (held.element, held.number) == (step.element, step.row)
        )

    def _tree(self, end: str, moving: Sequence[str]) -> SpeedTree:
        still = self._standing({end, *moving})
        steps: dict[str, SpeedStep | None] = {end: None}
        closing = []
        waiting = [end]
        # Breadth first from the end, so that every node has the path of fewest steps.
        for node in waiting:
            for held in self._at.get(node, ()):
                for other in held.leads(node, still):
                    step = SpeedStep(held.element, held.number, other, node, alike=held.is_alike(still))
                    own = steps[node]
                    # A node met again closes a loop, unless by the row on which the search came.
                    if other not in steps:
                        steps[other] = step
                        waiting.append(other)
                    elif own is None or (own.element, own.row) != (held.element, held.number):
                        closing.append(step)
        return SpeedTree(steps, tuple(closing))

    def _standing(self, moving: set[str]) -> set[str]:
        """Nodes tied to ground by clamps and springs, without those that turn with the ``moving`` nodes."""
        tied = Groups[str]()
        held = set[str]()
        # Rows of two nodes tie them on average, a row of one node holds it.
        for tie in self._rows:
            if len(tie.row) == 2:
                tied.join(*tie.row)
            elif len(tie.row) == 1:
                held |= tie.row.keys()
        for element in self.elements:
            if element.glyph == "clamp":
                held |= {node for node in element.ports.values() if node != GROUND}
        # Whoever asks about a shaft means that it turns, with all that is tied to it.
        turning = {other for node in moving for other in tied.of(node)}
        return {other for node in held - turning for other in tied.of(node)}


# Second speed ratio between two shafts through a loop of springs and gears.

SAME_RATIO_RTOL = 1e-9
"""Relative difference of two speed ratios up to which they count as equal but for rounding."""


def second_ratio(tree: SpeedTree, start: str, value: Values) -> Any | None:
    """Speed ratio from start to end by another way than that of the tree, or None if no other ratio exists.

    A step that closes a loop leads around the steps that its start does not share with its end; the tree has closing
    steps in both directions.
    """
    # Ratio of every node to the end of the tree; the end of a step comes before its start there.
    ratios: dict[str, Any] = {}
    for node, step in tree.steps.items():
        ratios[node] = 1 if step is None else step.ratio(value) * ratios[step.end]
    way = _way(tree, start)
    for closing in tree.closing:
        # Product of the ratios round the loop that the step closes, 1 where both ways agree.
        factor = closing.ratio(value) * ratios[closing.end] / ratios[closing.start]
        if abs(factor - 1) <= SAME_RATIO_RTOL:
            continue
        here, there = _way(tree, closing.start), _way(tree, closing.end)
        if way & (here - there):
            return ratios[start] * factor
    return None


def _way(tree: SpeedTree, node: str) -> set[str]:
    """Nodes on the way from a node to the end of a speed tree, the end left out."""
    way = set[str]()
    step = tree.steps[node]
    while step is not None:
        way.add(step.start)
        step = tree.steps[step.end]
    return way
