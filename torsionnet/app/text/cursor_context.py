"""Place of the cursor in a model text that is being written: the keys around it and the word begun."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import NamedTuple

from torsionnet.app.text.text_edits import TextLines, TextSpan
from torsionnet.base.errors import EntryPath

# Place of a cursor inside a flow mapping or list, as ``{type: spring, nodes: [a,``.

_TOKEN = re.compile(
    r"""(?P<quoted>"(?:[^"\\\n]|\\[^\n])*"|'(?:[^'\n]|'')*')|(?P<open_quote>["'][^\n]*)|(?P<comment>(?<=\s)\#[^\n]*)"""
    r"""|(?P<mark>[{}\[\],])|(?P<colon>:(?=[\s,\[\]{}]|$))|(?P<newline>\n)|\s|(?P<word>(?:[^\s{}\[\],:]|:(?![\s,\[\]{}]|$))+)""",
    re.VERBOSE | re.DOTALL,
)


@dataclass(frozen=True)
class FlowPlace:
    """Place in a flow mapping or list: keys and indices around it, and where the word begun starts."""

    path: tuple[str | int, ...]
    is_key: bool
    start: int
    is_list_item: bool
    is_text: bool = False


@dataclass
class _Frame:
    """Bracket that is open, with the key or index at which its reading stands."""

    mark: str
    key: str | None = None
    index: int = 0
    start: int | None = None
    is_done: bool = False

    def step(self) -> str | int:
        return self.index if self.mark == "[" else self.key or ""


def flow_place(text: str, start: int, end: int) -> FlowPlace | None:
    """Place of offset ``end`` in the flow mapping or list that opens at ``start``, None where it is closed before.

    Examples
    --------
    >>> flow_place("{type: spring, nodes: [a, b", 0, 27)
    FlowPlace(path=('nodes', 1), is_key=False, start=26, is_list_item=True, is_text=False)
    """
    frames: list[_Frame] = []
    is_text = is_new_line = False
    for sign in _TOKEN.finditer(text, start, end):
        kind, token = sign.lastgroup, sign[0]
        top = frames[-1] if frames else _Frame("")
        if kind == "mark" and token in "{[":
            frames.append(_Frame(token))
        elif kind == "mark" and token in "}]":
            wanted = "{" if token == "}" else "["
            if any(frame.mark == wanted for frame in frames):
                while frames.pop().mark != wanted:
                    pass
            if not frames:
                return None
            frames[-1].is_done = True
        elif kind == "mark":
            top.key, top.index, top.start, top.is_done = None, top.index + 1, None, False
        elif kind == "colon":
            _colon(frames, text, sign.start())
        elif kind == "newline":
            is_new_line = True
            continue
        elif kind in ("quoted", "open_quote", "word"):
            if top.is_done or (is_new_line and top.start is not None and top.mark == "{"):
                # What follows a finished value is the next key, though the comma is missing.
                top.key, top.start, top.is_done = None, None, False
            top.start = sign.start() if top.start is None else top.start
            top.is_done = kind == "quoted"
            is_text = kind == "open_quote"
        elif kind == "comment":
            is_text = sign.end() == end
        is_new_line = False if kind else is_new_line
    if not frames:
        return None
    top = frames[-1]
    is_key = top.mark == "{" and top.key is None
    path = tuple(frame.step() for frame in (frames[:-1] if is_key else frames))
    word = end if top.start is None else top.start
    return FlowPlace(path, is_key, word, top.mark == "[", is_text or top.is_done)


def _colon(frames: list[_Frame], text: str, at: int) -> None:
    """Take the word before a colon as key; of two words without a comma the last."""
    top = frames[-1]
    if top.start is None:
        return
    words = text[top.start : at].strip()
    if top.mark == "[" and len(frames) > 1 and frames[-2].mark == "{":  # the list was not closed
        frames.pop()
        top = frames[-1]
    top.key = words.split()[-1].strip("\"'") if top.key is not None and words.split() else words.strip("\"'")
    top.start, top.is_done = None, False


_DASHES = re.compile(r"\s*(?:-(?:\s+|$))*")
_KEY = re.compile(r"""("[^"]*"|'[^']*'|[^\s{\[\]},:"'#&*!|>%@`][^{\[\]},:"'#]*?)\s*:(?:(?=\s)|$)(\s*)""")
_COMMENT = re.compile(r"""^(?:[^"'#]|"[^"]*"|'[^']*'|(?<!\s)["'#])*?(?:(?<=\s)|^)#""")
_MOST_LINES_OF_FLOW = 400
"""Lines above the cursor among which the beginning of a flow mapping is looked for where indentation does not tell."""


