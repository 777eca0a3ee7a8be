"""YAML parser that gives plain data in which the position of every entry is known.

A composer of its own over PyYAML's events: it needs no constructor, reads scalars by the core rules of YAML 1.2
(``no`` and ``3:1`` stay text), keeps the digits of numbers, refuses duplicate keys and tags, and bounds what a file may
ask for.

Here as well: messages about faults of YAML syntax, in the words of someone who edits a model file; values of plain
(unquoted) YAML scalars by the core rules of YAML 1.2.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import yaml
from yaml.events import AliasEvent, MappingEndEvent, ScalarEvent, SequenceEndEvent, SequenceStartEvent, StreamEndEvent

from torsionnet.base.errors import CLOSE, EntryPath, Fault, ModelError, Position, Remedy, fault_of

_MEANINGS = (
    (
        "mapping values are not allowed",
        "stray-colon",
        'a ":" is not expected here; check the indentation, and put text that holds ": " in quotes',
    ),
    (r"expected ',' or '}'", "open-bracket", 'a "," between two entries or the closing "}" is missing{since}'),
    (r"expected ',' or '\]'", "open-bracket", 'a "," between two values or the closing "]" is missing{since}'),
    ("unexpected end of stream", "open-quote", "a quote is opened here and never closed"),
    ("unexpected document separator", "open-quote", "a quote is opened here and never closed"),
    ("could not find expected ':'", "missing-colon", 'a ":" is missing after this name'),
    (
        "expected (key|<block end>|'-' indicator)",
        "wrong-indentation",
        "this does not fit the indentation of the lines above",
    ),
    (
        "expected '?<document start",
        "wrong-indentation",
        "this stands outside of the model; check the indentation of the lines above",
    ),
    (
        "(unknown escape|escape sequence|hexdecimal)",
        "unknown-escape",
        'a backslash in double quotes begins an escape; use single quotes or write "\\\\"',
    ),
    ("(undefined tag handle|tag|directive)", "missing-quotes", 'words that begin with "!" or "%" need quotes'),
    ("(anchor|alias)", "missing-quotes", 'text that begins with "&" or "*" needs quotes'),
    (
        "block (sequence|mapping) entries are not allowed|block sequence entries",
        "stray-item",
        'a list item ("- ") is not expected here',
    ),
    ("node content", "missing-value", "a value is missing or is not closed here"),
    ("unexpected ':'", "stray-colon", 'a ":" is not expected here; put text that holds ":" in quotes'),
    ("indentation", "wrong-indentation", "this does not fit the indentation of the lines above"),
)
"""Kind of the break and message to the user by regular expression of the problem that PyYAML reports."""


_UNSEPARATED = re.compile(r"(\s*)(\w+)(\s*|:)[{\[]")


_VALUELESS = re.compile(r"([A-Za-z_]\w*):[,}\]]$")
"""An entry of a flow mapping that ends behind its colon, where YAML looks for a longer name."""


def explain(error: yaml.MarkedYAMLError, lines: Sequence[str]) -> tuple[Fault, tuple[int, int]]:
    """Fault of YAML syntax, and its line and column, from 0."""
    problem = error.problem or "this is no YAML"
    mark = _line_and_column(error.problem_mark or error.context_mark, lines)
    character = lines[mark[0]][mark[1] : mark[1] + 1] if mark[0] < len(lines) else ""
    if "cannot start any token" in problem:
        return _no_start(character), mark
    remedy, since = None, ""
    kind, meaning = _meaning(problem)
    unseparated = _UNSEPARATED.match(lines[mark[0]]) if kind == "stray-colon" else None
    if unseparated:
        text = f'write "{unseparated[2]}: " with a colon and a blank after the name'
        return Fault(text, kind="missing-colon"), (mark[0], unseparated.start(2))
    if "unexpected ':'" in problem and (bare := _VALUELESS.search(lines[mark[0]][: mark[1] + 2])):
        return Fault(f'"{bare[1]}" has no value; write it behind "{bare[1]}: "', kind="missing-value"), mark
    if error.context_mark is not None:
        opened = _line_and_column(error.context_mark, lines)
        since = f"; it began at line {opened[0] + 1}, column {opened[1] + 1}"
        if "end of stream" in problem or "document separator" in problem:
            mark = opened
        elif kind == "open-bracket" and opened[0] < mark[0] and _is_whole(lines[opened[0]]):
            text = f'the "{lines[opened[0]][opened[1]]}" opened here is not closed, or a comma is missing after it'
            return Fault(text, kind="open-bracket"), opened
        remedy = Remedy(CLOSE, place=opened) if kind == "open-bracket" else None
    return Fault(meaning.replace("{since}", since), kind=kind, remedy=remedy), mark


def _meaning(problem: str) -> tuple[str, str]:
    """Kind of the break that PyYAML calls a problem, and the message on it."""
    known = ((kind, meaning) for pattern, kind, meaning in _MEANINGS if re.search(pattern, problem))
    return next(known, ("unreadable-file", f"this cannot be read as YAML: {problem}"))


def _is_whole(line: str) -> bool:
    """Whether entries follow the opening bracket on its line, so that its end was meant to be there too."""
    return not line.rstrip().endswith(("{", "[", ","))


def _no_start(character: str) -> Fault:
    if character == "\t":
        return Fault("a tab stands here; YAML is indented with spaces", kind="wrong-indentation")
    return Fault(f'a value cannot begin with "{character}"; put it in quotes', kind="missing-quotes")


def _line_and_column(mark: yaml.Mark | None, lines: Sequence[str]) -> tuple[int, int]:
    """Line and column, from 0, of a place that the YAML parser names.

    The end of the file is the end of the last line that is not empty.
    """
    if mark is None:
        return 0, 0
    line, column = mark.line, mark.column
    if line < len(lines) and (lines[line][column:].strip() or column):
        return line, column
    line = min(line, len(lines) - 1)
    while line > 0 and not lines[line].strip():
        line -= 1
    if line == mark.line:
        return line, column
    return line, max(len(lines[line].rstrip()) - 1, 0)


Plain = None | bool | int | float | str

_WORDS: dict[str, Plain] = {"": None, "~": None}
_WORDS |= dict.fromkeys(("null", "Null", "NULL"))
_WORDS |= dict.fromkeys(("true", "True", "TRUE"), True) | dict.fromkeys(("false", "False", "FALSE"), False)

# The numbers YAML has and a drivetrain has not: as words they are refused wherever a value is read.
_WORDS |= {f"{sign}.{form}": f"{sign}inf" for sign in ("", "+", "-") for form in ("inf", "Inf", "INF")}
_WORDS |= dict.fromkeys((".nan", ".NaN", ".NAN"), "nan")

_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]{0,17})")
_DECIMAL = re.compile(r"[-+]?((0|[1-9][0-9]*)(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]{1,3})?")
_LONGEST_DECIMAL = 40
"""Length in characters of the longest text read as a decimal number, as floats have 17 digits; longer ones stay
text."""


@lru_cache(maxsize=4096)
def plain_value(text: str) -> Plain:
    """Value of an unquoted scalar of YAML, a number, text, true, false or nothing.

    A number that no float holds exactly as written stays text.

    >>> [plain_value(text) for text in ("1", "0.1", "1e3", "no", "3:1", "017", "true", "0.1234567890123456789")]
    [1, 0.1, 1000.0, 'no', '3:1', '017', True, '0.1234567890123456789']
    """
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if len(text) <= _LONGEST_DECIMAL and _DECIMAL.fullmatch(text):
        value = float(text)
        if math.isfinite(value) and Fraction(repr(value)) == Fraction(text):
            return value
    return text


MOST_CHARACTERS = 4_000_000
"""Largest number of characters of a file, as a longer one is no model and would only fill the memory."""
MOST_NODES = 200_000
"""Largest number of entries of a file with its aliases, as nested aliases could multiply a small file without bound."""
MOST_LEVELS = 20
"""Deepest nesting of entries in a file, to which the recursion of its reading is bounded."""
LONGEST_EXCERPT = 400
"""Length in characters of the longest line that a message quotes, as a longer one would hide the message."""

_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_ASCII_CONTROL = "[^\t\n\r\x20-\x7e]"
_CONTROL = "[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]"


class PythonParser(yaml.reader.Reader, yaml.scanner.Scanner, yaml.parser.Parser):
    """Source of YAML events in plain Python, where PyYAML comes without its C library."""

    def __init__(self, text: str) -> None:
        yaml.reader.Reader.__init__(self, text)
        yaml.scanner.Scanner.__init__(self)
        yaml.parser.Parser.__init__(self)


def fastest_parser() -> Any:
    """Class of a source of YAML events, in C where there is one."""
    try:
        from yaml.cyaml import CParser  # type: ignore[attr-defined]
    except ImportError:
        return PythonParser
    return CParser


class Span(NamedTuple):
    """Stretch of text by lines and columns from 0, the end not included."""

    line: int
    column: int
    end_line: int
    end_column: int


Place: TypeAlias = tuple[int, int, int, int]
"""Type of a stretch of text as a plain tuple with the fields of a :class:`Span`."""
_NOTHING: Mapping[str | int, LocatedNode] = MappingProxyType({})


@dataclass(slots=True)
class LocatedNode:
    """Value in a file with its position and that of its key; ``size`` counts the values in it, aliases followed.

    ``home`` is set where it comes from another document than what it stands in.
    Places are those of a :class:`Span` in a plain tuple, which Python's collector of cycles can forget about.
    """

    value: Any
    place: Place
    entries: Mapping[str | int, LocatedNode]
    size: int = 1
    key_place: Place | None = None
    home: LocatedDocument | None = None

    @property
    def span(self) -> Span:
        """Position of the value in the file."""
        return Span(*self.place)

    @property
    def key(self) -> Span | None:
        """Position of the value's key in the file, None for an entry of a list."""
        return Span(*self.key_place) if self.key_place else None


