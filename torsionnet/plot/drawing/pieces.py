"""Pieces of a schematic drawing, which hold strokes, texts and the rectangles these occupy, in points of 1/72 inch."""

from __future__ import annotations

import importlib.util
import math
import re
import struct
from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, field, fields, replace
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Colours of all pictures, as hexadecimal codes.

# Okabe and Ito's colours without the yellow, which is lost on white: told apart with any kind of colour vision.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#444444", "#56B4E9", "#E69F00")
INK, MUTED, FAINT, PAPER = "#222222", "#6b6b6b", "#dddddd", "#ffffff"


# Widths of the texts of a drawing in the font DejaVu Sans, read from its files, without matplotlib.

FACES = {"": "DejaVuSans.ttf", "italic": "DejaVuSans-Oblique.ttf", "bold": "DejaVuSans-Bold.ttf"}
"""Names of the files of the font by the slope or weight of a text."""

RASTER = 64
"""Number of steps in a hundredth of the size of the font to which widths are rounded, as matplotlib does."""
LIGATURES = {"ffi": "\ufb03", "ffl": "\ufb04", "ff": "\ufb00", "fi": "\ufb01", "fl": "\ufb02"}
"""Characters that stand for several letters which the font draws as one sign, by these letters."""


@dataclass(frozen=True)
class FontWidths:
    """Widths of the characters of one face of a font, and corrections for pairs of them, in units of the font."""

    unit: int
    glyphs: dict[int, int]
    advances: tuple[int, ...]
    kerning: dict[int, int]

    def width(self, text: str) -> float:
        """Width of a text in hundredths of the size of the font, as matplotlib draws it."""
        if "f" in text:
            for letters, sign in LIGATURES.items():
                text = text.replace(letters, sign)
        steps = 100 * RASTER / self.unit
        numbers = [self.glyphs.get(ord(letter), 0) for letter in text]
        total = sum(math.floor(self.advances[number] * steps + 0.5) for number in numbers)
        return (total + sum(math.floor(pair * steps + 0.5) for pair in self._pairs(numbers))) / RASTER

    def symbol_width(self, text: str) -> float:
        """Width of a text within a label with symbols in hundredths of the size of the font.

        There matplotlib places the characters one by one, and moves pairs of them by whole hundredths.
        """
        numbers = [self.glyphs.get(ord(letter), 0) for letter in text]
        total = 100 / self.unit * sum(self.advances[number] for number in numbers)
        return total + sum(round(100 * pair / self.unit) for pair in self._pairs(numbers))

    def _pairs(self, numbers: list[int]) -> list[int]:
        return [self.kerning.get(first << 16 | second, 0) for first, second in pairwise(numbers)]


@cache
def font_widths(face: str) -> FontWidths:
    """Widths of the characters of a face of DejaVu Sans, a name in ``FACES``."""
    tables = _tables((font_folder() / FACES[face]).read_bytes())
    (unit,) = struct.unpack_from(">H", tables["head"], 18)
    (count,) = struct.unpack_from(">H", tables["hhea"], 34)
    (glyph_count,) = struct.unpack_from(">H", tables["maxp"], 4)
    advances = [int(advance) for advance in np.frombuffer(tables["hmtx"], ">u2", 2 * count)[::2]]
    advances += advances[-1:] * (glyph_count - count)
    return FontWidths(unit, _glyphs(tables["cmap"]), tuple(advances), _kerning(tables.get("kern", b"")))


def font_folder() -> Path:
    """Folder of the files of DejaVu Sans, which matplotlib brings; it is looked for without an import of matplotlib."""
    package = importlib.util.find_spec("matplotlib")
    for folder in (package.submodule_search_locations or ()) if package is not None else ():
        if (Path(folder) / "mpl-data" / "fonts" / "ttf" / FACES[""]).is_file():
            return Path(folder) / "mpl-data" / "fonts" / "ttf"
    import matplotlib as mpl  # some distributions keep its data elsewhere, and only matplotlib knows where

    return Path(mpl.get_data_path()) / "fonts" / "ttf"


def _tables(data: bytes) -> dict[str, bytes]:
    (count,) = struct.unpack_from(">H", data, 4)
    tables = {}
    for number in range(count):
        tag, _, start, length = struct.unpack_from(">4sIII", data, 12 + 16 * number)
        tables[tag.decode()] = data[start : start + length]
    return tables


