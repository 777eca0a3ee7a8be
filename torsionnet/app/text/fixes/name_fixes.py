"""Quick fixes of names: misspelt ones, ones that are no names, texts that a comma split."""

from __future__ import annotations

import re
from collections.abc import Iterator

from torsionnet.app.text.fixes.fault_place import NUMBER, FaultPlace, word_edits
from torsionnet.app.text.text_edits import TextEdit, TextFix, TextSpan
from torsionnet.base.errors import INVALID_NAME, UNCONNECTED, UNKNOWN_KEY
from torsionnet.model.files.value_editing import node_at

_FRAGMENT_OF_TEXT = ("description", "source", "name")


def name_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another word where that was probably meant."""
    fault, text, meant = place.fault, place.written.text, place.fault.meant
    if not meant or not fault.about or NUMBER.match(meant):
        return
    if fault.path == ("parameters", meant):  # it would define itself
        return
    if fault.kind == UNCONNECTED:
        rare, right = sorted((fault.about, meant), key=lambda word: len(list(word_edits(word, text, 0, ""))))
        yield from place.fix(f'write "{right}"', *word_edits(rare, text, 0, right))
        return
    siblings = node_at(place.written.document, fault.path[:-1])
    if fault.on_key and siblings is not None and meant in siblings.entries and fault.kind == UNKNOWN_KEY:
        yield from place.without(fault.path)
        return
    for span in (place.span, *([place.value_span] if place.value_span else [])):
        edits = tuple(word_edits(fault.about, text[span.start : span.end], span.start, meant))
        if edits and fault.about != meant:
            yield from place.fix(f'write "{meant}"', *edits)
            return


def valid_name(place: FaultPlace) -> Iterator[TextFix]:
    """A name of letters, digits and _ in all places that have it."""
    name = place.fault.about
    if place.fault.kind != INVALID_NAME or '"' in name:
        return
    split = re.fullmatch(r"(\w+)(\s*)([{\[]\w*)", name)
    if split:  # a colon is missing before the bracket
        start = place.span.start + place.shown.find(name) + split.end(1)
        blank = split[2] or " "
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
    if fault.kind != UNKNOWN_KEY or node is None or node.value is not None:
        return
    siblings = written.node(fault.path[:-1]).entries
    keys = list(siblings)
    before = keys[keys.index(fault.path[-1]) - 1]
    if before in _FRAGMENT_OF_TEXT and isinstance(siblings[before].value, str):
        span = TextSpan(written.start(siblings[before]), place.span.end)
        text = written.text[span.start : span.end]
        if '"' not in text and "\\" not in text:
            yield from place.fix("put the text in quotes", TextEdit(span, f'"{text}"'))
