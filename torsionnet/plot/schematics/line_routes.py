"""Routes of the shaft lines of a schematic, their nodes and boxes in order, and cuts that fit the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import NamedTuple

from torsionnet.plot.schematics.topology import Link, Tree, Vertex, heights

PIECE, MISPLACED, LATE = 2e4, 1e6, 30.0
"""Costs in squared points of a cut shaft line, of each piece, of each branch that would fit elsewhere, and of each
point by which such a branch is offset."""


@dataclass(frozen=True)
class LineRoute:
    """Nodes, boxes and links in order along one shaft line of a schematic, and the link from its parent line."""

    incoming: Link | None
    parent: Vertex | None
    vertices: tuple[Vertex, ...]
    links: tuple[Link, ...]
    """Links from each node or box of the shaft line to the next, and, if the line is cut behind the last, the link
    there."""
    before: Link | None = None
    """Link at which the shaft line is cut before its first node or box, None if the line begins there."""
    shares: tuple[tuple[int, int], ...] = ()
    """Pairs (index from 0, number of parts) that tell which part of a node or box of the shaft line is drawn at each
    place; empty: all are whole."""

    def share(self, place: int) -> tuple[int, int]:
        """Pair (index from 0, number of parts) that tells which part of a node is drawn at a place of the line."""
        return self.shares[place] if self.shares else (0, 1)

    def cut(self, first: int, last: int) -> LineRoute:
        """Route of a piece of the shaft line, from the node or box with index ``first`` to the one before ``last``."""
        before = self.links[first - 1] if first else self.before
        incoming = None if first else self.incoming
        shares = self.shares[first:last]
        return LineRoute(incoming, self.parent, self.vertices[first:last], self.links[first:last], before, shares)

    def split(self, crowded: Mapping[Vertex, int]) -> LineRoute:
        """Copy of the route in which crowded nodes are split into parts with a piece of shaft between the parts."""
        vertices: list[Vertex] = []
        links: list[Link] = []
        shares: list[tuple[int, int]] = []
        for vertex, onward in zip_longest(self.vertices, self.links):
            parts = crowded.get(vertex, 1)
            vertices += [vertex] * parts
            links += [Link(vertex, vertex)] * (parts - 1) + ([onward] if onward is not None else [])
            shares += [(part, parts) for part in range(parts)]
        return LineRoute(self.incoming, self.parent, tuple(vertices), tuple(links), self.before, tuple(shares))


class BranchWidth(NamedTuple):
    """Distance in points of a branch from the start of its node, and width in points with the branch's own branches."""

    x: float
    need: float


class RouteStep(NamedTuple):
    """Widths in points of one node of a shaft line with the elements after it, and of the texts beyond either side."""

    width: float
    left: float
    right: float
    leaving: tuple[BranchWidth, ...]

    @property
    def whole(self) -> float:
        """Width in points of a node of a shaft line with the elements after it and the texts beyond either side."""
        return self.left + self.width + self.right


def line_routes(tree: Tree) -> dict[Vertex, LineRoute]:
    """Routes of the shaft lines of a tree, by the first node or box of each, lines nearer to the root first."""
    height = heights(tree)
    found: dict[Vertex, LineRoute] = {}
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
        found[head] = LineRoute(incoming, parent, tuple(vertices), tuple(links))
    return found


def line_width(start: float, steps: Sequence[RouteStep]) -> float:
    """Width in points of a shaft line in one piece, with all its branches."""
    x = start + max(0.0, steps[0].left - start)
    far = x
    for step in steps:
        far = max(far, x + step.width + step.right, *(x + leaving.x + leaving.need for leaving in step.leaving))
        x += step.width
    return far


def piece_starts(start: float, steps: Sequence[RouteStep], room: float, margin: float) -> list[int]:
    """Indices, from 0, of the nodes or boxes of a shaft line at which the pieces of the cut line begin.

    Few, of like width, with room for branches.
    """
    if line_width(start, steps) <= room:
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
    """Indices of the nodes of a line at which a piece that ends before index ``end`` may begin to fit a room in points.

    At least one step.
    """
    found = [end - 1]
    width = steps[end - 1].width + steps[end - 1].right
    for first in range(end - 2, -1, -1):
        width += steps[first].width
        if width + steps[first].left > room:
            break
        found.append(first)
    return found


def _cost(piece: Sequence[RouteStep], start: float, room: float) -> float:
    """Cost in squared points of a piece of a cut shaft line, from empty room, squared, and branches that do not fit."""
    x, cost = max(start, piece[0].left), PIECE
    for step in piece:
        for leaving in step.leaving:
            begin = x + leaving.x
            if begin + leaving.need > room:
                cost += MISPLACED * (step.left + leaving.x + leaving.need <= room) + LATE * begin
        x += step.width
    far = max(x + piece[-1].right, line_width(start, piece) if cost < MISPLACED else x)
    return cost + (room - min(far, room)) ** 2 + MISPLACED * max(0.0, x - room)
