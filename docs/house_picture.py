"""Picture and tables of the package's layers, their floors, and the way of a model through them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from html import escape
from importlib import import_module
from inspect import getdoc
from itertools import combinations, product
from pathlib import Path
from typing import NamedTuple

from page_parts import code, table

import torsionnet
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import Assembly
from torsionnet.linear.dynamic_stiffness.quotient import transfer_functions
from torsionnet.linear.dynamic_stiffness.tape import Tape, make_tape
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cached_request
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.defining import define
from torsionnet.model.definition import Definition
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.report.build import build
from torsionnet.report.document_tree import Report
from torsionnet.report.report import write_report

PACKAGE = Path(torsionnet.__file__).parent
sys.path.append(str(Path(__file__).parents[1] / "tests"))

from structure.floors import FLOORS, LAYERS, Layer  # noqa: E402
from structure.modules import modules_below  # noqa: E402
from structure.rules import SECTION_TYPES  # noqa: E402

WAY: tuple[tuple[object, str, type | str], ...] = (
    (compose, "takes the text apart", LocatedDocument),
    (define, "reads and checks its entries", Definition),
    (Drivetrain.from_definition, "can be asked", Drivetrain),
    (AssembledModel.assembly, "writes rows in numbers", Assembly),
    (cached_request, "turns names into readings", TransferRequest),
    (make_tape, "plans the elimination", Tape),
    (transfer_functions, "walks it at every frequency", FrequencyResponse),
    (build, "says what it means", Report),
    (write_report, "writes pages", "HTML, LaTeX, Markdown, PDF"),
)
"""Steps from a model file to a report: function, its task in words, and its result."""

LEFT, WIDTH, GAP, TOP = 16.0, 560.0, 16.0, 40.0
TITLE, STRIP, PAD, LANE = 22.0, 17.0, 6.0, 15.0
WAY_LEFT, WAY_WIDTH, WAY_BOX = 650.0, 330.0, 40.0
INK, MUTED = "#222222", "#6b6b6b"


def layers_page() -> str:
    """Tables of the layers with what each knows, and of the floors of those that have any."""
    levels = [
        [str(len(LAYERS) - depth), ", ".join(map(code, layer.names)), layer.knows] for depth, layer in enumerate(LAYERS)
    ]
    floors = [[code(name), " < ".join(code(floor or "*") for floor in floors)] for name, floors in FLOORS.items()]
    return (
        table(["layer", "modules", "knows about"], levels)
        + "\nWhere a layer has {term}`floors <floor>`, a module imports from its own and from those "
        "below it. `*` are the files\nthat stand in no folder of the layer.\n\n"
        + table(["layer", "floors, the lowest first"], floors)
    )


# What imports what


@cache
def arrows() -> list[tuple[int, int]]:
    """Pairs of layers, the first importing from the second below it, without arrows that follow from others."""
    level = {name: depth for depth, layer in enumerate(LAYERS) for name in layer.names}
    below: dict[int, set[int]] = {depth: set() for depth in range(len(LAYERS))}
    for first, second in _imports():
        if level[first] < level[second]:
            below[level[first]].add(level[second])
    reached: dict[int, set[int]] = {}
    for depth in reversed(range(len(LAYERS))):
        reached[depth] = below[depth].union(*(reached[other] for other in below[depth]))
    return [
        (depth, other)
        for depth, others in below.items()
        for other in sorted(others)
        if not any(other in reached[between] for between in others)
    ]


@cache
def _imports() -> set[tuple[str, str]]:
    """Names of the importing and of the imported package, of all imports between packages."""
    found = set()
    for module in modules_below(PACKAGE):
        for one in module.imports:
            package, *rest = one.name.split(".")
            if one.for_types and module.relative in SECTION_TYPES:
                continue
            if module.layer_name and package == PACKAGE.name and rest and rest[0] != module.layer_name:
                found.add((module.layer_name, rest[0]))
    return found


class Lane(NamedTuple):
    """Route of an arrow that leads past layers: its side, and the number of arrows inside of it there."""

    first: int
    last: int
    side: int
    place: int

    def passes(self, depth: int) -> bool:
        return self.first < depth < self.last


@cache
def lanes() -> list[Lane]:
    """Routes of all arrows that lead past a layer, on sides where they cross as few others as possible.

    The longest is outermost, so that a box leaves room for the arrows that pass it, and touches those that begin there.
    """
    long = sorted(((first, last) for first, last in arrows() if last > first + 1), key=lambda ends: ends[0] - ends[1])

    def crossings(sides: tuple[int, ...]) -> int:
        pairs = combinations(zip(long, sides, strict=True), 2)
        return sum(side == other and _cross(one, two) for (one, side), (two, other) in pairs)

    found: list[Lane] = []
    for (first, last), side in zip(long, min(product((1, -1), repeat=len(long)), key=crossings), strict=True):
        inside = [one.place for one in found if one.side == side and one.first < last and first < one.last]
        found.append(Lane(first, last, side, 1 + max(inside, default=-1)))
    return found


def _cross(one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether two arrows cross: each has an end between those of the other."""
    return all(any(low < end < high for end in ends) for ends, (low, high) in ((one, other), (other, one)))


