"""Layout of a model text: indentation, blanks and line ends, while comments, quotes, digits and order stay."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml
from yaml import tokens

from torsionnet.app.text.text_edits import TextEdit, TextLines, TextSpan, edited
from torsionnet.base.errors import ModelError
from torsionnet.model.files.located_yaml import LocatedDocument, LocatedNode, compose, fastest_parser

_STEP = 2
_OPENING = (tokens.FlowMappingStartToken, tokens.FlowSequenceStartToken)
_CLOSING = (tokens.FlowMappingEndToken, tokens.FlowSequenceEndToken)
_BLANK = re.compile(r"[ \t]*")


def formatted(text: str) -> list[TextEdit]:
    """Edits that bring a model text into the layout of the library's models; none for a text that is broken.

    Entries are indented by two blanks a level; within brackets one blank follows a colon and a comma and none stands
    beside the brackets; no line ends with blanks, and the last one ends with a line break. In block style, values that
    stand below each other stay so. Comments, empty lines, quotes, digits and the order of entries stay.

    Examples
    --------
    >>> text = "elements:\\n    disc: { type: inertia,node: a }   # cast\\n"
    >>> print(edited(text, formatted(text)), end="")
    elements:
      disc: {type: inertia, node: a}   # cast
    """
    body = text.removeprefix("\ufeff")
    try:
        document = compose(body, "")
    except ModelError:
        return []
    if document.faults or document.root is None or document.root.value is None:
        return []
    layout = _Layout(TextLines(body), document)
    # A layout in which the text would say something else is not taken.
    for edits in (list(layout.edits()), list(layout.edits(last_break=False))):
        if _same(document, edited(body, edits)):
            mark = len(text) - len(body)
            return [TextEdit(TextSpan(edit.span.start + mark, edit.span.end + mark), edit.text) for edit in edits]
    return []


def _same(document: LocatedDocument, text: str) -> bool:
    try:
        return bool(compose(text, "").data == document.data)
    except ModelError:
        return False


@dataclass
class _Layout:
    """Indentation of every line, in the old text and the new one, and the gaps between words on a line."""

    lines: TextLines
    document: LocatedDocument
    shift: dict[int, int] = field(default_factory=dict)
    """Blanks by which a line moves to the right, by its number."""
    texts: set[int] = field(default_factory=set)
    """Numbers of the lines whose end lies within a text of several lines."""
    aligned: set[tuple[int, int]] = field(default_factory=set)
    """Places of values that stand below others of the same mapping."""

    def edits(self, *, last_break: bool = True) -> Iterator[TextEdit]:
        """Edits in the order of the text."""
        if self.document.root is not None and not self.shift:
            self.entries(self.document.root, 0)
            self.between()
        edits = [*self.margins(), *self.gaps()]
        text = self.lines.text
        if last_break and text and not text.endswith(("\n", "\r")):
            end = len(text)
            edits.append(TextEdit(TextSpan(end, end), (re.search("\r\n|\r|\n", text) or ["\n"])[0]))
        return iter(sorted(edits))

    def align(self, node: LocatedNode) -> None:
        """Remember the values of a mapping that begin in the same column, further right than they would have to."""
        places = [(entry.place, entry.key_place) for entry in node.entries.values() if entry.key_place]
        columns = Counter(value[1] for value, key in places if value[0] == key[2])
        self.aligned |= {value[:2] for value, key in places if value[0] == key[2] and columns[value[1]] > 1}

    def line(self, number: int) -> str:
        """Text of a line without its break."""
        return self.lines.text[self.lines.starts[number] : self.lines.offset(number, len(self.lines.text))]

    def indent(self, number: int) -> int:
        """Column at which the content of a line begins, a tab counted as one step."""
        blank = _BLANK.match(self.line(number))
        return len(blank[0].replace("\t", " " * _STEP)) if blank else 0

    def is_block(self, node: LocatedNode) -> bool:
        """Whether a value has entries in block style."""
        line, column = node.place[:2]
        if not node.entries:
            return False
        shown = re.sub(r"^&\S+\s*", "", self.line(line)[column:])
        return not shown.startswith(("{", "[", "*"))

    def entries(self, node: LocatedNode, column: int) -> None:
        """Move the lines of a value in block style so that its entries begin at a column."""
        if not self.is_block(node):
            self.shift.setdefault(node.place[0], 0)
            self.scalar(node, 0, -_STEP)
            return
        is_list = isinstance(node.value, list)
        self.align(node)
        for entry in node.entries.values():
            line = (entry.key_place or entry.place)[0]
            if is_list:
                line = self.dash_line(entry)
            own = self.indent(line)
            self.shift.setdefault(line, column - own)
            if not self.is_block(entry):
                self.scalar(entry, line, column)
            else:
                self.entries(entry, column + _STEP)

    def dash_line(self, entry: LocatedNode) -> int:
        """Number of the line with the dash of a list item."""
        line = (entry.key_place or entry.place)[0]
        while line > 0 and not self.line(line).lstrip().startswith("-"):
            line -= 1
        return line

    def scalar(self, node: LocatedNode, line: int, column: int) -> None:
        """Move the further lines of a value that begins in a line of an entry at a column."""
        first, start, last, end = node.place
        if end == 0 and last > first:
            last -= 1
        is_text = not isinstance(node.value, (dict, list))
        sign = self.line(first)[start : start + 1]
        # Line breaks in quotes belong to the text.
        if is_text and sign in ("'", '"'):
            self.texts |= set(range(first, last))
        rest = [number for number in range(line + 1, last + 1) if self.line(number).strip()]
        move = self.shift.get(line, 0)
        if is_text and sign in ("|", ">"):
            self.texts |= set(range(first + 1, last + 1))
            if not re.match(r"[|>][-+]?[1-9]", self.line(first)[start:]) and rest:
                move = column + _STEP - min(self.indent(number) for number in rest)
        elif rest:
            inner = [number for number in rest if not self.line(number).lstrip().startswith(("}", "]"))]
            move = max(move, column + _STEP - min(self.indent(number) for number in inner)) if inner else move
        for number in rest:
            self.shift.setdefault(number, move)

    def between(self) -> None:
        """Move comments with the entries that they stand at."""
        count = len(self.lines.starts)
        known = [number for number in range(count) if number in self.shift]
        for number in range(count):
            if number in self.shift or not self.line(number).strip():
                continue
            after = next((entry_line for entry_line in known if entry_line > number), None)
            before = next((entry_line for entry_line in reversed(known) if entry_line < number), None)
            around = [entry_line for entry_line in (after, before) if entry_line is not None]
            fitting = [entry_line for entry_line in around if self.indent(entry_line) == self.indent(number)]
            # In the column of an entry a comment moves as that does, else into its column.
            if fitting:
                self.shift[number] = self.shift[fitting[0]]
            elif around:
                self.shift[number] = self.indent(around[0]) + self.shift[around[0]] - self.indent(number)

    def margins(self) -> Iterator[TextEdit]:
        """Edits of the blanks at both ends of the lines."""
        for number, start in enumerate(self.lines.starts):
            line = self.line(number)
            blank = len(line) - len(line.lstrip(" \t"))
            # An empty line keeps no blanks, but in a text of several lines.
            if number not in self.texts and number - 1 not in self.texts and not line.strip(" \t"):
                if line:
                    yield TextEdit(TextSpan(start, start + len(line)), "")
                continue
            new = " " * max(0, self.indent(number) + self.shift.get(number, 0))
            if line.strip(" \t") and new != line[:blank]:
                yield TextEdit(TextSpan(start, start + blank), new)
            kept = len(line.rstrip(" \t"))
            if number not in self.texts and kept < len(line):
                yield TextEdit(TextSpan(start + kept, start + len(line)), "")

    def gaps(self) -> Iterator[TextEdit]:
        """Edits of the blanks between words on the same line."""
        depth = 0
        for before, after in itertools.pairwise(self.words()):
            depth += isinstance(before, _OPENING) - isinstance(before, _CLOSING)
            line = before.end_mark.line
            if after.start_mark.line != line:
                continue
            span = TextSpan(self.offset(before.end_mark), self.offset(after.start_mark))
            old = self.lines.text[span.start : span.end]
            new = self.gap(before, after, depth, old)
            if new != old and not old.strip(" \t"):
                yield TextEdit(span, new)

    def gap(self, before: Any, after: Any, depth: int, old: str) -> str:
        """Blanks between two words."""
        if isinstance(before, _OPENING):
            return ""
        if isinstance(before, tokens.ValueToken):
            if isinstance(after, (tokens.FlowEntryToken, *_CLOSING)):
                return old
            place = (after.start_mark.line, after.start_mark.column)
            return old if not depth and place in self.aligned else " "
        if isinstance(after, (tokens.FlowEntryToken, *_CLOSING)):
            return old if isinstance(before, tokens.AnchorToken) else ""
        if isinstance(after, tokens.ValueToken):
            return "" if isinstance(before, tokens.ScalarToken) else old
        if isinstance(before, tokens.FlowEntryToken):
            return " "
        return " " if isinstance(before, tokens.BlockEntryToken) else old

    def offset(self, mark: Any) -> int:
        """Offset of a mark of the YAML scanner."""
        return self.lines.offset(mark.line, mark.column)

    def words(self) -> Iterator[Any]:
        """Tokens of the text that have a width."""
        source = fastest_parser()(self.lines.text)
        while (token := source.get_token()) is not None and not isinstance(token, yaml.StreamEndToken):
            if self.offset(token.end_mark) > self.offset(token.start_mark):
                yield token
