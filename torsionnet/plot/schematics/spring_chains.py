"""Symbols of springs and dashpots in parallel and in series between the two ends of an element, from its laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from torsionnet.model.damping import LossFactor
from torsionnet.model.element_base.stiffness_rows import TableEntry
from torsionnet.model.elements import GROUND, Action, Element, Law, Part, Values
from torsionnet.plot.drawing.pieces import Stroke
from torsionnet.plot.schematics.outlines import Glyph, dashpot, rectangle, zigzag

LENGTH, DASHPOT_LENGTH = 48.0, 40.0  # points, of a symbol with a spring, and of one without
RAIL, BETWEEN = 6.0, 20.0
"""Distances in points from an end of a symbol to the rail that joins parallel chains, and between two chains."""

HALF = {"spring": 9.0, "damper": 6.0}

SeriesChain = tuple[str, ...]
"""Springs and dashpots in series from one end of an element to the other, as the words ``spring`` and ``damper``."""


def parallel_chains(element: Element, values: Mapping[str, Any]) -> list[SeriesChain]:
    """List of an element's chains of springs and dashpots in parallel, those that begin with a spring first.

    None if its laws form no chains.
    """
    edges = _edges(element, values)
    first, second = _ends(element, values)
    direct = [(what,) for ends, what in edges if ends == {first, second}]
    inner = dict.fromkeys(node for ends, _ in edges for node in ends if node not in (first, second))
    chains = [_chain(node, first, second, edges) for node in inner]
    if not all(chains):
        return []
    return sorted(dict.fromkeys([*direct, *chains]), key=lambda chain: (chain[0] != "spring", len(chain)))


def _ends(element: Element, values: Mapping[str, Any]) -> tuple[str, str]:
    nodes = [*element.ports.values()]
    return nodes[0], nodes[1] if len(nodes) > 1 else far_end(element, values)


def far_end(element: Element, values: Mapping[str, Any]) -> str:
    """Name of the node to which an element on one node leads: ground, its own mass, or empty if it leads nowhere."""
    parts = element.parts(Values(values))
    if GROUND in element.ports.values() or any(map(_resists_turning, parts)):
        return GROUND
    heavy = {node for part in parts if isinstance(part, Law) and part.inertia != 0 for node in part.row}
    return next((node for node in element.internal_nodes if node in heavy), "")


def _resists_turning(part: Part) -> bool:
    """Whether a law resists a common rotation of all nodes, at rest or at constant speed."""
    if isinstance(part, Action):
        return False
    acts = not isinstance(part, Law) or part.is_elastic or part.damping != 0
    return bool(acts and sum(part.row.values()) != 0)


def _edges(element: Element, values: Mapping[str, Any]) -> list[tuple[set[str], str]]:
    """Pairs (set of two nodes, "spring" or "damper") for the laws of an element on the difference of two angles."""
    found: list[tuple[set[str], str]] = []
    for part in element.parts(Values(values)):
        if isinstance(part, Law) and part.acts and len(part.row) in (1, 2) and not sum(_with_ground(part.row).values()):
            ends = set(_with_ground(part.row))
            found += [(ends, "spring")] if part.is_elastic else []
            found += [(ends, "damper")] if part.damping != 0 else []
    return found


def _with_ground(row: Mapping[str, Any]) -> dict[str, Any]:
    """Coefficients of a twist by name of the node, with that of ground, which rows of laws leave out."""
    return dict(row) if len(row) > 1 else dict(row) | {GROUND: -next(iter(row.values()))}


def _chain(node: str, first: str, second: str, edges: list[tuple[set[str], str]]) -> SeriesChain:
    """Two words, each "spring" or "damper", for what lies between the first end, an inner node and the second end.

    Empty if more than two meet there.
    """
    ways = [[what for ends, what in edges if ends == {node, end}] for end in (first, second)]
    if any(len(way) != 1 for way in ways) or sum(node in ends for ends, _ in edges) != len(ways):
        return ()
    return ways[0][0], ways[1][0]


def chain_symbol(element: Element, values: Mapping[str, Any], plain: str) -> Glyph:
    """Symbol of an element's springs and dashpots in a schematic, at least one of them of the kind ``plain``."""
    found = parallel_chains(element, values)
    if not any(plain in chain for chain in found):
        found = [(plain,), *found]
    return _symbol(tuple(found), _spring_sign(element))


def _spring_sign(element: Element) -> str:
    """Word for what is drawn with the springs of an element: a pad behind them, an arrow across, or a bent line."""
    kinds = [spec for _, spec in element.specs()]
    if any(isinstance(spec, LossFactor) for spec in kinds):
        return "loss factor"
    if any(isinstance(spec, TableEntry) for spec in kinds):
        return "table"
    return "law of motion" if element.has_motion_laws else ""


@cache
def _symbol(found: tuple[SeriesChain, ...], sign: str) -> Glyph:
    length = LENGTH if any("spring" in chain for chain in found) else DASHPOT_LENGTH
    if any(len(chain) > 1 for chain in found):
        length = 2 * LENGTH - 8
    if len(found) == 1:
        half_width = 13.0 if "spring" in found[0] else 9.0
        half = 8.0 if found[0] == ("damper",) else HALF["damper"]
        return Glyph(tuple(_chain_strokes(found[0], sign, 0, length, 0, half)), length, half_width)
    return _railed(found, sign, length + 2 * RAIL if length > LENGTH else length)


def _railed(found: Sequence[SeriesChain], sign: str, length: float) -> Glyph:
    top = BETWEEN / 2 * (len(found) - 1)
    heights = [top - BETWEEN * place for place in range(len(found))]
    rails = [Stroke(((x, heights[-1]), (x, top))) for x in (RAIL, length - RAIL)]
    leads = [Stroke(((0, 0), (RAIL, 0))), Stroke(((length - RAIL, 0), (length, 0)))]
    drawn = [
        stroke
        for chain, y in zip(found, heights, strict=True)
        for stroke in _chain_strokes(chain, sign, RAIL, length - RAIL, y, HALF["damper"])
    ]
    return Glyph((*leads, *rails, *drawn), length, top + 12)


def _chain_strokes(chain: SeriesChain, sign: str, start: float, end: float, y: float, half: float) -> list[Stroke]:
    step = (end - start) / len(chain)
    strokes: list[Stroke] = []
    for place, what in enumerate(chain):
        x = start + place * step
        strokes += _spring(sign, x, x + step, y) if what == "spring" else dashpot(x, x + step, y, half)
    return strokes


def _spring(sign: str, start: float, end: float, y: float) -> list[Stroke]:
    """Strokes of a spring, with a pad behind it for a loss factor, an arrow across it for a table over frequency.

    Across one whose torque is not proportional to its twist goes a bent line.
    """
    core = zigzag(start, end, y)
    middle = (start + end) / 2
    if sign == "loss factor":
        edge = (end - start) / 6
        return [rectangle(start + edge, end - edge, y - 9, y + 9, "#d9d9d9", "thin"), core]
    if sign == "table":
        shaft = ((middle - 15, y - 12), (middle + 14, y + 12))
        head = ((middle + 8.5, y + 11), (middle + 15, y + 12.8), (middle + 12.6, y + 6.6))
        return [core, Stroke(shaft, "thin"), Stroke(head, "thin")]
    if sign:
        return [core, Stroke(((middle - 15, y - 9), (middle + 2, y - 3), (middle + 14, y + 12)), "thin")]
    return [core]