@dataclass
class LocatedDocument:
    """Data of a YAML file with the position of each entry.

    ``dropped`` holds values that a duplicate key made unreadable: what they name is not in ``data``.
    """

    file: str
    lines: list[str]
    root: LocatedNode | None = None
    faults: list[Fault] = field(default_factory=list)
    dropped: list[tuple[EntryPath, Any]] = field(default_factory=list)

    @property
    def data(self) -> Any:
        """Plain data of the whole file, None where the file is empty."""
        return None if self.root is None else self.root.value

    def position(self, path: EntryPath = (), *, on_key: bool = False) -> Position:
        """Position in the file of an entry, or of the nearest entry above it that exists.

        Of a value that fills several lines the key is shown.
        """
        node, depth, home = self.root, 0, self
        while node is not None and depth < len(path) and path[depth] in node.entries:
            node, depth = node.entries[path[depth]], depth + 1
            home = node.home or home
        if node is None:
            return self.place(Span(0, 0, 0, 1))
        show_key = on_key or depth < len(path) or node.span.end_line > node.span.line
        return home.place(node.key if show_key and node.key else node.span)

    def place(self, span: Span) -> Position:
        """Position in the file, with line and columns from 1, of a span that counts from 0.

        Of several lines the first.
        """
        source = self.lines[span.line] if span.line < len(self.lines) else ""
        end = span.end_column if span.end_line == span.line else len(source.rstrip())
        shown = "" if len(source) > LONGEST_EXCERPT else "".join(char if char.isprintable() else " " for char in source)
        return Position(self.file, span.line + 1, span.column + 1, max(end, span.column + 1) + 1, shown.rstrip())

    def fault(self, what: str | Fault, span: Span, *, kind: str = "") -> Fault:
        """Fault, or a fault with that message, at a span of the file."""
        return fault_of(what, kind).at(self.place(span))


