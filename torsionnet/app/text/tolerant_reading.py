"""Model texts read as far as they can be, also where they are no sound YAML."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, TypeAlias

from torsionnet.app.text.text_edits import TextLines
from torsionnet.base.errors import EntryPath, ModelError
from torsionnet.model.files.located_yaml import (
    MOST_CHARACTERS,
    MOST_LEVELS,
    MOST_NODES,
    LocatedDocument,
    LocatedNode,
    Place,
    compose,
)

# Flow mappings, lists and quoted text that a person can read but YAML refuses, written so that YAML reads them.

_CLOSING = {"{": "}", "[": "]"}
_PLAIN_IN_FLOW = re.compile(r"(?:[^,\[\]{}\n:#]|:(?![\s,\[\]{}]|$)|(?<!\s)#)+")
_PLAIN_IN_BLOCK = re.compile(r"(?:[^\n#]|(?<!\s)#)+")
_COLON = re.compile(r"\s*:(?=[\s,\[\]{}]|$)")
_UNREADABLE = re.compile(r"[@`%*!|>&?-]|\S*?:(?:\s|$)|.*?:(?:\s|$)")
"""Beginnings of a text that YAML does not read as text unless it is quoted."""


def mended(text: str) -> tuple[str, list[int]]:
    """Value of an entry with its brackets and quotes closed, and where in ``text`` each character and the end stood.

    Examples
    --------
    >>> mended("{type: spring, nodes: [a, b, stiffness: k_1")[0]
    '{type: spring, nodes: [a, b, ], stiffness: k_1}'
    >>> mended("{type: inertia node: a, inertia}}")[0]
    '{type: inertia, node: a, inertia}'
    """
    mending = _Mending(text)
    mending.run()
    return "".join(mending.out), [*mending.origins, len(text)]


@dataclass
class _Mending:
    """Walk through a value that writes it anew; ``state`` is "start" of an item, "value" after a colon, "done"."""

    text: str
    at: int = 0
    state: str = "value"
    stack: list[str] = field(default_factory=list)
    out: list[str] = field(default_factory=list)
    origins: list[int] = field(default_factory=list)

    def put(self, text: str, origin: int | None = None) -> None:
        """Write characters that stand in the text from ``origin`` on; without it they are new here."""
        for index, char in enumerate(text):
            self.out.append(char)
            self.origins.append(self.at if origin is None else origin + index)

    def run(self) -> None:
        text = self.text
        while self.at < len(text):
            char = text[self.at]
            if char.isspace():
                self.put(char, self.at)
                self.at += 1
            elif char == "#" and (self.at == 0 or text[self.at - 1].isspace()):
                end = text.find("\n", self.at)
                self.at = len(text) if end < 0 else end
            # A bracket within plain text is a character of it.
            elif char in "{[" and (self.stack or self.state == "value"):
                self.separate()
                self.stack.append(char)
                self.put(char, self.at)
                self.at += 1
                self.state = "start"
            elif char in "}]":
                self.close(char)
            elif char == "," and self.stack:
                if self.state != "start":
                    self.put(char, self.at)
                self.at += 1
                self.state = "start"
            elif char in "\"'":
                self.quoted(char)
            else:
                self.plain()
        # What is still open at the end is closed.
        while self.stack:
            self.put(_CLOSING[self.stack.pop()])

    def separate(self) -> None:
        """Write the comma that is missing between two values."""
        if self.state == "done" and self.stack:
            self.put(", ")

    def close(self, char: str) -> None:
        if char in (_CLOSING[opened] for opened in self.stack):
            while (needed := _CLOSING[self.stack.pop()]) != char:
                self.put(needed)
            self.put(char, self.at)
            self.state = "done"
        self.at += 1

    def quoted(self, quote: str) -> None:
        start = self.at
        pattern = r'"((?:[^"\\\n]|\\[^\n])*)"' if quote == '"' else r"'((?:[^'\n]|'')*)'"
        whole = re.compile(pattern).match(self.text, start)
        if whole:
            content, self.at, after = whole[1], whole.end(), start + 1
            if quote == "'":
                content = content.replace("''", "'")
        else:
            # A quote that is never closed holds the text up to the end of the entry, at most of the line.
            end = re.compile(r"[,\]}\n]" if self.stack else r"\n").search(self.text, start + 1)
            after = start + 1
            stop = end.start() if end else len(self.text)
            content = self.text[after:stop].rstrip()
            self.at = after + len(content)
        if not self.start_of_key():
            self.separate()
        self.put("'", start)
        for index, char in enumerate(content):
            self.put("''" if char == "'" else char, min(after + index, self.at))
        self.put("'")
        self.state = "done"
        self.colon()

    def start_of_key(self) -> bool:
        """Whether a colon follows; what a key needs before it is then written."""
        if not self.stack or not _COLON.match(self.text, self.at):
            return False
        if self.stack[-1] == "[" and "{" in self.stack:
            self.stack.pop()
            self.put("]")
            self.state = "done"
        if self.state != "start":
            self.put(", ")
        return True

    def colon(self) -> None:
        colon = _COLON.match(self.text, self.at) if self.stack else None
        if colon:
            self.at = colon.end()
            self.put(":" if self.text[self.at : self.at + 1].isspace() else ": ", self.at - 1)
            self.state = "value"

    def plain(self) -> None:
        words_match = (_PLAIN_IN_FLOW if self.stack else _PLAIN_IN_BLOCK).match(self.text, self.at)
        if words_match is None:  # a lone colon
            self.at += 1
            return
        start, words = self.at, words_match[0].rstrip()
        self.at += len(words)
        if self.stack and _COLON.match(self.text, self.at):
            value, blank, key = words.rpartition(" ")
            if blank and self.state == "value":
                self.scalar(value.rstrip(), start)
                self.put(", ", start + len(value.rstrip()))
                self.state = "start"
                words, start = key, start + len(value) + 1
            self.start_of_key()
            self.scalar(words, start)
            self.colon()
            return
        self.separate()
        self.scalar(words, start)
        self.state = "done"

    def scalar(self, words: str, start: int) -> None:
        if not _UNREADABLE.match(words) or (words[0] == "-" and words[1:2] not in ("", " ")):
            self.put(words, start)
        else:
            self.put("'", start)
            for index, char in enumerate(words):
                self.put("''" if char == "'" else char, start + index)
            self.put("'", start + len(words))
        self.state = "done"


_CONTROL = re.compile("[^\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")
_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_HEAD = re.compile(r"""(\s*)("[^"]*"|'[^']*'|[^\s\[\]{},:"'#][^\[\]{},:"'#]*?)\s*(:(?=\s|$)|$|(?=[\[{]))\s*""")
_WORD_AND_REST = re.compile(r"(\s*)([^\s\[\]{},:\"'#]+)\s+()")
_KEY = re.compile(r"\s*[^\s\[\]{},:\"'#]+\s*:(\s|$)")
_ITEM = re.compile(r"\s*-(\s|$)")
_LONGEST_WHOLE = 30
"""Number of lines up to which a block of entries is first tried as a whole."""

