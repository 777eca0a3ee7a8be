"""Springs and dashpots between the two ends of an element, read from its laws: in parallel, in series, or both."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.model.element_base.damping_entries import LossFactor
from torsionnet.model.element_base.stiffness_rows import TableEntry
from torsionnet.model.elements import GROUND, Action, Element, Law, Part, Values
from torsionnet.plot.drawing.pieces import Stroke
from torsionnet.plot.schematic.outlines import Glyph, dashpot, rectangle, zigzag

LENGTH, SHORT = 48.0, 40.0
RAIL, BETWEEN = 6.0, 20.0
"""From an end to the rail that joins strands in parallel; between two strands."""

HALF = {"spring": 9.0, "damper": 6.0}

Strand = tuple[str, ...]
"""What follows each other from one end to the other: ``spring`` and ``damper``."""


def strands(element: Element, values: Mapping[str, Any]) -> list[Strand]:
    """Ways from one end of an element to the other, springs first; none if its laws form no such ways."""
    edges = _edges(element, values)
    first, second = _ends(element, values)
    direct = [(what,) for ends, what in edges if ends == {first, second}]
    inner = dict.fromkeys(node for ends, _ in edges for node in ends if node not in (first, second))
    chains = [_chain(node, first, second, edges) for node in inner]
    if not all(chains):
        return []
    return sorted(dict.fromkeys([*direct, *chains]), key=lambda strand: (strand[0] != "spring", len(strand)))


def _ends(element: Element, values: Mapping[str, Any]) -> tuple[str, str]:
    nodes = [*element.ports.values()]
    return nodes[0], nodes[1] if len(nodes) > 1 else far_end(element, values)


def far_end(element: Element, values: Mapping[str, Any]) -> str:
    """Where an element on one node leads to: ground, a mass of its own, or empty where it leads nowhere."""
    parts = element.parts(Values(values))
    if GROUND in element.ports.values() or any(map(_resists_turning, parts)):
        return GROUND
    heavy = {node for part in parts if isinstance(part, Law) and part.inertia != 0 for node in part.row}
    return next((node for node in element.internal_nodes if node in heavy), "")


def _resists_turning(part: Part) -> bool:
    """Whether a part is felt when all nodes turn alike at a constant speed, or stand turned."""
    if isinstance(part, Action):
        return False
    acts = not isinstance(part, Law) or part.is_elastic or part.damping != 0
    return bool(acts and sum(part.row.values()) != 0)


def _edges(element: Element, values: Mapping[str, Any]) -> list[tuple[set[str], str]]:
    """What acts on the difference of two angles."""
    found: list[tuple[set[str], str]] = []
    for part in element.parts(Values(values)):
        if isinstance(part, Law) and part.acts and len(part.row) in (1, 2) and not sum(_with_ground(part.row).values()):
            ends = set(_with_ground(part.row))
            found += [(ends, "spring")] if part.is_elastic else []
            found += [(ends, "damper")] if part.damping != 0 else []
    return found


def _with_ground(row: Mapping[str, Any]) -> dict[str, Any]:
    """The row of a twist; a coefficient on ground has dropped out of it."""
    return dict(row) if len(row) > 1 else dict(row) | {GROUND: -next(iter(row.values()))}


def _chain(node: str, first: str, second: str, edges: list[tuple[set[str], str]]) -> Strand:
    """Two things in series by way of an inner node, or nothing if it is more than that."""
    ways = [[what for ends, what in edges if ends == {node, end}] for end in (first, second)]
    if any(len(way) != 1 for way in ways) or sum(node in ends for ends, _ in edges) != len(ways):
        return ()
    return ways[0][0], ways[1][0]


def network(element: Element, values: Mapping[str, Any], plain: str) -> Glyph:
    """Its strands between two rails, or its ``plain`` symbol alone if the laws say nothing else."""
    found = strands(element, values)
    if not any(plain in strand for strand in found):
        found = [(plain,), *found]
    length = LENGTH if any("spring" in strand for strand in found) else SHORT
    if any(len(strand) > 1 for strand in found):
        length = 2 * LENGTH - 8
    if len(found) == 1:
        reach = 13.0 if "spring" in found[0] else 9.0
        half = 8.0 if found[0] == ("damper",) else HALF["damper"]
        return Glyph(tuple(_strand(found[0], element, 0, length, 0, half)), length, reach)
    return _railed(found, element, length + 2 * RAIL if length > LENGTH else length)


def _railed(found: list[Strand], element: Element, length: float) -> Glyph:
    top = BETWEEN / 2 * (len(found) - 1)
    heights = [top - BETWEEN * place for place in range(len(found))]
    rails = [Stroke(((x, heights[-1]), (x, top))) for x in (RAIL, length - RAIL)]
    leads = [Stroke(((0, 0), (RAIL, 0))), Stroke(((length - RAIL, 0), (length, 0)))]
    drawn = [
        stroke
        for strand, y in zip(found, heights, strict=True)
        for stroke in _strand(strand, element, RAIL, length - RAIL, y, HALF["damper"])
    ]
    return Glyph((*leads, *rails, *drawn), length, top + 12)


def _strand(strand: Strand, element: Element, start: float, end: float, y: float, half: float) -> list[Stroke]:
    step = (end - start) / len(strand)
    strokes: list[Stroke] = []
    for place, what in enumerate(strand):
        x = start + place * step
        strokes += _spring(element, x, x + step, y) if what == "spring" else dashpot(x, x + step, y, half)
    return strokes


def _spring(element: Element, start: float, end: float, y: float) -> list[Stroke]:
    """A spring; a pad behind it where it loses energy in every cycle, an arrow across where it is known by a table."""
    core = zigzag(start, end, y)
    kinds = [spec for _, spec in element.specs()]
    if any(isinstance(spec, LossFactor) for spec in kinds):
        edge = (end - start) / 6
        return [rectangle(start + edge, end - edge, y - 9, y + 9, "#d9d9d9", "thin"), core]
    if any(isinstance(spec, TableEntry) for spec in kinds):
        middle = (start + end) / 2
        shaft = ((middle - 15, y - 12), (middle + 14, y + 12))
        head = ((middle + 8.5, y + 11), (middle + 15, y + 12.8), (middle + 12.6, y + 6.6))
        return [core, Stroke(shaft, "thin"), Stroke(head, "thin")]
    return [core]
