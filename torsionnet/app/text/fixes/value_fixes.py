"""Quick fixes of values and names: units, decimal commas, forms of numbers, misspelt words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from torsionnet.app.text.text_edits import TextEdit, TextFix, TextSpan, WrittenText, edited
from torsionnet.base.entries.composite import Named
from torsionnet.base.entries.spec import Json, Spec
from torsionnet.base.errors import (
    BRACKET,
    IN_UNIT,
    QUOTE,
    WRITE,
    EntryPath,
    Fault,
    ModelError,
    Remedy,
)
from torsionnet.base.units import expected_unit
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element import ELEMENT_TYPES
from torsionnet.model.element_base.element_entries import NodeName, NodePair, Teeth
from torsionnet.model.files.fault_places import entry_at
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.files.value_editing import node_at

# Faults of a model text with their places, as the rules of quick fixes look at them.

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
"""Expression of a decimal number."""


@dataclass(frozen=True)
class FaultPlace:
    """Fault of a model text with its stretch, as the rules of fixes look at it."""

    fault: Fault
    span: TextSpan
    written: WrittenText
    others: Sequence[Fault] = ()

    @property
    def shown(self) -> str:
        """Text that the fault marks."""
        return self.written.text[self.span.start : self.span.end]

    def remedy(self, how: str) -> Remedy | None:
        """Remedy of the fault if it is of that kind, else None."""
        remedy = self.fault.remedy
        return remedy if remedy is not None and remedy.how == how else None

    @cached_property
    def value_span(self) -> TextSpan | None:
        """Stretch of the value at the path of the fault, None where there is none."""
        node = node_at(self.written.document, self.fault.path)
        return self.written.value_span(node) if node is not None and self.fault.path else None

    @property
    def element_type(self) -> object:
        """Value of the entry ``type`` beside the one of the fault, None where there is none."""
        return getattr(node_at(self.written.document, (*self.fault.path[:-1], "type")), "value", None)

    @property
    def is_empty(self) -> bool:
        """Whether the fault is that the entry at its path has no value."""
        node = node_at(self.written.document, self.fault.path)
        return node is not None and node.value is None and not self.fault.on_key and self.fault.kind != "repeated-name"

    @cached_property
    def read_again(self) -> tuple[TextSpan, str]:
        """Stretch of the text that is read again to try a fix, and the heading that it needs.

        An entry of a section where it has lines of its own, else the whole text.
        """
        written, path = self.written, self.fault.path
        whole = TextSpan(0, len(written.text)), ""
        node = node_at(written.document, path[:2]) if len(path) > 1 and not written.is_json else None
        if node is None or node.key_place is None or written.is_flow(written.node(path[:1])):
            return whole
        line, column = written.lines.place(written.key_start(node))
        if written.line(line)[:column].strip():
            return whole
        return TextSpan(written.lines.starts[line], written.line_end(written.last_line(node))), f"{path[0]}:\n"

    def fix(self, title: str, *edits: TextEdit) -> Iterator[TextFix]:
        """Fix by some edits, if reading the changed entry finds nothing new."""
        if edits and self._mends(edits):
            yield TextFix(title, edits)

    def written_as(self, span: TextSpan, new: str) -> Iterator[TextFix]:
        """Fix that writes another value, in the quotes of the one there."""
        old = self.written.text[span.start : span.end]
        if old[:1] in ("'", '"') and old[:1] == old[-1:] and not new.startswith(old[0]):
            new = f"{old[0]}{new}{old[0]}"
        elif self.written.is_json and not NUMBER.fullmatch(new) and new not in ("true", "false"):
            new = self.written.written(new)
        yield from self.fix(f"write {new}", TextEdit(span, new))

    def without(self, *paths: tuple[str | int, ...]) -> Iterator[TextFix]:
        """Fixes that delete entries, one for each path."""
        for path in paths:
            if node_at(self.written.document, path) is not None and path:
                yield from self.fix(f'delete "{path[-1]}"', *self.written.removal(path))

    def with_value(self, key: str, *edits: TextEdit) -> Iterator[TextFix]:
        """First fix that gives the entry at the path, named ``key`` after edits, an example of its value."""
        for value in example_values(self.written.document, self.fault.path[:-1], key):
            edit = self.written.replacement(self.fault.path, value)
            fixes = list(self.fix(f"write {self.written.entry_text(key, value)}", *edits, edit))
            if fixes:
                yield from fixes
                return

    def _mends(self, edits: tuple[TextEdit, ...]) -> bool:
        part, _ = self.read_again
        alone = all(part.start <= edit.span.start and edit.span.end <= part.end for edit in edits)
        before = self._faults_alone if alone else self._faults_read
        try:
            after = self._faults_after(edits, alone=alone)
        except (ModelError, ValueError):
            return False
        return after <= before and (after < before or _bare(self.fault) not in before)

    def _faults_after(self, edits: Iterable[TextEdit], *, alone: bool) -> set[Fault]:
        """Faults in reading the section of the fault after edits, or its stretch alone."""
        text, heading = self.written.text, ""
        if alone:
            part, heading = self.read_again
            text = text[part.start : part.end]
            spans = (TextSpan(edit.span.start - part.start, edit.span.end - part.start) for edit in edits)
            edits = [TextEdit(span, edit.text) for span, edit in zip(spans, edits, strict=True)]
        text = heading + edited(text, edits).removeprefix("\ufeff")
        return section_faults(compose(text, self.written.document.file), self.fault)

    @cached_property
    def _faults_read(self) -> set[Fault]:
        return section_faults(self.written.document, self.fault)

    @cached_property
    def _faults_alone(self) -> set[Fault]:
        return self._faults_after((), alone=True)


def section_faults(document: LocatedDocument, fault: Fault) -> set[Fault]:
    """Faults, without their places, in reading the section of a fault, or the one entry of it that it is about."""
    data = document.data
    section = fault.path[0] if fault.path else ""
    specs = dict(Definition.specs())
    faults = {_bare(other) for other in document.faults}
    if isinstance(data, dict) and (section not in specs or section not in data):
        return faults | {_bare(other) for other in Definition.key_faults(data)}
    if not isinstance(data, dict):
        return faults
    raw, spec = data[section], specs[str(section)]
    if isinstance(spec, Named) and isinstance(raw, dict) and len(fault.path) > 1:
        name = fault.path[1]
        raw = {name: raw[name]} if name in raw else {}
        if not raw:
            return faults
    return faults | {_bare(other) for other in spec.read(raw)[1]}


def _bare(fault: Fault) -> Fault:
    """Fault without its place, which an edit before it moves."""
    return replace(fault, path=(), position=None)


def word_edits(word: str, text: str, start: int, new: str) -> Iterator[TextEdit]:
    """Edits that replace a word where it stands alone."""
    for place in re.finditer(rf"(?<![\w.]){re.escape(word)}(?![\w])", text):
        yield TextEdit(TextSpan(start + place.start(), start + place.end()), new)


# Examples of values for entries that a model lacks.

_FIRST_ELEMENT: dict[str, Json] = {"type": "inertia", "node": "disc", "inertia": "1 kg*m^2"}


def example_values(document: LocatedDocument, path: EntryPath, key: str) -> Iterator[Json]:
    """Values that the entry ``key`` of the table at ``path`` may have, the likeliest first.

    Nodes are those that the model has; a reader has to find out whether a value fits.
    """
    if key == "elements" and len(path) <= 1:
        yield {"disc": _FIRST_ELEMENT}
        return
    if len(path) < 2 or path[-2] not in ("elements", "parameters"):
        return
    if path[-2] == "parameters":
        yield 1
        return
    entries = entry_at(document.data, path)
    kind = entries.get("type") if isinstance(entries, Mapping) else None
    spec = dict(ELEMENT_TYPES[kind].specs()).get(key) if isinstance(kind, str) and kind in ELEMENT_TYPES else None
    if spec is None:
        return
    own = set(_texts(entries))
    nodes = list(dict.fromkeys(_nodes(entry_at(document.data, path[:-1]))))
    yield from _values(spec, [*(node for node in nodes if node not in own), "a", "b"])


def _values(spec: Spec[object], nodes: list[str]) -> Iterator[Json]:
    if isinstance(spec, NodePair):
        yield nodes[:2]
    elif isinstance(spec, NodeName):
        yield from nodes
    elif isinstance(spec, Teeth):
        yield [20, 40]
    dimension = getattr(spec, "dimension", None)
    if isinstance(dimension, str):
        unit = "" if dimension == "1" else expected_unit(dimension)
        for number in ("1", "0.1", "10"):
            yield f"{number} {unit}" if unit else float(number) if "." in number else int(number)
    words = getattr(spec, "options", None)
    if isinstance(words, tuple):
        yield from words


def _nodes(elements: Any) -> Iterator[str]:
    """Nodes that the elements name by ``node`` and ``nodes``."""
    for entries in elements.values() if isinstance(elements, Mapping) else ():
        if isinstance(entries, Mapping):
            named = [entries.get("node"), *(entries["nodes"] if isinstance(entries.get("nodes"), list) else [])]
            yield from (name for name in named if isinstance(name, str) and name != "ground")


def _texts(value: Any) -> Iterator[str]:
    inner = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    if isinstance(value, str):
        yield value
    for inner_value in inner:
        yield from _texts(inner_value)


# Quick fixes of values: units, decimal commas, forms of numbers and words.


def number_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another number where that was probably meant."""
    meant = place.fault.meant
    if NUMBER.match(meant) and NUMBER.match(place.shown.strip("'\"")):
        yield from place.written_as(place.span, meant)


