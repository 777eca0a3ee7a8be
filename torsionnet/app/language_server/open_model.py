"""Open file of an editor, and whether it is a model file.

Text of an open file with the counting of an editor: lines, and units of UTF-16, UTF-8 or UTF-32 in a line. This is the
only place that converts between the two; everything else counts characters.
"""

from __future__ import annotations

import asyncio
import bisect
import re
from collections.abc import Awaitable, Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from lsprotocol.types import Position, PositionEncodingKind, Range
from lsprotocol.types import TextEdit as EditorEdit

from torsionnet.app.text.text_edits import TextEdit, TextSpan

# Text of an open file with the counting of an editor: lines, and units of UTF-16, UTF-8 or UTF-32 in a line.

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
        return [0, *(line_break.end() for line_break in _BREAK.finditer(self.text))]

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


_KEY = re.compile(r"""^["']?torsionnet["']?[ \t]*:""", re.MULTILINE)
_KEY_IN_BRACES = re.compile(r"""[{,\s]["']?torsionnet["']?\s*:""")
_OTHERS = re.compile(r"""^["']?(vary|model)["']?[ \t]*:""", re.MULTILINE)
"""Expression of the keys of studies, benches, fits and campaigns, which name a model instead of being one."""
_OWN_NAME = re.compile(r"\.torsionnet\.(yaml|yml|json)$", re.IGNORECASE)
_OF_MODELS = re.compile(r"""^["']?(elements|use|parts|ports)["']?[ \t]*:""", re.MULTILINE)

_PARTS = re.compile(r"""^["']?parts["']?[ \t]*:""", re.MULTILINE)
_NO_PARTS = re.compile(r"""^["']?(elements|use|ports)["']?[ \t]*:""", re.MULTILINE)


@dataclass(frozen=True)
class OpenModel:
    """Model file that is open in an editor, with the text as shown there, saved or not."""

    uri: str
    shown: EditorText
    file: str
    folder: Path | None
    addresses: Mapping[Path, str] = field(default_factory=dict, compare=False)
    """Addresses of all files that are open, by their resolved paths."""

    @property
    def text(self) -> str:
        """Text of the file."""
        return self.shown.text


def is_model_text(text: str, file: str) -> bool:
    """Whether a text is that of a model file: it has the key ``torsionnet``, or the file has the ending of models.

    Studies, fits, benches and campaigns have the key too, and are no models.

    >>> is_model_text("torsionnet: 1\\nelements: {}", "plant.yaml"), is_model_text("services: {}", "compose.yaml")
    (True, False)
    >>> is_model_text("torsionnet: 1\\nmodel: amt_rig\\nvary: {}", "study.yaml")
    False
    """
    if _OWN_NAME.search(file):
        return True
    start = text.removeprefix("\ufeff").lstrip()
    if start.startswith("{"):
        return _KEY_IN_BRACES.search(start) is not None
    return _KEY.search(text.removeprefix("\ufeff")) is not None and not names_a_model(text)


def names_a_model(text: str) -> bool:
    """Whether a text is that of a study, fit, bench or campaign, which name a model instead of being one."""
    return _OTHERS.search(text) is not None and _OF_MODELS.search(text) is None


def is_parts_text(text: str) -> bool:
    r"""Whether a text is that of a file of parts, which models include, and which is no model itself.

    >>> is_parts_text("torsionnet: 1\nparts: {}"), is_parts_text("torsionnet: 1\nparts: {}\nelements: {}")
    (True, False)
    """
    return _PARTS.search(text) is not None and _NO_PARTS.search(text) is None


# Schedule of checks: the newest text of a file wins, and nothing waits for a long check.

CHANGE_DELAY = 0.1
"""Time in s without a further change after which a changed text is checked, as nobody reads while typing."""


class CheckSchedule:
    """Tasks that check open files, at most one of each file; a newer one takes the place of the one before."""

    def __init__(self, check: Callable[[str], Awaitable[None]]) -> None:
        self._check = check
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def ask(self, uri: str, delay: float = 0.0) -> None:
        """Check a file after a delay in s, unless it is asked for again before."""
        self.drop(uri)
        task = asyncio.get_running_loop().create_task(self._later(uri, delay))
        self._tasks[uri] = task
        task.add_done_callback(lambda done: self._forget(uri, done))

    def drop(self, uri: str) -> None:
        """Give up the check of a file that is no longer wanted; what it finds is not shown."""
        task = self._tasks.pop(uri, None)
        if task is not None:
            task.cancel()

    async def _later(self, uri: str, delay: float) -> None:
        await asyncio.sleep(delay)
        await self._check(uri)

    def _forget(self, uri: str, task: asyncio.Task[None]) -> None:
        if self._tasks.get(uri) is task:
            del self._tasks[uri]
