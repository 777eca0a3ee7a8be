"""Stretches and edits of a text by offsets, and their conversion to the counting of editors."""

from __future__ import annotations

import bisect
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import count

from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import EntryPath, UsageError
from torsionnet.base.plain_names import plain_name
from torsionnet.model.files.located_yaml import LocatedDocument, LocatedNode, compose
from torsionnet.model.files.value_editing import node_at
from torsionnet.model.files.writer import flow_text

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
        return [0, *(line_end.end() for line_end in _BREAK.finditer(self.text))]

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


@dataclass(frozen=True)
class TextFix:
    """Edits of a text that mend one fault of it, with a title that says what they do.

    ``hides`` marks a deletion or quotes, after which nearly every text is sound YAML.
    """

    title: str
    edits: tuple[TextEdit, ...]
    hides: bool = False


# Edits of single entries of a text with known places: replaced, inserted, removed, in block, flow and JSON style.

STEP = "  "
"""Blanks by which a text is indented further at each level."""
_ANCHOR = re.compile(r"&[^\s,\[\]{}]+\s*")
_COMMENT = re.compile(r"[ \t]*#")
_TO_COMMA = re.compile(r"[ \t]*,")


@dataclass(frozen=True)
class WrittenText:
    """Text of a model file with the places of its entries."""

    text: str
    document: LocatedDocument
    is_json: bool = False

    @cached_property
    def lines(self) -> TextLines:
        """Lines of the text."""
        return TextLines(self.text)

    @cached_property
    def line_break(self) -> str:
        """Break between the lines of the text."""
        line_end = re.search("\r\n|\r|\n", self.text)
        return line_end[0] if line_end else "\n"

    def node(self, path: EntryPath) -> LocatedNode:
        """Value at a path with its place; UsageError where there is none."""
        node = node_at(self.document, path)
        if node is None:
            raise UsageError(f"the text has no entry {'.'.join(map(str, path))}", kind="unknown-entry")
        return node

    def offset(self, line: int, column: int) -> int:
        """Offset of a place in the document, before which the text may have a byte order mark."""
        return self.lines.offset(line, column + (line == 0 and self.text.startswith("\ufeff")))

    def start(self, node: LocatedNode) -> int:
        """Offset at which a value begins."""
        return self.offset(node.place[0], node.place[1])

    def end(self, node: LocatedNode) -> int:
        """Offset at which a value ends, without comments and empty lines behind it."""
        start, end = self.start(node), self.offset(node.place[2], node.place[3])
        if node.entries and not self.is_flow(node) and not self.text.startswith("*", start):
            return self.end(list(node.entries.values())[-1])
        return start + len(self.text[start:end].rstrip())

    def value_span(self, node: LocatedNode) -> TextSpan:
        """Stretch of a value."""
        return TextSpan(self.start(node), max(self.start(node), self.end(node)))

    def key_start(self, node: LocatedNode) -> int:
        """Offset at which an entry begins, with its name where it has one."""
        return self.offset(node.key_place[0], node.key_place[1]) if node.key_place else self.start(node)

    def is_flow(self, node: LocatedNode) -> bool:
        """Whether a value stands in brackets."""
        start = self.start(node)
        anchor = _ANCHOR.match(self.text, start)
        return self.text.startswith(("{", "["), anchor.end() if anchor else start)

    def written(self, value: Json) -> str:
        """Text of a value on one line."""
        return json.dumps(value, ensure_ascii=False) if self.is_json else flow_text(value)

    def entry_text(self, key: str, value: Json) -> str:
        """Text of a value with its name on one line."""
        return f"{self.written(key)}: {self.written(value)}"

    def replacement(self, path: EntryPath, value: Json) -> TextEdit:
        """Edit that writes another value in the place of one."""
        node = self.node(path)
        span = self.value_span(node)
        blank = "" if span.start == 0 or self.text[span.start - 1] != ":" else " "
        if node.value is not None and node.entries and not self.is_flow(node) and node.key_place:
            colon = self.text.index(":", self.offset(node.key_place[2], node.key_place[3])) + 1
            span, blank = TextSpan(colon, span.end), " "
        elif node.value is None and node.key_place:
            key_end = self.offset(node.key_place[2], node.key_place[3])
            if ":" not in self.text[key_end : max(key_end, span.start)]:  # a name alone in brackets
                span, blank = TextSpan(key_end, key_end), ": "
        return TextEdit(span, blank + self.written(value))

    def insertion(self, parent: EntryPath, key: str, value: Json) -> TextEdit:
        """Edit that writes a new entry into a mapping as its last, in the style of the one before."""
        node, text = self.node(parent), self.entry_text(key, value)
        if not node.entries:
            return self._first(node, text, parent)
        last = list(node.entries.values())[-1]
        line, column = self.lines.place(self.key_start(last))
        if not self.is_flow(node):
            place = self.line_end(self.last_line(last))
            return TextEdit(TextSpan(place, place), f"{self.line_break}{' ' * column}{text}")
        end = self.end(last)
        indent = self.text[self.lines.starts[line] : self.key_start(last)]
        if indent.strip() or self.is_shared(node):  # several entries on a line
            return TextEdit(TextSpan(end, end), f", {text}")
        if _TO_COMMA.match(self.text, end) is None:
            return TextEdit(TextSpan(end, end), f",{self.line_break}{indent}{text}")
        place = self.line_end(self.lines.place(end)[0])
        return TextEdit(TextSpan(place, place), f"{self.line_break}{indent}{text},")

    def _first(self, node: LocatedNode, text: str, parent: EntryPath) -> TextEdit:
        if isinstance(node.value, dict):
            inside = self.text.index("{", self.start(node)) + 1
            return TextEdit(TextSpan(inside, inside), text)
        if node.value is not None or node.key_place is None:
            raise UsageError(f"{'.'.join(map(str, parent)) or 'the text'} is no table of entries", kind="wrong-form")
        line, column = node.key_place[:2]
        if self.is_json or not self._in_block(parent):
            return TextEdit(self.value_span(node), f"{'' if self.is_json else ' '}{{{text}}}")
        if self.value_span(node).start < self.value_span(node).end:  # null or ~
            return TextEdit(self.value_span(node), f"{{{text}}}")
        place = self.line_end(line)
        return TextEdit(TextSpan(place, place), f"{self.line_break}{' ' * column}{STEP}{text}")

    def _in_block(self, path: EntryPath) -> bool:
        return not any(self.is_flow(self.node(path[:length])) for length in range(len(path)))

    def is_shared(self, node: LocatedNode) -> bool:
        """Whether two entries of a value in brackets begin on the same line."""
        lines = [self.lines.place(self.key_start(child))[0] for child in node.entries.values()]
        return len(set(lines)) < len(lines)

    def line_end(self, line: int) -> int:
        """Offset of the end of a line, before its break."""
        return self.lines.offset(line, len(self.text))

    def line(self, number: int) -> str:
        """Text of a line, empty beyond the last."""
        if not 0 <= number < len(self.lines.starts):
            return ""
        return self.text[self.lines.starts[number] : self.line_end(number)]

    def last_line(self, node: LocatedNode) -> int:
        """Number of the last line of an entry in block style, with the comments that are indented below it."""
        column = self.lines.place(self.key_start(node))[1]
        last, _ = self.lines.place(self.end(node))
        while (comment := _COMMENT.match(self.line(last + 1))) and comment.end() - 1 > column:
            last += 1
        return last

    def first_line(self, node: LocatedNode) -> int:
        """Number of the first line of an entry, with the comments directly above it."""
        first, column = self.lines.place(self.key_start(node))
        column = len(self.line(first)) - len(self.line(first).lstrip())
        while (comment := _COMMENT.match(self.line(first - 1))) and comment.end() - 1 == column and first > 1:
            first -= 1
        return first

    def removal(self, path: EntryPath) -> list[TextEdit]:
        """Edits that remove an entry with its name and comments; what is empty then becomes {} or []."""
        node, parent = self.node(path), self.node(path[:-1])
        if self.is_flow(parent):
            return self._removal_in_flow(path, node, parent)
        start = self.key_start(node)
        line, _ = self.lines.place(start)
        before = self.text[self.lines.starts[line] : start]
        following = self._following(path, parent)
        if before.strip() and node.key_place is not None and following is not None:  # the first entry of a list item
            return [TextEdit(TextSpan(start, self.key_start(following)), "")]
        last = self.last_line(node)
        first = self.first_line(node)
        begin = self.lines.starts[first]
        end = self.lines.starts[last + 1] if last + 1 < len(self.lines.starts) else len(self.text)
        edits = [TextEdit(TextSpan(begin, end), "")]
        if len(parent.entries) == 1:
            empty = "{}" if isinstance(parent.value, dict) else "[]"
            if parent.key_place is None:
                return [TextEdit(self.value_span(parent), empty)]
            colon = self.text.index(":", self.offset(parent.key_place[2], parent.key_place[3])) + 1
            edits.insert(0, TextEdit(TextSpan(colon, colon), f" {empty}"))
        return edits

    def _removal_in_flow(self, path: EntryPath, node: LocatedNode, parent: LocatedNode) -> list[TextEdit]:
        start, end = self.key_start(node), self.end(node)
        following, keys = self._following(path, parent), list(parent.entries)
        place = keys.index(path[-1])
        before = parent.entries[keys[place - 1]] if place else None
        line, _ = self.lines.place(start)
        comma = _TO_COMMA.match(self.text, end)
        behind = self.line_end(self.lines.place(end)[0])
        rest = self.text[comma.end() if comma else end : behind].strip()
        alone = not self.text[self.lines.starts[line] : start].strip() and (not rest or rest.startswith("#"))
        if not alone or (following is None and before is None):
            if following is not None:
                return [TextEdit(TextSpan(start, self.key_start(following)), "")]
            return [TextEdit(TextSpan(start if before is None else self.end(before), end), "")]
        last, first = self.lines.place(end)[0], self.first_line(node)
        stop = self.lines.starts[last + 1] if last + 1 < len(self.lines.starts) else len(self.text)
        edits = [TextEdit(TextSpan(self.lines.starts[first], stop), "")]
        if following is None and before is not None and comma is None:
            comma_before = _TO_COMMA.match(self.text, self.end(before))
            if comma_before and comma_before.end() <= edits[0].span.start:
                edits.insert(0, TextEdit(TextSpan(self.end(before), comma_before.end()), ""))
            elif comma_before is None:  # the comma stands on another line
                return [TextEdit(TextSpan(self.end(before), end), "")]
        return edits

    def _following(self, path: EntryPath, parent: LocatedNode) -> LocatedNode | None:
        keys = list(parent.entries)
        place = keys.index(path[-1]) + 1
        return parent.entries[keys[place]] if place < len(keys) else None


