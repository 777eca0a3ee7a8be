"""Offsets of a text between characters and the counting of browsers."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterable
from typing import Any

from torsionnet.app.text.text_edits import TextEdit, TextSpan

_WIDE = re.compile("[\U00010000-\U0010ffff]")
"""Expression of a character that browsers count as two."""


class OffsetCounting:
    """Conversion of the offsets of one text.

    Examples
    --------
    >>> counting = OffsetCounting("\\U0001d70b: k")
    >>> counting.to_page(1), counting.from_page(2), counting.from_page(99)
    (2, 1, 4)
    """

    def __init__(self, text: str) -> None:
        self._length = len(text)
        self._wide = [] if text.isascii() else [found.start() for found in _WIDE.finditer(text)]
        self._wide_on_page = [place + before for before, place in enumerate(self._wide)]

    def to_page(self, offset: int) -> int:
        """Offset as the page counts it."""
        return offset + bisect_left(self._wide, offset)

    def from_page(self, offset: int) -> int:
        """Offset in characters, at most the length of the text, of one that the page counted."""
        return min(offset - bisect_left(self._wide_on_page, offset - 1), self._length)

    def span(self, span: TextSpan) -> dict[str, Any]:
        """Ends of a stretch as JSON data."""
        return {"from": self.to_page(span.start), "to": self.to_page(span.end)}

    def edits(self, edits: Iterable[TextEdit]) -> list[dict[str, Any]]:
        """Edits as JSON data."""
        return [self.span(edit.span) | {"text": edit.text} for edit in edits]