def sign_of_product(place: FaultPlace) -> Iterator[TextFix]:
    """A sign of multiplication before a parameter that was read as a unit."""
    if place.fault.kind != "unknown-unit" or place.value_span is None:
        return
    name, text = place.fault.about, place.written.text[place.value_span.start : place.value_span.end]
    known = node_at(place.written.document, ("parameters",))
    factor = re.search(rf"(\d)\s+{re.escape(name)}(?!\w)", text)
    if factor and known is not None and name in known.entries:
        start = place.value_span.start + factor.end(1)
        yield from place.fix(
            f"write {factor[1]}*{name}", TextEdit(TextSpan(start, start + factor.end() - factor.end(1)), f"*{name}")
        )


def point_for_comma(place: FaultPlace) -> Iterator[TextFix]:
    """A decimal point, also where a comma in brackets split the number; or no comma, where it may part thousands."""
    if place.fault.kind not in ("decimal-comma", "ambiguous-number") or place.remedy(WRITE) is not None:
        return
    parts = {".": "write a decimal point"} | (
        {"": "leave the comma out"} if place.fault.kind == "ambiguous-number" else {}
    )
    start, text = place.span.start, place.written.text
    comma_match = re.search(r"(\d),(\d)", place.shown)
    # In brackets the comma has split the number: the fault is at its second part.
    before = re.search(r"\d(\s*,\s*)$", text[:start])
    comma = start + comma_match.end(1) if comma_match else 0
    span = TextSpan(comma, comma + 1) if comma_match else TextSpan(before.start(1), start) if before else None
    for sign, title in parts.items():
        if span is not None:
            yield from place.fix(title, TextEdit(span, sign))