def compose(text: str, file: str, parser: Any = None) -> LocatedDocument:
    """Data of the single document in ``text``, with the position of every entry.

    Raises ModelError for a fault that makes the rest unreadable.
    """
    document = LocatedDocument(file, _BREAK.split(text[:MOST_CHARACTERS]))
    if len(text) > MOST_CHARACTERS:
        raise ModelError(
            [
                document.fault(
                    f"the file is too large: more than {MOST_CHARACTERS} characters", Span(0, 0, 0, 1), kind="too-large"
                )
            ]
        )
    control = re.search(_ASCII_CONTROL if text.isascii() else _CONTROL, text)
    if control:
        line = len(_BREAK.findall(text, 0, control.start()))
        column = control.start() - max((end.end() for end in _BREAK.finditer(text, 0, control.start())), default=0)
        what = f"a character that text cannot hold (U+{ord(control[0]):04X}); delete it"
        raise ModelError([document.fault(Fault(what, kind="invalid-character"), Span(line, column, line, column + 1))])
    try:
        composer = _Composer((parser or fastest_parser())(text), document)
        composer.events.get_event()  # the stream begins
        if type(composer.events.get_event()) is not StreamEndEvent:
            document.root = composer.node(composer.events.get_event(), (), 0)
            composer.events.get_event()  # the document ends
            more = composer.events.get_event()
            if type(more) is not StreamEndEvent:
                what = "a second document begins here (---); a file holds one model"
                raise composer.refusal(what, _span(more), kind="wrong-indentation")
    except yaml.MarkedYAMLError as error:
        fault, mark = explain(error, document.lines)
        raise ModelError([document.fault(fault, Span(mark[0], mark[1], mark[0], mark[1] + 1))]) from None
    return document