def _glyphs(table: bytes) -> dict[int, int]:
    """Numbers of the glyphs by code of the character, from the subtable of Unicode's basic plane (format 4)."""
    (count,) = struct.unpack_from(">H", table, 2)
    starts = [struct.unpack_from(">HHI", table, 4 + 8 * number) for number in range(count)]
    start = next(at for _, _, at in starts if struct.unpack_from(">H", table, at)[0] == 4)
    (double,) = struct.unpack_from(">H", table, start + 6)
    words = np.frombuffer(table[start:], ">u2", (len(table) - start) // 2).tolist()
    n = double // 2
    last, first, delta, offset = (words[at : at + n] for at in (7, 8 + n, 8 + 2 * n, 8 + 3 * n))
    glyphs: dict[int, int] = {}
    for place in range(n):
        for code in range(first[place], min(last[place], 0xFFFE) + 1):
            glyph = code
            if offset[place]:
                glyph = words[8 + 3 * n + place + offset[place] // 2 + code - first[place]]
                if not glyph:
                    continue
            glyphs[code] = (glyph + delta[place]) & 0xFFFF
    return glyphs


def _kerning(table: bytes) -> dict[int, int]:
    """Corrections of the distance of two glyphs, by the number of the first times 65536 plus that of the second."""
    if not table:
        return {}
    (count,) = struct.unpack_from(">H", table, 4 + 6)
    pairs = np.frombuffer(table, np.dtype([("left", ">u2"), ("right", ">u2"), ("value", ">i2")]), count, 4 + 14)
    keys = pairs["left"].astype(int) << 16 | pairs["right"]
    return dict(zip(keys.tolist(), pairs["value"].tolist(), strict=True))


# Runs of a label's text in one style, of which a label with symbols as in mathematics has several.

INDEX_SIZE = 0.7
"""Size of an index as a multiple of that of its symbol."""
X_HEIGHT = 100 * 1120 / 2048
"""Height of a small letter in hundredths of the size of the font."""
BEHIND_INDEX, BEFORE_INDEX = 0.05 * X_HEIGHT, 0.025 * INDEX_SIZE * X_HEIGHT
"""Room behind an index and, of an upright symbol, before it, in hundredths of the size of the text."""

LETTERS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ",
    "tau": "τ", "upsilon": "υ", "phi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ",
    "Theta": "Θ", "Lambda": "Λ", "Xi": "Ξ", "Pi": "Π", "Sigma": "Σ", "Upsilon": "Υ", "Phi": "Φ", "Psi": "Ψ",
    "Omega": "Ω", "varepsilon": "ε",
}  # fmt: skip
"""Greek letters by their names."""
_SYMBOL = re.compile(r"\\?([A-Za-z]+)(?:_\{\\mathrm\{(.*)\}\})?")


class TextRun(NamedTuple):
    """Piece of a label in one style: ``plain``, ``symbol`` (in italics but for capital Greek), or ``index``."""

    text: str
    style: str

    @property
    def is_italic(self) -> bool:
        """Whether the run is set in italics."""
        return self.style == "symbol" and not "Α" <= self.text <= "Ω"


def symbol_runs(text: str) -> list[TextRun]:
    r"""Runs of a label in which symbols stand between dollars, as ``labels.symbol`` writes them.

    >>> [tuple(run) for run in symbol_runs("$k_{\\mathrm{1}}$ = 460 N·m/rad")]
    [('k', 'symbol'), ('1', 'index'), (' = 460 N·m/rad', 'plain')]
    """
    runs: list[TextRun] = []
    for place, part in enumerate(text.split("$")):
        match = _SYMBOL.fullmatch(part) if place % 2 else None
        if match is None:
            runs += [TextRun(part, "plain")] if part else []
            continue
        runs.append(TextRun(LETTERS.get(match[1], match[1]), "symbol"))
        if match[2]:
            runs.append(TextRun(match[2].replace("\\_", "_"), "index"))
    return runs


def plain_symbols(text: str) -> str:
    r"""Text of a label without its markup for symbols.

    >>> plain_symbols("$k_{\\mathrm{1}}$ = 460 N·m/rad")
    'k_1 = 460 N·m/rad'
    """
    return "".join(f"_{run.text}" if run.style == "index" else run.text for run in symbol_runs(text))


@lru_cache(maxsize=4096)
def symbols_width(text: str) -> float:
    """Width of a label with symbols in hundredths of the size of its font, rounded up as matplotlib does."""
    width, upright = 0.0, False
    for run in symbol_runs(text):
        own = font_widths("italic" if run.is_italic else "").symbol_width(run.text)
        if run.style == "index":
            own = INDEX_SIZE * own + BEHIND_INDEX + (BEFORE_INDEX if upright else 0.0)
        upright = not run.is_italic
        width += own
    return float(math.ceil(width))


Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""Edges (x0, x1, y0, y1) of a rectangle of a drawing, in points of 1/72 inch."""
Texts = list[tuple[str, str]]
"""Lines of a label as pairs (text, name of its style in ``ROLES``), from top to bottom."""

MARGIN = 6.0
"""Distance in points between two rectangles of a drawing below which they count as overlapping."""


@dataclass(frozen=True)
class TextStyle:
    """Size in points, colour and font style of the texts of one kind in a drawing."""

    size: float
    color: str
    italic: bool = False
    bold: bool = False


ROLES = {
    "name": TextStyle(8.5, INK),
    "value": TextStyle(7.6, MUTED),
    "node": TextStyle(7.8, MUTED, italic=True),
    "port": TextStyle(7.0, MUTED),
    "input": TextStyle(9.0, PALETTE[1]),
    "sensor": TextStyle(9.0, PALETTE[2]),
    "what": TextStyle(7.0, MUTED),
    "note": TextStyle(7.6, MUTED),
    "title": TextStyle(13.0, INK, bold=True),
}
LEADING = 1.3
"""Distance from one line of text to the next, as a multiple of the size of the font."""


class Owner(NamedTuple):
    """Part of a drivetrain that a stroke or text of a drawing shows.

    Its kind is ``element``, ``node``, ``input`` or ``sensor``.
    """

    kind: str
    name: str


class Stroke(NamedTuple):
    """Line or filled shape of a drawing through positions (x, y) in points of 1/72 inch.

    ``look`` is a name in the table of pens (``PENS``).
    """

    points: tuple[Point, ...]
    look: str = "part"
    closed: bool = False
    fill: str = ""
    owner: Owner | None = None

    def shifted(self, dx: float, dy: float) -> Stroke:
        """Copy of the stroke moved by dx to the right and dy upwards, in points."""
        return Stroke(tuple([(x + dx, y + dy) for x, y in self.points]), self.look, self.closed, self.fill, self.owner)


class Label(NamedTuple):
    """Text of a drawing at (x, y) in points, centred at x or beginning there, with its base line at y."""

    x: float
    y: float
    text: str
    role: str
    left: bool = False
    owner: Owner | None = None

    def shifted(self, dx: float, dy: float) -> Label:
        """Copy of the label moved by dx to the right and dy upwards, in points."""
        return Label(self.x + dx, self.y + dy, self.text, self.role, self.left, self.owner)


@dataclass(frozen=True)
class LooseEnd:
    """Open end of a shaft that closes a loop of the schematic, to be joined by a wire or tagged with a node's name."""

    loop: int
    node: str
    x: float
    y: float
    tag: Box

    def shifted(self, dx: float, dy: float) -> LooseEnd:
        """Copy of the loose end moved by dx to the right and dy upwards, in points."""
        return LooseEnd(self.loop, self.node, self.x + dx, self.y + dy, shifted_box(self.tag, dx, dy))


@dataclass
class Piece:
    """Part of a drawing with strokes, labels, the rectangles they occupy, and loose ends of loops, all in points.

    ``boxes`` are areas that nothing else may take, ``wires`` lines that others may cross.
    """

    strokes: list[Stroke] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)
    wires: list[Box] = field(default_factory=list)
    ends: list[LooseEnd] = field(default_factory=list)
    anchors: dict[int, Point] = field(default_factory=dict)

    def shifted(self, dx: float, dy: float) -> Piece:
        """Copy of the piece of a drawing moved by dx to the right and dy upwards, in points."""
        if dx == 0 == dy:
            return replace(self, **{entry.name: copy(getattr(self, entry.name)) for entry in fields(self)})
        return Piece(
            [
                Stroke(tuple([(x + dx, y + dy) for x, y in points]), look, closed, fill, owner)
                for points, look, closed, fill, owner in self.strokes
            ],
            [label.shifted(dx, dy) for label in self.labels],
            [shifted_box(box, dx, dy) for box in self.boxes],
            [shifted_box(box, dx, dy) for box in self.wires],
            [end.shifted(dx, dy) for end in self.ends],
            {loop: (x + dx, y + dy) for loop, (x, y) in self.anchors.items()},
        )

    def room_shifted(self, dx: float, dy: float) -> Piece:
        """Copy of what the piece of a drawing occupies, without strokes and labels, moved to the right and upwards."""
        return Piece(
            boxes=[shifted_box(box, dx, dy) for box in self.boxes],
            wires=[shifted_box(box, dx, dy) for box in self.wires],
            ends=[end.shifted(dx, dy) for end in self.ends],
            anchors={loop: (x + dx, y + dy) for loop, (x, y) in self.anchors.items()},
        )

    def add(self, other: Piece) -> None:
        """Add to this piece the strokes, labels, boxes, wires, loose ends and anchors of another piece."""
        self.strokes += other.strokes
        self.labels += other.labels
        self.boxes += other.boxes
        self.wires += other.wires
        self.ends += other.ends
        self.anchors |= other.anchors

    def owned(self, kind: str, name: str) -> Owned:
        """Context manager within which whatever is drawn into the piece belongs to a part of the drivetrain.

        What belongs to another part already, because it was drawn within an inner context, remains with that.
        """
        return Owned(self, Owner(kind, name))

    def line(self, *points: Point, look: str = "shaft") -> None:
        """Draw a shaft or wire of the drawing through positions (x, y) in points; other lines may cross it."""
        self.strokes.append(Stroke(points, look))
        for (x0, y0), (x1, y1) in pairwise(points):
            self.wires.append((min(x0, x1) - 3, max(x0, x1) + 3, min(y0, y1) - 3, max(y0, y1) + 3))

    def write(self, x: float, y: float, lines: Iterable[tuple[str, str]], *, upward: bool = True) -> float:
        """Write lines of text, pairs (text, role), above or below y, and return the y in points at which they end."""
        ordered = list(lines)
        labels: list[Label] = []
        for text, role in reversed(ordered) if upward else ordered:
            height = LEADING * ROLES[role].size
            base = y + 0.3 * height if upward else y - height + 0.3 * height
            labels.append(Label(x, base, text, role))
            half = text_width(text, role) / 2
            low = y if upward else y - height
            self.boxes.append((x - half, x + half, low, low + height))
            y += height if upward else -height
        self.labels += reversed(labels) if upward else labels
        return y

    @property
    def extent(self) -> Box:
        """Edges x0, x1, y0, y1 in points of the smallest rectangle around the piece of the drawing and the origin."""
        left, right, low, high = zip(*self.boxes, *self.wires, (0.0, 0.0, 0.0, 0.0), strict=True)
        return float(min(left)), float(max(right)), float(min(low)), float(max(high))