_LONGEST_KEPT = 2000
"""Number of characters up to which the value of a block is kept for later readings."""

Entry: TypeAlias = "tuple[str | None, LocatedNode]"
"""Type of an entry of a mapping by its key, or of a list, whose key is None."""


def tolerant_document(text: str, file: str = "") -> LocatedDocument:
    """Data that can be read of a text that may be no sound YAML, with the position of every entry.

    Of sound YAML it is exactly what :func:`~torsionnet.model.files.located_yaml.compose` reads. Otherwise every entry
    is read on its own, by its indentation: a fault in one costs no other. The faults of YAML stand in ``faults``.

    Examples
    --------
    >>> tolerant_document("elements:\\n  motor: {type: inertia, no\\n  shaft: {type: spring}").data
    {'elements': {'motor': {'type': 'inertia', 'no': None}, 'shaft': {'type': 'spring'}}}
    """
    try:
        return compose(text, file)
    except (ModelError, RecursionError, ValueError) as error:
        faults = list(error.faults) if isinstance(error, ModelError) else []
    document = LocatedDocument(file, _BREAK.split(text[:MOST_CHARACTERS]), faults=faults)
    lines = _readable(document.lines)
    reading = _Reading(lines, document)
    entries = list(reading.entries(0, len(lines), 0))
    document.root = reading.joined(entries, (0, 0, len(lines) - 1, len(lines[-1])), ()) if entries else None
    return document


def tolerant_data(text: str) -> Any:
    r"""Data that can be read of a text by its indentation, without places; what was read before is taken from memory.

    Examples
    --------
    >>> tolerant_data("elements:\n  motor: {type: inertia, no")
    {'elements': {'motor': {'type': 'inertia', 'no': None}}}
    """
    document = LocatedDocument("", _BREAK.split(text[:MOST_CHARACTERS]))
    reading = _Reading(_readable(document.lines), document, has_places=False)
    entries = list(reading.entries(0, len(document.lines), 0))
    return reading.joined(entries, (0, 0, 0, 0), ()).value if entries else None


def _readable(lines: list[str]) -> list[str]:
    """Lines with blanks in place of control characters, and nothing in place of marks between documents."""
    lines = [line if line.isprintable() else re.sub(_CONTROL, " ", line) for line in lines]
    return ["" if line.startswith(("---", "...", "%")) else line for line in lines]


