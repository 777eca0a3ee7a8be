"""The lines of a schematic: which vertices follow each other on one shaft, and where a line is cut to fit the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import NamedTuple

from torsionnet.plot.schematic.topology import Link, Tree, Vertex, heights

PIECE, MISPLACED, LATE = 2e4, 1e6, 30.0
"""Costs, in squared points: of one more piece, of a branch that would fit elsewhere, of a point it begins later."""


@dataclass(frozen=True)
class Course:
    """Which vertices make up a line, and how it is reached."""

    incoming: Link | None
    parent: Vertex | None
    vertices: tuple[Vertex, ...]
    links: tuple[Link, ...]
    """Between the vertices; one more where the line is cut."""
    before: Link | None = None
    """The link at the cut."""
    shares: tuple[tuple[int, int], ...] = ()
    """Which part of its vertex each entry is, and of how many; all are whole if not given."""

    def share(self, place: int) -> tuple[int, int]:
        return self.shares[place] if self.shares else (0, 1)

    def cut(self, first: int, last: int) -> Course:
        """The piece from one vertex to another, with the link after it."""
        before = self.links[first - 1] if first else self.before
        incoming = None if first else self.incoming
        shares = self.shares[first:last]
        return Course(incoming, self.parent, self.vertices[first:last], self.links[first:last], before, shares)

    def split(self, crowded: Mapping[Vertex, int]) -> Course:
        """With vertices in several parts, a piece of shaft between them."""
        vertices: list[Vertex] = []
        links: list[Link] = []
        shares: list[tuple[int, int]] = []
        for vertex, onward in zip_longest(self.vertices, self.links):
            parts = crowded.get(vertex, 1)
            vertices += [vertex] * parts
            links += [Link(vertex, vertex)] * (parts - 1) + ([onward] if onward is not None else [])
            shares += [(part, parts) for part in range(parts)]
        return Course(self.incoming, self.parent, tuple(vertices), tuple(links), self.before, tuple(shares))


class Leaving(NamedTuple):
    """A line that leaves a step: how far from the step's start, and how wide it is with all that leaves it."""

    x: float
    need: float


class RouteStep(NamedTuple):
    """One vertex of a course with the elements after it; its texts may reach beyond it to both sides."""

    width: float
    left: float
    right: float
    leaving: tuple[Leaving, ...]

    @property
    def whole(self) -> float:
        return self.left + self.width + self.right


def courses(tree: Tree) -> dict[Vertex, Course]:
    """The lines of a tree by their heads, those nearer to the root first."""
    height = heights(tree)
    found: dict[Vertex, Course] = {}
    heads: list[tuple[Link | None, Vertex | None, Vertex]] = [(None, None, tree.root)]
    for incoming, parent, head in heads:
        vertices, links = [head], []
        while True:
            here = vertices[-1]
            going = [(link, child) for link, child in tree.children[here] if not link.is_gear]
            onward = max(going, key=lambda pair: (height[pair[1]], -pair[0].rank), default=None)
            heads += [(link, here, child) for link, child in tree.children[here] if (link, child) != onward]
            if onward is None:
                break
            links.append(onward[0])
            vertices.append(onward[1])
        found[head] = Course(incoming, parent, tuple(vertices), tuple(links))
    return found


def needed(start: float, steps: Sequence[RouteStep]) -> float:
    """Width of a line in one piece, with everything that leaves it."""
    x = start + max(0.0, steps[0].left - start)
    far = x
    for step in steps:
        far = max(far, x + step.width + step.right, *(x + leaving.x + leaving.need for leaving in step.leaving))
        x += step.width
    return far


def cuts(start: float, steps: Sequence[RouteStep], room: float, margin: float) -> list[int]:
    """Where the pieces of a line begin: few pieces of like width, and room for what leaves them."""
    if needed(start, steps) <= room:
        return [0]
    narrow = room - margin
    best: list[float] = [0.0]
    came: list[int] = [0]
    for end in range(1, len(steps) + 1):
        choices = {first: best[first] + _cost(steps[first:end], start if first == 0 else 0.0, narrow)
                   for first in _firsts(steps, end, narrow)}  # fmt: skip
        first = min(choices, key=lambda place: choices[place])
        best.append(choices[first])
        came.append(first)
    begins = [came[-1]]
    while begins[-1]:
        begins.append(came[begins[-1]])
    return begins[::-1]


def _firsts(steps: Sequence[RouteStep], end: int, room: float) -> list[int]:
    """Beginnings of a piece with this end that fits; one step always has to do."""
    found = [end - 1]
    width = steps[end - 1].width + steps[end - 1].right
    for first in range(end - 2, -1, -1):
        width += steps[first].width
        if width + steps[first].left > room:
            break
        found.append(first)
    return found


def _cost(piece: Sequence[RouteStep], start: float, room: float) -> float:
    """Empty room, squared, and what branches that do not fit cost."""
    x, cost = max(start, piece[0].left), PIECE
    for step in piece:
        for leaving in step.leaving:
            begin = x + leaving.x
            if begin + leaving.need > room:
                cost += MISPLACED * (step.left + leaving.x + leaving.need <= room) + LATE * begin
        x += step.width
    far = max(x + piece[-1].right, needed(start, piece) if cost < MISPLACED else x)
    return cost + (room - min(far, room)) ** 2 + MISPLACED * max(0.0, x - room)
