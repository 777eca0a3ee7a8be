"""Wires that close the loops of a schematic, led on a grid the shortest way with few corners and crossings."""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray

from torsionnet.plot.drawing.pieces import Box, LooseEnd, Piece, Point, Stroke, arc

CELL = 5.0
"""Width in points of a cell of the grid along which wires of the schematic are led; smaller ones find more ways and
take more time."""
CORNER, CROSSING, CROWD = 6, 12, 2  # costs in cells: of a corner, of crossing a line, of a cell close to a symbol
MOST_LOOPS = 8
"""Largest number of loops of a schematic that are closed by drawn wires; more wires could not be followed, and all
loops are tagged instead."""

MOST_CORNERS = 4
"""Largest number of corners of a wire of the schematic, above which a tag closes the loop instead."""

END_CELLS = 3
"""Number of grid cells at each end of a wire within which it may cross the shaft lines that it joins."""

_TURNS = ((0, 1, 3), (0, 1, 2), (1, 2, 3), (0, 2, 3))
"""Headings after each heading, none of them back: 0 to the right, 1 up, 2 to the left, 3 down."""
FAR = 1 << 60
"""Cost above that of any way."""


@dataclass(frozen=True)
class Grid:
    """Grid over a schematic with the cost of a wire's step onto each cell, -1 where no step is possible."""

    left: float
    bottom: float
    cost: NDArray[np.int64]

    def cell(self, point: Point) -> tuple[int, int]:
        """Indices (column, row) of the grid cell nearest to a place (x, y) in points."""
        return round((point[0] - self.left) / CELL), round((point[1] - self.bottom) / CELL)

    def point(self, cell: tuple[int, int]) -> Point:
        """Coordinates (x, y) in points of a grid cell given by column and row."""
        return self.left + CELL * cell[0], self.bottom + CELL * cell[1]


def draw_loops(block: Piece) -> None:
    """Draw a wire from every loose end of the schematic to the node that closes its loop, or a tag with its name."""
    ends, block.ends = block.ends, []
    for end in ends:
        way = _route(block, end) if len(ends) <= MOST_LOOPS else None
        if way is None:
            with block.owned("node", end.node):
                _tag(block, end)
        else:
            block.boxes.remove(end.tag)
            x, y = way[-1]
            with block.owned("node", end.node):
                block.line(*way, look="wire")
                block.strokes.append(Stroke(arc(x, y, 2.4, 2.4, 0, 360, 12), "wire", closed=True, fill="wire"))


def _tag(block: Piece, end: LooseEnd) -> None:
    x0, x1, y0, y1 = end.tag
    outline = ((x0, end.y), (x0 + 4, y0), (x1, y0), (x1, y1), (x0 + 4, y1))
    block.strokes.append(Stroke(outline, "thin", closed=True, fill="#ffffff"))
    block.write((x0 + x1) / 2 + 2, end.y - 5.5, [(end.node, "node")])


def _route(block: Piece, end: LooseEnd) -> list[Point] | None:
    target = block.anchors[end.loop]
    grid = _grid(block, end, target)
    way = _shortest(grid, grid.cell((end.x, end.y)), grid.cell(target))
    if way is None or _winds(grid, way):
        return None
    # The grid need not pass exactly through the ends: pull the first and last straight pieces onto them.
    return _cornered([grid.point(cell) for cell in way], (end.x, end.y), target)


def _grid(block: Piece, end: LooseEnd, target: Point) -> Grid:
    x0, x1, y0, y1 = block.extent
    left, bottom = x0 - 4 * CELL, y0 - 4 * CELL
    shape = (int((x1 - x0) / CELL) + 9, int((y1 - y0) / CELL) + 9)
    cost = np.ones(shape, dtype=np.int64)
    grid = Grid(left, bottom, cost)
    for box in block.boxes:
        if box != end.tag:
            cost[_cells(grid, box, 9)] = np.maximum(cost[_cells(grid, box, 9)], CROWD)
    for wire in block.wires:
        cost[_cells(grid, wire, 1)] = CROSSING
    for box in block.boxes:
        if box != end.tag:
            cost[_cells(grid, box, 3)] = -1
    for x, y in ((end.x, end.y), target):
        column, row = grid.cell((x, y))
        cost[column, row] = 1
    return grid


def _cells(grid: Grid, box: Box, margin: float) -> tuple[slice, slice]:
    x0, x1, y0, y1 = box
    low = (x0 - margin - grid.left) / CELL, (y0 - margin - grid.bottom) / CELL
    high = (x1 + margin - grid.left) / CELL, (y1 + margin - grid.bottom) / CELL
    first = [max(0, int(np.ceil(value))) for value in low]
    last = [int(np.floor(value)) + 1 for value in high]
    return slice(first[0], last[0]), slice(first[1], last[1])


