"""Symbols of elements in a schematic: chains of springs and dashpots, gear sets, clearances, friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from torsionnet.model.damping import LossFactor
from torsionnet.model.element_base.stiffness_table import TableEntry
from torsionnet.model.elements import GROUND, Action, Element, Law, Part, Values
from torsionnet.plot.drawing.pieces import Point, Stroke, arc
from torsionnet.plot.schematics.outlines import BODY, BOX, WHEEL, Glyph, dashpot, rectangle, wheel, zigzag

if TYPE_CHECKING:
    from torsionnet.plot.schematics.topology import BoxElement


# Symbols of a schematic: chains of springs and dashpots, boxes of gear sets, clearances and friction.

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


# Symbols of elements between two ends in a schematic, drawn along a line from (0, 0).

_LENGTH, _BOX_HALF = 52.0, 14.0


def _spring_glyph(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an element with stiffness in a schematic, springs and dashpots, with discs if both ends are heavy."""
    between = chain_symbol(element, values, "spring")
    ends = [*element.ports.values()]
    heavy = {
        node
        for part in element.parts(Values(values))
        if isinstance(part, Law) and part.inertia != 0 and len(part.row) == 1
        for node in part.row
    }
    return _between_discs(between) if len(ends) == 2 and heavy.issuperset(ends) else between


def _between_discs(inner: Glyph) -> Glyph:
    """Copy of a symbol of the schematic with a disc added at either end."""
    first, width, half = 4.0, 8.0, max(16.0, inner.half_width)
    start = first + width
    end = start + inner.length
    leads = (Stroke(((0, 0), (first, 0)), "shaft"), Stroke(((end + width, 0), (end + start, 0)), "shaft"))
    discs = (rectangle(first, start, -half, half, BODY), rectangle(end, end + width, -half, half, BODY))
    return Glyph((*leads, *inner.along(start, 0), *discs), end + start, half + 1)


def _damper(element: Element, values: Mapping[str, Any]) -> Glyph:
    return chain_symbol(element, values, "damper")


