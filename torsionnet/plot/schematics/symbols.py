"""Symbols of a schematic: chains of springs and dashpots, boxes of gear sets, clearances and friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from torsionnet.model.damping import LossFactor
from torsionnet.model.element_base.stiffness_table import TableEntry
from torsionnet.model.elements import GROUND, Action, Element, Law, Part, Values
from torsionnet.plot.drawing.pieces import Stroke, arc
from torsionnet.plot.schematics.outlines import BODY, WHEEL, Glyph, dashpot, rectangle, zigzag

if TYPE_CHECKING:
    from torsionnet.plot.schematics.topology import BoxElement


# Symbols of springs and dashpots in parallel and in series between the two ends of an element, from its laws.

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
    edges: list[tuple[set[str], str]] = []
    for part in element.parts(Values(values)):
        if isinstance(part, Law) and part.acts and len(part.row) in (1, 2) and not sum(_with_ground(part.row).values()):
            ends = set(_with_ground(part.row))
            edges += [(ends, "spring")] if part.is_elastic else []
            edges += [(ends, "damper")] if part.damping != 0 else []
    return edges


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
    chains = parallel_chains(element, values)
    if not any(plain in chain for chain in chains):
        chains = [(plain,), *chains]
    return _symbol(tuple(chains), _spring_sign(element))


def _spring_sign(element: Element) -> str:
    """Word for what is drawn with the springs of an element: a pad behind them, an arrow across, or a bent line."""
    kinds = [spec for _, spec in element.specs()]
    if any(isinstance(spec, LossFactor) for spec in kinds):
        return "loss factor"
    if any(isinstance(spec, TableEntry) for spec in kinds):
        return "table"
    return "law of motion" if element.has_motion_laws else ""


@cache
def _symbol(chains: tuple[SeriesChain, ...], sign: str) -> Glyph:
    length = LENGTH if any("spring" in chain for chain in chains) else DASHPOT_LENGTH
    if any(len(chain) > 1 for chain in chains):
        length = 2 * LENGTH - 8
    if len(chains) == 1:
        half_width = 13.0 if "spring" in chains[0] else 9.0
        half = 8.0 if chains[0] == ("damper",) else HALF["damper"]
        return Glyph(tuple(_chain_strokes(chains[0], sign, 0, length, 0, half)), length, half_width)
    return _railed(chains, sign, length + 2 * RAIL if length > LENGTH else length)


def _railed(chains: Sequence[SeriesChain], sign: str, length: float) -> Glyph:
    top = BETWEEN / 2 * (len(chains) - 1)
    heights = [top - BETWEEN * place for place in range(len(chains))]
    rails = [Stroke(((x, heights[-1]), (x, top))) for x in (RAIL, length - RAIL)]
    leads = [Stroke(((0, 0), (RAIL, 0))), Stroke(((length - RAIL, 0), (length, 0)))]
    drawn = [
        stroke
        for chain, y in zip(chains, heights, strict=True)
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


# Symbols inside boxes of a schematic, as a planetary set seen along its axis or a differential.

HALF_SIZE = 24.0
"""Half the width and height in points of a symbol inside a box of the schematic."""

RING, ROOT, SUN, MOST_PLANETS = 23.5, 20.5, 8.0, 6  # radii in points: rim and teeth of the ring, sun
PLANET = (ROOT - SUN) / 2  # radius in points that fills the gap between sun and ring


def box_symbol(element: BoxElement, x: float, y: float) -> list[Stroke]:
    """Strokes of the symbol of an element inside a box of the schematic, around (x, y) in points.

    There are none for elements without a symbol.
    """
    if element.glyph == "planetary":
        given: Any = getattr(element, "planets", 3)
        return planetary_symbol(
            x, y, len(given) if isinstance(given, tuple) else given if isinstance(given, int) else 3
        )
    if element.glyph == "differential":
        locked = bool(getattr(element, "locked", False)) or getattr(element, "differential", "") == "locked"
        return differential_symbol(x, y, locked=locked)
    drawn = SHARED_SYMBOLS.get(element.glyph)
    return [stroke.shifted(x, y) for stroke in drawn()] if drawn else []


def gearbox_symbol() -> list[Stroke]:
    """Strokes of the symbol of a gearbox around (0, 0) in points, two shafts with three pairs of wheels."""
    shafts = [Stroke(((-22, y), (22, y)), "part") for y in (9, -9)]
    pairs = ((-13, 6.5), (0, 9.0), (13, 11.5))
    wheels = []
    for x, upper in pairs:
        wheels += [
            rectangle(x - 3, x + 3, 9 - upper, 9 + upper, WHEEL),
            rectangle(x - 3, x + 3, upper - 27, 9 - upper, WHEEL),
        ]
    return [*shafts, *wheels]


def belt_symbol() -> list[Stroke]:
    """Strokes of the symbol of a belt around (0, 0) in points, two pulleys with the belt, seen along their axes."""
    (left, big), (right, small) = (-11.0, 11.0), (14.0, 7.0)
    tilt = math.degrees(math.asin((big - small) / (right - left)))
    around = (
        *arc(left, 0, big, big, 90 - tilt, 270 + tilt, 24),
        *arc(right, 0, small, small, tilt - 90, 90 - tilt, 24),
    )
    hubs = [_circle(x, 0, 1.5, "part") for x in (left, right)]
    wheels = [_circle(left, 0, big - 2, WHEEL), _circle(right, 0, small - 2, WHEEL)]
    return [Stroke(around, "part", closed=True, fill="#ffffff"), *wheels, *hubs]


def hydrodynamic_symbol() -> list[Stroke]:
    """Strokes of the symbol of a fluid coupling or converter around (0, 0) in points, two half shells with blades."""
    strokes: list[Stroke] = []
    for sign in (-1, 1):
        shell = tuple((sign * (x + 2), y) for x, y in arc(0, 0, 14, 18, -90, 90, 20))
        strokes.append(Stroke(shell, "part", closed=True, fill=WHEEL))
        strokes += [Stroke(((sign * 2, y), (sign * 13, y)), "thin") for y in (-9, 0, 9)]
    return strokes


SHARED_SYMBOLS: dict[str, Callable[[], list[Stroke]]] = {
    "gearbox": gearbox_symbol,
    "belt": belt_symbol,
    "hydrodynamic": hydrodynamic_symbol,
}
"""Functions that return the strokes of symbols used in boxes and between two ends, by the element's ``glyph``."""


