"""Text of an open file with the counting of an editor: lines, and units of UTF-16, UTF-8 or UTF-32 in a line.

This is the only place that converts between the two; everything else counts characters.
"""

from __future__ import annotations

import bisect
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from lsprotocol.types import Position, PositionEncodingKind, Range
from lsprotocol.types import TextEdit as EditorEdit

from torsionnet.app.text.text_edits import TextEdit, TextSpan

_BREAK = re.compile("\r\n|\n|\r")
"""Expression of a line break of the protocol, which knows fewer of them than YAML and Python do."""


@dataclass(frozen=True)
class EditorText:
    """Text with conversion of its offsets to positions of an editor, and back.

    Examples
    --------
    >>> text = EditorText("k: 3 # \\U0001d70f\\nd: 4")
    >>> text.position(8), text.offset(Position(0, 9)), text.offset(Position(1, 0))
    (0:9, 8, 9)
    """

    text: str
    encoding: str = PositionEncodingKind.Utf16.value

    @cached_property
    def _starts(self) -> list[int]:
        """Offsets of the first character of each line."""
        return [0, *(found.end() for found in _BREAK.finditer(self.text))]

    @cached_property
    def _one_each(self) -> bool:
        """Whether every character is one unit."""
        return self.encoding == PositionEncodingKind.Utf32.value or self.text.isascii()

    def _units(self, text: str) -> int:
        if self._one_each:
            return len(text)
        if self.encoding == PositionEncodingKind.Utf8.value:
            return len(text.encode("utf-8", "surrogatepass"))
        return len(text) + sum(char > "\uffff" for char in text)

    def offset(self, position: Position) -> int:
        """Offset in characters of a position, at most that of the end of its line or of the text."""
        if position.line >= len(self._starts):
            return len(self.text)
        start = self._starts[position.line]
        line = self._line(position.line)
        if self._one_each:
            return start + min(position.character, len(line))
        units = 0
        for index, char in enumerate(line):
            if units >= position.character:
                return start + index
            units += self._units(char)
        return start + len(line)

    def _line(self, number: int) -> str:
        last = number + 1 == len(self._starts)
        return self.text[self._starts[number] : None if last else self._starts[number + 1]].rstrip("\r\n")

    def position(self, offset: int) -> Position:
        """Position of the character with an offset."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect.bisect_right(self._starts, offset) - 1
        return Position(line, self._units(self.text[self._starts[line] : offset]))

    def range(self, span: TextSpan) -> Range:
        """Range in the editor of a stretch of the text."""
        return Range(self.position(span.start), self.position(span.end))

    def span(self, shown: Range) -> TextSpan:
        """Stretch of the text of a range in the editor."""
        start, end = sorted((self.offset(shown.start), self.offset(shown.end)))
        return TextSpan(start, end)

    def edits(self, edits: Iterable[TextEdit]) -> list[EditorEdit]:
        """Edits as the editor takes them."""
        return [EditorEdit(self.range(edit.span), edit.text) for edit in edits]

    @property
    def whole(self) -> TextSpan:
        """Stretch of the whole text."""
        return TextSpan(0, len(self.text))
