"""Stretches of a text that hold the names in a value."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass

from torsionnet.app.text.text_edits import TextLines, TextSpan
from torsionnet.model.files.located_yaml import LocatedNode, Place

_WORD = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
_ANCHOR = re.compile(r"[&!]\S*\s+")


@dataclass(frozen=True)
class TextStretches:
    """Text of a model with the places of its values.

    Places are counted from ``first``, where the text begins after its byte order mark.
    """

    lines: TextLines
    first: int = 0

    def span(self, place: Place) -> TextSpan:
        """Stretch of the text at a place of a document."""
        line, column, end_line, end_column = place
        start = self.lines.offset(line, column + (self.first if line == 0 else 0))
        end = self.lines.offset(end_line, end_column + (self.first if end_line == 0 else 0))
        return TextSpan(start, max(start, end))

    def whole(self, place: Place) -> TextSpan:
        """Stretch of a key or scalar without quotes and anchor."""
        span = self.span(place)
        written = self.lines.text[span.start : span.end]
        anchor = _ANCHOR.match(written)
        start = span.start + (anchor.end() if anchor else 0)
        written = self.lines.text[start : span.end]
        if len(written) > 1 and written[0] in "'\"" and written[-1] == written[0]:
            return TextSpan(start + 1, span.end - 1)
        return TextSpan(start, span.end)

    def is_alias(self, place: Place) -> bool:
        """Whether a value stands for one that is written elsewhere, as ``*n``."""
        start = self.span(place).start
        return self.lines.text[start : start + 1] == "*"

    def located(self, places: Iterable[Place], names: Sequence[str]) -> list[TextSpan | None]:
        """Stretch of each name among the words at some places, None of one that is not written there.

        Names stand in the order of the text, as far as that is possible.
        """
        words = [word for place in places for word in self._words(place)]
        free = [True] * len(words)
        found: list[TextSpan | None] = []
        last = -1
        for name in names:
            fitting = [at for at, (word, _) in enumerate(words) if word == name and free[at]]
            at = next((at for at in fitting if at > last), fitting[0] if fitting else -1)
            if at < 0:
                found.append(None)
                continue
            free[at], last = False, at
            found.append(words[at][1])
        return found

    def _words(self, place: Place) -> Iterator[tuple[str, TextSpan]]:
        span = self.whole(place)
        text = self.lines.text
        if self.is_alias(place):
            return
        for word in _WORD.finditer(text, span.start, span.end):
            if text[word.end() : word.end() + 1] != "(":  # a function or quantity
                yield word[0], TextSpan(*word.span())


def scalar_places(node: LocatedNode, fixed: Container[object] = ()) -> Iterator[Place]:
    """Places of the keys and scalars in a value, in the order of the text, without those of keys that are fixed."""
    if not node.entries:
        yield node.place
        return
    for key, entry in node.entries.items():
        if entry.key_place and key not in fixed:
            yield entry.key_place
        yield from scalar_places(entry)