def planetary_symbol(x: float, y: float, planets: int = 3) -> list[Stroke]:
    """Strokes of the symbol of a planetary set seen along the axis, around (x, y) in points.

    The carrier is the star that joins the planets' axles.
    """
    count = max(1, min(planets, MOST_PLANETS))
    orbit = (ROOT + SUN) / 2
    angles = [math.pi / 2 + 2 * math.pi * i / count for i in range(count)]
    axles = [(x + orbit * math.cos(angle), y + orbit * math.sin(angle)) for angle in angles]
    # Many planets get smaller, so that they do not touch each other.
    radius = min(PLANET, orbit * math.sin(math.pi / count) - 0.8) if count > 1 else PLANET
    wheels = [_circle(u, v, radius, WHEEL) for u, v in axles]
    carrier = [Stroke(((x, y), axle), "carrier") for axle in axles]
    hubs = [_circle(u, v, 1.5, "part") for u, v in (*axles, (x, y))]
    outer = [_circle(x, y, RING, BODY), _circle(x, y, ROOT, "#ffffff")]
    return [*outer, *wheels, _circle(x, y, SUN, WHEEL), *carrier, *hubs]


def differential_symbol(x: float, y: float, *, locked: bool = False) -> list[Stroke]:
    """Strokes of the symbol of a differential, around (x, y) in points.

    Side gears and pinions in a cage, with a bar between the side gears if locked.
    """
    cage = Stroke(_rectangle(x, y, 23, 21), "part", closed=True, fill="#ffffff")
    sides = [_bevel(x, y, sign, level=True) for sign in (-1, 1)]
    pinions = [_bevel(x, y, sign, level=False) for sign in (-1, 1)]
    shafts = [Stroke(((x + sign * 16, y), (x + sign * 23, y)), "shaft") for sign in (-1, 1)]
    pin = Stroke(((x, y - 21), (x, y + 21)), "thin")
    lock = [rectangle(x - 10, x + 10, y - 2.5, y + 2.5, "part")] if locked else []
    return [cage, pin, *shafts, *sides, *pinions, *lock]


def _bevel(x: float, y: float, sign: int, *, level: bool) -> Stroke:
    """Stroke of a bevel gear in the symbol of a differential about (x, y) in points, its small end inwards."""
    corners = ((7.0, -5.5), (16.0, -12.0), (16.0, 12.0), (7.0, 5.5))
    points = ((x + sign * u, y + v) if level else (x + v, y + sign * u) for u, v in corners)
    return Stroke(tuple(points), "part", closed=True, fill=WHEEL)


def _rectangle(x: float, y: float, width: float, height: float) -> tuple[tuple[float, float], ...]:
    return ((x - width, y - height), (x + width, y - height), (x + width, y + height), (x - width, y + height))


def _circle(x: float, y: float, radius: float, fill: str) -> Stroke:
    return Stroke(arc(x, y, radius, radius, 0, 360, 36), "thin", closed=True, fill=fill)


# Symbols of elements with laws of motion in a schematic: clearances and dry friction.

_HALF = 10.0  # points, half height of both symbols


def clearance_symbol() -> Glyph:
    """Symbol of a clearance in a schematic, a tooth that stands free between the two jaws of a fork."""
    back, first, jaw, second, tip = 12.0, 16.0, 4.0, 36.0, 40.0
    fork = [
        Stroke(((0, 0), (back, 0)), "shaft"),
        Stroke(((back, 0), (back, _HALF), (tip, _HALF), (tip, _HALF - jaw))),
        Stroke(((first, _HALF), (first, _HALF - jaw))),
    ]
    tooth = rectangle((first + second) / 2 - 3, (first + second) / 2 + 3, -_HALF, _HALF - 2, BODY)
    lead = Stroke((((first + second) / 2, -_HALF), (second + 16, -_HALF), (second + 16, 0)), "shaft")
    return Glyph((*fork, lead, tooth), second + 16, _HALF + 1)


def friction_symbol(element: Element) -> Glyph:
    """Symbol of dry friction in a schematic, two plates pressed together, behind a spring if the element has one."""
    start = 36.0 if element.internal_nodes else 0.0
    middle = start + 18.0
    inner, outer = 3.0, 8.0  # points from the middle to both faces of a plate
    leads = [
        Stroke(((start, 0), (middle - outer, 0)), "shaft"),
        Stroke(((middle + outer, 0), (middle + 18, 0)), "shaft"),
    ]
    plates = [
        rectangle(middle - outer, middle - inner, -_HALF, _HALF, BODY),
        rectangle(middle + inner, middle + outer, -_HALF, _HALF, BODY),
    ]
    hatches = [
        Stroke(((middle - 3, y), (middle + 3, y + 5)), "thin") for y in (-_HALF, -_HALF + 5, -_HALF + 10, -_HALF + 15)
    ]
    spring = [zigzag(0.0, start, 0.0)] if start else []
    return Glyph((*spring, *leads, *plates, *hatches), middle + 18, _HALF + 1)
