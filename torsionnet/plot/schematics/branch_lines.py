"""Branch lines of a schematic, led through a wire or gear wheels to the nearest free place above or below a line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.model.elements import GROUND, Element
from torsionnet.plot.drawing.pieces import Owner, Piece, Stroke, arc, box_array, overlap
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics.topology import Vertex

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
                block.strokes = [one._replace(owner=self.owner) for one in block.strokes]
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