def _shortest(grid: Grid, start: tuple[int, int], goal: tuple[int, int]) -> list[tuple[int, int]] | None:
    """Grid cells (column, row) of the cheapest way of a wire, which starts to the right and arrives up or down.

    A state is one whole number: four times that of the cell, which a frame of forbidden cells surrounds, plus the
    heading. States are taken up by their cost and the least that the rest of the way can cost (A*).
    """
    column = grid.cost.shape[1] + 2
    costs = np.pad(grid.cost, 1, constant_values=-1).ravel().tolist()
    least = _least_rest(grid, goal)
    begin = 4 * ((start[0] + 1) * column + start[1] + 1)
    goals = [4 * ((goal[0] + 1) * column + goal[1] + 1) + heading for heading in (1, 3)]
    steps, size = (column, 1, -column, -1), len(least)  # steps in the order of the headings
    best = [FAR] * size
    best[begin] = 0
    queue, bound = [least[begin] * size + begin], FAR
    while queue:
        whole, state = divmod(heappop(queue), size)
        if whole > bound:
            break
        cost = whole - least[state]
        if cost > best[state]:
            continue
        if state in goals:
            bound = whole
            continue
        cell, heading = divmod(state, 4)
        for turn in _TURNS[heading]:
            there = cell + steps[turn]
            step = costs[there]
            if step > 0:
                total = cost + step if turn == heading else cost + step + CORNER
                new = 4 * there + turn
                if total < best[new]:
                    best[new] = total
                    heappush(queue, (total + least[new]) * size + new)
    arrived = min(goals, key=lambda state: (best[state], state))
    return _traced(arrived, begin, best, costs, column) if best[arrived] < FAR else None


def _least_rest(grid: Grid, goal: tuple[int, int]) -> list[int]:
    """Least cost of the rest of a way without anything in its way, by state: its length and its corners."""
    x, y = np.meshgrid(*(np.arange(-1, count + 1) for count in grid.cost.shape), indexing="ij")
    right, up = goal[0] - x, goal[1] - y
    corners = np.empty((*x.shape, 4), dtype=int)
    for heading, sign in ((0, 1), (2, -1)):
        corners[..., heading] = np.where(sign * right >= 0, 1, 3)
    for heading, sign in ((1, 1), (3, -1)):
        corners[..., heading] = np.where(right != 0, 2, np.where(sign * up >= 0, 0, 4))
    return list(((np.abs(right) + np.abs(up))[..., None] + CORNER * corners).ravel().tolist())


def _winds(grid: Grid, way: list[tuple[int, int]]) -> bool:
    """Whether the way of a wire has too many corners, or crosses a shaft line other than those at its ends."""
    turns = sum((a[0] == b[0]) != (b[0] == c[0]) for a, b, c in zip(way, way[1:], way[2:], strict=False))
    return turns > MOST_CORNERS or any(grid.cost[cell] >= CROSSING for cell in way[END_CELLS:-END_CELLS])


def _traced(state: int, begin: int, best: list[int], costs: list[int], column: int) -> list[tuple[int, int]]:
    """Cells of the cheapest way that arrives in a state; of two that cost the same, the cheaper beginning counts."""
    steps, way = (column, 1, -column, -1), []
    while True:
        cell, turn = divmod(state, 4)
        x, y = divmod(cell, column)
        way.append((x - 1, y - 1))
        if state == begin:
            return way[::-1]
        before = [(4 * (cell - steps[turn]) + heading, CORNER * (heading != turn)) for heading in _TURNS[turn]]
        state = min(
            (earlier for earlier, corner in before if best[earlier] + costs[cell] + corner == best[state]),
            key=lambda earlier: (best[earlier], earlier),
        )


def _cornered(points: list[Point], start: Point, end: Point) -> list[Point]:
    """Corners of a wire of the schematic as places (x, y) in points, moved so that the wire meets both its ends."""
    corners = [points[0]]
    for before, here, after in zip(points, points[1:], points[2:], strict=False):
        if (before[0] == here[0]) != (here[0] == after[0]):
            corners.append(here)
    corners.append(points[-1])
    if len(corners) == 2:
        return [start, (end[0], start[1]), end]
    level = points[0][1] == points[1][1]
    corners[1] = (corners[1][0], start[1]) if level else (start[0], corners[1][1])
    corners[-2] = (end[0], corners[-2][1])
    return [start, *corners[1:-1], end]
