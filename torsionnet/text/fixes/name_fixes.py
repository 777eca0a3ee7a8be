"""Quick fixes of names: misspelt ones, ones that are no names, texts that a comma split."""

from __future__ import annotations

import re
from collections.abc import Iterator

from torsionnet.model.files.value_editing import node_at
from torsionnet.text.fixes.fault_place import MEANT, NUMBER, QUOTED, FaultPlace, word_edits
from torsionnet.text.text_edits import TextEdit, TextFix, TextSpan

_GOT = re.compile(r"got '([^']*)'")
_FRAGMENT_OF_TEXT = ("description", "source", "name")


def name_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another word where the message asks whether that was meant."""
    fault, text = place.fault, place.written.text
    found = MEANT.search(fault.message)
    meant = fault.meant or (found[1] if found else "")
    if not meant or ": " in meant or NUMBER.match(meant):
        return
    if fault.path == ("parameters", meant):  # it would define itself
        return
    if "is not connected to the rest" in fault.message:
        both = (fault.message.partition(" ")[0], meant)
        rare, right = sorted(both, key=lambda word: len(list(word_edits(word, text, 0, ""))))
        yield from place.fix(f'write "{right}"', *word_edits(rare, text, 0, right))
        return
    siblings = node_at(place.written.document, fault.path[:-1])
    if fault.on_key and siblings is not None and meant in siblings.entries and fault.kind == "unknown key":
        yield from place.without(fault.path)
        return
    quoted, got = QUOTED.search(fault.message), _GOT.search(fault.message)
    wrong = [fault.about, quoted[1] if quoted else "", got[1] if got else "", fault.message.partition(" ")[0]]
    spans = [place.span, *([place.value_span] if place.value_span else [])]
    for word in wrong:
        for span in spans:
            edits = tuple(word_edits(word, text[span.start : span.end], span.start, meant)) if word else ()
            if edits and word != meant:
                yield from place.fix(f'write "{meant}"', *edits)
                return


def valid_name(place: FaultPlace) -> Iterator[TextFix]:
    """A name of letters, digits and _ in all places that have it."""
    found = re.match(r'"([^"]*)" is not a valid name; use letters', place.fault.message)
    name = found[1] if found else ""
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
    if "text with a comma needs quotes" not in fault.message or node is None or node.value is not None:
        return
    siblings = written.node(fault.path[:-1]).entries
    keys = list(siblings)
    before = keys[keys.index(fault.path[-1]) - 1]
    if before in _FRAGMENT_OF_TEXT and isinstance(siblings[before].value, str):
        span = TextSpan(written.start(siblings[before]), place.span.end)
        text = written.text[span.start : span.end]
        if '"' not in text and "\\" not in text:
            yield from place.fix("put the text in quotes", TextEdit(span, f'"{text}"'))