def _disc(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an inertia between two ends of a schematic, a disc on a shaft."""
    del element, values
    return Glyph((Stroke(((0, 0), (30, 0)), "shaft"), rectangle(8.5, 21.5, -15, 15, BODY)), 30, 16)


def _clearance(element: Element, values: Mapping[str, Any]) -> Glyph:
    del element, values
    return clearance_symbol()


def _friction(element: Element, values: Mapping[str, Any]) -> Glyph:
    del values
    return friction_symbol(element)


def _coupling(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a coupling in a schematic, two flanges face to face."""
    del element, values
    flanges = (rectangle(10, 15, -13, 13, BODY), rectangle(15, 20, -13, 13, BODY))
    return Glyph((Stroke(((0, 0), (10, 0)), "shaft"), *flanges, Stroke(((20, 0), (30, 0)), "shaft")), 30, 14)


def _shaft(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a shaft in a schematic, a thin cylinder with lines between its segments."""
    del values
    start, end, half = 5.0, 55.0, 6.0
    outline = (*arc(start, 0, 2.5, half, 90, 270, 8), *arc(end, 0, 2.5, half, -90, 90, 8))
    given = getattr(element, "segments", 1)
    count = min(given, 6) if isinstance(given, int) else 1
    cuts = [start + (end - start) * i / count for i in range(1, count)]
    body = Stroke(outline, "part", closed=True, fill=BODY)
    rings = [Stroke(arc(x, 0, 2.5, half, -90, 90, 8), "thin") for x in (*cuts, end - 0.01)]
    leads = [Stroke(((0, 0), (start - 2.5, 0)), "shaft"), Stroke(((end + 2.5, 0), (60, 0)), "shaft")]
    return Glyph((*leads, body, *rings[:-1]), 60, 8)


def _gear(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a gear stage in a schematic, drawn in line for places without room for two shafts."""
    del element, values
    out: tuple[Point, ...] = ((15, -16), (30, -16), (30, 0), (42, 0))
    return Glyph(
        (Stroke(((0, 0), (15, 0)), "shaft"), Stroke(out, "shaft"), *wheel(15, 0, 8), *wheel(15, -16, 8)), 42, 26
    )


def _pendulum(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a pendulum absorber in a schematic, a rod on a pin, and the path of its end."""
    del element, values
    pin = Stroke(arc(13, 0, 3, 3, 0, 360), "part", closed=True, fill="#ffffff")
    path = Stroke(arc(13, 0, 28, 28, -32, 32), "thin")
    return Glyph((Stroke(((0, 0), (10, 0))), pin, Stroke(((16, 0), (48, 0))), path), 48, 15)


def _boxed(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an element whose own sign, as of a gearbox, stands in a box between its two ends in the schematic."""
    del values
    leads = (Stroke(((0, 0), (8, 0)), "shaft"), Stroke(((64, 0), (72, 0)), "shaft"))
    return Glyph((*leads, rectangle(8, 64, -24, 24, BOX), *box_symbol(element, 36, 0)), 72, 25)


def _other(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of elements without a symbol of their own in a schematic, an empty box."""
    del element, values
    leads = (Stroke(((0, 0), (8, 0)), "shaft"), Stroke(((40, 0), (48, 0)), "shaft"))
    return Glyph((*leads, rectangle(8, 40, -10, 10, "#ffffff")), 48, 11)


def _crank() -> Glyph:
    """Symbol of a crank throw in a schematic, its webs, pin and journals seen from the side."""
    webs = [rectangle(x, x + 6, -7, 21, BODY) for x in (14, 32)]
    pin = rectangle(20, 32, 12, 20, BODY)
    leads = [Stroke(((0, 0), (14, 0)), "shaft"), Stroke(((38, 0), (_LENGTH, 0)), "shaft")]
    return Glyph((*leads, pin, *webs), _LENGTH, 22)


def _machine() -> Glyph:
    """Symbol of an electric machine in a schematic, a circle with one period of an alternating voltage."""
    middle = _LENGTH / 2
    circle = Stroke(arc(middle, 0, _BOX_HALF, _BOX_HALF, 0, 360, 40), "part", closed=True, fill=BOX)
    wave = tuple((middle - 9 + 18 * i / 24, 5 * math.sin(2 * math.pi * i / 24)) for i in range(25))
    return Glyph((*_leads(), circle, Stroke(wave)), _LENGTH, _BOX_HALF + 1)


def _load() -> Glyph:
    """Symbol of a load in a schematic, a curve of torque that falls with speed over its axes."""
    axes = ((15.0, 11.0), (15.0, -9.0), (39.0, -9.0))
    falling = tuple((17.0 + u, 60 / (5.0 + u) - 9) for u in range(17))
    box = rectangle(12, 40, -_BOX_HALF, _BOX_HALF, BOX)
    return Glyph((*_leads(), box, Stroke(axes, "thin"), Stroke(falling)), _LENGTH, _BOX_HALF + 1)


def _controller() -> Glyph:
    """Symbol of a controller in a schematic, an arrow that comes back to where it starts, as a closed loop."""
    middle = _LENGTH / 2
    path = arc(middle, 0, 8.5, 8.5, 160, -140, 30)
    x, y = path[-1]
    head = ((x + 1.5, y + 4.5), (x - 4.5, y - 0.5), (x + 3.0, y - 4.0))
    box = rectangle(12, 40, -_BOX_HALF, _BOX_HALF, BOX)
    return Glyph((*_leads(), box, Stroke(path), Stroke(head, closed=True, fill="#222222")), _LENGTH, _BOX_HALF + 1)


def _sheet() -> Glyph:
    """Symbol of elements given by matrices or tables in a schematic, a box with rows and columns."""
    lines = [Stroke(((12, y), (40, y)), "thin") for y in (-7, 0, 7)]
    columns = [Stroke(((x, -_BOX_HALF), (x, _BOX_HALF)), "thin") for x in (21, 30.5)]
    return Glyph((*_leads(), rectangle(12, 40, -_BOX_HALF, _BOX_HALF, BOX), *lines, *columns), _LENGTH, _BOX_HALF + 1)


def _leads() -> tuple[Stroke, Stroke]:
    return Stroke(((0, 0), (12, 0)), "shaft"), Stroke(((40, 0), (_LENGTH, 0)), "shaft")


_MACHINES: dict[str, Callable[[], Glyph]] = {
    "crank": _crank,
    "machine": _machine,
    "load": _load,
    "controller": _controller,
    "sheet": _sheet,
}
"""Functions that return the symbols of elements drawn alike whatever their values, by the element's ``glyph``."""
_INLINE: dict[str, Callable[[Element, Mapping[str, Any]], Glyph]] = {
    "disc": _disc,
    "spring": _spring_glyph,
    "damper": _damper,
    "clearance": _clearance,
    "friction": _friction,
    "coupling": _coupling,
    "shaft": _shaft,
    "gear": _gear,
    "pendulum": _pendulum,
    "gearbox": _boxed,
    "belt": _boxed,
    "hydrodynamic": _boxed,
}


def inline_glyph(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an element between two ends in a schematic, as strokes with length and half width in points."""
    if element.glyph in _MACHINES:
        return _MACHINES[element.glyph]()
    return _INLINE.get(element.glyph, _other)(element, values)