@dataclass
class _Composer:
    """Composer that makes values with positions from YAML events, recursive as deep as the data are nested."""

    events: Any
    result: LocatedDocument
    anchors: dict[str, LocatedNode] = field(default_factory=dict)
    count: int = 0
    """Number of values made so far, those that aliases stand for included."""

    def refusal(self, what: str | Fault, span: Span, *, kind: str = "") -> ModelError:
        return ModelError([*self.result.faults, self.result.fault(what, span, kind=kind)])

    def node(self, event: Any, path: EntryPath, depth: int) -> LocatedNode:
        if depth > MOST_LEVELS:
            raise self.refusal(
                f"entries are nested more than {MOST_LEVELS} levels deep", _span(event), kind="too-large"
            )
        kind = type(event)
        if kind is AliasEvent:
            node = self.alias(event)
            self.count += node.size  # all that it stands for
        else:
            if event.tag is not None and not (event.tag == "!" and kind is ScalarEvent):
                raise self.refusal(_no_tag(event.tag), _span(event))
            if kind is ScalarEvent:
                value = plain_value(event.value) if event.implicit[0] else event.value
                node = LocatedNode(value, _place(event, event), _NOTHING)
            elif kind is SequenceStartEvent:
                items: dict[str | int, LocatedNode] = {}
                while type(inner := self.events.get_event()) is not SequenceEndEvent:
                    items[len(items)] = self.node(inner, (*path, len(items)), depth + 1)
                size = 1 + sum(item.size for item in items.values())
                node = LocatedNode([item.value for item in items.values()], _place(event, inner), items, size)
            else:
                node = self.mapping(event, path, depth)
            if event.anchor:
                self.anchors[event.anchor] = node
            self.count += 1  # what is in it was counted within
        if self.count > MOST_NODES:
            raise self.refusal(
                f"the file holds more than {MOST_NODES} entries, aliases (*) followed", _span(event), kind="too-large"
            )
        return node

    def alias(self, event: Any) -> LocatedNode:
        if event.anchor not in self.anchors:
            text = f'no anchor "&{event.anchor}" stands before this alias; text that begins with * needs quotes'
            raise self.refusal(Fault(text, kind="missing-quotes"), _span(event))
        return replace(self.anchors[event.anchor], place=_place(event, event), key_place=None)

    def mapping(self, event: Any, path: EntryPath, depth: int) -> LocatedNode:
        entries: dict[str | int, LocatedNode] = {}
        size = 1
        while type(inner := self.events.get_event()) is not MappingEndEvent:
            if type(inner) is not ScalarEvent:
                raise self.refusal(
                    "a name is expected before the colon, not a list, mapping or alias", _span(inner), kind="wrong-form"
                )
            key, place = inner.value, _place(inner, inner)
            if key == "<<" and inner.implicit[0]:
                raise self.refusal(
                    "merging with << is not supported; write the entries out", _span(inner), kind="missing-quotes"
                )
            if inner.tag is not None:
                raise self.refusal(_no_tag(inner.tag), _span(inner))
            entry = self.node(self.events.get_event(), (*path, key), depth + 1)
            size += entry.size
            entry.key_place = place
            if key in entries:
                self.duplicate(entries[key], entry, (*path, key))
            else:
                entries[key] = entry
        values = {key: entry.value for key, entry in entries.items()}
        return LocatedNode(values, _place(event, inner), entries, size)

    def duplicate(self, first: LocatedNode, second: LocatedNode, path: EntryPath) -> None:
        """Report a key that occurs twice in a file, with both positions; the first entry is kept."""
        assert first.key is not None
        assert second.key is not None
        where = f"line {first.key.line + 1}, column {first.key.column + 1}"
        text = f'"{path[-1]}" was already given at {where}; each name stands once'
        self.result.faults.append(self.result.fault(Fault(text, path, kind="repeated-name"), second.key))
        self.result.dropped.append((path, second.value))


def _place(first: Any, last: Any) -> Place:
    """Stretch of text from the beginning of one event to the end of another."""
    start, end = first.start_mark, last.end_mark
    return start.line, start.column, end.line, end.column


def _span(event: Any) -> Span:
    return Span(*_place(event, event))


def _no_tag(tag: str) -> Fault:
    shown = tag.replace("tag:yaml.org,2002:", "!!")
    return Fault(f'tags such as "{shown}" have no meaning in a model file; delete it', kind="missing-quotes")