@dataclass
class _Reading:
    """Reading by indentation of lines without control characters; blocks are stretches of lines."""

    lines: list[str]
    document: LocatedDocument
    count: int = 0
    has_places: bool = True

    def entries(self, start: int, end: int, depth: int) -> Iterator[Entry]:
        """Entries of the mapping or list that a block holds."""
        for first, last in self.blocks(start, end):
            if self.count < MOST_NODES:
                yield from self.block(first, last, depth)

    def blocks(self, start: int, end: int) -> Iterator[tuple[int, int]]:
        """Blocks of one entry each: its first line and those indented more."""
        first, level = -1, 0
        for index in range(start, end):
            line = self.lines[index]
            bare = line.lstrip()
            if not bare or bare[0] == "#":
                continue
            indent = len(line) - len(bare)
            if first >= 0:
                is_list = indent == level and _ITEM.match(line) and self.lines[first].rstrip().endswith(":")
                if indent > level or bare[0] in "]}" or (is_list and not _ITEM.match(self.lines[first])):
                    continue
                yield first, index
            first = index
            level = indent
        if first >= 0:
            yield first, end

    def block(self, first: int, last: int, depth: int) -> Iterator[Entry]:
        """Entries of one block, read as a whole where that works, else by its parts."""
        if depth >= MOST_LEVELS:
            return
        line = self.lines[first]
        head = _HEAD.match(line)
        has_children = head is not None and head[3] == ":" and not _bare(line[head.end() :]) and last - first > 1
        # Reading a block whole is dear where it fails, so that long blocks with children are parted at once.
        if last - first <= _LONGEST_WHOLE or not has_children:
            end = "\n" if last < len(self.lines) else ""
            whole = self.composed("\n".join(self.lines[first:last]) + end, first, depth)
            if whole is not None:
                yield from self.of(whole)
                return
        if _ITEM.match(line):
            yield from self.item(first, last, depth)
        elif head is not None and not _bare(line[head.end() :]):
            yield self.nested(head, first, last, depth)
        else:
            yield from self.leaf(first, last, depth)

    def composed(self, text: str, line: int, depth: int) -> LocatedNode | None:
        """Value of a text that begins at a line, None where it is no sound YAML."""
        root, dropped, levels = _composed_once(text) if len(text) <= _LONGEST_KEPT else _composed(text)
        if root is None or levels + depth > MOST_LEVELS or self.count + root.size > MOST_NODES:
            return None
        self.count += root.size
        self.document.dropped += dropped
        return copy(root, line) if self.has_places else root

    def of(self, root: LocatedNode) -> Iterator[Entry]:
        """Entries of a value that stands where entries are expected: a word alone is a key without a value."""
        if isinstance(root.value, dict):
            yield from ((str(key), node) for key, node in root.entries.items())
        elif isinstance(root.value, list):
            yield from ((None, node) for node in root.entries.values())
        elif root.value is not None:
            end = (*root.place[2:], *root.place[2:])
            yield str(root.value), LocatedNode(None, end, {}, key_place=root.place)

    def item(self, first: int, last: int, depth: int) -> Iterator[Entry]:
        """Entry of a list, read as if its dash were blank."""
        line = self.lines[first]
        column = line.index("-")
        self.lines[first] = line[:column] + " " + line[column + 1 :]
        entries = list(self.entries(first, last, depth + 1))
        self.lines[first] = line
        if entries:
            yield None, self.joined(entries, (first, column + 2, last - 1, len(self.lines[last - 1])), ())
        else:
            yield None, LocatedNode(None, (first, column + 1, first, column + 1), {})

    def nested(self, head: re.Match[str], first: int, last: int, depth: int) -> Entry:
        """Entry whose value stands in the lines below its key."""
        entries = list(self.entries(first + 1, last, depth + 1))
        key_place = (first, head.start(2), first, head.end(2))
        end = (last - 1, len(self.lines[last - 1]))
        begin = self._begin(first + 1, last) if entries else (first, head.end())
        node = self.joined(entries, (*begin, *(end if entries else begin)), ())
        node = node if entries else LocatedNode(None, node.place, {})
        node.key_place = key_place
        return head[2].strip("\"'"), node

    def _begin(self, first: int, last: int) -> tuple[int, int]:
        for index in range(first, last):
            bare = self.lines[index].lstrip()
            if bare and bare[0] != "#":
                return index, len(self.lines[index]) - len(bare)
        return first, 0

    def leaf(self, first: int, last: int, depth: int) -> Iterator[Entry]:
        """Entry with a value on its line; what is indented more and is no part of the value is read beside it."""
        line = self.lines[first]
        head = _HEAD.match(line) or _WORD_AND_REST.match(line)
        if head is None:
            yield from self.bare_value(first, last, depth)
            return
        rest = "\n".join([line[head.end() :], *self.lines[first + 1 : last]])
        after = [index for index in range(first + 1, last) if _bare(self.lines[index])]
        goes_on = not after or line.rstrip().endswith(("{", "[", ",")) or not _KEY.match(self.lines[after[0]])
        if not goes_on:
            rest = line[head.end() :]
        value, origins = mended(rest)
        root = self.composed(value, 0, depth)
        if root is None:
            place = (first, head.end(), first, len(line.rstrip()))
            root = LocatedNode(line[head.end() :].strip() or None, place, {})
        elif self.has_places:
            _move_to_origins(root, value, origins, rest, (first, head.end()))
        if self.has_places:  # else the value is one that is kept for later readings
            root.key_place = (first, head.start(2), first, head.end(2))
        yield head[2].strip("\"'"), root
        if not goes_on:  # one level deeper, so that a staircase of lines ends
            yield from self.entries(first + 1, last, depth + 1)

    def bare_value(self, first: int, last: int, depth: int) -> Iterator[Entry]:
        """Entries of a flow mapping or list without a key, as in a list or where the whole file is one."""
        rest = "\n".join(self.lines[first:last])
        value, origins = mended(rest)
        root = self.composed(value, 0, depth) if rest.lstrip().startswith(("{", "[")) else None
        if root is not None:
            if self.has_places:
                _move_to_origins(root, value, origins, rest, (first, 0))
            yield from self.of(root)

    def joined(self, listed: list[Entry], place: Place, path: EntryPath) -> LocatedNode:
        """Mapping or list of entries; the first one tells which of the two, and of equal keys the first is kept."""
        self.count += 1
        entries: dict[str | int, LocatedNode] = {}
        is_list = bool(listed) and listed[0][0] is None
        for key, node in listed:
            if is_list and key is None:
                entries[len(entries)] = node
            elif not is_list and key is not None:
                if key in entries:
                    self.document.dropped.append(((*path, key), node.value))
                else:
                    entries[key] = node
        size = 1 + sum(node.size for node in entries.values())
        value = [node.value for node in entries.values()] if is_list else {k: node.value for k, node in entries.items()}
        return LocatedNode(value, place, entries, size)