@dataclass(frozen=True)
class CursorContext:
    """Place of a cursor: the path of the mapping whose key is written there, or of the value.

    ``word`` is the key or value begun, up to the cursor. ``indent`` is the column of the block entry that is written.
    With ``is_text`` the cursor is in a comment, in quotes or after a value, where no word of a model can follow.
    """

    path: EntryPath
    is_key: bool
    word: TextSpan
    is_flow: bool = False
    is_list_item: bool = False
    is_text: bool = False
    indent: int = 0
    needs_blank: bool = False


class _Level(NamedTuple):
    """Key (or None for the dash of a list) that a line begins, its column and where its value stands."""

    column: int
    key: str | None
    value: int


def cursor_context(text: str, offset: int) -> CursorContext:
    """Place of the cursor at an offset of a text, which may be broken.

    Examples
    --------
    >>> context = cursor_context("elements:\\n  motor: {type: inertia, no", 37)
    >>> context.path, context.is_key, context.word, context.is_flow
    (('elements', 'motor'), True, TextSpan(start=35, end=37), True)
    """
    return _Cursor(text, offset).context()


class _Cursor:
    """Cursor in the lines of a text."""

    def __init__(self, text: str, offset: int) -> None:
        self.text, self.offset = text, max(0, min(offset, len(text)))
        self.starts = TextLines(text).starts
        self.row, self.column = TextLines(text).place(self.offset)

    def line(self, row: int) -> str:
        end = self.starts[row + 1] if row + 1 < len(self.starts) else len(self.text)
        return self.text[self.starts[row] : end].rstrip("\r\n\x85\u2028\u2029")

    def context(self) -> CursorContext:
        prefix = self.line(self.row)[: self.column]
        levels, rest = _levels(prefix)
        indent = len(prefix) - len(prefix.lstrip()) if prefix.strip() else self.column
        is_first_dash = bool(levels) and levels[0].key is None
        # A bracket behind the key of this line: the place is within it, if it is still open.
        if levels and levels[-1].key is not None and prefix[levels[-1].value : levels[-1].value + 1] in ("{", "["):
            in_flow = self.flow(self.row, levels[-1].value, self.path_above(indent, is_first_dash), levels)
            return in_flow or self.plain((), True, self.column, is_text=True)
        above = self.above(indent, is_first_dash)
        if isinstance(above, CursorContext):
            return above
        if _COMMENT.match(prefix):
            return self.plain((), True, self.column, is_text=True)
        if rest < len(prefix) and prefix[rest] in "{[":
            return self.flow(self.row, rest, above, levels) or self.plain((), True, self.column, is_text=True)
        path = (*above, *self.own(levels, indent))
        # Within quotes and folded text nothing is offered.
        is_text = prefix[rest : rest + 1] in ('"', "'", "|", ">")
        if levels and levels[-1].key is not None:
            needs_blank = prefix.endswith(":")
            return self.plain(path, False, rest, is_text=is_text, indent=levels[-1].column, needs_blank=needs_blank)
        if levels:
            return self.plain(path, False, rest, is_text=is_text, indent=rest, is_list_item=True)
        return self.plain(path, True, rest, is_text=is_text, indent=indent)

    def plain(
        self,
        path: EntryPath,
        is_key: bool,
        column: int,
        *,
        is_text: bool = False,
        indent: int = 0,
        is_list_item: bool = False,
        needs_blank: bool = False,
    ) -> CursorContext:
        word = TextSpan(self.starts[self.row] + min(column, self.column), self.offset)
        return CursorContext(path, is_key, word, False, is_list_item, is_text, indent, needs_blank)

    def own(self, levels: list[_Level], indent: int) -> EntryPath:
        """Keys and indices that the line of the cursor begins itself."""
        first = self.index_above(self.row, indent)
        return tuple(
            (first if number == 0 else 0) if level.key is None else level.key for number, level in enumerate(levels)
        )

    def index_above(self, row: int, column: int) -> int:
        """Number of items of the same list above a line."""
        count = 0
        for above in range(row - 1, -1, -1):
            line = self.line(above)
            bare = line.lstrip()
            if not bare or bare[0] == "#" or len(line) - len(bare) > column:
                continue
            if len(line) - len(bare) < column or not bare.startswith("-"):
                break
            count += 1
        return count

    def flow(self, row: int, column: int, above: EntryPath, levels: list[_Level]) -> CursorContext | None:
        """Place in a flow mapping that opens on a line, None where it is closed before the cursor."""
        place = flow_place(self.text, self.starts[row] + column, self.offset)
        if place is None:
            return None
        line = self.line(row)
        own = tuple(
            (self.index_above(row, level.column) if number == 0 else 0) if level.key is None else level.key
            for number, level in enumerate(levels)
        )
        return CursorContext(
            (*above, *own, *place.path), place.is_key, TextSpan(place.start, self.offset), True, place.is_list_item,
            place.is_text, len(line) - len(line.lstrip()),
        )  # fmt: skip

    def path_above(self, indent: int, is_dash: bool) -> EntryPath:
        """Keys and indices of the entries that the line of the cursor belongs to by its indentation alone."""
        path = self.above(indent, is_dash, by_indent=True)
        return () if isinstance(path, CursorContext) else path

    def above(self, level: int, is_dash: bool, *, by_indent: bool = False) -> EntryPath | CursorContext:
        """Keys and indices of the entries that the line of the cursor belongs to by its indentation.

        Where one of them opens a flow mapping or a text that still holds the cursor, the place in it.
        """
        path: list[str | int] = []
        open_ = self.open_flow() if self.row and not by_indent else None
        if open_ is not None:
            return open_
        # Upwards, lines that are indented less than all below them are the parents.
        for row in range(self.row - 1, -1, -1):
            if level == 0 and not is_dash:
                break
            line = self.line(row)
            bare = line.lstrip()
            if not bare or bare[0] == "#":
                continue
            indent = len(line) - len(bare)
            # A dash may stand in the column of its parent's key: "nodes:" above "- a".
            is_parent = indent < level or (is_dash and indent == level and bare[0] != "-")
            if not is_parent:
                continue
            levels, rest = _levels(line)
            value = line[rest:].strip()
            if value[:1] in ("{", "[") and not by_indent:
                in_flow = self.flow(row, rest, (), levels)
                if in_flow is not None:
                    return replace(in_flow, path=(*self.path_of(row), *in_flow.path))
            if value[:1] in ("|", ">") and not by_indent:
                return self.plain((), True, self.column, is_text=True)
            # One line may open several levels, as "- name: {": each counts if it is left of what is below.
            for inner in reversed(levels):
                is_above = inner.column < level or (is_dash and inner.column == level and inner.key is not None)
                if not is_above:
                    continue
                if inner.key is None:
                    path.append(self.index_above(row, inner.column) if inner is levels[0] else 0)
                    is_dash = True
                elif not value or value[0] in "#&":
                    path.append(inner.key)
                    is_dash = False
                level = inner.column
            level = min(level, indent)
        return tuple(reversed(path))

    def path_of(self, row: int) -> EntryPath:
        """Keys and indices around a line above the cursor."""
        line = self.line(row)
        cursor = _Cursor(self.text, self.starts[row])
        return cursor.path_above(len(line) - len(line.lstrip()), line.lstrip().startswith("-"))

    def open_flow(self) -> CursorContext | None:
        """Place in a flow mapping that goes on over a line end, whatever the indentation of the cursor's line."""
        row = self.row - 1
        while row >= 0 and not self.line(row).strip():
            row -= 1
        last = self.line(row).rstrip() if row >= 0 else ""
        if not last.endswith(("{", "[", ",")) and not self.line(self.row).lstrip().startswith(("}", "]")):
            return None
        for above in range(row, max(row - _MOST_LINES_OF_FLOW, -1), -1):
            levels, rest = _levels(self.line(above))
            if self.line(above)[rest : rest + 1] in ("{", "["):
                in_flow = self.flow(above, rest, (), levels)
                if in_flow is not None:
                    return replace(in_flow, path=(*self.path_of(above), *in_flow.path))
                if levels:
                    return None
        return None


def _levels(line: str) -> tuple[list[_Level], int]:
    """Dashes and key that a line begins with, and the column of what follows them."""
    levels: list[_Level] = []
    dashes = _DASHES.match(line)
    at = dashes.end() if dashes else 0
    levels += [_Level(column, None, at) for column in range(at) if line[column] == "-"]
    key = _KEY.match(line, at)
    if key:
        levels.append(_Level(at, key[1].strip("\"'"), key.end()))
        at = key.end()
    return levels, at