# The picture


@dataclass
class Drawing:
    """Builder of an SVG: shapes and texts in the order in which they are drawn."""

    shapes: list[str] = field(default_factory=list)

    def box(self, x: float, y: float, width: float, height: float, fill: str, tip: str = "") -> None:
        title = f"<title>{escape(tip)}</title>" if tip else ""
        size = f'x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}"'
        self.shapes.append(f'<rect {size} rx="3" fill="{fill}" stroke="{MUTED}" stroke-width="0.8">{title}</rect>')

    def text(self, x: float, y: float, words: str, look: str = "", anchor: str = "middle") -> None:
        look = f' class="{look}"' if look else ""
        self.shapes.append(f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}"{look}>{escape(words)}</text>')

    def arrow(self, x: float, y: float, to_x: float, to_y: float) -> None:
        ends = f'x1="{x:g}" y1="{y:g}" x2="{to_x:g}" y2="{to_y:g}"'
        self.shapes.append(f'<line {ends} stroke="{INK}" stroke-width="1.3" marker-end="url(#head)"/>')

    def svg(self, width: float, height: float) -> str:
        return "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" font-size="12.5" '
                f'font-family="Helvetica, Arial, sans-serif" fill="{INK}">',
                "<style>.b{font-weight:bold} .s{font-size:11px} "
                f".w{{font-size:11px;fill:{MUTED}}} .h{{font-size:14px;font-weight:bold}}</style>",
                '<defs><marker id="head" viewBox="0 0 8 8" refX="7.5" refY="4" markerWidth="7" markerHeight="7" '
                f'orient="auto"><path d="M0 0.8 L8 4 L0 7.2 z" fill="{INK}"/></marker></defs>',
                f'<rect width="{width:g}" height="{height:g}" rx="6" fill="white"/>',
                *self.shapes,
                "</svg>",
                "",
            ]
        )


def picture() -> str:
    """SVG of the layers from the top, floors in them, arrows to the layers imported, and a model's way beside them."""
    drawing, places = Drawing(), list(_places())
    bottom = places[-1][1] + places[-1][2]
    drawing.text(LEFT, TOP - 16, "Who imports from whom", "h", "start")
    for depth, (layer, (sides, y, height)) in enumerate(zip(LAYERS, places, strict=True)):
        _layer(drawing, layer, sides, y, height, depth)
    past = {(one.first, one.last): _lane_at(one) for one in lanes()}
    for first, last in arrows():
        x = past.get((first, last), LEFT + WIDTH / 2)
        drawing.arrow(x, places[first][1] + places[first][2], x, places[last][1] - 1)
    _way(drawing, bottom)
    return drawing.svg(WAY_LEFT + WAY_WIDTH + LEFT, bottom + LEFT)


