"""Branch lines of a schematic to a free place above or below its shaft, and wires that close loops."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.model.elements import GROUND, Element
from torsionnet.plot.drawing.pieces import (
    Box,
    LooseEnd,
    Owner,
    Piece,
    Point,
    Stroke,
    Texts,
    arc,
    box_array,
    label_width,
    overlap,
    shifted_box,
    text_width,
)
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics.drawing_plan import Mark, marks_beside
from torsionnet.plot.schematics.topology import Link, Vertex

if TYPE_CHECKING:
    from torsionnet.plot.schematics.drawing_plan import DrawingPlan


# Branch lines of a schematic, led through a wire or gear wheels to the nearest free place above or below a line.

STEP, FARTHEST = 4.0, 3000.0
SMALLEST_WHEELS, LARGEST_WHEELS, FARTHEST_WHEELS, SHORTEST_WIRE = 50.0, 110.0, 170.0, 36.0
MESH, ELBOW = 12.0, 12.0  # points: spring of a compliant mesh, shaft between a wheel and its line
SMALLEST_WHEEL_RATIO = 0.45
"""Least radius of a drawn gear wheel divided by that of its mate, whatever the gear ratio; below, it would be a dot."""

UP_IF = 0.6
"""Ratio of the distance upwards to that downwards below which a branch of the schematic is drawn above its line; a
larger value moves more branches above their line."""


@dataclass(frozen=True)
class GearPair:
    """Gear pair of a schematic between a line and a branch, with element, offset, texts and ratio of drawn radii."""

    element: Element
    offset: float
    """Horizontal distance in points (1/72 inch) from the start of a branch to the middle of its gear wheels."""
    texts: Sequence[tuple[str, str]]
    child_over_parent: float
    """Radius of the gear wheel on the branch over that of the wheel on the parent line."""

    @property
    def compliant(self) -> bool:
        """Whether the mesh of the gear pair has a stiffness."""
        return getattr(self.element, "stiffness", None) is not None


@dataclass(frozen=True)
class BranchStart:
    """Branch of a schematic still to be placed, with the point (x, y) in points at which it leaves its line.

    A line, given by its first vertex, or a finished piece.
    """

    x: float
    y: float
    what: Vertex | Piece
    stages: tuple[GearPair, ...] = ()
    owner: Owner | None = None
    """Node or element of the drivetrain from which the branch leaves."""

    @property
    def last(self) -> float:
        """Horizontal place in points of the last gear pair of the branch, or of its wire if it has no gears."""
        return self.x + (self.stages[-1].offset if self.stages else 0.0)


@dataclass(frozen=True)
class Branch:
    """Branch of a schematic with its finished drawing, and the point (x, y) in points at which it leaves its line."""

    x: float
    y: float
    block: Piece
    stages: tuple[GearPair, ...] = ()
    up_if: float = UP_IF
    """Ratio of the distance upwards to that downwards up to which the branch of the schematic is drawn above its line;
    0: never up."""
    owner: Owner | None = None
    """Node or element of the drivetrain from which the branch leaves."""

    def connector(self, distance: float) -> Piece:
        """Drawing of the wire or gear wheels from a line to a branch ``distance`` points below (negative for above)."""
        block = Piece()
        if not self.stages:
            block.line((self.x, self.y), (self.x, -distance))
            dot = Stroke(arc(self.x, self.y, 2.4, 2.4, 0, 360, 12), "part", closed=True, fill="part")
            block.strokes.append(dot)
            if self.owner is not None:
                block.strokes = [stroke._replace(owner=self.owner) for stroke in block.strokes]
        for stage in self.stages:
            with block.owned("element", stage.element.name):
                _wheels(block, stage, self.x + stage.offset, distance)
        return block


def wheel_ratio(element: Any, parent: str, values: Mapping[str, Any]) -> float:
    """Drawn radius of the gear wheel on a branch divided by that on its parent line, kept within drawable limits."""
    tau = abs(float(element.ratio_value(dict(values)))) if hasattr(element, "ratio_value") else 1.0
    ratio = tau if next(iter(element.ports.values())) == parent else 1 / tau
    return min(max(ratio, SMALLEST_WHEEL_RATIO), 1 / SMALLEST_WHEEL_RATIO)


def _wheels(block: Piece, stage: GearPair, x: float, distance: float) -> None:
    down = distance > 0
    mesh = MESH if stage.compliant else 0.0
    between = abs(distance) if abs(distance) < FARTHEST_WHEELS else LARGEST_WHEELS
    # Radii r_1 + r_2 = distance of the lines, in the ratio of the teeth.
    first = (between - mesh) / (1 + stage.child_over_parent)
    second = between - mesh - first
    side = -1 if down else 1
    block.strokes += [*outlines.wheel(x, 0, first), *outlines.wheel(x, side * between, second)]
    if between == abs(distance):
        block.line((x, -distance), (x + ELBOW, -distance))
    else:
        block.line((x, side * between), (x + ELBOW, side * between), (x + ELBOW, -distance))
    if mesh:
        spring = outlines.zigzag(0, mesh, 0, 4, 2)
        start = -first if down else first + mesh
        block.strokes += outlines.Glyph((spring,), mesh, 4).hanging(x, start)
    low, high = sorted((-side * first, side * (between + second)))
    half, beyond = 7.0, 3.0
    if stage.element.ports.get("housing", GROUND) != GROUND:
        half, beyond = 11.0, 8.0
        block.strokes.append(outlines.rectangle(x - half, x + half, low - 5, high + 5, look="housing"))
    block.boxes.append((x - half, x + half, low, high))
    block.write(x, -side * (first + beyond), stage.texts, upward=down)


def place_branches(base: Piece, drops: Sequence[Branch], *, may_rise: bool) -> None:
    """Add branches to the drawing of a shaft line at the nearest free places, from the rightmost to the leftmost."""
    for drop in reversed(drops):
        down = _distance(base, drop, 1)
        up = _distance(base, drop, -1) if may_rise and drop.up_if and drop.y == 0 else FARTHEST
        distance = -up if up < drop.up_if * down else down
        if distance >= FARTHEST:
            distance = _below(base, drop)
        base.add(drop.connector(distance))
        base.add(drop.block.shifted(drop.x, -distance))


def _distance(base: Piece, drop: Branch, sign: int) -> float:
    """Least distance in points from its line at which a branch and its connector meet nothing that was drawn before."""
    taken = box_array([*base.boxes, *base.wires])
    # The line itself lies between the wheels and below the start of a wire: that is no collision.
    own = [box for box in base.wires if box[2] < drop.y < box[3] or box[2] < 0 < box[3]]
    crossed = box_array(
        [*(box for box in base.boxes if not _holds(box, drop)), *(w for w in base.wires if w not in own)]
    )
    block = box_array([*drop.block.boxes, *drop.block.wires])
    block[:, :2] += drop.x
    down = np.array([0, 0, -sign, -sign])
    distance = (SMALLEST_WHEELS if drop.stages else SHORTEST_WIRE) - drop.y
    distance += MESH * any(stage.compliant for stage in drop.stages)
    while distance < FARTHEST:
        connector = drop.connector(sign * distance)
        joined = box_array([*connector.boxes, *connector.wires])
        there = block + distance * down
        free = not overlap(there, taken) and not overlap(joined, crossed, 2)
        if free and not overlap(box_array(connector.boxes), there[: len(drop.block.boxes)], 1):
            return distance
        distance += max(STEP, STEP * distance / 200)
    return FARTHEST


def _below(base: Piece, drop: Branch) -> float:
    """Distance in points of a branch placed below all that is drawn, for a connector that has to cross something."""
    _, _, bottom, _ = base.extent
    _, _, _, top = drop.block.extent
    return top - bottom + STEP


def _holds(box: tuple[float, float, float, float], drop: Branch) -> bool:
    """Whether a branch of the schematic starts at the edge of a box, or under a text inside that box."""
    return drop.y != 0 and box[0] <= drop.x <= box[1] and box[2] - 6 <= drop.y <= box[3]


# Row of symbols of a schematic from left to right, with the marks on it and the branches that leave it.

MANY_MARKS, MARK_LIFT = 4, 22.0
"""Number of marks in a row from which on every other one is raised, and the points by which it is raised."""


FAR_OUT = 1e5
"""Coordinate in points beyond any drawing."""
SIDE_GAP, VERTICAL_GAP = 7.0, 3.0
"""Least distances in points between neighbouring pieces of a schematic, sideways and up or down."""

NEGLIGIBLE = 1e-6
"""Distance in points far above rounding errors and far below a pixel."""
RECENT_BOXES = 120
"""Number of rectangles drawn last in a row against which a new piece of the schematic is checked for overlap: more take
time, fewer may let pieces overlap."""


class Row:
    """Row of pieces of a schematic, placed along y = 0 from left to right; ``x`` is where the last symbol ends."""

    def __init__(self, wall: float = -FAR_OUT, *, measures: bool = False) -> None:
        self.block = Piece()
        self.measures = measures
        """Whether only the room that the row takes is asked for, so that placed pieces need no strokes."""
        self.x = 0.0
        self.columns: list[Box] = []
        """Rectangles (x0, x1, y0, y1) in points above and below the row that are kept free for branches: wires and
        wheels."""
        self.wall = wall
        self.named_until = -FAR_OUT

    def put(self, piece: Piece, left: float, right: float, columns: Sequence[Box] = ()) -> float:
        """Place a piece drawn around x = 0 behind the others of the row, and return the x in points of its middle.

        ``left`` and ``right`` are the extents of its symbol, ``columns`` areas to be kept free around it.
        """
        own = [*piece.boxes, *columns]
        x = max(self.x + left, *(self.wall - box[0] for box in own), -FAR_OUT)
        near = min((box[0] for box in own), default=0.0) - SIDE_GAP - NEGLIGIBLE
        for there in [*self.block.boxes[-RECENT_BOXES:], *self.columns[-RECENT_BOXES:]]:
            for box in own if there[1] > x + near else ():
                if box[2] < there[3] + VERTICAL_GAP and there[2] < box[3] + VERTICAL_GAP:
                    x = max(x, there[1] + SIDE_GAP - box[0])
        self.block.add(piece.room_shifted(x, 0) if self.measures else piece.shifted(x, 0))
        self.columns += [shifted_box(box, x, 0) for box in columns]
        self.x = x + right
        return x

    def keep_free(self, width: float) -> float:
        """Keep a column of a width in points free above and below the row, and return the x in points of its middle."""
        return self.put(Piece(), width / 2, width / 2, [(-width / 2, width / 2, -FAR_OUT, FAR_OUT)])

    def name(self, start: float, texts: Texts) -> float:
        """Keep room above the row for a name over the symbols from ``start``, and return the x in points behind it."""
        half = label_width(texts) / 2
        end = max(self.x, start + 14, 2 * (self.named_until + SIDE_GAP + half) - start, 2 * (self.wall + half) - start)
        middle = (start + end) / 2
        self.named_until = middle + half
        self.x = end
        return end

    def draw_bracket(self, x0: float, x1: float, y: float) -> None:
        """Draw a bracket at height y over the symbols of the row from x0 to x1, in points."""
        self.block.strokes.append(Stroke(((x0, y - 3), (x0, y), (x1, y), (x1, y - 3)), "faint"))
        self.block.boxes.append((x0, x1, y - 2, y + 1))


class PlannedRow(Row):
    """Row of a schematic with its plan, the branches that leave the row, and brackets for the names of its nodes."""

    def __init__(self, plan: DrawingPlan, wall: float = -FAR_OUT, *, measures: bool = False) -> None:
        super().__init__(wall, measures=measures)
        self.plan = plan
        self.exits: list[BranchStart] = []
        self.brackets: list[tuple[float, float, str]] = []

    @property
    def values(self) -> Any:
        """Values of the drivetrain's parameters, by name of the parameter."""
        return self.plan.drivetrain.exact_values

    def link_marks(self, node: str, link: Link | None, *, alone: bool = True) -> list[Mark]:
        """List of the marks of the torque and twist sensors, at one node, on the elements of a schematic's link."""
        return marks_beside(self.plan.taps.get(node, ()), link, alone=alone) if link is not None else []

    def draw_marks_on_shaft(self, marks: Sequence[Mark]) -> None:
        """Draw marks of inputs and sensors on the row, with the piece of shaft on which they stand."""
        start = self.x
        self.draw_marks(marks)
        if marks:
            self.block.line((start, 0), (self.x, 0))

    def draw_marks(self, marks: Iterable[Mark]) -> None:
        """Draw marks of inputs and sensors on the shaft of the row, with their names above.

        Of many, every other name stands higher.
        """
        ordered = list(marks)
        for place, mark in enumerate(ordered):
            lift = MARK_LIFT if len(ordered) >= MANY_MARKS and place % 2 else 0.0
            piece = mark.piece(lift)
            self.put(piece, 9, 9)

    def add_loose_end(self, number: int, end: Vertex) -> None:
        """Add to the row a loose end that closes loop ``number`` at a node or box, with room for a tag with a name."""
        width = text_width(end.name, "node") + 10
        tag = (self.x, self.x + width, -8.0, 8.0)
        self.block.ends.append(LooseEnd(number, end.name, self.x, 0, tag))
        self.block.boxes.append(tag)
        self.x += width


# Wires that close the loops of a schematic, led on a grid the shortest way with few corners and crossings.

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