def as_said(place: FaultPlace) -> Iterator[TextFix]:
    """Fix that writes what the remedy says, for the whole value or a part of it."""
    remedy = place.remedy(WRITE)
    if remedy is None:
        return
    start = place.written.text.find(remedy.old, place.span.start, place.span.end)
    if not remedy.old:
        yield from place.fix(f"write {remedy.new}", TextEdit(place.span, remedy.new))
    elif remedy.old == place.shown.strip("'\""):
        yield from place.written_as(place.span, remedy.new)
    elif start >= 0:
        span = TextSpan(start, start + len(remedy.old))
        yield from place.fix(f"write {remedy.new}", TextEdit(span, remedy.new))


def without_zeros(place: FaultPlace) -> Iterator[TextFix]:
    if place.fault.kind == "ambiguous-number":
        zeros = re.match(r"(['\"]?[-+]?)(0+)(?=\d)", place.shown)
        if zeros:
            start = place.span.start
            span = TextSpan(start + zeros.start(2), start + zeros.end(2))
            yield from place.fix("leave the 0 out", TextEdit(span, ""))


def expected_unit_written(place: FaultPlace) -> Iterator[TextFix]:
    """The unit that the remedy expects, with the number as it is."""
    remedy, shown = place.remedy(IN_UNIT), place.shown.strip("'\"")
    number = NUMBER.match(shown)
    if remedy is None or number is None or shown != remedy.old:
        return
    symbol = re.match(r"[A-Za-z]+", remedy.new)
    prefix = re.match(rf"[kMGmµ](?={symbol[0]}(?![a-z]))", shown[number.end() :].strip()) if symbol else None
    # The expected unit alone would be smaller or larger by a power of ten.
    yield from place.written_as(place.span, f"{number[0]} {prefix[0] if prefix else ''}{remedy.new}")