def _bare(text: str) -> str:
    """Text without blanks, empty where only a comment stands."""
    bare = text.strip()
    return "" if bare.startswith("#") else bare


def _depth(node: LocatedNode) -> int:
    return 1 + max((_depth(entry) for entry in node.entries.values()), default=-1)


def _composed(text: str) -> tuple[LocatedNode | None, list[tuple[EntryPath, Any]], int]:
    """Value of a text, what duplicate keys hide in it, and its levels; no value where it is no sound YAML."""
    try:
        document = compose(text, "")
    except (ModelError, RecursionError, ValueError):
        return None, [], 0
    return document.root, document.dropped, 0 if document.root is None else _depth(document.root)


_composed_once = lru_cache(maxsize=4096)(_composed)


def copy(node: LocatedNode, lines: int) -> LocatedNode:
    """Copy of a value in which all places are some lines further down."""
    line, column, end_line, end_column = node.place
    entries = {key: copy(child, lines) for key, child in node.entries.items()}
    value = node.value
    if isinstance(value, dict):
        value = {key: child.value for key, child in entries.items()}
    elif isinstance(value, list):
        value = [child.value for child in entries.values()]
    key = node.key_place
    moved = None if key is None else (key[0] + lines, key[1], key[2] + lines, key[3])
    return LocatedNode(value, (line + lines, column, end_line + lines, end_column), entries, node.size, moved)


def _nodes(root: LocatedNode) -> Iterator[LocatedNode]:
    yield root
    for entry in root.entries.values():
        yield from _nodes(entry)


def _move_to_origins(root: LocatedNode, text: str, origins: list[int], written: str, start: tuple[int, int]) -> None:
    """Move the places of a value from those in a mended ``text`` to those in the one ``written``, at ``start``."""
    mended_lines, lines = TextLines(text), TextLines(written)

    def moved(line: int, column: int) -> tuple[int, int]:
        offset = mended_lines.starts[line] + column if line < len(mended_lines.starts) else len(text)
        down, right = lines.place(origins[min(offset, len(text))])
        return start[0] + down, right + (0 if down else start[1])

    for node in _nodes(root):
        node.place = (*moved(*node.place[:2]), *moved(*node.place[2:]))
        if node.key_place is not None:
            node.key_place = (*moved(*node.key_place[:2]), *moved(*node.key_place[2:]))
