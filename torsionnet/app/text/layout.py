"""Layout of a model text: the outline of its sections, and its formatting, which keeps comments and digits."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from yaml import tokens

from torsionnet.app.text.hover import entry_under, key_words, thing_words, value_words
from torsionnet.app.text.named_places import SECTION_KINDS, NamedPlace, NamesInText, place_at
from torsionnet.app.text.text_edits import TextEdit, TextLines, TextSpan, edited
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.errors import EntryPath, ModelError
from torsionnet.model.files.located_yaml import LocatedDocument, LocatedNode, compose, fastest_parser

# Outline of a model text for editors: its sections, and what stands in them.


@dataclass(frozen=True)
class OutlineItem:
    """Entry of an outline, with the stretch of the whole entry and that of its name.

    ``kind`` is section, or that of what is named, as element, parameter or node.
    """

    name: str
    kind: str
    detail: str
    span: TextSpan
    name_span: TextSpan
    children: tuple[OutlineItem, ...] = ()


def outline(text: str, file: str = "") -> list[OutlineItem]:
    """Outline of a model text: its sections, what each defines, and below each element its nodes.

    Examples
    --------
    >>> text = "elements:\\n  disc: {type: inertia, node: hub, inertia: 2 kg*m^2}\\n"
    >>> (section,) = outline(text)
    >>> element = section.children[0]
    >>> section.name, element.name, element.detail, [child.name for child in element.children]
    ('elements', 'disc', 'inertia at hub', ['hub'])
    """
    names = NamesInText.of(text, file)
    if names.root is None:
        return []
    return list(_Outline(names).sections(names.root, ()))


class _Outline:
    """Outline of the entries of a document with the names in it."""

    def __init__(self, names: NamesInText) -> None:
        self.names = names
        self.nodes: dict[EntryPath, list[NamedPlace]] = {}
        for place in names.places:
            if place.kind == "node":
                for length in range(2, len(place.path)):
                    self.nodes.setdefault(place.path[:length], []).append(place)

    def sections(self, node: LocatedNode, path: EntryPath) -> Iterator[OutlineItem]:
        """Sections of a model or part."""
        for key, entry in node.entries.items():
            section = str(key)
            kind = "axis" if section == "configurations" else SECTION_KINDS.get(section, "")
            below = [self.thing(entry, (*path, key, name), thing, kind) for name, thing in entry.entries.items()]
            children = tuple(thing for thing in below if thing is not None) if kind else ()
            item = self.item(entry, section, "section", _value_text(entry.value) if not kind else "", children)
            if item is not None:
                yield item

    def thing(self, whole: LocatedNode, path: EntryPath, node: LocatedNode, kind: str) -> OutlineItem | None:
        """Entry of a section by its name, with what is in it."""
        name = str(path[-1])
        if kind == "element":
            places = self.nodes.get(path, [])
            nodes = tuple(OutlineItem(named.name, "node", "", named.span, named.span) for named in places)
            return self.item(node, name, kind, _element_words(node.value, [named.name for named in nodes]), nodes)
        if kind == "part":
            return self.item(node, name, kind, _value_text(node.value), tuple(self.sections(node, path)))
        if kind == "axis":
            return self.axis(whole, node, name)
        return self.item(node, name, kind, _value_text(node.value), ())

    def axis(self, whole: LocatedNode, node: LocatedNode, name: str) -> OutlineItem | None:
        """Axis with its alternatives, or an alternative of the only axis."""
        from torsionnet.model.configurations import has_axes

        if not has_axes(whole.value):
            return self.item(node, name, "configuration", _value_text(node.value), ())
        below = [
            self.item(alternative, str(label), "configuration", _value_text(alternative.value), ())
            for label, alternative in node.entries.items()
        ]
        return self.item(node, name, "axis", "", tuple(alternative for alternative in below if alternative is not None))

    def item(
        self, node: LocatedNode, name: str, kind: str, detail: str, children: tuple[OutlineItem, ...]
    ) -> OutlineItem | None:
        """Entry with its stretches, None for one of a list, which has no name."""
        if node.key_place is None:
            return None
        name_span = self.names.stretches.whole(node.key_place)
        start, end = self.names.stretches.span(node.key_place).start, self.names.stretches.span(node.place).end
        text = self.names.stretches.lines.text
        end = max(len(text[:end].rstrip()), name_span.end, *(child.span.end for child in children), 0)
        return OutlineItem(name, kind, detail, TextSpan(start, end), name_span, children)


def _element_words(raw: Any, nodes: list[str]) -> str:
    """Text on an element: its type and its nodes."""
    kind = str(raw.get("type", "")).replace("_", " ") if isinstance(raw, Mapping) else ""
    where = f"at {nodes[0]}" if len(nodes) == 1 else ", ".join(nodes)
    return f"{kind} {where}".strip()


def _value_text(raw: Any) -> str:
    """Text on the value of an entry: the value itself, that of a parameter, or what a sensor measures."""
    if not isinstance(raw, Mapping):
        return "" if raw is None or isinstance(raw, list) else _short(str(raw))
    if isinstance(raw.get("by"), str):
        return _short(f"by {raw['by'].replace('_', ' ')} of {raw.get('of', '')}")
    for key in ("value", "type", "rule", "part"):
        if isinstance(raw.get(key), str | int | float):
            return _short(str(raw[key]))
    if len(raw) <= 3 and all(isinstance(inner, str | int | float) for inner in raw.values()):
        return _short(", ".join(f"{key} {inner}" for key, inner in raw.items()))
    return ""


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 60 else f"{line[:57]}..."


# Explanation of the word at a place in a model text.


@dataclass(frozen=True)
class Hover:
    """Explanation in Markdown, without HTML, of a stretch of a model text."""

    markdown: str
    span: TextSpan


def hover(text: str, offset: int, file: str = "", folder: Path | None = None) -> Hover | None:
    """Explanation of what stands at an offset of a model text, None where there is nothing to say.

    Of a name what it stands for, of a key what the entry is, of a value what it is in SI units. Catalogues lie in
    ``folder``.

    Examples
    --------
    >>> text = "parameters: {k: 2 kN*m/rad}\\nelements: {shaft: {type: spring, nodes: [a, b], stiffness: 3*k}}"
    >>> print(hover(text, text.index("3*k")).markdown)
    `stiffness`: `3*k` = 6000 N*m/rad
    <BLANKLINE>
    with `k` = 2000 N*m/rad
    """
    names = NamesInText.of(text, file)
    place = place_at(names.places, offset)
    # What a name stands for says more than the entry in which it stands.
    if place is not None:
        words = thing_words(place, names)
        if words:
            return Hover(words, place.span)
    under = entry_under(names, offset)
    if under is None:
        return None
    with files_beside(folder):
        words = key_words(under) if under.on_key else value_words(under)
    return Hover(words, under.span) if words else None


# Layout of a model text: indentation, blanks and line ends, while comments, quotes, digits and order stay.

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