def as_parameter(text: str, element: str, entry: str, symbol: str, file: str = "") -> list[TextEdit]:
    """Edits that make the number of an element's entry a parameter of the model, named after both.

    Raises
    ------
    UsageError
        The text has no such number.

    Examples
    --------
    >>> text = "elements:\\n  motor: {type: inertia, node: a, inertia: 0.078 kg*m^2}\\n"
    >>> print(edited(text, as_parameter(text, "motor", "inertia", "J")))
    parameters:
      J_motor: 0.078 kg*m^2
    elements:
      motor: {type: inertia, node: a, inertia: J_motor}
    <BLANKLINE>
    """
    document = compose(text.removeprefix("\ufeff"), file)
    written = WrittenText(text, document, file.lower().endswith(".json"))
    node = written.node(("elements", element, entry))
    if isinstance(node.value, (dict, list)):
        raise UsageError(f"{entry} of {element} is no number", kind="wrong-form")
    parameters = node_at(document, ("parameters",))
    taken = parameters.entries if parameters else {}
    stem = plain_name(f"{symbol}_{element}")
    name = next(
        candidate for number in count(1) if (candidate := stem if number == 1 else f"{stem}_{number}") not in taken
    )
    use = written.replacement(("elements", element, entry), name)
    if parameters:
        return [written.insertion(("parameters",), name, node.value), use]
    start, pair = written.key_start(written.node(("elements",))), written.entry_text(name, node.value)
    if written.is_json or written.is_flow(written.node(())):
        new = f"{written.written('parameters')}: {{{pair}}}, "
    else:
        new = f"parameters:{written.line_break}{STEP}{pair}{written.line_break}"
    return [TextEdit(TextSpan(start, start), new), use]