def _places() -> Iterator[tuple[tuple[float, float], float, float]]:
    """Left and right end, top and height of each layer, from the top layer down."""
    y, past = TOP, lanes()
    for depth, layer in enumerate(LAYERS):
        sides = [
            max((one.place + 1 for one in past if one.side == s and one.passes(depth)), default=0) for s in (-1, 1)
        ]
        height = TITLE + max(len(FLOORS.get(name, ())) * STRIP for name in layer.names)
        height += PAD if height > TITLE else 0
        yield (LEFT + LANE * sides[0], LEFT + WIDTH - LANE * sides[1]), y, height
        y += height + GAP


def _lane_at(one: Lane) -> float:
    return LEFT + LANE * (one.place + 0.5) if one.side < 0 else LEFT + WIDTH - LANE * (one.place + 0.5)


def _layer(drawing: Drawing, layer: Layer, sides: tuple[float, float], y: float, height: float, depth: int) -> None:
    """Draw a layer: its packages beside each other, floors in them with the lowest at the bottom."""
    left, right = sides
    between = 18.0
    width = (right - left - between * (len(layer.names) - 1)) / len(layer.names)
    known = _imports()
    for number, name in enumerate(layer.names):
        x, floors = left + number * (width + between), FLOORS.get(name, ())
        drawing.box(x, y, width, height, _tint(depth), _said_of(name))
        drawing.text(x + width / 2, y + 15.5, name, "b")
        for place, floor in enumerate(reversed(floors)):
            top = y + TITLE + place * STRIP
            drawing.box(x + PAD, top, width - 2 * PAD, STRIP, "white", _said_of(f"{name}.{floor}" if floor else name))
            drawing.text(x + width / 2, top + 12.5, floor or "files in no folder", "s")
        if number and (layer.names[number - 1], name) in known:
            drawing.arrow(x - between, y + 11, x - 1, y + 11)
        elif number and (name, layer.names[number - 1]) in known:
            drawing.arrow(x, y + 11, x - between + 1, y + 11)


def _said_of(name: str) -> str:
    """First line of the docstring of a module."""
    if name == "__main__":
        return "python -m torsionnet"
    return (getdoc(import_module(f"torsionnet.{name}")) or "").partition("\n")[0]


def _way(drawing: Drawing, bottom: float) -> None:
    """Draw the way of a model from its file at the top to pages at the bottom, in the colours of the layers."""
    drawing.text(WAY_LEFT, TOP - 16, "The way of a model", "h", "start")
    step = (bottom - TOP - WAY_BOX) / len(WAY)
    middle = WAY_LEFT + WAY_WIDTH / 2
    drawing.box(WAY_LEFT, TOP, WAY_WIDTH, WAY_BOX, "white")
    drawing.text(middle, TOP + 17, "a model file", "b")
    drawing.text(middle, TOP + 32, "YAML or JSON", "s")
    for number, (made_by, words, made) in enumerate(WAY, 1):
        y = TOP + number * step
        drawing.arrow(middle, y - step + WAY_BOX, middle, y - 1)
        drawing.text(middle - 10, y - (step - WAY_BOX) / 2 + 4, _called(made_by), "b s", "end")
        drawing.text(middle + 10, y - (step - WAY_BOX) / 2 + 4, words, "w", "start")
        if isinstance(made, str):
            drawing.box(WAY_LEFT, y, WAY_WIDTH, WAY_BOX, "white")
            drawing.text(middle, y + 25, made, "b")
            continue
        home = made.__module__.removeprefix("torsionnet.")
        depth = next(depth for depth, layer in enumerate(LAYERS) if home.split(".")[0] in layer.names)
        drawing.box(WAY_LEFT, y, WAY_WIDTH, WAY_BOX, _tint(depth), (getdoc(made) or "").partition("\n")[0])
        drawing.text(middle, y + 17, made.__name__, "b")
        drawing.text(middle, y + 32, home.replace(".", "/") + ".py", "s")


def _called(made_by: object) -> str:
    return str(getattr(made_by, "__name__", "") or getattr(made_by, "attrname", ""))


def _tint(depth: int) -> str:
    """Colour of a layer, from blue at the top to sand at the bottom."""
    share = depth / (len(LAYERS) - 1)
    first, last = (214, 230, 245), (245, 236, 214)
    return "#" + "".join(f"{round(a + share * (b - a)):02x}" for a, b in zip(first, last, strict=True))
