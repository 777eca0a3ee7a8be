"""Widths of the texts of a drawing in the font DejaVu Sans, read from its files, without matplotlib."""

from __future__ import annotations

import importlib.util
import math
import struct
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np

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
    advances = [int(one) for one in np.frombuffer(tables["hmtx"], ">u2", 2 * count)[::2]]
    advances += advances[-1:] * (glyph_count - count)
    return FontWidths(unit, _glyphs(tables["cmap"]), tuple(advances), _kerning(tables.get("kern", b"")))


def font_folder() -> Path:
    """Folder of the files of DejaVu Sans, which matplotlib brings; it is looked for without an import of matplotlib."""
    found = importlib.util.find_spec("matplotlib")
    for folder in (found.submodule_search_locations or ()) if found is not None else ():
        if (Path(folder) / "mpl-data" / "fonts" / "ttf" / FACES[""]).is_file():
            return Path(folder) / "mpl-data" / "fonts" / "ttf"
    import matplotlib as mpl  # some distributions keep its data elsewhere, and only matplotlib knows where

    return Path(mpl.get_data_path()) / "fonts" / "ttf"


def _tables(data: bytes) -> dict[str, bytes]:
    (count,) = struct.unpack_from(">H", data, 4)
    found = {}
    for number in range(count):
        tag, _, start, length = struct.unpack_from(">4sIII", data, 12 + 16 * number)
        found[tag.decode()] = data[start : start + length]
    return found


def _glyphs(table: bytes) -> dict[int, int]:
    """Numbers of the glyphs by code of the character, from the subtable of Unicode's basic plane (format 4)."""
    (count,) = struct.unpack_from(">H", table, 2)
    starts = [struct.unpack_from(">HHI", table, 4 + 8 * number) for number in range(count)]
    start = next(at for _, _, at in starts if struct.unpack_from(">H", table, at)[0] == 4)
    (double,) = struct.unpack_from(">H", table, start + 6)
    words = np.frombuffer(table[start:], ">u2", (len(table) - start) // 2).tolist()
    n = double // 2
    last, first, delta, offset = (words[at : at + n] for at in (7, 8 + n, 8 + 2 * n, 8 + 3 * n))
    found: dict[int, int] = {}
    for place in range(n):
        for code in range(first[place], min(last[place], 0xFFFE) + 1):
            glyph = code
            if offset[place]:
                glyph = words[8 + 3 * n + place + offset[place] // 2 + code - first[place]]
                if not glyph:
                    continue
            found[code] = (glyph + delta[place]) & 0xFFFF
    return found


def _kerning(table: bytes) -> dict[int, int]:
    """Corrections of the distance of two glyphs, by the number of the first times 65536 plus that of the second."""
    if not table:
        return {}
    (count,) = struct.unpack_from(">H", table, 4 + 6)
    pairs = np.frombuffer(table, np.dtype([("left", ">u2"), ("right", ">u2"), ("value", ">i2")]), count, 4 + 14)
    keys = pairs["left"].astype(int) << 16 | pairs["right"]
    return dict(zip(keys.tolist(), pairs["value"].tolist(), strict=True))