class Owned:
    """Context in which strokes and labels drawn into a piece get an owner."""

    __slots__ = ("labels", "owner", "piece", "strokes")

    def __init__(self, piece: Piece, owner: Owner) -> None:
        self.piece, self.owner = piece, owner
        self.strokes, self.labels = len(piece.strokes), len(piece.labels)

    def __enter__(self) -> None:
        """Begin the context, which counts what was drawn before."""

    def __exit__(self, *error: object) -> None:
        """Give what was drawn in the meantime its owner, where it has none."""
        piece, owner = self.piece, self.owner
        for place in range(self.strokes, len(piece.strokes)):
            points, look, closed, fill, known = piece.strokes[place]
            if known is None:
                piece.strokes[place] = Stroke(points, look, closed, fill, owner)
        for place in range(self.labels, len(piece.labels)):
            if piece.labels[place].owner is None:
                piece.labels[place] = piece.labels[place]._replace(owner=owner)


def shifted_box(box: Box, dx: float, dy: float) -> Box:
    """Copy of a rectangle (x0, x1, y0, y1) moved by dx to the right and dy upwards, in points."""
    return (box[0] + dx, box[1] + dx, box[2] + dy, box[3] + dy)


@lru_cache(maxsize=4096)
def text_width(text: str, role: str) -> float:
    """Width in points of a text in the font of its role, a name in ``ROLES``."""
    look = ROLES[role]
    if is_math(text, role):
        return symbols_width(text) * (look.size / 100)
    face = "bold" if look.bold else "italic" if look.italic else ""
    return font_widths(face).width(text) * (look.size / 100)


