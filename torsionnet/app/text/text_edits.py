"""Stretches and edits of a text by offsets, and their conversion to the counting of editors."""

from __future__ import annotations

import bisect
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

_BREAKS = "\n\r\x85\u2028\u2029"
_BREAK = re.compile(f"\r\n|[{_BREAKS}]")
"""Expression of a line break, as the reader of model files counts lines."""


@dataclass(frozen=True, order=True)
class TextSpan:
    """Stretch of a text by offsets in characters from 0; ``end`` is not included."""

    start: int
    end: int


@dataclass(frozen=True, order=True)
class TextEdit:
    """Text that takes the place of a stretch; an empty stretch inserts, an empty text deletes."""

    span: TextSpan
    text: str


def edited(text: str, edits: Iterable[TextEdit]) -> str:
    """Text after some edits, each of which counts in the text before; ValueError where two of them overlap.

    Examples
    --------
    >>> edited("k: 3", [TextEdit(TextSpan(3, 4), "5"), TextEdit(TextSpan(0, 1), "stiffness")])
    'stiffness: 5'
    """
    pieces: list[str] = []
    done = 0
    for edit in sorted(edits):
        if edit.span.start < done:
            raise ValueError(f"two edits overlap at character {edit.span.start}")
        pieces += [text[done : edit.span.start], edit.text]
        done = edit.span.end
    return "".join([*pieces, text[done:]])


@dataclass(frozen=True)
class TextLines:
    """Lines of a text, by which offsets become lines and columns from 0.

    Examples
    --------
    >>> lines = TextLines("a: 1\\nb: 2")
    >>> lines.offset(1, 3), lines.place(8)
    (8, (1, 3))
    """

    text: str

    @cached_property
    def starts(self) -> list[int]:
        """Offsets of the first character of each line."""
        return [0, *(found.end() for found in _BREAK.finditer(self.text))]

    def offset(self, line: int, column: int) -> int:
        """Offset of a place, at most that of the end of its line or of the text."""
        if line >= len(self.starts):
            return len(self.text)
        end = self.starts[line + 1] if line + 1 < len(self.starts) else len(self.text)
        while end > self.starts[line] and self.text[end - 1] in _BREAKS:
            end -= 1
        return min(self.starts[line] + max(column, 0), end)

    def place(self, offset: int) -> tuple[int, int]:
        """Line and column of an offset."""
        line = bisect.bisect_right(self.starts, max(offset, 0)) - 1
        return line, min(offset, len(self.text)) - self.starts[line]


def utf16_offset(text: str, offset: int) -> int:
    """Offset as browsers and most editors count it, where a character above U+FFFF counts two.

    >>> utf16_offset("\\U0001d70bk", 1)
    2
    """
    return offset if text.isascii() else offset + sum(char > "\uffff" for char in text[:offset])


def character_offset(text: str, utf16: int) -> int:
    """Offset in characters of one that a browser counted.

    >>> character_offset("\\U0001d70bk", 2)
    1
    """
    if text.isascii():
        return min(utf16, len(text))
    counted = 0
    for index, char in enumerate(text):
        if counted >= utf16:
            return index
        counted += 2 if char > "\uffff" else 1
    return len(text)


@dataclass(frozen=True)
class TextFix:
    """Edits of a text that mend one fault of it, with a title that says what they do.

    ``hides`` marks a deletion or quotes, after which nearly every text is sound YAML.
    """

    title: str
    edits: tuple[TextEdit, ...]
    hides: bool = False