def other_form(place: FaultPlace) -> Iterator[TextFix]:
    """Quotes around a value that is to be text, brackets around one that is to be a list."""
    shown, span = place.shown, place.span
    if place.value_span != span:
        return
    if place.remedy(QUOTE) and shown and '"' not in shown:
        yield from place.fix("put it in quotes", TextEdit(span, f'"{shown}"'))
    if place.remedy(BRACKET):
        yield from place.fix("make it a list", TextEdit(span, f"[{shown}]"))


def value_missing(place: FaultPlace) -> Iterator[TextFix]:
    """An example of a value that is missing behind its name."""
    path = place.fault.path
    if len(path) < 2 or not place.is_empty:
        return
    parent, key = (path, "value") if path[-2] == "parameters" else (path[:-1], str(path[-1]))
    for value in example_values(place.written.document, parent, key):
        fixes = list(place.fix(f"write {place.written.written(value)}", place.written.replacement(path, value)))
        if fixes:
            yield from fixes
            return


# Quick fixes of names: misspelt ones, ones that are no names, texts that a comma split.

_FRAGMENT_OF_TEXT = ("description", "source", "name")


def name_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another word where that was probably meant."""
    fault, text, meant = place.fault, place.written.text, place.fault.meant
    if not meant or not fault.about or NUMBER.match(meant):
        return
    if fault.path == ("parameters", meant):  # it would define itself
        return
    if fault.kind == "unconnected-nodes":
        rare, right = sorted((fault.about, meant), key=lambda word: len(list(word_edits(word, text, 0, ""))))
        yield from place.fix(f'write "{right}"', *word_edits(rare, text, 0, right))
        return
    siblings = node_at(place.written.document, fault.path[:-1])
    if fault.on_key and siblings is not None and meant in siblings.entries and fault.kind == "unknown-entry":
        yield from place.without(fault.path)
        return
    for span in (place.span, *([place.value_span] if place.value_span else [])):
        edits = tuple(word_edits(fault.about, text[span.start : span.end], span.start, meant))
        if edits and fault.about != meant:
            yield from place.fix(f'write "{meant}"', *edits)
            break
    node = node_at(place.written.document, fault.path)
    if fault.kind == "unknown-entry" and node is not None and node.value is None:
        yield from place.with_value(meant, *edits)


def valid_name(place: FaultPlace) -> Iterator[TextFix]:
    """A name of letters, digits and _ in all places that have it."""
    name = place.fault.about
    if place.fault.kind != "invalid-name" or '"' in name:
        return
    split = re.fullmatch(r"(\w+)(\s*:?\s*)([{\[]\w*)", name)
    if split:  # a colon, or the blank behind it, is missing before the bracket
        start = place.span.start + place.shown.find(name) + split.end(1)
        blank = split[2].rpartition(":")[2] or " "
        yield from place.fix(f'write "{split[1]}: "', TextEdit(TextSpan(start, start + len(split[2])), f":{blank}"))
        return
    new = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_")
    if not re.match("[A-Za-z]", new) or re.search(rf"(?<!\w){re.escape(new)}(?!\w)", place.written.text):
        return
    edits = tuple(word_edits(name, place.written.text, 0, new))
    if len(edits) > 1 or place.fault.on_key:  # a node that is named once is rather one of the others, misspelt
        yield from place.fix(f"write {new}", *edits)


def text_with_comma(place: FaultPlace) -> Iterator[TextFix]:
    """Quotes around a text whose comma split it."""
    fault, written = place.fault, place.written
    node = node_at(written.document, fault.path)
    if fault.kind != "unknown-entry" or node is None or node.value is not None:
        return
    siblings = written.node(fault.path[:-1]).entries
    keys = list(siblings)
    before = keys[keys.index(fault.path[-1]) - 1]
    if before in _FRAGMENT_OF_TEXT and isinstance(siblings[before].value, str):
        span = TextSpan(written.start(siblings[before]), place.span.end)
        text = written.text[span.start : span.end]
        if '"' not in text and "\\" not in text:
            yield from place.fix("put the text in quotes", TextEdit(span, f'"{text}"'))