def is_math(text: str, role: str) -> bool:
    """Whether a text is mathtext: it has a dollar from :func:`torsionnet.plot.drawing.labels.symbol`; no title is."""
    return "$" in text and role != "title"


def label_width(lines: Iterable[tuple[str, str]]) -> float:
    """Width in points of the widest line of a label."""
    return max((text_width(text, role) for text, role in lines), default=0.0)


def overlap(boxes: NDArray[np.float64], others: NDArray[np.float64], margin: float = MARGIN) -> bool:
    """Whether any rectangle of one array (n, 4) is closer than a margin in points to any of another array (m, 4)."""
    if not len(boxes) or not len(others):
        return False
    a, b = boxes[:, None, :], others[None, :, :]
    apart = (
        (a[..., 1] + margin <= b[..., 0])
        | (b[..., 1] + margin <= a[..., 0])
        | (a[..., 3] + margin <= b[..., 2])
        | (b[..., 3] + margin <= a[..., 2])
    )
    return not bool(apart.all())


def box_array(boxes: Sequence[Box]) -> NDArray[np.float64]:
    """Array of rectangles, each a row x0, x1, y0, y1 in points, shape (n, 4)."""
    return np.array(boxes, dtype=float).reshape(-1, 4)


def arc(x: float, y: float, a: float, b: float, start: float, end: float, steps: int = 24) -> tuple[Point, ...]:
    """Positions (x, y) on an arc, between two angles in degrees, of the ellipse with a centre and half axes a and b."""
    angles = [math.radians(start + (end - start) * i / steps) for i in range(steps + 1)]
    return tuple((x + a * math.cos(angle), y + b * math.sin(angle)) for angle in angles)
